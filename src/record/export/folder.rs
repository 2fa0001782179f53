//! The folder of an export: what an export has written there is listed in a file, and the next
//! export to the folder removes what is listed before it writes.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{ExportError, Format};
use crate::file::{self, FileError};
use crate::record::atomic;

/// Name of the list.
pub const LIST: &str = "coronet-export.json";

/// Largest size of a list, bytes.
const LONGEST: u64 = 64 << 20;

/// Content of the list.
#[derive(Debug, Serialize, Deserialize)]
pub struct List {
    /// Version of the program that has written it.
    pub coronet: String,
    /// Names of the bodies, in the order of the column `body`; of a log only.
    #[serde(default)]
    pub bodies: Vec<String>,
    /// Names of the files of the export, the index first.
    pub files: Vec<String>,
}

impl List {
    /// For these files.
    pub fn new(bodies: Vec<String>, files: Vec<String>) -> List {
        List {
            coronet: env!("CARGO_PKG_VERSION").into(),
            bodies,
            files,
        }
    }

    /// Writes the list into `folder`. It is written before the files: what a killed export leaves
    /// is removed too.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        let text = serde_json::to_string_pretty(self).expect("texts become JSON") + "\n";
        atomic::write_file(&folder.join(LIST), text.as_bytes())
    }

    /// The list in `folder`, if there is one.
    fn read(folder: &Path) -> Result<Option<List>, ExportError> {
        let path = folder.join(LIST);
        let bytes = match file::read(&path, LONGEST) {
            Err(error) if error.is_not_found() => return Ok(None),
            read => read?,
        };
        let foreign = |error: serde_json::Error| ExportError::List {
            path: path.clone(),
            problem: error.to_string(),
        };
        serde_json::from_slice(&bytes).map(Some).map_err(foreign)
    }
}

/// Makes place for files with these `names`: removes the files of an earlier export, which are
/// those of its list, and what a killed export was writing. All other files are the user's. Returns
/// the number of listed files that were removed.
///
/// # Errors
/// If a file of the user has one of the names, then nothing is removed; if the list is not that of
/// an export, or a file cannot be removed.
pub fn clear(folder: &Path, names: &[String]) -> Result<usize, ExportError> {
    let listed = List::read(folder)?.map_or(Vec::new(), |list| list.files);
    for name in names.iter().filter(|name| !listed.contains(name)) {
        let path = folder.join(name);
        if file::exists(&path)? {
            return Err(ExportError::Foreign { path });
        }
    }
    // A list may come from a stranger: only names that an export gives, in this folder.
    let is_ours = |name: &str| {
        let extension = Path::new(name).extension();
        let known = Format::ALL.iter().flat_map(|format| format.extensions());
        let is_plain = Path::new(name)
            .file_name()
            .is_some_and(|plain| plain == name);
        is_plain && extension.is_some_and(|extension| known.into_iter().any(|e| extension == e))
    };
    let mut removed = 0;
    for name in listed.iter().filter(|name| is_ours(name)) {
        removed += usize::from(remove(&folder.join(name))?);
    }
    for entry in fs::read_dir(folder).map_err(FileError::new(folder, "list"))? {
        let entry = entry.map_err(FileError::new(folder, "list"))?;
        let name = entry.file_name();
        let whole = name.to_str().and_then(temporary);
        if whole.is_some_and(|whole| listed.iter().any(|name| name == whole)) {
            remove(&entry.path())?;
        }
    }
    Ok(removed)
}

/// Removes a regular file; returns whether there was one.
fn remove(path: &Path) -> Result<bool, FileError> {
    match path.symlink_metadata() {
        Ok(metadata) if metadata.is_file() => {
            fs::remove_file(path).map_err(FileError::new(path, "remove"))?;
            Ok(true)
        }
        Ok(_) => Ok(false),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(FileError::new(path, "examine")(error)),
    }
}

/// The file that a temporary file of this name was going to be.
fn temporary(name: &str) -> Option<&str> {
    let hidden = name.strip_prefix('.')?;
    if !atomic::is_temporary(Path::new(name)) {
        return None;
    }
    // .NAME.PROCESS.NUMBER.ENDING
    let mut parts = hidden.rsplitn(4, '.');
    parts.nth(3)
}
