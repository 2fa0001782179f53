//! A store that several machines share: results are fetched from it before they are made, and put
//! there after.
//!
//! It holds objects that are never changed: `files/<SHA-256 of the bytes>`, and for each result
//! `results/<stage>/<key>.json`, its stamp, which is put last and only if there is none yet. So a
//! stamp never names a file that is not there, whoever puts what at the same time.
//!
//! What arrives is not trusted: `fetch` checks every byte. What fails is told, and the result is
//! made here.

mod fetch;
mod folder;
mod job;
mod put;

use std::collections::HashSet;
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

pub use folder::Folder;

use super::stamp::{InputStamp, OutputStamp, Stamp};
use crate::file::FileError;
use crate::record::Digest;

/// Objects under names: a folder, or a service. Names are plain parts between slashes.
pub trait Objects: Sync {
    /// Where they are, for messages.
    fn place(&self) -> String;

    /// Writes an object to `to`; false if there is none. An object longer than `limit` is an
    /// error, of which at most that much is written.
    ///
    /// # Errors
    /// See [`RemoteError`].
    fn get(&self, name: &str, limit: u64, to: &mut dyn Write) -> Result<bool, RemoteError>;

    /// Size of the object of that name, bytes; `None` if there is none.
    ///
    /// # Errors
    /// See [`RemoteError`].
    fn size(&self, name: &str) -> Result<Option<u64>, RemoteError>;

    /// Puts a file under a name, whole or not at all. If there is one, it is replaced, or stays
    /// and the answer is false.
    ///
    /// # Errors
    /// See [`RemoteError`].
    fn put(&self, name: &str, file: &Path, replace: bool) -> Result<bool, RemoteError>;

    /// Removes what killed processes have left, as far as that is possible.
    fn tidy(&self) {}
}

/// What is wrong with a remote store.
#[derive(Debug, thiserror::Error)]
pub enum RemoteError {
    /// It cannot be used: no network, no permission, no answer in time.
    #[error("{0}")]
    Unusable(String),
    /// An object is missing, damaged or hostile.
    #[error("{object} {what}")]
    Bad {
        /// Name of the object.
        object: String,
        /// What is wrong.
        what: String,
    },
    /// A result is too large for this machine, as it says of itself.
    #[error("{0}")]
    TooLarge(String),
    /// A file of this machine cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl RemoteError {
    /// A bad object.
    pub fn bad(object: &str, what: impl Into<String>) -> Self {
        RemoteError::Bad {
            object: object.to_string(),
            what: what.into(),
        }
    }
}

/// A remote store in use by a run.
pub struct Remote<'a> {
    objects: &'a dyn Objects,
    /// Only fetch: what is not there ends the run.
    pub only: bool,
    /// It did not answer: it is not asked again.
    is_off: AtomicBool,
    /// Keys of results that are bad there: they are replaced.
    bad: Mutex<HashSet<Digest>>,
    /// Keys of results that were here before and have been offered.
    offered: Mutex<HashSet<Digest>>,
}

/// What happened to a result that was offered to a remote store.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Put {
    /// It is there now.
    New,
    /// It was there.
    Known,
}

impl<'a> Remote<'a> {
    /// With nothing known about it yet.
    pub fn new(objects: &'a dyn Objects) -> Self {
        Remote {
            objects,
            only: false,
            is_off: AtomicBool::new(false),
            bad: Mutex::default(),
            offered: Mutex::default(),
        }
    }

    /// As [`Remote::new`], for a run that makes nothing.
    pub fn only(objects: &'a dyn Objects) -> Self {
        Remote {
            only: true,
            ..Remote::new(objects)
        }
    }

    /// Where it is, for messages.
    pub fn place(&self) -> String {
        self.objects.place()
    }

    /// The result of this key is not fetched again.
    pub(super) fn distrust(&self, key: Digest) {
        self.bad.lock().expect("nobody panics").insert(key);
    }

    fn distrusts(&self, key: &Digest) -> bool {
        self.bad.lock().expect("nobody panics").contains(key)
    }

    /// Brings a result into the folder of its key, whose lock the caller holds; `inputs`: those
    /// that it was made from here, if they are known. `None` if it is not there.
    ///
    /// # Errors
    /// See [`RemoteError`]; the folder is as before.
    pub fn fetch(
        &self,
        wanted: &Wanted,
        inputs: Option<&[InputStamp]>,
    ) -> Result<Option<Stamp>, RemoteError> {
        if self.is_off.load(Ordering::Relaxed) || self.distrusts(&wanted.key) {
            return Ok(None);
        }
        let fetched = self.noted(fetch::fetch(self.objects, wanted, inputs));
        if matches!(fetched, Err(RemoteError::Bad { .. })) {
            self.distrust(wanted.key);
        }
        fetched
    }

    /// Puts the result in a folder there, if it is not there or is bad there.
    ///
    /// # Errors
    /// See [`RemoteError`]; [`RemoteError::Bad`] also if there is another result of this key.
    pub fn put(&self, folder: &Path, stamp: &Stamp) -> Result<Put, RemoteError> {
        if self.is_off.load(Ordering::Relaxed) {
            return Ok(Put::Known);
        }
        let replace = self.distrusts(&stamp.key);
        self.noted(put::put(self.objects, folder, stamp, replace))
    }

    /// Removes what killed processes have left there.
    pub fn tidy(&self) {
        self.objects.tidy();
    }

    /// A store that did not answer is not asked again.
    fn noted<T>(&self, result: Result<T, RemoteError>) -> Result<T, RemoteError> {
        if matches!(result, Err(RemoteError::Unusable(_))) {
            self.is_off.store(true, Ordering::Relaxed);
        }
        result
    }
}

/// A result to fetch.
pub struct Wanted<'a> {
    /// Name of the stage.
    pub stage: &'a str,
    /// Its key.
    pub key: Digest,
    /// Folder of the key in the store of this machine.
    pub folder: &'a Path,
}

/// Name of the object of a stamp.
fn stamp_name(stage: &str, key: &Digest) -> String {
    format!("results/{stage}/{}.json", key.hex())
}

/// SHA-256 of all bytes of a file of a result; `None` in an early stamp of a file whose digest
/// does not include them all.
fn sha256(output: &OutputStamp) -> Option<Digest> {
    let is_whole = !super::content::has_own_digest(Path::new(&output.file));
    output.sha256.or(is_whole.then_some(output.digest))
}

/// Name of the object of a file.
fn file_name(sha256: &Digest) -> String {
    format!("files/{}", sha256.hex())
}
