//! Files beside the table of a study on a cluster: which jobs were submitted, why points failed.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::file;
use coronet::record::Digest;
use coronet::record::atomic::{create_folder, write_file};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::fault::Untrusted;

const JOBS: &str = "jobs.json";
const LOCK: &str = "lock";

/// Largest size of these files, bytes.
const LONGEST: u64 = 16 << 20;

/// A job of the batch system.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Submitted {
    /// Word of the batch system.
    pub on: String,
    pub id: String,
    pub points: Vec<usize>,
    /// UTC.
    pub at: String,
}

/// Why a point failed.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Failure {
    /// Key of the result that was not made: with other settings the failure does not count.
    pub key: Option<Digest>,
    pub why: String,
    /// Exit code.
    pub code: u8,
    /// Folder of the checkpoints and frames so far.
    pub work: Option<PathBuf>,
}

/// All jobs that were submitted for a study.
pub fn jobs(folder: &Path) -> Result<Vec<Submitted>> {
    Ok(read(&folder.join(JOBS))?.unwrap_or_default())
}

/// Lets one process at a time look for what is missing and submit it.
pub fn lock(folder: &Path) -> Result<File> {
    create_folder(folder)?;
    let path = folder.join(LOCK);
    let options = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path);
    let file = options.with_context(|| format!("cannot open {}", path.display()))?;
    file.lock()
        .with_context(|| format!("cannot lock {}", path.display()))?;
    Ok(file)
}

pub fn add(folder: &Path, job: Submitted) -> Result<()> {
    let mut all = jobs(folder)?;
    all.push(job);
    write(&folder.join(JOBS), &all)
}

pub fn failure(folder: &Path, point: usize) -> Result<Option<Failure>> {
    read(&failure_path(folder, point))
}

/// Keeps why a point failed, or forgets it.
pub fn set_failure(folder: &Path, point: usize, failure: Option<&Failure>) -> Result<()> {
    let path = failure_path(folder, point);
    match failure {
        Some(failure) => write(&path, failure),
        None => {
            let _ = fs::remove_file(path);
            Ok(())
        }
    }
}

fn failure_path(folder: &Path, point: usize) -> PathBuf {
    folder.join(format!("failed-{point}.json"))
}

fn write(path: &Path, value: &impl Serialize) -> Result<()> {
    create_folder(path.parent().unwrap_or(Path::new(".")))?;
    let text = serde_json::to_string_pretty(value)?;
    Ok(write_file(path, text.as_bytes())?)
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<Option<T>> {
    let bytes = match file::read_no_link(path, LONGEST) {
        Err(error) if error.is_not_found() => return Ok(None),
        other => other?,
    };
    match serde_json::from_slice(&bytes) {
        Ok(value) => Ok(Some(value)),
        Err(error) => bail!(Untrusted(format!(
            "{} is damaged: {error}; remove it",
            path.display()
        ))),
    }
}
