//! Hashes all files of finished results again, and sets aside files that differ from their stamp.
//! Files that cannot be read are reported and not changed.

use std::io;
use std::path::{Path, PathBuf};

use super::content::{ContentError, bytes, content, set_aside};
use super::key::contradiction;
use super::latest::{self, ManifestError};
use super::name::MANIFEST;
use super::stamp::{self, OutputStamp, Stamp, StampError};
use super::store::{LATEST, MARK, Store, refuse_links_below};
use crate::file::{self, FileError};

/// Findings in one folder.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The folder of the result.
    pub folder: PathBuf,
    /// Name of the job in messages: `relax drop`; only the stage, if the stamp cannot be used.
    pub label: String,
    /// Bytes that were hashed.
    pub bytes: u64,
    /// What is wrong in it; empty if all is well.
    pub problems: Vec<Problem>,
}

/// A file that is damaged or cannot be read.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The file.
    pub file: PathBuf,
    /// What is wrong.
    pub what: String,
    /// It was read and is wrong; otherwise it could not be read.
    pub damaged: bool,
    /// Its new path; `None` if it was not moved.
    pub kept: Option<PathBuf>,
}

/// Verifies every finished result in the store, its mark and its manifests; `each` is called with
/// each finding. Unfinished folders are skipped, and a folder in use is
/// not set aside.
///
/// # Errors
/// If the store cannot be listed.
pub fn verify(store: &Store, each: &mut dyn FnMut(&Finding)) -> Result<Vec<Finding>, FileError> {
    let mut findings = Vec::new();
    let mut add = |finding: Finding| {
        each(&finding);
        findings.push(finding);
    };
    for stage in store.stages()? {
        for folder in store.folders(&stage)? {
            if let Some(finding) = examine(store, &stage, folder) {
                add(finding);
            }
        }
    }
    let names = examine_names(store);
    if !names.problems.is_empty() {
        add(names);
    }
    Ok(findings)
}

fn examine(store: &Store, stage: &str, folder: PathBuf) -> Option<Finding> {
    let mut finding = Finding {
        label: stage.to_string(),
        bytes: 0,
        problems: Vec::new(),
        folder,
    };
    let folder = finding.folder.clone();
    let path = folder.join(stamp::FILE);
    let checked = Stamp::read(&folder).map(|stamp| {
        let stamp = stamp?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        let misplaced = stamp.stage != stage || stamp.key.hex() != name;
        let wrong = misplaced.then_some("it belongs to another folder");
        Some((wrong.or_else(|| contradiction(&stamp)), stamp))
    });
    match checked {
        Ok(None) => return None,
        Ok(Some((wrong, stamp))) => {
            finding.label = stamp.label();
            if let Some(what) = wrong {
                let error = ContentError::Damaged(what.to_string());
                finding.problems.push(problem(store, &folder, &path, error));
            }
            for output in &stamp.outputs {
                let path = folder.join(&output.file);
                match check(&folder, &path, output) {
                    Ok(()) => finding.bytes += output.bytes,
                    Err(error) => finding.problems.push(problem(store, &folder, &path, error)),
                }
            }
        }
        Err(error) => {
            let error = match error {
                StampError::File(error) => ContentError::File(error),
                StampError::Invalid { what, .. } => ContentError::Damaged(what),
            };
            finding.problems.push(problem(store, &folder, &path, error));
        }
    }
    Some(finding)
}

/// Compares a file in the folder of a result with its stamp: size, content, all bytes.
pub(super) fn check(folder: &Path, path: &Path, output: &OutputStamp) -> Result<(), ContentError> {
    refuse_links_below(folder, path).map_err(ContentError::File)?;
    let length = match path.symlink_metadata() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(ContentError::Damaged("it is missing".to_string()));
        }
        other => other.map_err(FileError::new(path, "examine"))?.len(),
    };
    if length != output.bytes {
        let what = format!("it has {length} bytes, not {}", output.bytes);
        return Err(ContentError::Damaged(what));
    }
    let found = content(path)?;
    if found != output.digest {
        let what = format!("it holds {found}, not {}", output.digest);
        return Err(ContentError::Damaged(what));
    }
    match output.sha256 {
        Some(wanted) if bytes(path)? != wanted => {
            let what = "what it holds is right, but not the bytes around it".to_string();
            Err(ContentError::Damaged(what))
        }
        _ => Ok(()),
    }
}

/// Sets a damaged file aside, unless a process uses the folder.
fn problem(store: &Store, folder: &Path, file: &Path, error: ContentError) -> Problem {
    let damaged = matches!(error, ContentError::Damaged(_));
    let mut what = error.to_string();
    let kept = match damaged {
        true => aside(store, folder, file).unwrap_or_else(|error| {
            what += &format!("; it stays where it is: {error}");
            None
        }),
        false => None,
    };
    Problem {
        file: file.to_path_buf(),
        what,
        damaged,
        kept,
    }
}

/// New path of a damaged file. If the file is missing, the stamp is set aside.
fn aside(store: &Store, folder: &Path, file: &Path) -> Result<Option<PathBuf>, FileError> {
    let Some(_lock) = store.lock(folder, &mut |_| false)? else {
        return Ok(None);
    };
    if file::is_there(file)? {
        // Another process may have repaired it meanwhile.
        let wanted = Stamp::read(folder).ok().flatten().and_then(|stamp| {
            let mut outputs = stamp.outputs.into_iter();
            outputs.find(|output| folder.join(&output.file) == file)
        });
        if wanted.is_some_and(|wanted| content(file).is_ok_and(|found| found == wanted.digest)) {
            return Ok(None);
        }
        return set_aside(folder, file).map(Some);
    }
    let stamp = folder.join(stamp::FILE);
    match file::is_there(&stamp)? {
        true => set_aside(folder, &stamp).map(|_| None),
        false => Ok(None),
    }
}

/// The mark of the store and the manifests of its names. The next run writes them again, so
/// nothing is set aside.
fn examine_names(store: &Store) -> Finding {
    let mut finding = Finding {
        folder: store.root().join(LATEST),
        label: LATEST.to_string(),
        bytes: 0,
        problems: Vec::new(),
    };
    let mut add = |file: PathBuf, what: String, damaged: bool| {
        finding.problems.push(Problem {
            file,
            what,
            damaged,
            kept: None,
        });
    };
    let mark = store.root().join(MARK);
    match store.is_marked() {
        Ok(true) => {}
        Ok(false) => add(mark, "it is missing or was damaged".to_string(), true),
        Err(error) => add(mark, error.to_string(), false),
    }
    let names = latest::pipelines(store).unwrap_or_else(|error| {
        add(error.path.clone(), error.to_string(), false);
        Vec::new()
    });
    for name in names {
        let path = latest::folder(store, &name).join(MANIFEST);
        match latest::read(store, &name) {
            Ok(manifest) => {
                for entry in manifest.unwrap_or_default().results {
                    let result = store.root().join(&entry.folder);
                    let name = latest::folder(store, &name).join(&entry.name);
                    match file::is_folder(&result) {
                        Ok(true) => {}
                        Ok(false) => {
                            add(
                                name,
                                format!("the result in {} is gone", result.display()),
                                true,
                            );
                        }
                        Err(error) => add(name, error.to_string(), false),
                    }
                }
            }
            Err(ManifestError::Invalid { what, .. }) => add(path, what, true),
            Err(ManifestError::File(error)) => add(path, error.to_string(), false),
        }
    }
    finding
}
