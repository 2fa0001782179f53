//! `coronet verify` and `coronet gc`: care of the store.

use std::io::{BufRead as _, IsTerminal as _};
use std::path::PathBuf;

use anyhow::{Context as _, Result, bail};
use coronet::pipeline::sweep::{self, Options, Swept};
use coronet::pipeline::verify::{self, Finding, Problem};
use coronet::pipeline::{self, Store};
use coronet::scene::file;
use serde_json::json;

use crate::arguments::{StoreArguments, SweepArguments};
use crate::fault::{Unreadable, Untrusted, Usage};
use crate::jobs;
use crate::print::{note, out};

pub fn verify(arguments: &StoreArguments) -> Result<()> {
    let store = existing(&arguments.artifacts)?;
    let findings = verify::verify(&store, &mut |finding| {
        print_finding(finding, arguments.json)
    })?;
    let problems: Vec<&Problem> = findings.iter().flat_map(|found| &found.problems).collect();
    let bytes: u64 = findings.iter().map(|finding| finding.bytes).sum();
    let (results, count) = (findings.len(), problems.len());
    if arguments.json {
        out!(
            "{}",
            json!({"results": results, "bytes": bytes, "problems": count})
        );
    } else {
        out!("{results} results, {}, {count} problems", size(bytes));
    }
    let damaged = problems.iter().filter(|problem| problem.damaged).count();
    if damaged > 0 {
        let text =
            format!("files that cannot be trusted: {damaged}; `coronet run` makes them again");
        bail!(Untrusted(text));
    }
    if count > 0 {
        bail!(Unreadable(format!(
            "files that cannot be read: {count}; they are left as they are"
        )));
    }
    if results == 0 {
        let path = store.root().display();
        bail!(Usage(format!(
            "{path} holds no finished result, so nothing was verified"
        )));
    }
    Ok(())
}

/// The store at a path, where there must be one.
fn existing(path: &std::path::Path) -> Result<Store> {
    match path.metadata() {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let path = path.display();
            bail!(Usage(format!(
                "there is no store at {path}; name it with --artifacts"
            )))
        }
        other => other.with_context(|| format!("cannot examine {}", path.display()))?,
    };
    Ok(Store::new(path))
}

fn print_finding(finding: &Finding, json: bool) {
    if json {
        let problem = |problem: &Problem| {
            let kept = problem.kept.as_ref().map(|kept| kept.to_string_lossy());
            json!({"file": problem.file.to_string_lossy(), "what": problem.what,
                "damaged": problem.damaged, "kept": kept})
        };
        let problems: Vec<_> = finding.problems.iter().map(problem).collect();
        let object = json!({
            "folder": finding.folder.to_string_lossy(),
            "result": finding.label,
            "bytes": finding.bytes,
            "problems": problems,
        });
        return out!("{object}");
    }
    let word = if finding.problems.is_empty() {
        "good"
    } else {
        "bad"
    };
    out!("{word:5} {:20} {}", finding.label, finding.folder.display());
    for problem in &finding.problems {
        out!("      {}: {}", problem.file.display(), problem.what);
        if let Some(kept) = &problem.kept {
            out!("      kept as {}", kept.display());
        }
    }
}

pub fn sweep(arguments: &SweepArguments) -> Result<()> {
    let store = existing(&arguments.store.artifacts)?;
    let options = options(&store, arguments)?;
    let json = arguments.store.json;
    if arguments.dry_run {
        return print_swept(sweep::plan(&store, &options)?, json, "would remove");
    }
    // Refused before anything is asked.
    drop(sweep::hold(&store)?);
    let planned = sweep::plan(&store, &options)?;
    let asks = !arguments.yes && !json && std::io::stdin().is_terminal();
    if asks && !planned.removed.is_empty() {
        print_list(&planned, json, "would remove");
        if !agreed()? {
            out!("nothing was removed");
            return Ok(());
        }
    }
    let approved: Vec<PathBuf> = planned.removed.into_iter().map(|(path, ..)| path).collect();
    let mut swept = sweep::sweep(&store, &options, &approved)?;
    swept.unknown.extend(planned.unknown);
    print_swept(swept, json, "removed")
}

fn options(store: &Store, arguments: &SweepArguments) -> Result<Options> {
    let mut planned = Vec::new();
    for path in &arguments.pipelines {
        let loaded = file::load(path, &[])?;
        let pipeline = jobs::pipeline(&loaded)?;
        let decisions = pipeline::plan(store, &pipeline)?;
        planned.push((path.display().to_string(), decisions));
    }
    Ok(Options {
        older_than: arguments.older_than,
        unfinished: arguments.unfinished,
        forgotten: arguments.forget.clone(),
        planned,
        without_names: arguments.without_names,
    })
}

/// Asks on the terminal.
fn agreed() -> Result<bool> {
    note!("remove these results? [y/N]");
    let mut answer = String::new();
    let asked = std::io::stdin().lock().read_line(&mut answer);
    asked.context("cannot read the answer")?;
    Ok(["y", "yes"].contains(&answer.trim().to_lowercase().as_str()))
}

/// Fails if some folders could not be read.
fn print_swept(swept: Swept, json: bool, word: &str) -> Result<()> {
    print_list(&swept, json, word);
    match swept.unknown.into_iter().next() {
        Some(error) => Err(error).context("not all of the store can be read"),
        None => Ok(()),
    }
}

fn print_list(swept: &Swept, json: bool, word: &str) {
    for (folder, why) in &swept.kept {
        if json {
            out!("{}", json!({"kept": folder.to_string_lossy(), "why": why}));
        } else {
            out!("keep    {} ({why})", folder.display());
        }
    }
    for (folder, label, bytes) in &swept.removed {
        if json {
            let object = json!({"removed": folder.to_string_lossy(), "result": label,
                "bytes": bytes, "dry_run": word != "removed"});
            out!("{object}");
        } else {
            out!("{word} {} ({label}, {})", folder.display(), size(*bytes));
        }
    }
    for error in &swept.unknown {
        if json {
            let folder = error.path.to_string_lossy();
            out!("{}", json!({"kept": folder, "why": error.to_string()}));
        } else {
            out!("keep    {error}");
        }
    }
    if json {
        return;
    }
    let bytes = swept.removed.iter().map(|(_, _, bytes)| bytes).sum();
    out!("{word} {} results, {}", swept.removed.len(), size(bytes));
}

/// Bytes for people.
pub fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{b} B"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b if b < 1e12 => format!("{:.2} GB", b / 1e9),
        b => format!("{:.2} TB", b / 1e12),
    }
}
