//! The folders of results: `artifacts/<stage>/<key>/`.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::stamp::{self, OutputStamp, Stamp};
use crate::record::atomic::{FileError, is_temporary, sync_folder_of};
use crate::record::{Digest, checkpoint, log};

/// Extension of checkpoints.
pub const CHECKPOINT: &str = "checkpoint";
/// Extension of logs.
pub const LOG: &str = "mcap";

/// Folder of the run in progress, in the folder of a key.
pub const WORK: &str = "work";
/// Folder of finished files that are not published yet, in [`WORK`].
pub const OUT: &str = "out";

const LOCK: &str = "lock";
/// Name of the folder of newest results.
pub const LATEST: &str = "latest";

/// How often a waiting process looks again.
const POLL: Duration = Duration::from_millis(100);

/// A folder of results.
#[derive(Clone, Debug)]
pub struct Store {
    root: PathBuf,
}

/// What a quick look at the folder of a key finds: the stamp, and the sizes of the files.
#[derive(Debug)]
pub enum Found {
    /// Finished and, as far as sizes tell, whole.
    Finished(Box<Stamp>),
    Nothing,
    /// Not usable; why.
    Unusable(String),
}

/// Held while a result is being made; released when the process ends, however it ends.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Store {
    /// The store in the folder `root`, which need not exist yet.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Store { root: root.into() }
    }

    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Folder of the result of `stage` with `key`.
    pub fn folder(&self, stage: &str, key: &Digest) -> PathBuf {
        self.root.join(stage).join(key.hex())
    }

    /// Folders of all keys of `stage`, in the order of their names.
    pub fn folders(&self, stage: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.root.join(stage));
        let entries = entries.into_iter().flatten().flatten();
        let mut folders: Vec<_> = entries
            .map(|entry| entry.path())
            .filter(|path| is_key(path) && path.is_dir())
            .collect();
        folders.sort();
        folders
    }

    /// Names of the stages that have results here.
    pub fn stages(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.root).into_iter().flatten().flatten();
        let folders = entries.filter(|entry| entry.path().is_dir());
        let mut names: Vec<_> = folders
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| name != LATEST && !name.starts_with('.'))
            .collect();
        names.sort();
        names
    }

    /// Valid stamps of `stage`, with their folders. Damaged ones are passed over: their own key
    /// reports them.
    pub fn stamps(&self, stage: &str) -> Vec<(PathBuf, Stamp)> {
        let read = |folder: PathBuf| {
            let stamp = Stamp::read(&folder).ok()??;
            Some((folder, stamp))
        };
        self.folders(stage).into_iter().filter_map(read).collect()
    }

    /// A quick look at the folder of a key: stamp and sizes, no content.
    pub fn find(&self, stage: &str, key: &Digest) -> Found {
        let folder = self.folder(stage, key);
        let stamp = match Stamp::read(&folder) {
            Ok(Some(stamp)) => stamp,
            Ok(None) => return set_aside_before(&folder),
            Err(error) => return Found::Unusable(error.to_string()),
        };
        if stamp.key != *key || stamp.stage != stage {
            let what = format!("{} belongs to {} {}", stamp::FILE, stamp.label(), stamp.key);
            return Found::Unusable(what);
        }
        for output in &stamp.outputs {
            if let Err(what) = quick_check(&folder, output) {
                return Found::Unusable(what);
            }
        }
        Found::Finished(Box::new(stamp))
    }

    /// Takes the lock of a folder, making the folder if needed. While another process has it,
    /// `wait` is called with that process's name, again and again; it returns false to give up
    /// (`None`).
    pub fn lock(
        &self,
        folder: &Path,
        wait: &mut dyn FnMut(&str) -> bool,
    ) -> Result<Option<Lock>, FileError> {
        let path = folder.join(LOCK);
        loop {
            fs::create_dir_all(folder).map_err(FileError::new(folder, "create the folder"))?;
            let mut file = open_lock(&path)?;
            match file.try_lock() {
                // Whoever removed the folder meanwhile took the name of the lock with it.
                Ok(()) if same_file(&file, &path) => {
                    sign(&mut file);
                    clean_up(folder);
                    return Ok(Some(Lock { _file: file }));
                }
                Ok(()) => {}
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

    /// Keeps [`Store::lock_all`] out while a pipeline runs. `None` where nothing can be written:
    /// then nothing can be removed, either.
    pub fn share(&self, wait: &mut dyn FnMut(&str) -> bool) -> Option<Lock> {
        let path = self.root.join(LOCK);
        fs::create_dir_all(&self.root).ok()?;
        let file = open_lock(&path).ok()?;
        while let Err(TryLockError::WouldBlock) = file.try_lock_shared() {
            if !wait("a clean-up") {
                return None;
            }
            std::thread::sleep(POLL);
        }
        Some(Lock { _file: file })
    }

    /// Has the store for itself, or `None` if some pipeline runs.
    pub fn lock_all(&self) -> Result<Option<Lock>, FileError> {
        let path = self.root.join(LOCK);
        let file = open_lock(&path)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Lock { _file: file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            Err(TryLockError::Error(source)) => Err(FileError::new(&path, "lock")(source)),
        }
    }
}

/// Digest of what a file contains: of a checkpoint and of a log the content however it was
/// compressed, of any other file the bytes. An error is a description of the damage.
pub fn content(path: &Path) -> Result<Digest, String> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some(CHECKPOINT) => {
            let checkpoint = checkpoint::read(path).map_err(|error| error.to_string())?;
            Ok(checkpoint.digest())
        }
        Some(LOG) => log::content_digest(path).map_err(|error| error.to_string()),
        _ => bytes_digest(path).map_err(|error| format!("cannot read {}: {error}", path.display())),
    }
}

