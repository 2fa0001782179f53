//! Order and freshness: which stage runs, why, and where its result is kept.
//!
//! | module | what |
//! |---|---|
//! | [`key`] | the name of a result before it exists: SHA-256 over all that it depends on |
//! | [`stamp`] | what is written beside a result, for people and for the next run |
//! | `seal`, `name` | a JSON file that shows damage; names that stay inside the store |
//! | [`store`] | the folders of results, and a quick look at one |
//! | [`content`] | what a file holds; setting damaged files aside |
//! | [`lock`] | one process makes a result; none is removed while a pipeline runs |
//! | [`decide`] | fresh or stale, and the reasons; the same function serves `plan` and `run` |
//! | [`run`], `report` | the walk over the jobs, and what became of them |
//! | [`context`] | what a running stage sees |
//! | `publish` | from files in the work folder to a stamped result |
//! | [`latest`] | the newest results by name, which are also the roots of [`sweep`] |
//! | [`sweep`], [`verify`] | removal of what nobody reaches; hashing everything again |
//! | [`machine`] | where and how fast |
//! | [`progress`] | how far a job is, for other processes |
//!
//! Nothing here knows a stage or any physics. Settings are names, values to show and canonical
//! bytes; results are files with a digest of their content.
//!
//! A result lives in `artifacts/<stage>/<key>/`: its files and `stamp.json`, which is written last,
//! so a folder without a stamp is unfinished. `work/` in there belongs to the run in progress and
//! outlives kills; `lock` is held while it runs.

pub mod content;
pub mod context;
pub mod decide;
mod error;
pub mod key;
pub mod latest;
pub mod lock;
pub mod machine;
pub mod name;
pub mod progress;
mod publish;
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
    /// As the user writes it: `pack.spacing`, `body.drop.velocity`. Is in no key.
    pub name: String,
    /// For people: `0.25 mm`.
    pub shown: String,
    /// For the key: what the setting is and its value. Equal settings have equal bytes, and no
    /// others.
    pub canonical: Vec<u8>,
}

/// One file of a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Name in the folder of the key; may have subfolders, with `/`.
    pub file: String,
    /// Whether the content is part of the result's digest. A page that shows how long a run took is
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
    /// What it is applied to (the name of a body), or empty. Is in no key.
    pub part: String,
    /// Grows when the same settings give another result.
    pub version: u32,
    /// The settings that this stage reads, no others, in a fixed order.
    pub settings: Vec<Setting>,
}

/// One job of a pipeline: a stage, applied to one thing.
pub trait Stage: Sync {
    fn identity(&self) -> &Identity;

    fn name(&self) -> &str {
        self.identity().name
    }

    fn part(&self) -> &str {
        &self.identity().part
    }

    fn version(&self) -> u32 {
        self.identity().version
    }

    fn settings(&self) -> Vec<Setting> {
        self.identity().settings.clone()
    }

    /// Earlier jobs of the pipeline whose results it reads.
    fn inputs(&self) -> Vec<usize> {
        Vec::new()
    }

    /// Name of the one setting (an end time) whose change lets a finished result serve as a
    /// beginning: see [`Context::relatives`].
    fn extends(&self) -> Option<&str> {
        None
    }

    /// How much there is to do, for [`plan`].
    fn work(&self) -> Option<Work> {
        None
    }

    /// What a user should know when the setting `name` makes this stage stale.
    fn remark(&self, _name: &str) -> Option<&str> {
        None
    }

    /// Makes the result's files in [`Context::output`].
    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError>;
}

/// What a job will take, as far as it can be told before it starts.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// CPU seconds, on a machine that the stage knows.
    pub amount: f64,
    /// CPU seconds of this machine for one of those; asked where no earlier result tells.
    pub slower: fn() -> f64,
    /// Threads that share them.
    pub threads: usize,
    /// Bytes at most.
    pub memory: f64,
    /// Bytes of files that stay.
    pub disk: f64,
}

/// Name of a job for people: `relax drop`, `impact`.
pub fn label(stage: &dyn Stage) -> String {
    stamp::label(stage.name(), stage.part())
}

/// A pipeline: jobs in an order in which they can run.
pub struct Pipeline<'a> {
    /// Name under `artifacts/latest/`.
    pub name: String,
    pub jobs: Vec<Box<dyn Stage + 'a>>,
}

/// What happens while a pipeline runs, for whoever watches.
#[derive(Clone, Debug)]
pub enum Event<'a> {
    /// Another process makes this result.
    Waiting {
        job: &'a str,
        holder: &'a str,
    },
    /// A job starts; `decision` says why.
    Started {
        decision: &'a Decision,
    },
    Progress {
        job: &'a str,
        progress: Progress,
    },
    /// Something that the user should know, but that stops nothing.
    Warning {
        job: &'a str,
        text: &'a str,
    },
    /// What a job that failed has computed so far stays in a folder.
    Kept {
        job: &'a str,
        folder: &'a std::path::Path,
    },
    Ended {
        report: &'a Report,
    },
}

/// How far a job is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Part of the work done, 0 to 1.
    pub fraction: f64,
    /// In the stage's own unit of work, per second; 0 if unknown.
    pub speed: f64,
    /// Unit of `speed`, as `particle-steps/s`.
    pub unit: &'static str,
    /// Where it is: `t = 3.1 ms of 40 ms`.
    pub text: String,
}

/// Receives [`Event`]s.
pub trait Watch: Sync {
    fn event(&self, event: &Event);
}

/// Watches nothing.
pub struct Silent;

impl Watch for Silent {
    fn event(&self, _event: &Event) {}
}
