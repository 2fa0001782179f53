//! What can go wrong in a pipeline.

use std::path::PathBuf;

use crate::record::Digest;
use crate::record::atomic::FileError;

/// Any error of a stage's own.
pub type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Why a stage did not finish.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// A file of input `index` cannot be trusted: its producer has to run again.
    #[error("input {}: {what}", file.display())]
    Input {
        index: usize,
        file: PathBuf,
        what: String,
    },
    /// Stopped on request; the same command goes on.
    #[error("stopped on request")]
    Interrupted,
    #[error(transparent)]
    Failed(Cause),
}

impl StageError {
    pub fn failed(cause: impl Into<Cause>) -> Self {
        StageError::Failed(cause.into())
    }
}

impl From<FileError> for StageError {
    fn from(error: FileError) -> Self {
        StageError::Failed(error.into())
    }
}

/// Why a pipeline stopped.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{job}: {source}")]
    Stage {
        job: String,
        #[source]
        source: Cause,
    },
    #[error("{job}: stopped on request; the same command goes on from there")]
    Interrupted { job: String },
    #[error(
        "{job}: the same key {} gave two results: {first} (in {}) and {second} (in {}); \
         both are kept. The program is not deterministic here, or its VERSION stood still while \
         its numbers changed: please report it. Remove the one that you do not trust and run \
         again",
        key.short(), folder.display(), other.display()
    )]
    Nondeterministic {
        job: String,
        key: Digest,
        first: Digest,
        folder: PathBuf,
        second: Digest,
        other: PathBuf,
    },
    #[error("{job}: {} was damaged again right after it was made anew: {what}", file.display())]
    DamagedAgain {
        job: String,
        file: PathBuf,
        what: String,
    },
    #[error("{job}: the stage named an output {file:?} that it did not write")]
    NoOutput { job: String, file: String },
    #[error(
        "{name:?} cannot be the name of results: a name, and each part of it between slashes, does \
         not start with a dot and has no backslash or control character; choose another with --name"
    )]
    Name { name: String },
    #[error(
        "{}: no name in latest/ leads to a result, so every finished result would be removed; \
         say --without-names if that is meant", path.display()
    )]
    NoNames { path: PathBuf },
    #[error("{} is not a store of Coronet: it has no {mark}{remedy}", path.display())]
    NotAStore {
        path: PathBuf,
        mark: &'static str,
        remedy: &'static str,
    },
    #[error(transparent)]
    Manifest(#[from] super::latest::ManifestError),
    #[error("there is no stage {name:?} in this pipeline; it has {known}")]
    UnknownStage { name: String, known: String },
    #[error("{} is in use by {holder}; try again when that has ended", path.display())]
    Busy { path: PathBuf, holder: String },
    #[error("there is no pipeline {name:?} in {}", path.display())]
    UnknownPipeline { name: String, path: PathBuf },
}
