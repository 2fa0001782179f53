//! Locks: only one process makes a result, and no process removes results while a pipeline runs.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek as _, Write as _};
use std::path::Path;
use std::time::Duration;

use super::store::{Store, is_read_only};
use crate::file::{self, FileError};

pub(super) const LOCK: &str = "lock";

/// Who only looks whether a lock is held holds it for a moment: so often and so long that is waited
/// for.
const LOOKS: u32 = 3;
const LOOK: Duration = Duration::from_millis(5);

/// Time between two attempts of a waiting process.
const POLL: Duration = Duration::from_millis(100);

/// Largest number of bytes of a lock that are shown.
const LONGEST: u64 = 1 << 10;

/// Held while a result is being made; released when the process ends, however it ends.
#[derive(Debug)]
pub struct Lock {
    file: File,
    /// Whether the file names this process.
    signed: bool,
}

impl Drop for Lock {
    fn drop(&mut self) {
        if self.signed {
            let _ = self.file.set_len(0);
        }
    }
}

impl Store {
    /// Takes the lock of the folder of a key, making the folder if needed. While another process
    /// holds it, `wait` is called repeatedly with that process's name; it returns false to give up
    /// (`None`).
    ///
    /// # Errors
    /// If the folder or its lock cannot be used, or one of them is a symbolic link.
    pub fn lock(
        &self,
        folder: &Path,
        wait: &mut dyn FnMut(&str) -> bool,
    ) -> Result<Option<Lock>, FileError> {
        let path = folder.join(LOCK);
        let mut looks = 0;
        loop {
            self.create(folder)?;
            let (mut file, writable) = open(&path)?;
            match file.try_lock() {
                // A process that removed the folder meanwhile has also removed the file of the
                // lock.
                Ok(()) if same_file(&file, &path) => {
                    if writable {
                        sign(&mut file);
                    }
                    super::store::clean_up(folder)?;
                    let signed = writable;
                    return Ok(Some(Lock { file, signed }));
                }
                Ok(()) => {}
                // Maybe [`Store::is_locked`], for a moment.
                Err(TryLockError::WouldBlock) if looks < LOOKS => {
                    looks += 1;
                    std::thread::sleep(LOOK);
                }
                Err(TryLockError::WouldBlock) => {
                    if !wait(&holder(&path)) {
                        return Ok(None);
                    }
                    std::thread::sleep(POLL);
                }
                Err(TryLockError::Error(source)) => {
                    return Err(FileError::new(&path, "lock")(source));
                }
            }
        }
    }

    /// Excludes [`Store::lock_all`] while a pipeline runs; makes the store if needed. `None` if
    /// `wait` gives up, and in a read-only store, from which nothing can be removed.
    ///
    /// # Errors
    /// If the store cannot be made or its lock not be opened.
    pub fn share(&self, wait: &mut dyn FnMut(&str) -> bool) -> Result<Option<Lock>, FileError> {
        self.mark()?;
        let path = self.root().join(LOCK);
        let file = match open(&path) {
            Ok((file, _)) => file,
            Err(error) if is_read_only(&error.source) => {
                return Ok(None);
            }
            Err(error) => return Err(error),
        };
        loop {
            match file.try_lock_shared() {
                Ok(()) => {
                    let signed = false;
                    return Ok(Some(Lock { file, signed }));
                }
                Err(TryLockError::WouldBlock) if wait("a clean-up") => std::thread::sleep(POLL),
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(source)) => {
                    return Err(FileError::new(&path, "lock")(source));
                }
            }
        }
    }

    /// Locks the store exclusively; `None` if a pipeline runs.
    ///
    /// # Errors
    /// If the lock of the store cannot be opened.
    pub fn lock_all(&self) -> Result<Option<Lock>, FileError> {
        let path = self.root().join(LOCK);
        let (file, _) = open(&path)?;
        match file.try_lock() {
            Ok(()) => {
                let signed = false;
                Ok(Some(Lock { file, signed }))
            }
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(source)) => Err(FileError::new(&path, "lock")(source)),
        }
    }

    /// The process that holds the lock of the folder of a key, if any; writes nothing.
    ///
    /// # Errors
    /// If the lock exists and cannot be opened.
    pub fn is_locked(&self, folder: &Path) -> Result<Option<String>, FileError> {
        let path = folder.join(LOCK);
        let file = match file::open_no_link(&path) {
            Err(error) if error.is_not_found() => return Ok(None),
            other => other?,
        };
        match file.try_lock_shared() {
            Ok(()) => Ok(None),
            Err(TryLockError::WouldBlock) => Ok(Some(holder(&path))),
            Err(TryLockError::Error(source)) => Err(FileError::new(&path, "lock")(source)),
        }
    }
}

/// Opens a lock, making it if needed, and returns whether it is writable. A lock of another user
/// may only be readable, which is enough to hold it.
fn open(path: &Path) -> Result<(File, bool), FileError> {
    file::refuse_link(path)?;
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK);
    }
    match options.open(path) {
        Ok(file) => {
            let metadata = file.metadata().map_err(FileError::new(path, "examine"))?;
            if !metadata.is_file() {
                let what = io::Error::other("it is not a regular file");
                return Err(FileError::new(path, "lock")(what));
            }
            Ok((file, true))
        }
        Err(error) if is_read_only(&error) => match file::open_no_link(path) {
            Ok(file) => Ok((file, false)),
            Err(_) => Err(FileError::new(path, "open")(error)),
        },
        Err(error) => Err(FileError::new(path, "open")(error)),
    }
}

/// Writes the name of this process into a lock. Errors, as of a full disk, are ignored.
fn sign(file: &mut File) {
    let host = super::machine::host();
    let text = format!(
        "process {} on {host} since {}",
        std::process::id(),
        super::machine::now()
    );
    let _ = file.set_len(0);
    let _ = file.rewind();
    let _ = file.write_all(text.as_bytes());
}

fn holder(path: &Path) -> String {
    let bytes = file::read_no_link(path, LONGEST).unwrap_or_default();
    match String::from_utf8_lossy(&bytes).into_owned() {
        text if text.is_empty() => "another process".into(),
        text => text,
    }
}

#[cfg(unix)]
fn same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let (Ok(held), Ok(named)) = (file.metadata(), fs::symlink_metadata(path)) else {
        return false;
    };
    held.ino() == named.ino() && held.dev() == named.dev()
}

#[cfg(not(unix))]
fn same_file(_file: &File, path: &Path) -> bool {
    path.exists()
}
