//! The pipeline: which stage runs, why, and where its result is stored.
//!
//! | module | what |
//! |---|---|
//! | [`key`] | the name of a result before it exists: SHA-256 over all that it depends on |
//! | [`stamp`] | the record beside a result, for users and for the next run |
//! | `seal`, `name` | detection of damage in JSON files; names that stay inside the store |
//! | [`store`] | the folders of results, and a quick check of one |
//! | [`content`] | digests of files; setting damaged files aside |
//! | [`lock`] | one process makes a result; none is removed while a pipeline runs |
//! | [`decide`] | fresh or stale, and the reasons; the same function for `plan` and `run` |
//! | [`run`], `report` | the loop over the jobs, and their results |
//! | [`context`] | the environment of a running stage |
//! | `publish` | from files in the work folder to a stamped result |
//! | [`remote`] | results of other machines: fetched before they are made, put there after |
//! | [`latest`] | the newest results by name, which are also the roots of [`sweep`] |
//! | [`sweep`], [`verify`] | removal of unreachable results; hashing of all results |
//! | [`machine`] | the machine, and the time of a run |
//! | [`progress`] | the progress of a job, for other processes |
//!
//! This module is independent of the stages and of physics. Settings are names, values to show and
//! canonical bytes; results are files with a digest of their content.
//!
//! A result is in `artifacts/<stage>/<key>/`: its files and `stamp.json`, which is written last, so
//! a folder without a stamp is unfinished. Its `work/` belongs to the run in progress and survives
//! kills; `lock` is held while it runs.

pub mod content;
pub mod context;
pub mod decide;
mod error;
pub mod key;
pub mod latest;
pub mod lock;
pub mod machine;
pub mod name;
mod need;
pub mod progress;
mod publish;
pub mod remote;
mod report;
pub mod run;
mod seal;
pub mod stamp;
pub mod store;
pub mod sweep;
pub mod verify;

pub use context::{Context, Input, Relative};
pub use decide::{Decision, plan};
pub use error::{PipelineError, StageError};
pub use report::{Ended, Report, Status};
pub use run::{Run, run};
pub use stamp::{OutputStamp, Stamp};
pub use store::Store;

/// One setting that a stage reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// As the user writes it: `pack.spacing`, `body.drop.velocity`. Not in the key.
    pub name: String,
    /// The value as shown: `0.25 mm`.
    pub shown: String,
    /// For the key: identity and value of the setting. Only equal settings have equal bytes.
    pub canonical: Vec<u8>,
}

/// One file of a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Name in the folder of the key; may have subfolders, with `/`.
    pub file: String,
    /// Whether the content is part of the result's digest. A page that shows the time of a run is
    /// kept and verified, but differs from run to run.
    pub counted: bool,
}

impl Output {
    /// A file whose content the settings determine.
    pub fn counted(file: impl Into<String>) -> Self {
        Output {
            file: file.into(),
            counted: true,
        }
    }

    /// A file that may differ from run to run.
    pub fn shown(file: impl Into<String>) -> Self {
        Output {
            file: file.into(),
            counted: false,
        }
    }
}

/// What a job is, and what its result depends on besides its inputs.
#[derive(Clone, Debug)]
pub struct Identity {
    /// Name of the stage, of its table in the pipeline file and of its folder.
    pub name: &'static str,
    /// What it is applied to (the name of a body), or empty. Not in the key.
    pub part: String,
    /// Is increased when the same settings give another result.
    pub version: u32,
    /// The settings that this stage reads, no others, in a fixed order.
    pub settings: Vec<Setting>,
}

/// One job of a pipeline: a stage, applied to one thing.
pub trait Stage: Sync {
    /// What the job is and which settings it reads.
    fn identity(&self) -> &Identity;

    /// Name of the stage.
    fn name(&self) -> &str {
        self.identity().name
    }

    /// What the stage is applied to, or empty.
    fn part(&self) -> &str {
        &self.identity().part
    }

    /// Version of the stage's numerics.
    fn version(&self) -> u32 {
        self.identity().version
    }

    /// The settings that the stage reads.
    fn settings(&self) -> Vec<Setting> {
        self.identity().settings.clone()
    }

    /// Earlier jobs of the pipeline whose results it reads.
    fn inputs(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Name of the one setting (an end time) that may differ in a finished result from which this
    /// one can start: see [`Context::relatives`].
    fn extends(&self) -> Option<&str> {
        None
    }

    /// Which of the results that differ in [`Stage::extends`] alone it would start from, if any.
    fn begins_from(&self, relatives: &[Relative]) -> Option<usize> {
        (!relatives.is_empty()).then_some(0)
    }

    /// Estimate of the work, for [`plan`].
    fn work(&self) -> Option<Work> {
        None
    }

    /// Remark for the user when the setting `name` makes this stage stale.
    fn remark(&self, _name: &str) -> Option<&str> {
        None
    }

    /// Makes the result's files in [`Context::output`].
    ///
    /// # Errors
    /// See [`StageError`].
    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError>;
}

/// Estimated cost of a job before it starts.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// CPU seconds.
    pub amount: f64,
    /// Threads that share them.
    pub threads: usize,
    /// Peak memory, bytes.
    pub memory: f64,
    /// Size of the files that stay, bytes.
    pub disk: f64,
}

/// Name of a job in messages: `relax drop`, `impact`.
pub fn label(stage: &dyn Stage) -> String {
    stamp::label(stage.name(), stage.part())
}

/// A pipeline: jobs in an order in which they can run.
pub struct Pipeline<'a> {
    /// Name under `artifacts/latest/`.
    pub name: String,
    /// Jobs; inputs come before their readers.
    pub jobs: Vec<Box<dyn Stage + 'a>>,
}

/// Events of a running pipeline, for a watcher.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// Another process makes this result.
    Waiting {
        /// Label of the job, or `run`.
        job: &'a str,
        /// The process that makes the result.
        holder: &'a str,
    },
    /// A job starts; `decision` contains the reasons.
    Started {
        /// What is done and the reasons.
        decision: &'a Decision,
    },
    /// A job advances.
    Progress {
        /// Label of the job.
        job: &'a str,
        /// How far it is.
        progress: Progress,
    },
    /// Something that the user should know; the run continues.
    Warning {
        /// Label of the job.
        job: &'a str,
        /// The message.
        text: &'a str,
    },
    /// The checkpoints and frames of a failed job stay in a folder.
    Kept {
        /// Label of the job.
        job: &'a str,
        /// The folder.
        folder: &'a std::path::Path,
    },
    /// A job has ended well.
    Ended {
        /// The result.
        report: &'a Report,
    },
}

/// Progress of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Part of the work done, 0 to 1.
    pub fraction: f64,
    /// In the stage's own unit of work, per second; 0 if unknown.
    pub speed: f64,
    /// Unit of `speed`, as `particle-steps/s`.
    pub unit: &'static str,
    /// Its state: `t = 3.1 ms of 40 ms`.
    pub text: String,
}

/// Receives [`Event`]s.
pub trait Watch: Sync {
    /// Called at each event.
    fn event(&self, event: &Event);
}

/// Ignores all events.
pub struct Silent;

impl Watch for Silent {
    fn event(&self, _event: &Event) {}
}
