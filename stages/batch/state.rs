//! What is known of each point of a study on a cluster.

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Result;
use coronet::pipeline::remote::Remote;
use coronet::pipeline::{self, Decision, Event, Run, Store, Watch};
use coronet::scene::file;

use super::record::Failure;
use super::{job, point, record, system};
use crate::arguments::{On, StudyArguments};
use crate::fault;
use crate::print::note;
use crate::study::trial::{Outcome, Trial};
use crate::{PROGRAM, jobs, remote};

/// How far a point is.
pub enum State {
    /// All results are in the store of this machine, or its scene is refused, which takes no time
    /// to find out.
    Done,
    Failed(Outcome),
    /// In a job of the batch system.
    Running(String),
    Waiting(String),
    /// In no job: never submitted, killed, or stopped.
    Missing,
}

/// A point, and what the rest of it needs.
pub struct Known {
    pub state: State,
    /// CPU time, s.
    pub seconds: f64,
    /// Peak memory, bytes.
    pub memory: f64,
}

impl State {
    pub fn has_ended(&self) -> bool {
        matches!(self, State::Done | State::Failed(_))
    }

    pub fn is_active(&self) -> bool {
        self.job().is_some()
    }

    /// The job that it is in.
    pub fn job(&self) -> Option<&str> {
        match self {
            State::Running(job) | State::Waiting(job) => Some(job),
            _ => None,
        }
    }

    pub fn word(&self) -> &'static str {
        match self {
            State::Done => "done",
            State::Failed(_) => "failed",
            State::Running(_) => "running",
            State::Waiting(_) => "waiting",
            State::Missing => "missing",
        }
    }

    pub fn text(&self) -> String {
        match self {
            State::Failed(Outcome::Failed { why, .. }) => format!("failed: {why}"),
            State::Running(job) | State::Waiting(job) => format!("{} in job {job}", self.word()),
            _ => self.word().to_string(),
        }
    }

    /// The outcome of a point that failed.
    pub fn outcome(self) -> Option<Outcome> {
        match self {
            State::Failed(outcome) => Some(outcome),
            _ => None,
        }
    }
}

/// Looks at all points.
///
/// # Errors
/// If the store cannot be read, or the batch system does not answer.
pub fn look(trials: &[Trial], arguments: &StudyArguments, folder: &Path) -> Result<Vec<Known>> {
    let active = active(arguments, folder)?;
    let asked = job::memory_asked(arguments)?;
    let objects = remote::open(arguments.remote.url(), &arguments.store.artifacts)?;
    let remote = objects.as_deref().map(Remote::only);
    let store = Store::new(&arguments.store.artifacts);
    let mut all = Vec::new();
    for (k, trial) in trials.iter().enumerate() {
        let mut decisions = point::plan(&store, trial)?;
        let lacks = |decisions: &Option<Vec<Decision>>| {
            let mut all = decisions.iter().flatten();
            all.any(|decision| decision.fresh.is_none())
        };
        if let Some(remote) = remote.as_ref().filter(|_| lacks(&decisions)) {
            fetch(&store, trial, remote)?;
            decisions = point::plan(&store, trial)?;
        }
        let state = match active.get(&(k + 1)) {
            _ if !lacks(&decisions) => State::Done,
            Some((job, true)) => State::Running(job.clone()),
            Some((job, false)) => State::Waiting(job.clone()),
            // Here a point that failed runs again.
            None if arguments.batch.on == On::Local => State::Missing,
            None => ended(k + 1, &decisions, folder, asked)?,
        };
        let rest = decisions.iter().flatten();
        let rest: Vec<&Decision> = rest.filter(|decision| decision.fresh.is_none()).collect();
        let seconds = |decision: &&Decision| {
            let threads = decision.work.map_or(1, |work| work.threads);
            decision.seconds.unwrap_or(0.0) * threads as f64
        };
        let memory = rest.iter().filter_map(|decision| decision.work);
        all.push(Known {
            state,
            seconds: rest.iter().map(seconds).sum(),
            memory: memory.map(|work| work.memory).fold(0.0, f64::max),
        });
    }
    Ok(all)
}

/// A point that is in no job and not finished; `asked`: memory of a new job, bytes. What was
/// refused with less runs again.
fn ended(
    number: usize,
    decisions: &Option<Vec<Decision>>,
    folder: &Path,
    asked: Option<f64>,
) -> Result<State> {
    let key = decisions.as_ref().and_then(|all| point::first_key(all));
    let failure = record::failure(folder, number)?;
    let had_less = |failure: &Failure| {
        let more = asked
            .zip(failure.memory)
            .is_some_and(|(asked, had)| asked > had);
        failure.code == fault::USAGE && more
    };
    Ok(
        match failure.filter(|failure| failure.key == key && !had_less(failure)) {
            Some(failure) => State::Failed(Outcome::Failed {
                why: failure.why,
                code: failure.code,
                work: failure.work,
            }),
            None => State::Missing,
        },
    )
}

/// The points that a job has: its number, and whether it runs.
fn active(arguments: &StudyArguments, folder: &Path) -> Result<HashMap<usize, (String, bool)>> {
    let on = arguments.batch.on;
    let word: String = on.into();
    let mut jobs = record::jobs(folder)?;
    jobs.retain(|job| job.on == word);
    if !jobs.is_empty() {
        let server = system::server(on)?;
        jobs.retain(|job| job.server == server);
    }
    let ids: Vec<String> = jobs.into_iter().map(|job| job.id).collect();
    let tasks = system::active(on, &ids)?.into_iter();
    Ok(tasks
        .map(|task| (task.point, (task.job, task.runs)))
        .collect())
}

/// Brings what the remote store has of a point.
fn fetch(store: &Store, trial: &Trial, remote: &Remote) -> Result<()> {
    let Ok(loaded) = file::load(&trial.pipeline, &trial.sets) else {
        return Ok(());
    };
    let mut pipeline = jobs::pipeline(&loaded)?;
    pipeline.name.clone_from(&trial.name);
    let patience = Patience::default();
    let fetched = pipeline::run(&Run {
        store,
        pipeline: &pipeline,
        also: None,
        until: None,
        stop: &patience.0,
        watch: &patience,
        remote: Some(remote),
        threads: 1,
        program: PROGRAM.to_string(),
    });
    match fetched {
        Err(error @ pipeline::PipelineError::Remote { .. }) => {
            note!("warning: {}: {error}", trial.name);
            Ok(())
        }
        // What is not there, or is being made, is missing.
        Err(
            pipeline::PipelineError::NotThere { .. } | pipeline::PipelineError::Interrupted { .. },
        )
        | Ok(_) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// Does not wait for a process that makes a result.
#[derive(Default)]
struct Patience(AtomicBool);

impl Watch for Patience {
    fn event(&self, event: &Event) {
        if let Event::Waiting { .. } = event {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}
