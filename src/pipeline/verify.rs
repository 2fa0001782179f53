//! Hashes finished results again, whole, and sets aside what does not hold what its stamp says.

use std::fs;
use std::path::{Path, PathBuf};

use super::stamp::{self, OutputStamp, Stamp};
use super::store::{Store, content, set_aside};

/// What was found in one folder.
#[derive(Clone, Debug)]
pub struct Finding {
    pub folder: PathBuf,
    /// For people: `relax drop`; only the stage, if the stamp cannot be read.
    pub label: String,
    /// Bytes that were hashed.
    pub bytes: u64,
    pub problems: Vec<Problem>,
}

/// A file that cannot be trusted.
#[derive(Clone, Debug)]
pub struct Problem {
    pub file: PathBuf,
    pub what: String,
    /// Where it is kept now; `None` if it is missing or could not be renamed.
    pub kept: Option<PathBuf>,
}

/// Verifies every finished result in the store; `each` sees a finding as soon as it is made.
/// Unfinished folders are passed over, those in use too.
pub fn verify(store: &Store, each: &mut dyn FnMut(&Finding)) -> Vec<Finding> {
    let mut findings = Vec::new();
    for stage in store.stages() {
        for folder in store.folders(&stage) {
            let finding = match Stamp::read(&folder) {
                Ok(None) => continue,
                Ok(Some(stamp)) => examine(store, &folder, &stamp),
                Err(error) => Finding {
                    problems: vec![problem(
                        store,
                        &folder,
                        &folder.join(stamp::FILE),
                        error.to_string(),
                    )],
                    folder,
                    label: stage.clone(),
                    bytes: 0,
                },
            };
            each(&finding);
            findings.push(finding);
        }
    }
    findings
}

fn examine(store: &Store, folder: &Path, stamp: &Stamp) -> Finding {
    let mut finding = Finding {
        folder: folder.to_path_buf(),
        label: stamp.label(),
        bytes: 0,
        problems: Vec::new(),
    };
    for output in &stamp.outputs {
        let path = folder.join(&output.file);
        match check(&path, output) {
            Ok(()) => finding.bytes += output.bytes,
            Err(what) => finding.problems.push(problem(store, folder, &path, what)),
        }
    }
    finding
}

fn check(path: &Path, output: &OutputStamp) -> Result<(), String> {
    let length = fs::metadata(path)
        .map_err(|_| "it is missing".to_string())?
        .len();
    if length != output.bytes {
        return Err(format!("it has {length} bytes, not {}", output.bytes));
    }
    let found = content(path)?;
    if found != output.digest {
        return Err(format!("it holds {found}, not {}", output.digest));
    }
    Ok(())
}

/// Sets the file aside, unless somebody works in the folder.
fn problem(store: &Store, folder: &Path, file: &Path, what: String) -> Problem {
    let lock = store.lock(folder, &mut |_| false);
    let kept = match lock {
        Ok(Some(_lock)) if file.exists() => set_aside(folder, file).ok(),
        // A missing file leaves a stamp that promises too much.
        Ok(Some(_lock)) => set_aside(folder, &folder.join(stamp::FILE)).ok().and(None),
        _ => None,
    };
    Problem {
        file: file.to_path_buf(),
        what,
        kept,
    }
}
