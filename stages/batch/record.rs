//! Files beside the table of a study on a cluster: which jobs were submitted, why points failed.

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::file::{self, FileError};
use coronet::record::Digest;
use coronet::record::atomic::{create_folder, write_file};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::fault::{Untrusted, Usage};

const JOBS: &str = "jobs.json";
const STUDY: &str = "origin.json";
const LOCK: &str = "lock";

/// Largest size of these files, bytes.
const LONGEST: u64 = 16 << 20;

/// A job of the batch system.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Submitted {
    /// Word of the batch system.
    pub on: String,
    pub id: String,
    /// Identity of the server, where numbers begin again with each.
    #[serde(default)]
    pub server: Option<String>,
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
    /// Memory that it could use, bytes.
    #[serde(default)]
    pub memory: Option<f64>,
}

/// All jobs that were submitted for a study.
pub fn jobs(folder: &Path) -> Result<Vec<Submitted>> {
    Ok(read(&folder.join(JOBS))?.unwrap_or_default())
}

/// Refuses a folder that another study of the same name has, unless both files are equal; `takes`:
/// it belongs to this one from now on.
///
/// # Errors
/// If another study has it, or files cannot be read or written.
pub fn claim(folder: &Path, study: &Path, takes: bool) -> Result<()> {
    let cannot = || format!("cannot read {}", study.display());
    let (own, path) = (
        study.canonicalize().with_context(cannot)?,
        folder.join(STUDY),
    );
    let known: Option<PathBuf> = read(&path)?;
    match known {
        Some(other) if other != own && differs(&other, &own) => bail!(Usage(format!(
            "{} has the name of {}, whose results are in {}; rename one, give another \
             --artifacts, or forget it with `coronet gc --forget NAME`",
            study.display(),
            other.display(),
            folder.display()
        ))),
        Some(other) if other == own => Ok(()),
        _ if takes => write(&path, &own),
        _ => Ok(()),
    }
}

/// Lets another study have the folder, whose tables stay until then.
pub fn release(folder: &Path) -> Result<()> {
    let path = folder.join(STUDY);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(FileError::new(&path, "remove")(error).into())
        }
        _ => Ok(()),
    }
}

/// Whether a file that is there has other bytes than one's own.
fn differs(other: &Path, own: &Path) -> bool {
    let [other, own] = [other, own].map(|path| fs::read(path).ok());
    other.is_some() && other != own
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
