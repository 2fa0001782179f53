//! Studies on a cluster, and a look at any study: one array job of the batch system, each task of
//! which is a point.
//!
//! | module | what |
//! |---|---|
//! | `point` | the task: runs one point, and keeps why it failed |
//! | `state` | what is known of each point, from the store and from the batch system |
//! | `system` | the commands of Slurm and of HyperQueue |
//! | `job` | what a job asks for, and its script |
//! | `record` | the files beside the table of the study: submitted jobs, failed points |
//!
//! Points share a store on a file system that all nodes see, or a remote store. Nothing else
//! travels, so any shell can look at a study, stop it and continue it.

mod job;
pub mod point;
pub mod record;
mod state;
mod system;

use std::path::Path;
use std::time::Duration;

use anyhow::{Result, bail};
use coronet::pipeline::machine;
use serde_json::json;

use crate::arguments::StudyArguments;
use crate::print::{note, out};
use crate::study::trial::{Outcome, Trial};
use crate::table;
use crate::watch::duration;
use job::Job;
use record::Submitted;
use state::{Known, State};

/// Time between two looks of a command that waits.
const BETWEEN: Duration = Duration::from_secs(5);

/// Looks one after the other that may fail in a command that waits, as those at a busy system do.
const UNANSWERED: usize = 60;

/// Folder of the files of this module, in that of the study's results.
const FOLDER: &str = "batch";

/// Brings a study on a cluster a step further. When every point has ended: the points that failed
/// there; the others are finished in the store, or run here in no time.
///
/// # Errors
/// If the store, the batch system or an option cannot be used.
pub fn collect(
    trials: &[Trial],
    arguments: &StudyArguments,
    out: &Path,
) -> Result<Option<Vec<Option<Outcome>>>> {
    let folder = out.join(FOLDER);
    let options = &arguments.batch;
    let submits = !options.look && !options.cancel;
    let lock = submits.then(|| record::lock(&folder)).transpose()?;
    let mut known = state::look(trials, arguments, &folder)?;
    if options.cancel {
        return cancel(&known, arguments).map(|()| None);
    }
    let missing: Vec<usize> = places(&known, |state| matches!(state, State::Missing));
    if !missing.is_empty() && submits {
        let job = Job::new(&missing, &known, arguments, &folder)?;
        let server = system::server(options.on)?;
        let id = system::submit(options.on, &job)?;
        let submitted = Submitted {
            on: options.on.into(),
            id,
            server,
            points: job.points.clone(),
            at: machine::now(),
        };
        record::add(&folder, submitted)?;
        known = state::look(trials, arguments, &folder)?;
    }
    drop(lock);
    let mut unanswered = 0;
    while options.wait && known.iter().any(|known| known.state.is_active()) {
        std::thread::sleep(BETWEEN);
        match state::look(trials, arguments, &folder) {
            Ok(found) => (known, unanswered) = (found, 0),
            Err(error) if unanswered < UNANSWERED => {
                unanswered += 1;
                note!("warning: {error:#}; the jobs go on, and are looked at again");
            }
            Err(error) => return Err(error),
        }
    }
    let is_whole = known.iter().all(|known| known.state.has_ended());
    if !is_whole || options.look {
        tell(trials, &known, arguments);
    }
    if options.wait && !is_whole {
        let logs = folder.join(job::LOGS);
        bail!(
            "points ended without a result; their output is in {}. The same command submits them \
             again",
            logs.display()
        );
    }
    let failed = known.into_iter().map(|known| known.state.outcome());
    Ok((is_whole && !options.look).then(|| failed.collect()))
}

/// Numbers of the points in a state.
fn places(known: &[Known], is: impl Fn(&State) -> bool) -> Vec<usize> {
    let points = known.iter().enumerate();
    let found = points.filter(|(_, known)| is(&known.state));
    found.map(|(k, _)| k + 1).collect()
}

fn cancel(known: &[Known], arguments: &StudyArguments) -> Result<()> {
    let active = known.iter().filter_map(|known| known.state.job());
    let mut jobs: Vec<&str> = active.collect();
    jobs.sort_unstable();
    jobs.dedup();
    for job in &jobs {
        system::cancel(arguments.batch.on, job)?;
        note!(
            "job {job} was told to stop; its points stop after a checkpoint if they get the time"
        );
    }
    if jobs.is_empty() {
        note!("no point is waiting or running");
    }
    Ok(())
}

/// The state of each point, and what to do next.
fn tell(trials: &[Trial], known: &[Known], arguments: &StudyArguments) {
    let states = || trials.iter().zip(known);
    let count = |word: &str| known.iter().filter(|k| k.state.word() == word).count();
    let rest = |known: &Known| match known.state.has_ended() {
        true => 0.0,
        false => known.seconds,
    };
    let words = ["done", "failed", "running", "waiting", "missing"];
    if arguments.store.json {
        let point = |(trial, known): (&Trial, &Known)| {
            json!({"point": trial.name, "title": trial.title, "state": known.state.word(),
                "job": known.state.job(), "cpu_seconds": known.seconds})
        };
        let points: Vec<_> = states().map(point).collect();
        let counts: serde_json::Map<_, _> = words
            .map(|word| (word.to_string(), json!(count(word))))
            .into_iter()
            .collect();
        return out!("{}", json!({"points": points, "counts": counts}));
    }
    let row = |(trial, known): (&Trial, &Known)| {
        let rest = match rest(known) {
            0.0 => String::new(),
            seconds => format!("about {} of CPU", duration(seconds)),
        };
        vec![
            trial.name.clone(),
            trial.title.clone(),
            known.state.text(),
            rest,
        ]
    };
    for line in table::lines(&states().map(row).collect::<Vec<_>>(), &[]) {
        out!("{line}");
    }
    let counts = words.map(|word| format!("{} {word}", count(word)));
    let rest = match known.iter().map(rest).sum() {
        0.0 => String::new(),
        seconds => format!("; about {} of CPU to go", duration(seconds)),
    };
    out!("{}{rest}", counts.join(", "));
    if !arguments.batch.look {
        out!("look     the same command with --look; `coronet status` shows running jobs");
        out!("stop     the same command with --cancel");
        out!(
            "go on    the same command: it submits what is missing, and writes the table at the end"
        );
    }
}
