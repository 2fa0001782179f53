//! Errors of checkpoints.

use std::path::PathBuf;

use crate::record::atomic::FileError;

/// A checkpoint that cannot be written, read or used.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file does not start with the magic bytes.
    #[error("{} is not a Coronet checkpoint", path.display())]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// The format is newer than this program.
    #[error(
        "{} has checkpoint format {found}; this program reads up to {supported}: use a newer one",
        path.display()
    )]
    NewerVersion {
        /// The file.
        path: PathBuf,
        /// Its format version.
        found: u32,
        /// Highest format version that this program reads.
        supported: u32,
    },
    /// The file is too short.
    #[error("{} is cut off: {found} bytes of {expected}", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Least number of bytes that the file should have.
        expected: u64,
        /// Number of bytes that it has.
        found: u64,
    },
    /// The content contradicts its checksum or its header.
    #[error("{} is damaged: {section}: {what}", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// Name of the array, or `header`.
        section: String,
        /// What is wrong.
        what: String,
    },
    /// The header declares more data than the file can contain.
    #[error("{} declares too much data: {what}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The data and the limit.
        what: String,
    },
    /// The checkpoint is of another kind, or lacks an array.
    #[error("a {kind:?} checkpoint is not a {expected:?}: {what}")]
    WrongContent {
        /// Kind that it has.
        kind: String,
        /// What was expected.
        expected: &'static str,
        /// What is wrong.
        what: String,
    },
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] FileError),
}

impl CheckpointError {
    /// Whether the file was read and its content is wrong, so that its stage must run again.
    /// False for an I/O error.
    pub fn is_damage(&self) -> bool {
        !matches!(self, CheckpointError::Io(_))
    }
}
