//! Arguments for several machines: remote stores, and studies on a cluster.

use std::path::PathBuf;

use clap::{Args, ValueEnum, value_parser};

use super::{StoreArguments, StudyArguments};
use crate::study::trial::Place;

#[derive(Debug, Args)]
pub struct RemoteArguments {
    /// Store that machines share, `file:///FOLDER` or `s3://BUCKET/PREFIX`: results are fetched
    /// from it before they are made, and put there after
    #[arg(long, value_name = "URL", env = "CORONET_REMOTE")]
    pub remote: Option<String>,
}

impl RemoteArguments {
    /// The URL, if one is given.
    pub fn url(&self) -> Option<&str> {
        self.remote.as_deref().filter(|url| !url.is_empty())
    }
}

#[derive(Debug, Args)]
pub struct PushArguments {
    /// Names in `latest/`: their results, and what they were made from [default: all finished
    /// results]
    pub names: Vec<String>,
    #[command(flatten)]
    pub remote: RemoteArguments,
    #[command(flatten)]
    pub store: StoreArguments,
}

impl StudyArguments {
    /// Where the points keep their results.
    pub fn place(&self) -> Place<'_> {
        Place {
            artifacts: &self.store.artifacts,
            remote: self.remote.url(),
        }
    }
}

/// Where the points of a study run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum On {
    /// On this machine, now
    #[default]
    Local,
    /// As an array job of Slurm
    Slurm,
    /// As a task array of HyperQueue
    Hq,
}

#[derive(Debug, Args)]
pub struct BatchArguments {
    /// Where the points run. On a cluster the command submits what is missing and ends; the same
    /// command later writes the table
    #[arg(long, value_enum, default_value_t, value_name = "WHERE")]
    pub on: On,
    /// Wait until the submitted points have ended, and write the table
    #[arg(long)]
    pub wait: bool,
    /// Show the state of each point and the time that it still needs, with what points share for
    /// each of them; run and submit nothing
    #[arg(long, conflicts_with_all = ["wait", "cancel"])]
    pub look: bool,
    /// Stop the submitted points; the same command without this continues
    #[arg(long, conflicts_with = "wait")]
    pub cancel: bool,
    /// File with partition, account, time, memory, cores, options and setup of the jobs (TOML)
    #[arg(long, value_name = "FILE")]
    pub profile: Option<PathBuf>,
    /// Partition of Slurm
    #[arg(long, value_name = "NAME")]
    pub partition: Option<String>,
    /// Longest time of a point, as the batch system writes it [default: three times the forecast]
    #[arg(long, value_name = "TIME")]
    pub time: Option<String>,
    /// Memory of a point, as `800M` or `4G` [default: from the forecast]
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<String>,
    /// Cores of a point [default: 1]
    #[arg(long, value_name = "N", value_parser = value_parser!(u16).range(1..))]
    pub cores: Option<u16>,
    /// Run only this point: the task of a batch job
    #[arg(long, hide = true)]
    pub point: Option<usize>,
}

impl BatchArguments {
    /// The first option given that only a job of a batch system has.
    pub fn of_jobs(&self) -> Option<&'static str> {
        let given = [
            ("--wait", self.wait),
            ("--cancel", self.cancel),
            ("--profile", self.profile.is_some()),
            ("--partition", self.partition.is_some()),
            ("--time", self.time.is_some()),
            ("--memory", self.memory.is_some()),
            ("--cores", self.cores.is_some()),
        ];
        given.into_iter().find(|(_, is)| *is).map(|(name, _)| name)
    }
}
