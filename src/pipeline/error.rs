//! Errors of a pipeline.

use std::path::PathBuf;

use crate::record::Digest;
use crate::record::atomic::FileError;

/// Any error of a stage's own.
pub type Cause = Box<dyn std::error::Error + Send + Sync>;

/// Why a stage did not finish.
#[derive(Debug, thiserror::Error)]
pub enum StageError {
    /// A file of input `index` is damaged: its producer has to run again.
    #[error("input {}: {what}", file.display())]
    Input {
        /// Place of the input in [`super::Stage::inputs`].
        index: usize,
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// Stopped on request; the same command continues.
    #[error("stopped on request")]
    Interrupted,
    /// Any other error of the stage.
    #[error(transparent)]
    Failed(Cause),
}

impl StageError {
    /// An error of the stage's own.
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
    /// A file of the store cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A stage failed.
    #[error("{job}: {source}")]
    Stage {
        /// The job.
        job: String,
        /// The error of the stage.
        #[source]
        source: Cause,
    },
    /// The run was stopped on request.
    #[error("{job}: stopped on request; the same command continues from there")]
    Interrupted {
        /// The job in progress.
        job: String,
    },
    /// Equal keys gave unequal results.
    #[error(
        "{job}: the same key {} gave two results: {first} (in {}) and {second} (in {}); \
         both are kept. The program is not deterministic here, or its VERSION was not increased \
         when its numbers changed: please report it. Remove the one that you do not trust and run \
         again",
        key.short(), folder.display(), other.display()
    )]
    Nondeterministic {
        /// The job.
        job: String,
        /// The key of both results.
        key: Digest,
        /// Digest of the stored result.
        first: Digest,
        /// Folder of the stored result.
        folder: PathBuf,
        /// Digest of the new result.
        second: Digest,
        /// Folder of the new result.
        other: PathBuf,
    },
    /// A run that makes nothing lacks a result.
    #[error(
        "{job}: {place} does not have this result; `coronet run --remote` makes it and puts it \
         there"
    )]
    NotThere {
        /// The job.
        job: String,
        /// The remote store.
        place: String,
    },
    /// A run that makes nothing cannot use its remote store.
    #[error("{job}: {place}: {source}")]
    Remote {
        /// The job.
        job: String,
        /// The remote store.
        place: String,
        /// What is wrong.
        #[source]
        source: super::remote::RemoteError,
    },
    /// An input was damaged again after its stage had run again.
    #[error("{job}: {} was damaged again right after it was regenerated: {what}", file.display())]
    DamagedAgain {
        /// The job.
        job: String,
        /// The damaged file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// An output of the stage is missing.
    #[error("{job}: the stage named an output {file:?} that it did not write")]
    NoOutput {
        /// The job.
        job: String,
        /// Name of the output.
        file: String,
    },
    /// The name is not valid for a pipeline.
    #[error(
        "{name:?} cannot be the name of results: a name, and each part of it between slashes, does \
         not start with a dot, has at most 200 bytes and no backslash or control character, and is \
         not manifest.json; choose another with --name"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// A name that is inside another one's folder.
    #[error(
        "{name:?} cannot be the name of results, for {outer:?} is one: its folder is not shared; \
         choose another with --name"
    )]
    Within {
        /// The name.
        name: String,
        /// The name that is a part of it.
        outer: String,
    },
    /// Removal would leave no result.
    #[error(
        "{}: no name in latest/ leads to a result, so every finished result would be removed; \
         give --without-names if that is intended", path.display()
    )]
    NoNames {
        /// The store.
        path: PathBuf,
    },
    /// The folder is not a store.
    #[error("{} is not a store of Coronet: it has no valid {mark}{remedy}", path.display())]
    NotAStore {
        /// The folder.
        path: PathBuf,
        /// Name of the file that marks a store.
        mark: &'static str,
        /// What to do, with its separator; may be empty.
        remedy: &'static str,
    },
    /// A manifest cannot be used.
    #[error(transparent)]
    Manifest(#[from] super::latest::ManifestError),
    /// The pipeline does not contain the stage.
    #[error("there is no stage {name:?} in this pipeline; it has {known}")]
    UnknownStage {
        /// Name of the stage.
        name: String,
        /// Names of its stages.
        known: String,
    },
    /// Another process uses the result or the store.
    #[error("{} is in use by {holder}; try again when that has ended", path.display())]
    Busy {
        /// The locked folder.
        path: PathBuf,
        /// The process.
        holder: String,
    },
    /// The store does not contain the pipeline.
    #[error(
        "there is no pipeline {name:?} in {}; `coronet list` shows the names, of which a study has \
         one for each point", path.display()
    )]
    UnknownPipeline {
        /// Name of the pipeline.
        name: String,
        /// The store.
        path: PathBuf,
    },
}
