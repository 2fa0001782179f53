//! Digests of files of results, and the handling of damaged files.

use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use super::stamp;
use crate::file::{self, FileError};
use crate::record::atomic::sync_folder_of;
use crate::record::checkpoint::CheckpointError;
use crate::record::log::LogError;
use crate::record::{Digest, checkpoint, log};

/// Extension of checkpoints.
pub const CHECKPOINT: &str = "checkpoint";
/// Extension of logs.
pub const LOG: &str = "mcap";

/// Why a file has no digest.
#[derive(Debug, thiserror::Error)]
pub enum ContentError {
    /// It could not be read, so nothing is known about it.
    #[error(transparent)]
    File(FileError),
    /// It is missing, or it was read and is wrong.
    #[error("{0}")]
    Damaged(String),
}

impl From<FileError> for ContentError {
    fn from(error: FileError) -> Self {
        if error.is_not_found() {
            ContentError::Damaged("it is missing".into())
        } else {
            ContentError::File(error)
        }
    }
}

impl From<CheckpointError> for ContentError {
    fn from(error: CheckpointError) -> Self {
        match error {
            CheckpointError::Io(error) => error.into(),
            damage => ContentError::Damaged(damage.to_string()),
        }
    }
}

impl From<LogError> for ContentError {
    fn from(error: LogError) -> Self {
        match error {
            LogError::Io(error) => error.into(),
            damage => ContentError::Damaged(damage.to_string()),
        }
    }
}

/// Digest of the content of a file: for a checkpoint and a log independent of compression, for any
/// other file of its bytes. Symbolic links are rejected.
///
/// # Errors
/// See [`ContentError`].
pub fn content(path: &Path) -> Result<Digest, ContentError> {
    file::refuse_link(path)?;
    if file::is_folder(path)? {
        return Err(ContentError::Damaged("it is a folder".into()));
    }
    match path.extension().and_then(|extension| extension.to_str()) {
        Some(CHECKPOINT) => Ok(checkpoint::read(path)?.digest()),
        Some(LOG) => Ok(log::content_digest(path)?),
        _ => bytes(path),
    }
}

/// Whether the digest of the content of a file does not include all its bytes.
pub fn has_own_digest(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    matches!(extension, Some(CHECKPOINT | LOG))
}

/// SHA-256 of all bytes of a file. Symbolic links are rejected.
///
/// # Errors
/// See [`ContentError`].
pub fn bytes(path: &Path) -> Result<Digest, ContentError> {
    use sha2::Digest as _;
    let mut file = file::open_no_link(path)?;
    let mut hasher = sha2::Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok(Digest(hasher.finalize().into())),
            Ok(count) => hasher.update(&buffer[..count]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(FileError::new(path, "read")(error).into()),
        }
    }
}

/// Renames a damaged file to the first free `<name>.bad-N` and returns that name. The stamp is
/// renamed first, so that the rest does not count as a finished result.
///
/// # Errors
/// If a file cannot be renamed.
pub fn set_aside(folder: &Path, file: &Path) -> Result<PathBuf, FileError> {
    let stamp = folder.join(stamp::FILE);
    if file != stamp {
        rename_aside(&stamp)?;
    }
    let kept = rename_aside(file)?;
    sync_folder_of(file)?;
    Ok(kept)
}

/// Renames a file to the first free `<name>.bad-N`, if it exists.
pub(super) fn rename_aside(file: &Path) -> Result<PathBuf, FileError> {
    let kept = free_name(file, "bad")?;
    match fs::rename(file, &kept) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(kept),
        other => other
            .map(|()| kept)
            .map_err(FileError::new(file, "set aside")),
    }
}

/// First `<path>.<word>-N` that does not exist.
///
/// # Errors
/// If the folder cannot be examined.
pub fn free_name(path: &Path, word: &str) -> Result<PathBuf, FileError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut candidates = (1u64..).map(|n| path.with_file_name(format!("{name}.{word}-{n}")));
    loop {
        let candidate = candidates.next().expect("endless");
        match candidate.symlink_metadata() {
            Ok(_) => {}
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(candidate),
            Err(error) => return Err(FileError::new(&candidate, "examine")(error)),
        }
    }
}
