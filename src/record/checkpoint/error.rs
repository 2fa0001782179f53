//! What can be wrong with a checkpoint.

use std::path::PathBuf;

use crate::record::atomic::FileError;

/// A checkpoint that cannot be written, read or understood.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    #[error("{} is no Coronet checkpoint", path.display())]
    NotACheckpoint { path: PathBuf },
    #[error(
        "{} has checkpoint format {found}; this program reads up to {supported}: use a newer one",
        path.display()
    )]
    NewerVersion {
        path: PathBuf,
        found: u32,
        supported: u32,
    },
    #[error("{} is cut off: {found} bytes of {expected}", path.display())]
    Truncated {
        path: PathBuf,
        /// Least number of bytes that the file should have.
        expected: u64,
        found: u64,
    },
    #[error("{} is damaged: {section}: {what}", path.display())]
    Corrupt {
        path: PathBuf,
        /// Name of the array, or `header`.
        section: String,
        what: String,
    },
    #[error("{} claims too much: {what}", path.display())]
    TooLarge { path: PathBuf, what: String },
    #[error("a {kind:?} checkpoint is no {expected:?}: {what}")]
    WrongContent {
        kind: String,
        expected: &'static str,
        what: String,
    },
    #[error(transparent)]
    Io(#[from] FileError),
}

impl CheckpointError {
    /// Whether the file was read and its content is wrong, so that its stage should run again.
    /// Never for an I/O error.
    pub fn is_damage(&self) -> bool {
        !matches!(self, CheckpointError::Io(_))
    }
}
