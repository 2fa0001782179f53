//! A remote store in a folder that several machines see.

use std::io::{self, ErrorKind, Read as _, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Objects, RemoteError};
use crate::file::{self, FileError};
use crate::pipeline::store::{folders_in, refuse_links_below, sweep};
use crate::record::atomic::{AtomicFile, create_folder};

/// Age from which a temporary file counts as left by a killed process; of clocks of other machines.
const LEFT_OVER: Duration = Duration::from_secs(24 * 3600);

/// Objects as files below a folder, which must exist: a folder that is not mounted is missing.
#[derive(Clone, Debug)]
pub struct Folder {
    root: PathBuf,
}

impl Folder {
    /// The objects below `root`.
    pub fn new(root: impl Into<PathBuf>) -> Self {
        Folder { root: root.into() }
    }

    /// Path of an object; no part of it is a link, which could lead anywhere.
    fn path(&self, name: &str) -> Result<PathBuf, RemoteError> {
        if !self.root.is_dir() {
            let root = self.root.display();
            let what = format!("there is no folder {root}; make it, or mount what it is on");
            return Err(RemoteError::Unusable(what));
        }
        let path = self.root.join(name);
        refuse_links_below(&self.root, &path).map_err(failed(name))?;
        Ok(path)
    }
}

/// An error of the folder. A failed read says nothing about an object, which must not be replaced
/// then; an object that cannot be one is bad.
fn failed(name: &str) -> impl Fn(FileError) -> RemoteError {
    move |error| match error.source.kind() {
        ErrorKind::NotADirectory | ErrorKind::IsADirectory | ErrorKind::AlreadyExists => {
            RemoteError::bad(name, format!("cannot be used: {error}"))
        }
        _ if error.source.raw_os_error().is_some() => RemoteError::Unusable(error.to_string()),
        _ => RemoteError::bad(name, format!("cannot be used: {error}")),
    }
}

impl Objects for Folder {
    fn place(&self) -> String {
        format!("file://{}", self.root.display())
    }

    fn get(&self, name: &str, limit: u64, to: &mut dyn Write) -> Result<bool, RemoteError> {
        let path = self.path(name)?;
        let file = match file::open_no_link(&path) {
            Err(error) if error.is_not_found() => return Ok(false),
            other => other.map_err(failed(name))?,
        };
        let copied = io::copy(&mut file.take(limit.saturating_add(1)), to);
        let count = copied.map_err(|error| failed(name)(FileError::new(&path, "copy")(error)))?;
        if count > limit {
            return Err(RemoteError::bad(
                name,
                format!("is longer than {limit} bytes"),
            ));
        }
        Ok(true)
    }

    fn size(&self, name: &str) -> Result<Option<u64>, RemoteError> {
        let found = self.path(name)?.metadata().ok();
        let file = found.filter(|found| found.is_file());
        Ok(file.map(|file| file.len()))
    }

    fn put(&self, name: &str, file: &Path, replace: bool) -> Result<bool, RemoteError> {
        let path = self.path(name)?;
        let folder = path.parent().unwrap_or(&self.root);
        create_folder(folder).map_err(failed(name))?;
        let put = || {
            let mut source = file::open_no_link(file)?;
            let mut target = AtomicFile::create(&path)?;
            io::copy(&mut source, &mut target).map_err(FileError::new(&path, "write"))?;
            match replace {
                true => target.commit().map(|()| true),
                false => target.commit_new(),
            }
        };
        put().map_err(failed(name))
    }

    fn tidy(&self) {
        let files = self.path("files").ok();
        let results = self.path("results").ok();
        let stages = results.and_then(|folder| folders_in(&folder).ok());
        for folder in stages.into_iter().flatten().chain(files) {
            let _ = sweep(&folder, LEFT_OVER);
        }
    }
}
