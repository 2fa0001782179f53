//! The task of a batch job: one point of a study.

use std::path::Path;

use anyhow::{Result, bail};
use coronet::pipeline::{self, Decision, Store, machine};
use coronet::scene::error::SceneError;
use coronet::scene::file;

use super::FOLDER;
use super::record::{self, Failure};
use crate::arguments::StudyArguments;
use crate::command::study::{STOPPING, told};
use crate::fault::{self, Failed, Usage};
use crate::print::note;
use crate::study::trial::{Outcome, Trial};
use crate::{jobs, signals};

/// Runs point `number`, from 1. A failure is kept for whoever collects the study, and is an error.
pub fn run(trials: &[Trial], number: usize, arguments: &StudyArguments, out: &Path) -> Result<()> {
    let Some(trial) = number.checked_sub(1).and_then(|k| trials.get(k)) else {
        let count = trials.len();
        bail!(Usage(format!("--point {number}: points are 1 to {count}")));
    };
    let stop = signals::stop_flag(STOPPING)?;
    let folder = out.join(FOLDER);
    let threads = arguments.batch.cores.unwrap_or(1);
    let outcome = trial.run(arguments.place(), usize::from(threads), &stop);
    note!("{}  {}  {}", trial.name, trial.title, told(&outcome));
    let Outcome::Failed { why, code, work } = outcome? else {
        return record::set_failure(&folder, number, None);
    };
    let text = format!("{}: {why}", trial.name);
    // What was killed may end well in another try, as with more memory.
    if code < fault::KILLED {
        let failure = Failure {
            key: next(&arguments.store.artifacts, trial)?,
            why,
            code,
            work,
            memory: Some(machine::memory()),
        };
        record::set_failure(&folder, number, Some(&failure))?;
    }
    bail!(Failed(text, code))
}

/// Key of the first result that a point lacks.
fn next(artifacts: &Path, trial: &Trial) -> Result<Option<coronet::record::Digest>> {
    let lacks = plan(&Store::new(artifacts), trial)?;
    Ok(lacks.and_then(|decisions| first_key(&decisions)))
}

/// The decisions about the jobs of a point; `None` if its scene is refused.
pub fn plan(store: &Store, trial: &Trial) -> Result<Option<Vec<Decision>>> {
    let loaded = match file::load(&trial.pipeline, &trial.sets) {
        Ok(loaded) => loaded,
        Err(SceneError::File(error)) => return Err(error.into()),
        Err(_) => return Ok(None),
    };
    let pipeline = jobs::pipeline(&loaded)?;
    Ok(Some(pipeline::plan(store, &pipeline)?))
}

/// Key of the first result that is not there.
pub fn first_key(decisions: &[Decision]) -> Option<coronet::record::Digest> {
    let mut lacks = decisions.iter().filter(|decision| decision.fresh.is_none());
    lacks.next().and_then(|decision| decision.key)
}
