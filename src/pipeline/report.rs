//! The results of a run and of its jobs.

use std::path::PathBuf;

use super::stamp::Stamp;
use crate::file::FileError;

/// How a job succeeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Nothing had to be done.
    Fresh,
    /// Ran from the beginning.
    Ran,
    /// Ran, but not from the beginning.
    Resumed,
    /// Came from a remote store.
    Fetched,
}

impl Status {
    /// `fresh`, `ran`, `resumed` or `fetched`.
    pub fn word(self) -> &'static str {
        match self {
            Status::Fresh => "fresh",
            Status::Ran => "ran",
            Status::Resumed => "resumed",
            Status::Fetched => "fetched",
        }
    }
}

/// A job that succeeded.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the stage.
    pub stage: String,
    /// What the stage was applied to, or empty.
    pub body: String,
    /// How it ended.
    pub status: Status,
    /// Why it ran.
    pub reasons: Vec<String>,
    /// Where the result is.
    pub folder: PathBuf,
    /// Stamp of the result.
    pub stamp: Stamp,
    /// Wall time of this call, s.
    pub seconds: f64,
    /// CPU time of this call, s.
    pub cpu_seconds: f64,
}

impl Report {
    /// Name of the job in messages: `relax drop`.
    pub fn label(&self) -> String {
        super::stamp::label(&self.stage, &self.body)
    }
}

/// A run whose jobs all succeeded.
#[derive(Debug)]
pub struct Ended {
    /// In the order of the jobs.
    pub reports: Vec<Report>,
    /// Why the results have no names in `latest/`, if they have none.
    pub unnamed: Option<FileError>,
}
