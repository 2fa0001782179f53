//! The log: all frames of a run as an MCAP file of well-known Foxglove messages (protobuf), which
//! standard viewers show without a plug-in.
//!
//! | topic | schema | when |
//! |---|---|---|
//! | `/tf` | `foxglove.FrameTransform` world -> box | once |
//! | `/wall` | `foxglove.PointCloud` | once, if there are walls |
//! | `/body/NAME` | `foxglove.PointCloud`, one for each body | every frame |
//! | `/revolved` | `foxglove.PointCloud`, the body of revolution, for viewers | frames of rings |
//! | `/figures` | `coronet.Figures`: crater, crown ..., as `/measures` | frames with a surface |
//! | `/measures` | `coronet.Measures`, one double for each scalar, after two times | every frame |
//!
//! Log time is simulated time x `time_scale`, in nanoseconds. Metadata: `coronet` (format, spacing,
//! dimension, time scale, time of contact if there is one), `bodies`, `provenance`; attachment:
//! `pipeline.toml`.
//!
//! A chunk ends only between frames, so a log that is cut off contains whole frames. A run writes
//! one *segment* from each start or resumption; [`merge`] makes of them the log of an uninterrupted
//! run, byte for byte.

mod background;
mod cloud;
mod fields;
mod measures;
mod merge;
mod output;
mod read;
mod records;
mod reel;
mod setup;
mod times;

pub use background::{Flush, LogWriter};
pub use cloud::viridis;
pub use merge::{Merged, Recovered, Segment, merge, recover, recover_unless, segments};
pub use read::{Frames, Info, content_digest, info, read_frames};
pub use reel::{BASE, Reel};
pub use setup::{LogBody, LogSetup};
pub use times::times;

use std::path::{Path, PathBuf};

use super::atomic::FileError;

/// A log that cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] FileError),
    /// The file does not start as MCAP does.
    #[error("{} is not an MCAP file", path.display())]
    NotALog {
        /// The file.
        path: PathBuf,
    },
    /// A record is incomplete or contradicts its checksum.
    #[error(
        "{} is cut off or damaged: {what}; `coronet recover {}` saves its complete frames",
        path.display(), path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The file is valid MCAP with other content.
    #[error("{} is not a log of Coronet: {what}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is missing or unknown.
        what: String,
    },
    /// A segment ends before the next one starts.
    #[error("{} lacks frames up to t = {until} s: {what}", path.display())]
    FramesLost {
        /// The file.
        path: PathBuf,
        /// Simulated time from which the next segment continues, s.
        until: f64,
        /// What is wrong.
        what: String,
    },
    /// There is no complete frame to recover.
    #[error("{} has no complete frame: {what}", path.display())]
    NoFrames {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The output would overwrite this file.
    #[error("{} is not replaced: {what}", path.display())]
    NotReplaced {
        /// The file.
        path: PathBuf,
        /// The reason.
        what: &'static str,
    },
    /// The frame contradicts the setup of the log.
    #[error("a frame does not fit the log: {0}")]
    Frame(String),
    /// The copy was asked to stop.
    #[error("stopped on request; nothing was written")]
    Stopped,
    /// The writer ended at an earlier error.
    #[error("the log is closed after an earlier error")]
    Closed,
}

impl LogError {
    /// Whether the file was read and its content is wrong. False for an I/O error and for a mistake
    /// of the caller.
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
            | LogError::Stopped
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

/// A message of a log.
#[derive(Clone, Copy, Debug)]
pub struct Message<'a> {
    /// Its channel.
    pub topic: &'a str,
    /// Name of the type of its content, as `foxglove.PointCloud`.
    pub schema_name: &'a str,
    /// A protobuf `FileDescriptorSet`.
    pub schema: &'a [u8],
    /// Nanoseconds.
    pub log_time: u64,
    /// A protobuf message.
    pub data: &'a [u8],
}

/// Sees every message of a log while it is written, on the thread that writes it.
pub type Tap = Box<dyn FnMut(&Message) + Send>;

/// Topic of the body of revolution.
const REVOLVED: &str = "/revolved";
/// Topic of the figures.
const FIGURES: &str = "/figures";

/// Log time of simulated `time`, s, in nanoseconds.
fn log_time(time: f64, time_scale: f64) -> u64 {
    (time * time_scale * 1e9).round().max(0.0) as u64
}
