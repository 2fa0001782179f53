//! What became of a run and of its jobs.

use std::path::PathBuf;

use super::stamp::Stamp;
use crate::file::FileError;

/// How a job ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Nothing had to be done.
    Fresh,
    Ran,
    /// Ran, but not from the beginning.
    Resumed,
}

impl Status {
    pub fn word(self) -> &'static str {
        match self {
            Status::Fresh => "fresh",
            Status::Ran => "ran",
            Status::Resumed => "resumed",
        }
    }
}

/// A job that ended well.
#[derive(Clone, Debug)]
pub struct Report {
    pub stage: String,
    /// What the stage was applied to, or empty.
    pub body: String,
    pub status: Status,
    /// Why it ran.
    pub reasons: Vec<String>,
    /// Where the result is.
    pub folder: PathBuf,
    pub stamp: Stamp,
    /// Wall and CPU time of this call, s.
    pub seconds: f64,
    pub cpu_seconds: f64,
}

impl Report {
    /// For people: `relax drop`.
    pub fn label(&self) -> String {
        super::stamp::label(&self.stage, &self.body)
    }
}

/// A run whose jobs all ended well.
#[derive(Debug)]
pub struct Ended {
    /// In the order of the jobs.
    pub reports: Vec<Report>,
    /// Why the results have no names in `latest/`, if they have none.
    pub unnamed: Option<FileError>,
}
