//! The frames of a running impact, and the instants at which it can begin: joins the frames and
//! checkpoints of all attempts to one result.

use coronet::file;
use coronet::measure::loss;
use coronet::method::frame::Schedule;
use coronet::method::{Diverged, Solver};
use coronet::particle::State;
use coronet::pipeline::content::LOG;
use coronet::pipeline::content::{ContentError, content};
use coronet::pipeline::store::entries;
use coronet::pipeline::{Context, Relative, StageError};
use coronet::record::Checkpoint;
use coronet::record::log::{self, BASE, LogError, LogWriter, Segment};

use crate::flight::{self, Shared};
use crate::stop::{Past, Stop};

/// Frames of the whole run.
pub const FRAMES: &str = "frames.mcap";

/// Number of the next frame, as a scalar of a checkpoint.
const NEXT: &str = "frames/next";
/// Number of frames taken so far.
const TAKEN: &str = "frames/taken";

/// Begin of a run.
pub struct Start {
    pub state: State,
    pub next: u64,
    pub taken: u64,
    /// What is known of the frames so far.
    pub past: Option<Past>,
    /// Begin after t = 0.
    pub resumed: bool,
}

/// Why a run did not reach its end.
pub enum Trouble {
    Stage(StageError),
    /// Frames before the checkpoint are missing in the log.
    FramesLost(String),
}

impl From<StageError> for Trouble {
    fn from(error: StageError) -> Self {
        Trouble::Stage(error)
    }
}

impl From<Trouble> for StageError {
    fn from(trouble: Trouble) -> Self {
        match trouble {
            Trouble::Stage(error) => error,
            Trouble::FramesLost(what) => StageError::failed(what),
        }
    }
}

/// Takes the frames when they are due.
pub struct Frames {
    pub log: LogWriter,
    pub due: Schedule,
    pub taken: u64,
    pub error: Option<LogError>,
    pub watch: loss::Watch,
    /// Measures frames, which can end the run.
    pub stop: Stop,
    /// Remark about the last frame.
    pub warning: Option<String>,
}

impl Frames {
    /// Takes a frame if the solver has reached the next frame's time.
    pub fn step(&mut self, solver: &dyn Solver) {
        let time = solver.time();
        if self.error.is_some() || !self.due.takes(time) {
            return;
        }
        let frame = solver.frame();
        let warning = self.watch.look(time, &frame.scalars);
        self.warning = warning.or(self.warning.take());
        let figures = self.stop.look(&frame);
        self.error = self.log.measured(frame, figures).err();
        self.taken += 1;
    }

    /// Whether a condition has ended the run.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_met()
    }

    pub fn check(&mut self) -> Result<(), StageError> {
        self.error
            .take()
            .map_or(Ok(()), |error| Err(StageError::failed(error)))
    }

    /// What this process has of a checkpoint, and what gives the rest.
    pub fn checkpoint<'a>(&self, solver: &'a dyn Solver) -> Shared<'a> {
        let (state, more) = solver.share();
        let mut checkpoint = Checkpoint::from(state);
        checkpoint.scalars.push((NEXT.into(), self.due.next as f64));
        checkpoint.scalars.push((TAKEN.into(), self.taken as f64));
        self.stop.keep(&mut checkpoint);
        (checkpoint, more)
    }
}

/// The instant of a checkpoint, if it is one of an impact.
pub fn start(checkpoint: Checkpoint) -> Option<Start> {
    let next = checkpoint.scalar(NEXT)? as u64;
    let taken = checkpoint.scalar(TAKEN)? as u64;
    let past = Some(Past::read(&checkpoint)?);
    Some(Start {
        state: State::try_from(checkpoint).ok()?,
        past,
        next,
        taken,
        resumed: true,
    })
}

/// Makes a finished run the beginning of this one: its log becomes the base. The inner error is
/// the reason why it cannot be used.
pub fn adopt(
    context: &Context,
    relative: &Relative,
    file: &str,
) -> Result<Result<Start, String>, StageError> {
    let log = relative.folder.join(FRAMES);
    let mut outputs = relative.stamp.outputs.iter();
    let wanted = outputs
        .find(|output| output.file == FRAMES)
        .map(|output| output.digest);
    match content(&log) {
        Ok(found) if Some(found) == wanted => {}
        Ok(_) => return Ok(Err("its log belongs to another run".into())),
        Err(ContentError::Damaged(what)) => return Ok(Err(what)),
        Err(ContentError::File(error)) => return Err(error.into()),
    }
    let start = match relative.checkpoint(file) {
        Ok(checkpoint) => start(checkpoint),
        Err(ContentError::Damaged(what)) => return Ok(Err(what)),
        Err(ContentError::File(error)) => return Err(error.into()),
    };
    let Some(start) = start else {
        return Ok(Err(format!("{file} is not a state of an impact")));
    };
    flight::clear(context)?;
    flight::link_or_copy(&log, &context.work().join(BASE)).map_err(StageError::failed)?;
    Ok(Ok(start))
}

/// Number of the first segment that does not exist yet.
pub fn next_segment(context: &Context) -> Result<u32, StageError> {
    let entries = entries(context.work())?;
    let numbers = entries.iter().filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        name.strip_prefix("segment-")?
            .strip_suffix(&format!(".{LOG}"))?
            .parse::<u32>()
            .ok()
    });
    Ok(numbers.max().map_or(0, |last| last.saturating_add(1)))
}

/// One log of all segments, with every frame that was taken. If a segment is damaged, frames are
/// lost, and the run has to start again.
pub fn merge(context: &Context, taken: u64) -> Result<(), Trouble> {
    let trouble = |error: LogError| match error.is_damage() {
        true => Trouble::FramesLost(error.to_string()),
        false => StageError::failed(error).into(),
    };
    let mut segments = log::segments(context.work()).map_err(trouble)?;
    let path = context.work().join(BASE);
    if file::is_there(&path).map_err(StageError::from)? {
        let resumed_from = None;
        segments.insert(0, Segment { path, resumed_from });
    }
    let merged = log::merge(&segments, &context.output().join(FRAMES)).map_err(trouble)?;
    if merged.frames != taken {
        let what = format!("the log has {} of {taken} frames", merged.frames);
        return Err(Trouble::FramesLost(what));
    }
    Ok(())
}

/// A failed log makes checkpoints fail, which wait for its frames; returns the log's error.
pub fn first_cause(error: StageError, log: LogWriter) -> StageError {
    let StageError::Failed(source) = error else {
        return error;
    };
    match log.finish() {
        Err(cause) if !source.is::<Diverged>() && !matches!(cause, LogError::Closed) => {
            StageError::failed(cause)
        }
        _ => StageError::Failed(source),
    }
}
