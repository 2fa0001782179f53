//! Atomic replacement of files: a temporary name in the same folder, fsync, rename, fsync of the
//! folder. On an error the old file stays and the temporary file is removed (a kill leaves it: see
//! [`is_temporary`]).

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

pub use crate::file::FileError;

const SUFFIX: &str = ".coronet-tmp";

/// A file being written under a temporary name; without [`commit`](Self::commit), dropping removes
/// it.
pub struct AtomicFile {
    file: Option<File>,
    temporary: PathBuf,
    path: PathBuf,
}

impl AtomicFile {
    /// Starts a new version of `path`, whose folder must exist. The temporary file is created
    /// exclusively, so that a link of that name is never followed.
    ///
    /// # Errors
    /// If the temporary file cannot be created.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        loop {
            let temporary = temporary_name(path);
            let created = OpenOptions::new()
                .write(true)
                .create_new(true)
                .open(&temporary);
            match created {
                Ok(file) => {
                    return Ok(AtomicFile {
                        file: Some(file),
                        temporary,
                        path: path.to_path_buf(),
                    });
                }
                // A killed process with our id left this file; try the next name.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(FileError::new(&temporary, "create")(error)),
            }
        }
    }

    /// The open file.
    pub fn file(&mut self) -> &mut File {
        self.file.as_mut().expect("open until commit")
    }

    /// The final name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// As [`Self::commit`], if no file has the final name yet; otherwise that one stays and the
    /// answer is false.
    ///
    /// # Errors
    /// If the file cannot be written or get its name.
    pub fn commit_new(mut self) -> Result<bool, FileError> {
        let synced = self.file().sync_all();
        synced.map_err(FileError::new(&self.path, "flush to disk"))?;
        match fs::hard_link(&self.temporary, &self.path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(FileError::new(&self.path, "name")(error)),
            Ok(()) => sync_folder_of(&self.path).map(|()| true),
        }
    }

    /// Makes the content durable and gives it its final name.
    ///
    /// # Errors
    /// If the file cannot be written or renamed.
    pub fn commit(mut self) -> Result<(), FileError> {
        let file = self.file.take().expect("open until commit");
        let published = file
            .sync_all()
            .map_err(FileError::new(&self.path, "flush to disk"))
            .and_then(|()| {
                drop(file);
                fs::rename(&self.temporary, &self.path)
                    .map_err(FileError::new(&self.path, "rename into place"))
            });
        if let Err(error) = published {
            let _ = fs::remove_file(&self.temporary);
            return Err(error);
        }
        sync_folder_of(&self.path)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Replaces `path` by `bytes`, atomically and durably.
///
/// # Errors
/// If the file cannot be written or renamed.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)
        .map_err(FileError::new(path, "write"))?;
    file.commit()
}

/// Replaces `path` by what `fill` writes, atomically and durably.
///
/// # Errors
/// If the file cannot be written or renamed.
pub fn write_with(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut AtomicFile>) -> io::Result<()>,
) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    let mut out = BufWriter::with_capacity(1 << 20, &mut file);
    let flushed = fill(&mut out).and_then(|()| out.flush());
    // Dropping the buffer would try again to write its rest.
    drop(out.into_parts());
    flushed.map_err(FileError::new(path, "write"))?;
    file.commit()
}

/// Replaces `path` by `bytes`, atomically, without waiting for the disk: for content that need not
/// survive a power cut, after which the file can be empty.
///
/// # Errors
/// If the file cannot be written or renamed.
pub fn write_passing(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes)
        .map_err(FileError::new(path, "write"))?;
    drop(file.file.take());
    fs::rename(&file.temporary, path)
        .inspect_err(|_| drop(fs::remove_file(&file.temporary)))
        .map_err(FileError::new(path, "rename into place"))
}

/// A name for a temporary file beside `path` that this process has not used yet.
pub fn temporary_name(path: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    path.with_file_name(format!(".{name}.{}.{count}{SUFFIX}", std::process::id()))
}

/// Creates a folder with its missing parents and makes their names durable.
///
/// # Errors
/// If a folder cannot be created.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    if let Some(parent) = path.parent() {
        create_folder(parent)?;
    }
    match fs::create_dir(path) {
        // Another process has created it.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.is_dir() => Ok(()),
        Err(error) => Err(FileError::new(path, "create the folder")(error)),
        Ok(()) => sync_folder_of(path),
    }
}

/// Makes the names in the folder of `path` durable.
///
/// # Errors
/// If the folder cannot be opened or flushed.
pub fn sync_folder_of(path: &Path) -> Result<(), FileError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    File::open(folder)
        .and_then(|folder| folder.sync_all())
        .map_err(FileError::new(folder, "flush to disk"))
}

/// Whether `path` has the name of a temporary file of [`AtomicFile`]. Such files may be removed
/// unless their process still runs.
pub fn is_temporary(path: &Path) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().ends_with(SUFFIX))
}