fn bytes_digest(path: &Path) -> std::io::Result<Digest> {
    use sha2::Digest as _;
    let mut file = File::open(path)?;
    let mut hasher = sha2::Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(Digest(hasher.finalize().into())),
            count => hasher.update(&buffer[..count]),
        }
    }
}

/// Renames a file that cannot be trusted to the first free `<name>.bad-N` and returns that name.
/// The stamp goes the same way first, so that nobody takes the rest for a finished result.
pub fn set_aside(folder: &Path, file: &Path) -> Result<PathBuf, FileError> {
    let stamp = folder.join(stamp::FILE);
    if file != stamp && stamp.exists() {
        rename_aside(&stamp)?;
    }
    let kept = rename_aside(file)?;
    sync_folder_of(file)?;
    Ok(kept)
}

/// Renames a file to the first free `<name>.bad-N`.
pub(super) fn rename_aside(file: &Path) -> Result<PathBuf, FileError> {
    let kept = free_name(file, "bad");
    match fs::rename(file, &kept) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(kept),
        other => other
            .map(|()| kept)
            .map_err(FileError::new(file, "set aside")),
    }
}

/// First `<path>.<word>-N` that is not taken.
pub fn free_name(path: &Path, word: &str) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let candidates = (1..).map(|n| path.with_file_name(format!("{name}.{word}-{n}")));
    candidates
        .into_iter()
        .find(|path| !path.exists())
        .expect("endless")
}

/// Whether the last part of `path` is a key.
pub fn is_key(path: &Path) -> bool {
    let name = path
        .file_name()
        .and_then(|name| name.to_str())
        .unwrap_or_default();
    name.len() == 64
        && name
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// Compares the length of a file, and what the header of a checkpoint says, with the stamp.
fn quick_check(folder: &Path, output: &OutputStamp) -> Result<(), String> {
    let path = folder.join(&output.file);
    let length = fs::metadata(&path)
        .map_err(|_| format!("{} is missing", output.file))?
        .len();
    if length != output.bytes {
        return Err(format!(
            "{} has {length} bytes, not {}",
            output.file, output.bytes
        ));
    }
    if path
        .extension()
        .is_some_and(|extension| extension == CHECKPOINT)
    {
        let peek = checkpoint::peek(&path).map_err(|error| error.to_string())?;
        if peek.digest != output.digest {
            return Err(format!(
                "{} holds something else: {}",
                output.file, peek.digest
            ));
        }
    }
    Ok(())
}

/// A folder without a stamp: was something set aside?
fn set_aside_before(folder: &Path) -> Found {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut bad: Vec<_> = names.filter(|name| name.contains(".bad-")).collect();
    bad.sort();
    let files = bad.iter().filter(|name| !name.starts_with(stamp::FILE));
    match files.last().or(bad.last()) {
        Some(name) => Found::Unusable(format!("a file was damaged and is kept as {name}")),
        None => Found::Nothing,
    }
}

fn open_lock(path: &Path) -> Result<File, FileError> {
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    options.open(path).map_err(FileError::new(path, "open"))
}

/// Writes into a lock who has it. A full disk is no reason to stop here.
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
    let text = fs::read_to_string(path).unwrap_or_default();
    if text.is_empty() {
        "another process".into()
    } else {
        text
    }
}

#[cfg(unix)]
fn same_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let (Ok(held), Ok(named)) = (file.metadata(), fs::metadata(path)) else {
        return false;
    };
    held.ino() == named.ino() && held.dev() == named.dev()
}

#[cfg(not(unix))]
fn same_file(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// Removes what killed writers left; only under the lock, so no living writer is disturbed.
pub fn clean_up(folder: &Path) {
    for folder in [folder.to_path_buf(), folder.join(WORK)] {
        for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
            if is_temporary(&entry.path()) {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}
