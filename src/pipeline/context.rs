//! The environment of a running stage: its inputs, its folders, the watcher, requests to stop.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::content::{ContentError, content};
use super::machine::{Clock, now};
use super::progress::Teller;
use super::stamp::{InputStamp, Stamp};
use super::store::OUT;
use super::{Event, Progress, Report, StageError, Watch};
use crate::file::{self, FileError};
use crate::record::atomic::{create_folder, write_file};
use crate::record::{Checkpoint, Digest, checkpoint};

/// File in the work folder that keeps the time spent by earlier attempts.
pub const SPENT: &str = "spent.json";

/// Largest size of that file, bytes.
const LONGEST: u64 = 1 << 16;

/// A finished input.
#[derive(Clone, Debug)]
pub struct Input {
    /// Folder of the result.
    pub folder: PathBuf,
    /// Its stamp.
    pub stamp: Stamp,
}

/// A finished result that differs in nothing but the setting that [`super::Stage::extends`] names.
#[derive(Clone, Debug)]
pub struct Relative {
    /// Folder of the result.
    pub folder: PathBuf,
    /// Its stamp.
    pub stamp: Stamp,
}

/// Time spent on a result over all attempts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Spent {
    /// UTC.
    pub started: String,
    pub attempts: u32,
    pub wall_seconds: f64,
    pub cpu_seconds: f64,
    /// The inputs of the result, which a clean-up keeps.
    #[serde(default)]
    pub inputs: Vec<InputStamp>,
}

/// The environment of a running stage.
pub struct Context<'a> {
    /// In the order of [`super::Stage::inputs`].
    pub inputs: Vec<Input>,
    /// Finished beginnings or continuations of this result.
    pub relatives: Vec<Relative>,
    pub(super) key: Digest,
    pub(super) work: PathBuf,
    pub(super) job: String,
    pub(super) teller: Teller,
    pub(super) stop: &'a AtomicBool,
    pub(super) watch: &'a dyn Watch,
    pub(super) resumed: bool,
    pub(super) notes: Vec<String>,
    pub(super) clock: Clock,
    /// Time spent by earlier attempts.
    pub(super) spent: Spent,
}

impl Context<'_> {
    /// Key of the result that is being made.
    pub fn key(&self) -> Digest {
        self.key
    }

    /// Folder for files that survive a kill; no other process writes there.
    pub fn work(&self) -> &Path {
        &self.work
    }

    /// Folder for the files of the result; empty at the start of each attempt.
    pub fn output(&self) -> PathBuf {
        self.work.join(OUT)
    }

    /// Whether to write a checkpoint and return [`StageError::Interrupted`].
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Reports progress to the watcher.
    pub fn progress(&self, progress: Progress) {
        let job = &self.job;
        self.teller.tell(&progress);
        self.watch.event(&Event::Progress { job, progress });
    }

    /// Reports a warning to the user; it is not in the stamp.
    pub fn warn(&self, text: &str) {
        let job = &self.job;
        self.watch.event(&Event::Warning { job, text });
    }

    /// Reports where the checkpoints and frames of a job that fails stay.
    pub fn report_kept(&self) {
        let (job, folder) = (&self.job[..], self.work());
        self.watch.event(&Event::Kept { job, folder });
    }

    /// Adds a sentence to the stamp.
    pub fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// Records that this attempt did not start from the beginning.
    pub fn resumed(&mut self) {
        self.resumed = true;
    }

    /// Records that this attempt goes on from a `part`, 0 to 1, of a finished result: that much of
    /// its time belongs to this one too.
    pub fn goes_on_from(&mut self, stamp: &Stamp, part: f64) {
        self.spent.wall_seconds += part * stamp.wall_seconds;
        self.spent.cpu_seconds += part * stamp.cpu_seconds;
    }

    /// Saves the time spent so far, so that the stamp counts attempts that are killed later.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save_time(&self) -> Result<(), FileError> {
        let json = serde_json::to_string_pretty(&self.spent_now()).expect("plain data");
        write_file(&self.work.join(SPENT), json.as_bytes())
    }

    pub(super) fn spent_now(&self) -> Spent {
        let (wall, cpu) = self.clock.read();
        Spent {
            wall_seconds: self.spent.wall_seconds + wall,
            cpu_seconds: self.spent.cpu_seconds + cpu,
            ..self.spent.clone()
        }
    }

    /// Path of `file` of input `index`, after hashing its whole content.
    ///
    /// # Errors
    /// [`StageError::Input`] if it is missing or wrong; [`StageError::Failed`] if it cannot be
    /// read.
    pub fn verified(&self, index: usize, file: &str) -> Result<PathBuf, StageError> {
        let Input { folder, stamp } = &self.inputs[index];
        let path = folder.join(file);
        let check = || {
            let wanted = output_digest(stamp, file)?;
            let found = content(&path)?;
            if found != wanted {
                let what = format!("it holds {found}, not {wanted}");
                return Err(ContentError::Damaged(what));
            }
            Ok(())
        };
        check().map_err(|error| self.input_error(index, file, error))?;
        Ok(path)
    }

    /// Reads and verifies the checkpoint `file` of input `index`.
    ///
    /// # Errors
    /// As [`Context::verified`].
    pub fn checkpoint(&self, index: usize, file: &str) -> Result<Checkpoint, StageError> {
        let Input { folder, stamp } = &self.inputs[index];
        read_checkpoint(folder, stamp, file).map_err(|error| self.input_error(index, file, error))
    }

    fn input_error(&self, index: usize, file: &str, error: ContentError) -> StageError {
        match error {
            ContentError::File(error) => error.into(),
            ContentError::Damaged(what) => StageError::Input {
                index,
                file: self.inputs[index].folder.join(file),
                what,
            },
        }
    }
}

