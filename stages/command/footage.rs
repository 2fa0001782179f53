//! The frames of a run from which pictures are made: of its log, or, while it is under way, of what
//! it has recorded so far.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use coronet::file::exists;
use coronet::particle::Frame;
use coronet::pipeline::progress::{Unfinished, unfinished};
use coronet::pipeline::store::WORK;
use coronet::pipeline::{Store, content};
use coronet::record::log::{LogError, Reel};
use coronet::scene::Scene;

use crate::arguments::RenderArguments;
use crate::fault::Usage;
use crate::journal::FRAMES;
use crate::print::note;
use crate::runs::Run;

/// Two times are equal if they differ by less, s.
const EQUAL: f64 = 1e-9;

/// The frames of a run that are wanted.
pub struct Footage {
    reel: Reel,
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
        let path = Path::new(&arguments.run);
        let is_log = path.extension().is_some_and(|found| found == content::LOG);
        let store = Store::new(&arguments.store.artifacts);
        let reel = match is_log && exists(path)? {
            true => Reel::finished(path),
            false => reel(&store, &arguments.run)?,
        };
        Ok(Footage {
            reel,
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
        Ok(self.reel.info()?.scene(self.reel.path())?)
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
        Ok(self.reel.frames()?.take_while(is_early).filter(is_due))
    }

    /// The mistake when no frame is between the wanted times.
    ///
    /// # Errors
    /// If a log cannot be read.
    pub fn none_chosen(&self) -> Result<Usage> {
        let times = self.reel.frames()?.map(|frame| Ok(frame?.time));
        let times: Vec<f64> = times.collect::<Result<_, LogError>>()?;
        let (Some(first), Some(last)) = (times.first(), times.last()) else {
            return Ok(Usage("the log has no frame".into()));
        };
        let [first, last] = [first, last].map(|time| 1e3 * time);
        Ok(Usage(format!(
            "no frame is between these times; the log has those from {first:.3} to {last:.3} ms"
        )))
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
        for frame in self.reel.frames()? {
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

/// The frames of a run that is under way, or stopped, and that `name` means; `None` if it is not.
///
/// # Errors
/// If something cannot be read, or it has written no frames.
pub fn under_way(store: &Store, name: &str) -> Result<Option<Reel>> {
    let jobs = match exists(store.root())? {
        true => unfinished(store)?,
        false => Vec::new(),
    };
    let meant = Path::new(name).canonicalize().ok();
    let is_mine = |job: &&Unfinished| {
        let told = job.told.as_ref();
        let is_its_folder = meant.is_some() && job.folder.canonicalize().ok() == meant;
        let is_meant = is_its_folder || told.is_some_and(|(told, _)| told.pipeline == name);
        job.stage == "impact" && is_meant
    };
    let Some(job) = jobs.iter().find(is_mine) else {
        return Ok(None);
    };
    // A run that was stopped is named after its last checkpoint, and has no impact then.
    let run = Run::meant(store, name).ok();
    let is_finished = run.is_some_and(|run| run.result("impact").is_some());
    if job.holder.is_none() && is_finished {
        return Ok(None);
    }
    let begun = Reel::under_way(&job.folder.join(WORK))?;
    let has_frames = |reel: &Reel| Ok::<_, LogError>(reel.frames()?.next().is_some());
    let reel = match begun {
        Some(reel) if has_frames(&reel)? => Some(reel),
        _ => None,
    };
    match (reel, is_finished) {
        (Some(reel), false) => Ok(Some(reel)),
        (Some(reel), true) => {
            note!(
                "these are frames of the run of {name} that is under way, not of the finished one \
                 in latest"
            );
            Ok(Some(reel))
        }
        (None, true) => Ok(None),
        (None, false) => bail!(no_frames(name)),
    }
}

fn no_frames(name: &str) -> Usage {
    Usage(format!("{name} has no frames yet; run it, or wait"))
}

/// The frames of the run that a user means.
fn reel(store: &Store, name: &str) -> Result<Reel> {
    if let Some(reel) = under_way(store, name)? {
        return Ok(reel);
    }
    let run = Run::meant(store, name)?;
    match run.result("impact") {
        Some((folder, _)) => Ok(Reel::finished(&folder.join(FRAMES))),
        None => {
            check_gone(&run)?;
            bail!(no_frames(name))
        }
    }
}

/// An error if the impact of a run is gone.
pub fn check_gone(run: &Run) -> Result<()> {
    let is_impact = |folder: &&PathBuf| folder.parent().is_some_and(|p| p.ends_with("impact"));
    if let Some(folder) = run.gone.iter().find(is_impact) {
        let folder = folder.display();
        bail!("the result in {folder} is gone; `coronet run` makes it again");
    }
    Ok(())
}
