//! Checkpoints of a running stage, from which a killed run continues.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use coronet::file::{self, FileError};
use coronet::particle::Shares;
use coronet::pipeline::content::CHECKPOINT;
use coronet::pipeline::content::ContentError;
use coronet::pipeline::store::{OUT, entries};
use coronet::pipeline::{Context, Output, StageError};
use coronet::record::background::CheckpointWriter;
use coronet::record::checkpoint::{self, LEVEL};
use coronet::record::log::Flush;
use coronet::record::{Checkpoint, Digest};

/// Rolling checkpoints, of which the newest two are kept.
const ROLLING: &str = "step-";
/// Checkpoints that become part of the result, so that a shorter run can start from them.
pub const KEPT: &str = "kept-";
/// Text with the key for which a rolling checkpoint was written.
const KEY: &str = "key";

/// What this process has of a checkpoint, and what gives the rest if several share the run.
pub type Shared<'a> = (Checkpoint, Option<Box<dyn Shares + 'a>>);

/// Writes the checkpoints of a running stage, in the background if one process has all.
pub struct Flight {
    folder: PathBuf,
    key: Digest,
    writer: CheckpointWriter,
    every: Duration,
    last: Instant,
}

impl Flight {
    /// `every`: wall seconds between rolling checkpoints.
    pub fn new(context: &Context, every: f64) -> Result<Self, StageError> {
        Ok(Flight {
            folder: context.work().to_path_buf(),
            key: context.key(),
            writer: CheckpointWriter::new(LEVEL).map_err(StageError::failed)?,
            every: Duration::try_from_secs_f64(every).unwrap_or(Duration::MAX),
            last: Instant::now(),
        })
    }

    /// Whether it is time for a rolling checkpoint.
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    /// Queues `checkpoint` for writing after the frames before it are durable.
    pub fn save(
        &mut self,
        context: &Context,
        (mut checkpoint, more): Shared,
        after: Option<Flush>,
        kept: bool,
    ) -> Result<(), StageError> {
        let prefix = if kept { KEPT } else { ROLLING };
        let name = format!("{prefix}{:012}.{CHECKPOINT}", checkpoint.step);
        checkpoint.texts.push((KEY.into(), self.key.to_string()));
        let path = self.folder.join(name);
        let Some(more) = more else {
            self.writer
                .submit(checkpoint, path, after)
                .map_err(StageError::failed)?;
            self.last = Instant::now();
            return self.collect(context);
        };
        if let Some(after) = after {
            after.wait().map_err(StageError::failed)?;
        }
        let written = checkpoint.write_with(Some(&*more), &path, LEVEL);
        written.map_err(StageError::failed)?;
        self.last = Instant::now();
        self.settle(context)
    }

    /// Registers the checkpoints written since the last call and removes unneeded ones. Returns
    /// errors of earlier writes.
    pub fn collect(&mut self, context: &Context) -> Result<(), StageError> {
        if !self
            .writer
            .written()
            .map_err(StageError::failed)?
            .is_empty()
        {
            self.settle(context)?;
        }
        Ok(())
    }

    /// Waits until all is on disk.
    pub fn land(&mut self, context: &Context) -> Result<(), StageError> {
        self.writer.wait().map_err(StageError::failed)?;
        self.settle(context)
    }

    fn settle(&self, context: &Context) -> Result<(), StageError> {
        let rolling = list(&self.folder, ROLLING)?;
        for old in rolling.iter().rev().skip(2) {
            let _ = fs::remove_file(old);
        }
        Ok(context.save_time()?)
    }
}

/// The newest valid checkpoint in the work folder. Damaged ones are set aside.
///
/// # Errors
/// If one cannot be read: it may be valid, so nothing is changed.
pub fn newest(context: &Context) -> Result<Option<Checkpoint>, StageError> {
    let mut paths = list(context.work(), ROLLING)?;
    paths.extend(list(context.work(), KEPT)?);
    paths.sort_by_key(|path| std::cmp::Reverse(number(path)));
    for path in paths {
        match read(context, &path) {
            Ok(checkpoint) => return Ok(Some(checkpoint)),
            Err(error) => pass_over(context, &path, error)?,
        }
    }
    Ok(None)
}

/// Reads a checkpoint of the result that is being made.
fn read(context: &Context, path: &Path) -> Result<Checkpoint, ContentError> {
    file::refuse_link(path)?;
    let checkpoint = checkpoint::read(path)?;
    if checkpoint.text(KEY) == Some(&context.key().to_string()) {
        return Ok(checkpoint);
    }
    let what = "it belongs to another result".to_string();
    Err(ContentError::Damaged(what))
}

/// Sets a damaged checkpoint aside, with a warning; one that cannot be read is an error.
fn pass_over(context: &Context, path: &Path, error: ContentError) -> Result<(), StageError> {
    let what = match error {
        ContentError::File(error) => return Err(error.into()),
        ContentError::Damaged(what) => what,
    };
    let mut name = path.to_path_buf().into_os_string();
    name.push(".bad");
    fs::rename(path, name).map_err(FileError::new(path, "set aside"))?;
    context.warn(&format!("{} is skipped: {what}", path.display()));
    Ok(())
}

/// Removes files of earlier attempts from the work folder.
pub fn clear(context: &Context) -> Result<(), StageError> {
    for entry in entries(context.work())? {
        let path = entry.path();
        if entry.file_name() != OUT && !file::is_folder(&path)? {
            fs::remove_file(&path).map_err(FileError::new(&path, "remove"))?;
        }
    }
    Ok(context.save_time()?)
}

/// Moves the kept checkpoints into the result. They depend on the interruptions of the run, so no
/// digest includes them, and a damaged one is left out.
pub fn keep(context: &Context) -> Result<Vec<Output>, StageError> {
    let mut outputs = Vec::new();
    for path in list(context.work(), KEPT)? {
        if let Err(error) = read(context, &path) {
            pass_over(context, &path, error)?;
            continue;
        }
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        // A link, so that a resumed run also finds the checkpoint.
        let target = context.output().join(&name);
        link_or_copy(&path, &target).map_err(FileError::new(&target, "link"))?;
        outputs.push(Output::shown(name));
    }
    Ok(outputs)
}

/// Makes a link to the file, or a copy where the file system has no links.
pub fn link_or_copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if fs::hard_link(from, to).is_err() {
        fs::copy(from, to)?;
    }
    Ok(())
}

/// Paths with that prefix, in the order of their step numbers.
fn list(folder: &Path, prefix: &str) -> Result<Vec<PathBuf>, FileError> {
    let mut paths: Vec<_> = entries(folder)?
        .into_iter()
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(prefix) && name.ends_with(CHECKPOINT)
        })
        .collect();
    paths.sort();
    Ok(paths)
}

fn number(path: &Path) -> u64 {
    let stem = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let digits = stem.rsplit('-').next().unwrap_or_default();
    digits.parse().unwrap_or(0)
}
