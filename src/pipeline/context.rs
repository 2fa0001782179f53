//! What a running stage sees: its inputs, its folders, who watches, and whether to stop.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::machine::Clock;
use super::stamp::Stamp;
use super::store::{OUT, content};
use super::{Event, Progress, StageError, Watch};
use crate::record::atomic::{FileError, write_file};
use crate::record::{Checkpoint, Digest, checkpoint};

/// File in the work folder that keeps the time spent by earlier attempts.
pub const SPENT: &str = "spent.json";

/// A finished input.
#[derive(Clone, Debug)]
pub struct Input {
    pub folder: PathBuf,
    pub stamp: Stamp,
}

/// A finished result that differs in nothing but the setting that [`super::Stage::extends`] names.
#[derive(Clone, Debug)]
pub struct Relative {
    pub folder: PathBuf,
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
}

/// The surroundings of a running stage.
pub struct Context<'a> {
    /// In the order of [`super::Stage::inputs`].
    pub inputs: Vec<Input>,
    /// Finished beginnings or continuations of this result.
    pub relatives: Vec<Relative>,
    pub(super) key: Digest,
    pub(super) work: PathBuf,
    pub(super) job: String,
    pub(super) stop: &'a AtomicBool,
    pub(super) watch: &'a dyn Watch,
    pub(super) resumed: bool,
    pub(super) notes: Vec<String>,
    pub(super) clock: Clock,
    /// By attempts before this one.
    pub(super) spent: Spent,
}

impl Context<'_> {
    /// Key of the result that is being made.
    pub fn key(&self) -> Digest {
        self.key
    }

    /// Folder for what outlives a kill; nobody else writes there.
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

    pub fn progress(&self, progress: Progress) {
        let job = &self.job;
        self.watch.event(&Event::Progress { job, progress });
    }

    /// Tells the user, and nobody else.
    pub fn warn(&self, text: &str) {
        let job = &self.job;
        self.watch.event(&Event::Warning { job, text });
    }

    /// Keeps a sentence in the stamp.
    pub fn note(&mut self, text: impl Into<String>) {
        self.notes.push(text.into());
    }

    /// Says that this attempt did not start from the beginning.
    pub fn resumed(&mut self) {
        self.resumed = true;
    }

    /// Keeps the time spent so far, so that the stamp counts attempts that are killed later.
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
    pub fn verified(&self, index: usize, file: &str) -> Result<PathBuf, StageError> {
        let path = self.inputs[index].folder.join(file);
        let bad = |what: String| StageError::Input {
            index,
            file: path.clone(),
            what,
        };
        let output = self.inputs[index]
            .stamp
            .outputs
            .iter()
            .find(|output| output.file == file);
        let output = output.ok_or_else(|| bad("its stamp does not name it".into()))?;
        let found = content(&path).map_err(bad)?;
        if found != output.digest {
            return Err(bad(format!("it holds {found}, not {}", output.digest)));
        }
        Ok(path)
    }

    /// Reads and verifies the checkpoint `file` of input `index`.
    pub fn checkpoint(&self, index: usize, file: &str) -> Result<Checkpoint, StageError> {
        let Input { folder, stamp } = &self.inputs[index];
        read_checkpoint(folder, stamp, file).map_err(|what| StageError::Input {
            index,
            file: folder.join(file),
            what,
        })
    }
}

impl Relative {
    /// Reads and verifies the checkpoint `file`; the error says what is wrong with it.
    pub fn checkpoint(&self, file: &str) -> Result<Checkpoint, String> {
        read_checkpoint(&self.folder, &self.stamp, file)
    }

    /// Canonical value of the setting `name`, hexadecimal.
    pub fn setting(&self, name: &str) -> Option<&str> {
        let mut settings = self.stamp.settings.iter();
        let setting = settings.find(|setting| setting.name == name)?;
        Some(&setting.canonical)
    }
}

/// Reads a checkpoint, of which each array is checked, and compares its digest with the stamp's.
fn read_checkpoint(folder: &Path, stamp: &Stamp, file: &str) -> Result<Checkpoint, String> {
    let output = stamp.outputs.iter().find(|output| output.file == file);
    let output = output.ok_or("its stamp does not name it")?;
    let path = folder.join(file);
    // The header yields the digest, and `read` compares every array with the header.
    let peek = checkpoint::peek(&path).map_err(|error| error.to_string())?;
    if peek.digest != output.digest {
        return Err(format!("it holds {}, not {}", peek.digest, output.digest));
    }
    checkpoint::read(&path).map_err(|error| error.to_string())
}

impl Spent {
    /// What earlier attempts left, or nothing.
    pub(super) fn read(work: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(work.join(SPENT)).ok()?).ok()
    }
}
