//! The folders of results: `artifacts/<stage>/<key>/`.
//!
//! Symbolic links are never followed: a link in place of the folder of a stage, of a key or of work
//! in progress could lead out of the store.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::content::{CHECKPOINT, ContentError, rename_aside};
use super::key;
use super::name::is_key;
use super::stamp::{self, OutputStamp, Stamp, StampError};
use crate::file::{self, FileError};
use crate::record::atomic::{create_folder, is_temporary, write_file};
use crate::record::{Digest, checkpoint};

/// Folder of the run in progress, in the folder of a key.
pub const WORK: &str = "work";
/// Folder of finished files that are not yet published, in [`WORK`].
pub const OUT: &str = "out";

/// Name of the folder of newest results.
pub const LATEST: &str = "latest";

/// File that marks a folder as a store: results are removed only from such a folder.
pub const MARK: &str = "store.json";
/// Its content.
const MARK_TEXT: &str = "{\n  \"coronet_store\": 1\n}\n";

/// The layout in it.
const LAYOUT: u64 = 1;

/// The layout of a store from the content of its mark.
fn layout(mark: &[u8]) -> Option<u64> {
    let mark: serde_json::Value = serde_json::from_slice(mark).ok()?;
    mark["coronet_store"].as_u64()
}

/// A folder of results.
#[derive(Clone, Debug)]
pub struct Store {
    root: PathBuf,
}

/// Result of a quick check of the folder of a key: stamp and sizes of the files.
#[derive(Debug)]
pub enum Found {
    /// Finished, with files of the right size.
    Finished(Box<Stamp>),
    /// There is no finished result.
    Nothing,
    /// Not usable, with the reason.
    Unusable(String),
}

impl Store {
    /// The store in the folder `root`, which need not exist yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Store { root: root.into() }
    }

    /// Folder of the store.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folder of the result of `stage` with `key`.
    pub fn folder(&self, stage: &str, key: &Digest) -> PathBuf {
        self.root.join(stage).join(key.hex())
    }

    /// Makes the store, if needed, and marks it as one.
    ///
    /// # Errors
    /// If the folder cannot be made, or the mark not be read or written; a store that is read-only
    /// and holds results may lack it.
    pub fn mark(&self) -> Result<(), FileError> {
        create_folder(&self.root)?;
        let path = self.root.join(MARK);
        match file::read_no_link(&path, MARK_TEXT.len() as u64 * 2) {
            Ok(bytes) if bytes == MARK_TEXT.as_bytes() => return Ok(()),
            Ok(bytes) => match layout(&bytes) {
                Some(layout) if layout > LAYOUT => {
                    let what = format!(
                        "the store is of a newer program (layout {layout}); use that program, or \
                         another folder with --artifacts"
                    );
                    return Err(FileError::new(&path, "use")(io::Error::other(what)));
                }
                _ => drop(rename_aside(&path)?),
            },
            Err(error) if error.is_not_found() => {}
            Err(error) => return Err(error),
        }
        match write_file(&path, MARK_TEXT.as_bytes()) {
            Err(error) if is_read_only(&error.source) && !self.stages()?.is_empty() => Ok(()),
            other => other,
        }
    }

    /// Whether the folder is marked as a store.
    ///
    /// # Errors
    /// If the mark exists and cannot be read.
    pub fn is_marked(&self) -> Result<bool, FileError> {
        match file::read_no_link(&self.root.join(MARK), MARK_TEXT.len() as u64 * 2) {
            Ok(bytes) => Ok(bytes == MARK_TEXT.as_bytes()),
            Err(error) if error.is_not_found() => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Makes a folder inside the store, durably.
    ///
    /// # Errors
    /// If that fails, or if a part of the path below the root is a symbolic link.
    pub fn create(&self, folder: &Path) -> Result<(), FileError> {
        self.refuse_links(folder)?;
        create_folder(folder)
    }

    /// Fails if any part of `path` below the root is a symbolic link.
    ///
    /// # Errors
    /// If it is one, or cannot be examined.
    pub fn refuse_links(&self, path: &Path) -> Result<(), FileError> {
        refuse_links_below(&self.root, path)
    }

    /// Folders of all keys of `stage`, in the order of their names, without links.
    ///
    /// # Errors
    /// If a folder cannot be listed.
    pub fn folders(&self, stage: &str) -> Result<Vec<PathBuf>, FileError> {
        let folder = self.root.join(stage);
        if !file::is_folder(&folder)? {
            return Ok(Vec::new());
        }
        let folders = folders_in(&folder)?;
        Ok(folders.into_iter().filter(|path| is_key(path)).collect())
    }

    /// Names of the folders that may belong to stages: neither hidden nor links.
    ///
    /// # Errors
    /// If the root cannot be listed.
    pub fn stages(&self) -> Result<Vec<String>, FileError> {
        let folders = folders_in(&self.root)?;
        let names = folders
            .iter()
            .filter_map(|path| path.file_name()?.to_str().map(str::to_string));
        Ok(names
            .filter(|name| name != LATEST && !name.starts_with('.'))
            .collect())
    }

    /// Valid stamps of `stage`, with their folders. Damaged ones, and those that the user may not
    /// read, are skipped: [`Store::find`] of their key reports them.
    ///
    /// # Errors
    /// If a folder or a stamp cannot be read for another reason.
    pub fn stamps(&self, stage: &str) -> Result<Vec<(PathBuf, Stamp)>, FileError> {
        let mut stamps = Vec::new();
        for folder in self.folders(stage)? {
            match Stamp::read(&folder) {
                Ok(Some(stamp)) if key::contradiction(&stamp).is_none() => {
                    stamps.push((folder, stamp))
                }
                Ok(_) | Err(StampError::Invalid { .. }) => {}
                Err(StampError::File(error)) if error.is_permission_denied() => {}
                Err(StampError::File(error)) => return Err(error),
            }
        }
        Ok(stamps)
    }

    /// A quick check of the folder of a key: stamp and sizes, not content.
    ///
    /// # Errors
    /// If the stamp or a file cannot be examined, or is a link.
    pub fn find(&self, stage: &str, key: &Digest) -> Result<Found, FileError> {
        let folder = self.folder(stage, key);
        self.refuse_links(&folder)?;
        let stamp = match Stamp::read(&folder) {
            Ok(Some(stamp)) => stamp,
            Ok(None) => return set_aside_before(&folder),
            Err(StampError::File(error)) => return Err(error),
            Err(error) => return Ok(Found::Unusable(error.to_string())),
        };
        if stamp.key != *key || stamp.stage != stage {
            let what = format!("{} belongs to {} {}", stamp::FILE, stamp.label(), stamp.key);
            return Ok(Found::Unusable(what));
        }
        if let Some(what) = key::contradiction(&stamp) {
            let what = format!("{} contradicts itself: {what}", stamp::FILE);
            return Ok(Found::Unusable(what));
        }
        for output in &stamp.outputs {
            match quick_check(&folder, output) {
                Ok(()) => {}
                Err(ContentError::Damaged(what)) => return Ok(Found::Unusable(what)),
                Err(ContentError::File(error)) => return Err(error),
            }
        }
        Ok(Found::Finished(Box::new(stamp)))
    }
}

/// Fails if any part of `path` below `root` is a symbolic link.
///
/// # Errors
/// If it is one, or cannot be examined.
pub fn refuse_links_below(root: &Path, path: &Path) -> Result<(), FileError> {
    let inside = path.strip_prefix(root).unwrap_or(path);
    let mut part = root.to_path_buf();
    for component in inside.components() {
        part.push(component);
        file::refuse_link(&part)?;
    }
    Ok(())
}

/// Whether the folder is read-only, in contrast to a failed write.
pub(super) fn is_read_only(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ReadOnlyFilesystem | io::ErrorKind::PermissionDenied
    )
}

