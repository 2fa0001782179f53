//! The frames of a run: of its log, or, while it is under way, of the logs that it has begun.

use std::path::{Path, PathBuf};

use super::read::{Info, info, read_frames};
use super::times::times;
use super::{LogError, segments};
use crate::file;
use crate::particle::Frame;

/// The log of the run that a run continues, in its work folder.
pub const BASE: &str = "base.mcap";

/// Two times are equal if they differ by less, s.
const EQUAL: f64 = 1e-9;

/// Logs that follow each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Reel {
    logs: Vec<PathBuf>,
    /// Whether the last one of each attempt may be incomplete.
    is_open: bool,
}

impl Reel {
    /// The log at `path`, of a finished run.
    pub fn finished(path: &Path) -> Self {
        Reel {
            logs: vec![path.to_path_buf()],
            is_open: false,
        }
    }

    /// What a run has written to its work folder; `None` if it has begun no log.
    ///
    /// # Errors
    /// If the folder or a segment cannot be read.
    pub fn under_way(work: &Path) -> Result<Option<Self>, LogError> {
        let base = work.join(BASE);
        let mut logs: Vec<PathBuf> = match file::is_there(&base)? {
            true => vec![base],
            false => Vec::new(),
        };
        logs.extend(segments(work)?.into_iter().map(|segment| segment.path));
        let is_open = true;
        Ok((!logs.is_empty()).then_some(Reel { logs, is_open }))
    }

    /// The first log.
    pub fn path(&self) -> &Path {
        &self.logs[0]
    }

    /// What it says at its beginning.
    ///
    /// # Errors
    /// As [`info`].
    pub fn info(&self) -> Result<Info, LogError> {
        info(self.path())
    }

    /// Times of the frames, s, in their order.
    ///
    /// # Errors
    /// If the log of a finished run cannot be read to its end, or one cannot be read at all.
    pub fn times(&self) -> Result<Vec<f64>, LogError> {
        match self.is_open {
            false => times(self.path()),
            true => self.frames()?.map(|frame| Ok(frame?.time)).collect(),
        }
    }

    /// All frames, in their order, as [`read_frames`]; a log that is being written ends where it is
    /// incomplete.
    ///
    /// # Errors
    /// If a log cannot be opened.
    pub fn frames(
        &self,
    ) -> Result<impl Iterator<Item = Result<Frame, LogError>> + use<>, LogError> {
        let logs = self.logs.iter().map(|path| read_frames(path));
        let logs = logs.collect::<Result<Vec<_>, LogError>>()?;
        let is_open = self.is_open;
        let goes_on = move |frame: &Result<Frame, LogError>| {
            let error = frame.as_ref().err();
            !error.is_some_and(|error| is_open && error.is_damage())
        };
        // A log that was resumed begins before the end of the one before, with the same frames.
        let mut last = f64::NEG_INFINITY;
        let is_new = move |frame: &Result<Frame, LogError>| {
            let Ok(frame) = frame else { return true };
            let is_new = frame.time > last + EQUAL;
            last = last.max(frame.time);
            is_new
        };
        let frames = logs
            .into_iter()
            .flat_map(move |log| log.take_while(goes_on));
        Ok(frames.filter(is_new))
    }
}
