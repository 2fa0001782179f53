//! The log: what happened, frame by frame, as an MCAP file of well-known Foxglove messages
//! (protobuf), so that stock viewers show it with no plug-in.
//!
//! | topic | schema | when |
//! |---|---|---|
//! | `/tf` | `foxglove.FrameTransform` world -> box | once |
//! | `/wall` | `foxglove.PointCloud` | once, if there are walls |
//! | `/body/NAME` | `foxglove.PointCloud`, one a body | every frame |
//! | `/measures` | `coronet.Measures`, one double a scalar, `time_s` first | ends every frame |
//!
//! Log time is simulated time x `time_scale`, in nanoseconds. Metadata: `coronet` (format, spacing,
//! dimension, time scale), `bodies`, `provenance`; attachment: `pipeline.toml`.
//!
//! A chunk ends only between frames, so whatever is cut off, whole frames remain. A run writes one
//! *segment* from each start or resumption; [`merge`] makes of them the log that an undisturbed run
//! writes, byte for byte.

mod background;
mod cloud;
mod fields;
mod measures;
mod merge;
mod output;
mod read;
mod records;
mod setup;

pub use background::{Flush, LogWriter};
pub use merge::{Merged, Recovered, Segment, merge, recover, segments};
pub use read::{Frames, Info, content_digest, info, read_frames};
pub use setup::{LogBody, LogSetup};

use std::path::{Path, PathBuf};

use super::atomic::FileError;

/// A log that cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    #[error(transparent)]
    Io(#[from] FileError),
    #[error("{} is no MCAP file", path.display())]
    NotALog { path: PathBuf },
    #[error("{} is cut off or damaged: {what}", path.display())]
    Damaged { path: PathBuf, what: String },
    #[error("{} is no log of Coronet: {what}", path.display())]
    Foreign { path: PathBuf, what: String },
    #[error("{} lacks frames up to t = {until} s: {what}", path.display())]
    FramesLost {
        path: PathBuf,
        /// Simulated time from which the next segment goes on, s.
        until: f64,
        what: String,
    },
    #[error("{} has no whole frame: {what}", path.display())]
    NoFrames { path: PathBuf, what: String },
    #[error("{} is not replaced: {what}", path.display())]
    NotReplaced { path: PathBuf, what: &'static str },
    #[error("a frame does not fit the log: {0}")]
    Frame(String),
    #[error("the log is closed: an earlier error ended it")]
    Closed,
}

impl LogError {
    /// Whether the file was read and its content is wrong. Never for an I/O error, nor for a
    /// mistake of the caller.
    pub fn is_damage(&self) -> bool {
        match self {
            LogError::NotALog { .. }
            | LogError::Damaged { .. }
            | LogError::Foreign { .. }
            | LogError::FramesLost { .. }
            | LogError::NoFrames { .. } => true,
            LogError::Io(_)
            | LogError::NotReplaced { .. }
            | LogError::Frame(_)
            | LogError::Closed => false,
        }
    }

    /// For an error of the MCAP library while writing.
    fn writing(path: &Path) -> impl Fn(mcap::McapError) -> LogError {
        let path = path.to_path_buf();
        move |error| {
            let source = match error {
                mcap::McapError::Io(source) => source,
                other => std::io::Error::other(other),
            };
            LogError::Io(FileError {
                path: path.clone(),
                action: "write",
                source,
            })
        }
    }
}

/// Log time of simulated `time`, s, in nanoseconds.
fn log_time(time: f64, time_scale: f64) -> u64 {
    (time * time_scale * 1e9).round().max(0.0) as u64
}