/// The folders in a folder, sorted; no links. Empty if it does not exist.
pub(super) fn folders_in(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let mut folders = Vec::new();
    for entry in entries(folder)? {
        let kind = entry.file_type();
        if kind
            .map_err(FileError::new(&entry.path(), "examine"))?
            .is_dir()
        {
            folders.push(entry.path());
        }
    }
    folders.sort();
    Ok(folders)
}

/// The entries of a folder; none if it does not exist.
///
/// # Errors
/// If the folder cannot be listed.
pub fn entries(folder: &Path) -> Result<Vec<fs::DirEntry>, FileError> {
    let list = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(FileError::new(folder, "list"))?,
    };
    list.collect::<io::Result<_>>()
        .map_err(FileError::new(folder, "list"))
}

/// Compares the length of a file, and the header of a checkpoint, with the stamp.
fn quick_check(folder: &Path, output: &OutputStamp) -> Result<(), ContentError> {
    let path = folder.join(&output.file);
    refuse_links_below(folder, &path)?;
    let damaged = |what: String| Err(ContentError::Damaged(what));
    let metadata = match path.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return damaged(format!("{} is missing", output.file));
        }
        other => other.map_err(FileError::new(&path, "examine"))?,
    };
    if !metadata.is_file() {
        return damaged(format!("{} is not a regular file", output.file));
    }
    let length = metadata.len();
    if length != output.bytes {
        return damaged(format!(
            "{} has {length} bytes, not {}",
            output.file, output.bytes
        ));
    }
    let extension = path.extension();
    if extension.is_some_and(|extension| extension == CHECKPOINT) {
        let peek = checkpoint::peek(&path)?;
        if peek.digest != output.digest {
            return damaged(format!(
                "{} holds something else: {}",
                output.file, peek.digest
            ));
        }
    }
    Ok(())
}

/// A folder without a stamp: finds a file that was set aside.
fn set_aside_before(folder: &Path) -> Result<Found, FileError> {
    let names = entries(folder)?;
    let names = names
        .iter()
        .filter_map(|entry| entry.file_name().into_string().ok());
    let mut bad: Vec<_> = names.filter(|name| name.contains(".bad-")).collect();
    bad.sort();
    let mut files = bad
        .iter()
        .rev()
        .filter(|name| !name.starts_with(stamp::FILE));
    Ok(match files.next().or(bad.last()) {
        Some(name) => Found::Unusable(format!("a file was damaged and is kept as {name}")),
        None => Found::Nothing,
    })
}

/// Removes temporary files of killed writers; only under the lock, so that no writer is active.
///
/// # Errors
/// If a folder cannot be listed.
pub fn clean_up(folder: &Path) -> Result<(), FileError> {
    for folder in [folder.to_path_buf(), folder.join(WORK)] {
        if !file::is_folder(&folder)? {
            continue;
        }
        sweep(&folder, Duration::ZERO)?;
    }
    Ok(())
}

/// Removes temporary files from a folder that are older than `age`.
///
/// # Errors
/// If the folder cannot be listed.
pub fn sweep(folder: &Path, age: Duration) -> Result<(), FileError> {
    for entry in entries(folder)? {
        let modified = entry.metadata().and_then(|metadata| metadata.modified());
        let old = modified.is_ok_and(|at| at.elapsed().is_ok_and(|elapsed| elapsed >= age));
        if is_temporary(&entry.path()) && old {
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(())
}
