//! The frames of a run from which pictures are made: of its log, or, while it is under way, of what
//! it has recorded so far.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use coronet::file::exists;
use coronet::particle::Frame;
use coronet::pipeline::progress::{Unfinished, unfinished};
use coronet::pipeline::store::WORK;
use coronet::pipeline::{Store, content};
use coronet::record::log::{self, LogError};
use coronet::scene::Scene;

use crate::arguments::RenderArguments;
use crate::fault::Usage;
use crate::journal::{BASE, FRAMES};
use crate::runs::Run;

/// Two times are equal if they differ by less, s.
const EQUAL: f64 = 1e-9;

/// Logs that follow each other, and the frames of them that are wanted.
pub struct Footage {
    logs: Vec<PathBuf>,
    /// Whether the last log may be incomplete.
    is_open: bool,
    from: f64,
    until: f64,
    every: f64,
}

impl Footage {
    /// Finds the log of the run that a user means.
    ///
    /// # Errors
    /// If there is no such run, or it has no frames.
    pub fn find(arguments: &RenderArguments) -> Result<Footage> {
        let (logs, is_open) = logs(arguments)?;
        if logs.is_empty() {
            let text = format!("{} has no frames yet; run it, or wait", arguments.run);
            bail!(Usage(text));
        }
        Ok(Footage {
            logs,
            is_open,
            from: arguments.from.unwrap_or(f64::NEG_INFINITY),
            until: arguments.until.unwrap_or(f64::INFINITY),
            every: arguments.every.unwrap_or(0.0),
        })
    }

    /// The scene, of which the part that was simulated.
    ///
    /// # Errors
    /// If the log cannot be read, or its scene is of another version.
    pub fn scene(&self) -> Result<Scene> {
        let first = &self.logs[0];
        Ok(log::info(first)?.scene(first)?)
    }

    /// All frames, in their order; a log that is being written ends where it is incomplete.
    fn all(&self) -> Result<impl Iterator<Item = Result<Frame, LogError>>> {
        let frames = self.logs.iter().map(|path| log::read_frames(path));
        let frames = frames.collect::<Result<Vec<_>, LogError>>()?;
        let is_open = self.is_open;
        let mut last = f64::NEG_INFINITY;
        let ends = move |frame: &Result<Frame, LogError>| {
            let error = frame.as_ref().err();
            !error.is_some_and(|error| is_open && error.is_damage())
        };
        // A log that was resumed begins before the end of the one before, with the same frames.
        let is_new = move |frame: &Result<Frame, LogError>| {
            let Ok(frame) = frame else { return true };
            let is_new = frame.time > last + EQUAL;
            last = last.max(frame.time);
            is_new
        };
        Ok(frames
            .into_iter()
            .flat_map(move |log| log.take_while(ends))
            .filter(is_new))
    }

    /// The frames between the wanted times.
    ///
    /// # Errors
    /// If a log cannot be opened.
    pub fn chosen(&self) -> Result<impl Iterator<Item = Result<Frame, LogError>>> {
        let (from, until, every) = (self.from - EQUAL, self.until + EQUAL, self.every - EQUAL);
        let mut next = from;
        let is_early = move |frame: &Result<Frame, LogError>| {
            frame.as_ref().map_or(true, |frame| frame.time <= until)
        };
        let is_due = move |frame: &Result<Frame, LogError>| {
            let Ok(frame) = frame else { return true };
            let is_due = frame.time >= next;
            if is_due {
                next = frame.time + every;
            }
            is_due
        };
        Ok(self.all()?.take_while(is_early).filter(is_due))
    }

    /// The frame nearest to a time, or the last one. As in an export, the time may be outside the
    /// frames by half of their distance.
    ///
    /// # Errors
    /// If the time is outside the run.
    pub fn one(&self, at: Option<f64>, scene: &Scene) -> Result<Frame> {
        let goal = at.unwrap_or(f64::INFINITY);
        let mut best: Option<Frame> = None;
        let (mut first, mut last) = (f64::INFINITY, f64::NEG_INFINITY);
        for frame in self.all()? {
            let frame = frame?;
            (first, last) = (first.min(frame.time), last.max(frame.time));
            let distance = |frame: &Frame| (frame.time - goal).abs();
            let is_better = |best: &Frame| goal.is_infinite() || distance(&frame) < distance(best);
            if best.as_ref().is_none_or(is_better) {
                let is_past = frame.time > goal;
                best = Some(frame);
                if is_past {
                    break;
                }
            } else {
                break;
            }
        }
        let Some(best) = best else {
            bail!(Usage("the log has no frame".into()));
        };
        let reach = 0.5 * scene.frames.interval;
        let near = first - reach - EQUAL..=last + reach + EQUAL;
        if at.is_some_and(|at| !near.contains(&at)) {
            let (at, nearest) = (1e3 * goal, 1e3 * best.time);
            bail!(Usage(format!(
                "there is no frame at {at} ms: the nearest one is at {nearest:.3} ms"
            )));
        }
        Ok(best)
    }
}

/// The logs of a run in their order, and whether it is under way.
fn logs(arguments: &RenderArguments) -> Result<(Vec<PathBuf>, bool)> {
    let path = Path::new(&arguments.run);
    if path.extension().is_some_and(|found| found == content::LOG) && exists(path)? {
        return Ok((vec![path.to_path_buf()], false));
    }
    let store = Store::new(&arguments.store.artifacts);
    let jobs = if exists(store.root())? {
        unfinished(&store)?
    } else {
        Vec::new()
    };
    let is_mine = |job: &&Unfinished| {
        let told = job.told.as_ref();
        job.stage == "impact" && told.is_some_and(|(told, _)| told.pipeline == arguments.run)
    };
    let mine = jobs.iter().find(is_mine);
    let run = Run::meant(&store, &arguments.run);
    if let Some(job) = mine {
        // A run that was stopped is named after its last checkpoint, and has no impact then.
        let named = run
            .as_ref()
            .ok()
            .filter(|run| run.result("impact").is_some());
        if job.holder.is_some() || job.touched() > named.and_then(|run| run.named) {
            let work = job.folder.join(WORK);
            let segments = log::segments(&work)?;
            // Frames of the run that this one continues.
            let base = work.join(BASE);
            let mut logs: Vec<PathBuf> = exists(&base)?.then_some(base).into_iter().collect();
            logs.extend(segments.into_iter().map(|segment| segment.path));
            return Ok((logs, true));
        }
    }
    let run = run?;
    let impact = run.result("impact").map(|(folder, _)| folder.join(FRAMES));
    Ok((impact.into_iter().collect(), false))
}