impl Input {
    /// The result of a job, with its name: equal bodies share a result, which has that of one.
    pub(super) fn of(report: &Report) -> Input {
        let body = report.body.clone();
        Input {
            folder: report.folder.clone(),
            stamp: Stamp {
                body,
                ..report.stamp.clone()
            },
        }
    }

    /// Its entry in the stamp of its reader.
    pub(super) fn stamp_of(&self) -> InputStamp {
        InputStamp {
            stage: self.stamp.stage.clone(),
            body: self.stamp.body.clone(),
            key: self.stamp.key,
            digest: self.stamp.digest,
        }
    }
}

impl Relative {
    /// Reads and verifies the checkpoint `file`.
    ///
    /// # Errors
    /// See [`ContentError`].
    pub fn checkpoint(&self, file: &str) -> Result<Checkpoint, ContentError> {
        read_checkpoint(&self.folder, &self.stamp, file)
    }

    /// Value of the setting `name`, as shown; exact.
    pub fn setting(&self, name: &str) -> Option<&str> {
        let mut settings = self.stamp.settings.iter();
        let setting = settings.find(|setting| setting.name == name)?;
        Some(&setting.value)
    }
}

/// The digest of a file in a stamp.
fn output_digest(stamp: &Stamp, file: &str) -> Result<Digest, ContentError> {
    let output = stamp.outputs.iter().find(|output| output.file == file);
    let missing = || ContentError::Damaged("its stamp does not name it".into());
    Ok(output.ok_or_else(missing)?.digest)
}

/// Reads a checkpoint, of which each array is checked, and compares its digest with the stamp's.
fn read_checkpoint(folder: &Path, stamp: &Stamp, file: &str) -> Result<Checkpoint, ContentError> {
    let wanted = output_digest(stamp, file)?;
    let path = folder.join(file);
    file::refuse_link(&path)?;
    // The header yields the digest, and `read` compares every array with the header.
    let found = checkpoint::peek(&path)?.digest;
    if found != wanted {
        let what = format!("it holds {found}, not {wanted}");
        return Err(ContentError::Damaged(what));
    }
    Ok(checkpoint::read(&path)?)
}

impl Spent {
    /// The record of earlier attempts, if there is one that is not damaged.
    pub(super) fn read(work: &Path) -> Result<Option<Self>, FileError> {
        let bytes = file::read_if_there(&work.join(SPENT), LONGEST)?;
        Ok(bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok()))
    }

    /// Makes the work folder, empties the folder of finished files and counts the attempt.
    pub(super) fn begin(work: &Path) -> Result<Self, FileError> {
        let out = work.join(OUT);
        if file::is_there(&out)? {
            fs::remove_dir_all(&out).map_err(FileError::new(&out, "empty"))?;
        }
        create_folder(&out)?;
        let mut spent = Spent::read(work)?.unwrap_or_else(|| Spent {
            started: now(),
            ..Spent::default()
        });
        spent.attempts += 1;
        Ok(spent)
    }
}
