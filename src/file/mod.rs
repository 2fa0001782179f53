//! Files from outside: only regular files are opened, and their size is limited.
//!
//! A pipe or a device in place of a file could make the program wait or read without end; a
//! symbolic link in a store could lead out of it.

use std::fs::{File, Metadata, OpenOptions};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// An operation on a file that failed.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}: {source}", path.display())]
pub struct FileError {
    /// The file or folder.
    pub path: PathBuf,
    /// The operation, as a verb: `write`, `rename` ...
    pub action: &'static str,
    /// Error of the operating system.
    pub source: io::Error,
}

impl FileError {
    /// For `map_err`: wraps an `io::Error` with the path and the action.
    pub fn new(path: &Path, action: &'static str) -> impl Fn(io::Error) -> FileError {
        let path = path.to_path_buf();
        move |source| FileError {
            path: path.clone(),
            action,
            source,
        }
    }

    /// Whether there is no such file.
    pub fn is_not_found(&self) -> bool {
        self.source.kind() == io::ErrorKind::NotFound
    }

    /// Whether the operating system failed, in contrast to a file that is absent or no file that
    /// can be used.
    pub fn is_failure(&self) -> bool {
        self.source.raw_os_error().is_some() && !is_absence(&self.source)
    }

    /// Whether the user may not do this.
    pub fn is_permission_denied(&self) -> bool {
        self.source.kind() == io::ErrorKind::PermissionDenied
    }
}

/// Opens a regular file for reading; symbolic links are followed. Never waits for a writer.
///
/// # Errors
/// If the file cannot be opened, or is a folder, a pipe, a socket or a device.
pub fn open(path: &Path) -> Result<File, FileError> {
    open_with(path, 0)
}

/// As [`open`], but the last component of `path` must not be a symbolic link.
///
/// # Errors
/// Those of [`open`], and if the file is a symbolic link.
pub fn open_no_link(path: &Path) -> Result<File, FileError> {
    refuse_link(path)?;
    #[cfg(unix)]
    return open_with(path, libc::O_NOFOLLOW);
    #[cfg(not(unix))]
    open_with(path, 0)
}

/// The whole content of a regular file of at most `limit` bytes; symbolic links are followed.
///
/// # Errors
/// Those of [`open`], and if the file is longer than `limit`.
pub fn read(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    read_all(open(path)?, path, limit)
}

/// The content of a text file without the byte order mark with which spreadsheets begin one.
pub fn without_mark(content: &[u8]) -> &[u8] {
    content.strip_prefix(b"\xef\xbb\xbf").unwrap_or(content)
}

/// A table of the columns of `content`, a CSV file that may have comments.
pub fn table(content: &[u8]) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(without_mark(content))
}

/// As [`read`], but the last component of `path` must not be a symbolic link.
///
/// # Errors
/// Those of [`open_no_link`], and if the file is longer than `limit`.
pub fn read_no_link(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    read_all(open_no_link(path)?, path, limit)
}

/// Fails if `path` itself is a symbolic link; a missing file is not one.
///
/// # Errors
/// If it is a link, or cannot be examined.
pub fn refuse_link(path: &Path) -> Result<(), FileError> {
    if !is_link(path)? {
        return Ok(());
    }
    let what = "it is a symbolic link, which is never followed here; remove it";
    Err(FileError::new(path, "use")(io::Error::other(what)))
}

/// Bytes of the file at `path`, at most `longest`; `None` if there is none, or nothing that can be
/// one: a link, or too long.
///
/// # Errors
/// If the operating system cannot read it.
pub fn read_if_there(path: &Path, longest: u64) -> Result<Option<Vec<u8>>, FileError> {
    if examined(path)?.is_none_or(|metadata| !metadata.is_file()) {
        return Ok(None);
    }
    match read_no_link(path, longest) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.is_failure() => Err(error),
        Err(_) => Ok(None),
    }
}

/// Whether `path` is a folder; a link to one is none.
///
/// # Errors
/// If it cannot be examined.
pub fn is_folder(path: &Path) -> Result<bool, FileError> {
    Ok(examined(path)?.is_some_and(|metadata| metadata.is_dir()))
}

/// Whether `path` is a symbolic link.
///
/// # Errors
/// If it cannot be examined.
pub fn is_link(path: &Path) -> Result<bool, FileError> {
    Ok(examined(path)?.is_some_and(|metadata| metadata.is_symlink()))
}

/// Whether there is anything at `path`, be it a link that leads nowhere.
///
/// # Errors
/// If it cannot be examined.
pub fn is_there(path: &Path) -> Result<bool, FileError> {
    Ok(examined(path)?.is_some())
}

/// Whether there is anything at `path`, or where a link there leads.
///
/// # Errors
/// If that cannot be examined.
pub fn exists(path: &Path) -> Result<bool, FileError> {
    match path.metadata() {
        Ok(_) => Ok(true),
        Err(error) if is_absence(&error) => Ok(false),
        Err(error) => Err(FileError::new(path, "examine")(error)),
    }
}

/// When the file at `path` was last changed; `None` if there is none.
///
/// # Errors
/// If it cannot be examined.
pub fn changed(path: &Path) -> Result<Option<SystemTime>, FileError> {
    let time = examined(path)?.map(|metadata| metadata.modified());
    time.transpose().map_err(FileError::new(path, "examine"))
}

fn examined(path: &Path) -> Result<Option<Metadata>, FileError> {
    match path.symlink_metadata() {
        Ok(metadata) => Ok(Some(metadata)),
        Err(error) if is_absence(&error) => Ok(None),
        Err(error) => Err(FileError::new(path, "examine")(error)),
    }
}

/// Whether an error says that nothing is there, in contrast to one of reading.
fn is_absence(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
    )
}

fn open_with(path: &Path, flags: i32) -> Result<File, FileError> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        // Opening a pipe would otherwise wait for its other end.
        options.custom_flags(flags | libc::O_NONBLOCK);
    }
    #[cfg(not(unix))]
    let _ = flags;
    let file = options.open(path).map_err(FileError::new(path, "open"))?;
    let metadata = file.metadata().map_err(FileError::new(path, "examine"))?;
    if !metadata.is_file() {
        let what = "it is not a regular file";
        return Err(FileError::new(path, "read")(io::Error::other(what)));
    }
    Ok(file)
}

fn read_all(file: File, path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let mut bytes = Vec::new();
    // The length that a file reports is no limit: files of /proc report zero and can be endless.
    file.take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(FileError::new(path, "read"))?;
    if bytes.len() as u64 > limit {
        let what = format!("it is longer than {limit} bytes");
        return Err(FileError::new(path, "read")(io::Error::other(what)));
    }
    Ok(bytes)
}
