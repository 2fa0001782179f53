//! What a run has not made, and the command that goes on.

use coronet::pipeline::{self, Pipeline, PipelineError, Store};

use crate::print::{note, out, quoted};

/// Jobs without a result, and the command that makes them.
pub struct Rest {
    /// Their names, with what each goes on from.
    pub missing: Vec<String>,
    pub command: String,
}

impl Rest {
    /// `None` if nothing is missing.
    ///
    /// # Errors
    /// If the store cannot be read.
    pub fn of(store: &Store, pipeline: &Pipeline) -> Result<Option<Rest>, PipelineError> {
        let decisions = pipeline::plan(store, pipeline)?;
        let stale = decisions.iter().filter(|decision| decision.fresh.is_none());
        let missing: Vec<String> = stale
            .map(|decision| match &decision.start {
                Some(start) => format!("{} (goes on from {start})", decision.label()),
                None => decision.label(),
            })
            .collect();
        Ok((!missing.is_empty()).then(|| Rest {
            missing,
            command: command(std::env::args_os().map(|word| word.to_string_lossy().into_owned())),
        }))
    }

    /// On standard output.
    pub fn print(&self) {
        out!("missing  {}", self.missing.join(", "));
        out!("go on    {}", self.command);
    }

    /// On standard error, beside an error.
    pub fn tell(&self) {
        note!("missing  {}", self.missing.join(", "));
        note!("go on    {}", self.command);
    }
}

/// The words of a command without `--until`, for a shell.
fn command(words: impl Iterator<Item = String>) -> String {
    let (mut kept, mut skip) = (Vec::new(), false);
    for word in words {
        if std::mem::take(&mut skip) {
            continue;
        }
        match word.as_str() {
            "--until" => skip = true,
            text if text.starts_with("--until=") => {}
            text => kept.push(quoted(text)),
        }
    }
    kept.join(" ")
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_command_that_goes_on_is_the_same_without_its_end() {
        let words = ["coronet", "run", "--until", "relax", "--set", "a.b=1 m/s"];
        let command = super::command(words.iter().map(|word| word.to_string()));
        assert_eq!(command, "coronet run --set 'a.b=1 m/s'");
        let words = ["run", "--until=pack", "it's"].map(str::to_string);
        assert_eq!(super::command(words.into_iter()), "run 'it'\\''s'");
    }
}
