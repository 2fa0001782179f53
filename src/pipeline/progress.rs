//! `progress.json` in the work folder: how far a job is, for whoever looks from another process.
//!
//! It is written when a job starts and at most once a second after that, and stays with the work
//! folder of a job that was stopped or killed. Nothing depends on it: a run goes on where it cannot
//! be written, and a damaged one only has nothing to say.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

use serde::{Deserialize, Serialize};

use super::content::CHECKPOINT;
use super::store::{Store, WORK, entries};
use super::{Progress, machine, stamp};
use crate::file::{self, FileError};
use crate::record::atomic::write_passing;

/// Name of the file.
pub const FILE: &str = "progress.json";

/// No such file is longer, bytes.
const LONGEST: u64 = 1 << 16;

/// Time between two versions of the file.
const BETWEEN: Duration = Duration::from_secs(1);

/// What the file says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Told {
    /// Name under `latest/`.
    pub pipeline: String,
    /// Name of the stage.
    pub stage: String,
    /// What the stage is applied to, or empty.
    pub body: String,
    /// Process that writes it.
    pub process: u32,
    /// Its host.
    pub host: String,
    /// UTC, when this attempt started.
    pub started: String,
    /// Wall time of this attempt, s.
    pub seconds: f64,
    /// Part of the work done, 0 to 1.
    pub fraction: f64,
    /// The part that was done when this attempt first told of it.
    pub first: Option<f64>,
    /// In the unit of the stage, per second; 0 if unknown.
    pub speed: f64,
    /// Unit of the work of the stage.
    pub unit: String,
    /// Where it is: `t = 3.1 of 40 ms`.
    pub text: String,
    /// Why the stage ended, if that was not for a stop or a kill.
    #[serde(default)]
    pub failure: Option<String>,
}

impl Told {
    /// Wall time that is left, if the rest goes as fast as this attempt so far, s.
    pub fn left(&self) -> Option<f64> {
        let done = self.fraction - self.first?;
        (done > 0.0).then(|| self.seconds / done * (1.0 - self.fraction))
    }

    /// For people: `relax drop`.
    pub fn label(&self) -> String {
        stamp::label(&self.stage, &self.body)
    }
}

/// Writes the file.
#[derive(Debug)]
pub(super) struct Teller {
    path: PathBuf,
    start: Instant,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    told: Told,
    last: Instant,
}

impl Teller {
    /// Starts to tell of a job of the pipeline of that name, in its work folder.
    pub(super) fn start(work: &Path, pipeline: &str, [stage, body]: [&str; 2]) -> Teller {
        let told = Told {
            pipeline: pipeline.to_string(),
            stage: stage.to_string(),
            body: body.to_string(),
            process: std::process::id(),
            host: machine::host(),
            started: machine::now(),
            ..Told::default()
        };
        let path = work.join(FILE);
        write(&path, &told);
        let now = Instant::now();
        Teller {
            path,
            start: now,
            state: Mutex::new(State { told, last: now }),
        }
    }

    /// Tells how far the job is, if that was not told just now.
    pub(super) fn tell(&self, progress: &Progress) {
        let Ok(mut state) = self.state.lock() else {
            return;
        };
        let is_first = state.told.first.is_none();
        if !is_first && state.last.elapsed() < BETWEEN {
            return;
        }
        state.last = Instant::now();
        let told = &mut state.told;
        told.seconds = self.start.elapsed().as_secs_f64();
        told.fraction = progress.fraction;
        told.first.get_or_insert(progress.fraction);
        told.speed = progress.speed;
        told.unit = progress.unit.to_string();
        told.text.clone_from(&progress.text);
        write(&self.path, told);
    }

    /// Tells that the stage has ended, and why.
    pub(super) fn fail(&self, cause: &dyn std::error::Error) {
        if let Ok(mut state) = self.state.lock() {
            state.told.failure = Some(cause.to_string());
            write(&self.path, &state.told);
        }
    }
}

/// What cannot be written is not told; that is no reason to stop.
fn write(path: &Path, told: &Told) {
    if let Ok(json) = serde_json::to_string_pretty(told) {
        let _ = write_passing(path, json.as_bytes());
    }
}

/// A job that has begun and not ended.
#[derive(Clone, Debug)]
pub struct Unfinished {
    /// Folder of its key.
    pub folder: PathBuf,
    /// Name of the stage.
    pub stage: String,
    /// The process that works at it; `None` if it was stopped or killed.
    pub holder: Option<String>,
    /// What its file of progress says, and when that was written.
    pub told: Option<(Told, SystemTime)>,
    /// When its newest checkpoint was written.
    pub checkpoint: Option<SystemTime>,
}

impl Unfinished {
    /// For people: `relax drop`; without the body where that is not known.
    pub fn label(&self) -> String {
        match &self.told {
            Some((told, _)) => told.label(),
            None => self.stage.clone(),
        }
    }

    /// When its files were last written.
    pub fn touched(&self) -> Option<SystemTime> {
        let told = self.told.as_ref().map(|(_, at)| *at);
        told.max(self.checkpoint)
    }
}

/// All jobs of a store that have begun and not ended; those under way first. Nothing is written.
///
/// # Errors
/// If a folder cannot be listed, or a lock not be opened.
pub fn unfinished(store: &Store) -> Result<Vec<Unfinished>, FileError> {
    let mut found = Vec::new();
    for stage in store.stages()? {
        for folder in store.folders(&stage)? {
            let work = folder.join(WORK);
            if !file::is_folder(&work)? {
                continue;
            }
            let holder = store.is_locked(&folder)?;
            // Of a finished result, a work folder is what a kill left.
            if holder.is_none() && file::is_there(&folder.join(stamp::FILE))? {
                continue;
            }
            let (told, checkpoint) = (read(&work)?, newest_checkpoint(&work)?);
            if holder.is_some() || told.is_some() || checkpoint.is_some() {
                found.push(Unfinished {
                    told: told.filter(|(told, _)| told.stage == stage),
                    checkpoint,
                    holder,
                    stage: stage.clone(),
                    folder,
                });
            }
        }
    }
    found.sort_by_key(|job| (job.holder.is_none(), std::cmp::Reverse(job.touched())));
    Ok(found)
}

/// What the file in a work folder says, if it is not damaged, and when it was written.
fn read(work: &Path) -> Result<Option<(Told, SystemTime)>, FileError> {
    let path = work.join(FILE);
    let Some(bytes) = file::read_if_there(&path, LONGEST)? else {
        return Ok(None);
    };
    let written = path.symlink_metadata().and_then(|found| found.modified());
    let told = serde_json::from_slice(&bytes).ok().zip(written.ok());
    Ok(told)
}

fn newest_checkpoint(work: &Path) -> Result<Option<SystemTime>, FileError> {
    let is_checkpoint = |entry: &&fs::DirEntry| {
        let path = entry.path();
        path.extension().is_some_and(|found| found == CHECKPOINT)
    };
    let modified = |entry: &fs::DirEntry| entry.metadata().ok()?.modified().ok();
    let all = entries(work)?;
    Ok(all.iter().filter(is_checkpoint).filter_map(modified).max())
}
