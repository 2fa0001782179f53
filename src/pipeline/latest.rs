//! `artifacts/latest/<name>/`: the newest results by name, as links, and `manifest.json`, which
//! lists them. The name is that of the pipeline, which goes from run to run; a run with other
//! settings has a name of its own as well ([`super::Run`]).

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use serde::{Deserialize, Serialize};

use super::content::free_name;
use super::name::{MANIFEST, is_key, is_plain_name};
use super::stamp::InputStamp;
use super::store::{LATEST, Store, entries, folders_in, sweep};
use super::{Report, Stamp, seal};
use crate::file::{self, FileError};
use crate::record::Digest;
use crate::record::atomic::{temporary_name, write_file};

/// Largest size of a manifest, bytes.
const LONGEST: u64 = 16 << 20;

/// Age from which a temporary file counts as left by a killed process.
const LEFT_OVER: Duration = Duration::from_secs(3600);

/// The results of a named pipeline.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    /// Name of the pipeline.
    pub pipeline: String,
    /// Its results, one for each job.
    pub results: Vec<Entry>,
}

/// One result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Name of the link: `relax-drop`.
    pub name: String,
    /// From the root of the store.
    pub folder: PathBuf,
    /// Key of the result.
    pub key: Digest,
    /// Digest of its content.
    pub digest: Digest,
}

/// A manifest that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ManifestError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The content is not a manifest.
    #[error("{} is not a valid manifest: {what}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// Folder of a pipeline's newest results.
pub fn folder(store: &Store, pipeline: &str) -> PathBuf {
    store.root().join(LATEST).join(pipeline)
}

/// Names of all pipelines with results here; a name can have several parts.
///
/// # Errors
/// If a folder cannot be listed, or a name is a symbolic link.
pub fn pipelines(store: &Store) -> Result<Vec<String>, FileError> {
    let latest = store.root().join(LATEST);
    file::refuse_link(&latest)?;
    let (mut names, mut folders) = (Vec::new(), vec![latest.clone()]);
    while let Some(folder) = folders.pop() {
        let path = folder.join(MANIFEST);
        if file::is_there(&path)? || has_results(&folder)? {
            names.push(name_of(&folder, &latest)?);
        } else {
            // Of a study, or of names of several parts.
            for entry in entries(&folder)? {
                file::refuse_link(&entry.path())?;
            }
        }
        folders.extend(folders_in(&folder)?);
    }
    names.sort();
    Ok(names)
}

/// Whether a folder has links to results.
fn has_results(folder: &Path) -> Result<bool, FileError> {
    for entry in entries(folder)? {
        let path = entry.path();
        if file::is_link(&path)? {
            match fs::read_link(&path) {
                Ok(to) if is_key(&to) => return Ok(true),
                // A temporary one, which has its name by now.
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                other => drop(other.map_err(FileError::new(&path, "read"))?),
            }
        }
    }
    Ok(false)
}

/// Name of the pipeline with this folder.
fn name_of(folder: &Path, latest: &Path) -> Result<String, FileError> {
    let name = folder.strip_prefix(latest).unwrap_or(folder).to_str();
    let odd = || FileError::new(folder, "use")(io::Error::other("its name is not UTF-8"));
    Ok(name.ok_or_else(odd)?.to_string())
}

/// The manifest of a pipeline; `None` if there is none.
///
/// # Errors
/// If it cannot be read, was damaged, or names something outside the store.
pub fn read(store: &Store, pipeline: &str) -> Result<Option<Manifest>, ManifestError> {
    let folder = folder(store, pipeline);
    let path = folder.join(MANIFEST);
    store.refuse_links(&path)?;
    let bytes = match file::read_no_link(&path, LONGEST) {
        Err(error) if error.is_not_found() && has_results(&folder)? => {
            let what = "it is missing; `coronet run` writes it again".to_string();
            return Err(ManifestError::Invalid { path, what });
        }
        Err(error) if error.is_not_found() => return Ok(None),
        other => other?,
    };
    let parsed = || {
        let text = String::from_utf8(bytes).map_err(|error| error.to_string())?;
        seal::check(&text)?;
        let manifest: Manifest = serde_json::from_str(&text).map_err(|error| error.to_string())?;
        if let Some(entry) = manifest.results.iter().find(|entry| !entry.is_plain()) {
            return Err(format!("{:?} leads out of the store", entry.name));
        }
        Ok(manifest)
    };
    let parsed: Result<Manifest, String> = parsed();
    parsed
        .map(Some)
        .map_err(|what| ManifestError::Invalid { path, what })
}

impl Entry {
    /// Whether the entry names a link in its own folder and the folder of a key in the store.
    fn is_plain(&self) -> bool {
        let parts: Vec<_> = self.folder.iter().collect();
        let stage = parts.first().and_then(|part| part.to_str());
        parts.len() == 2
            && stage.is_some_and(is_plain_name)
            && is_key(&self.folder)
            && is_plain_name(&self.name)
            && self.name != MANIFEST
    }
}

/// Points the names to these results. `whole`: they are all results of the pipeline, so that other
/// names are outdated; else other names stay that belong to these results ([`fitting`]). Returns
/// the new names of folders that were in place of links, as in a copied store.
///
/// # Errors
/// If a file cannot be read or written, or a folder is a symbolic link.
pub(super) fn finish(
    store: &Store,
    pipeline: &str,
    reports: &[Report],
    whole: bool,
) -> Result<Vec<PathBuf>, FileError> {
    let folder = folder(store, pipeline);
    // A second run must succeed in a read-only store.
    if renewed(store, pipeline, reports, whole)?.changes {
        store.create(&folder)?;
    }
    // Without the lock, another process may be writing younger files.
    let lock = lock(&folder);
    let Renewed {
        manifest,
        outdated,
        changes,
    } = renewed(store, pipeline, reports, whole)?;
    sweep(&folder, lock.as_ref().map_or(LEFT_OVER, |_| Duration::ZERO))?;
    if changes {
        write(&folder, &manifest)?;
    } else if whole {
        renew_time(&folder.join(MANIFEST));
    }
    let up = "../".repeat(Path::new(pipeline).components().count() + 1);
    let mut moved = Vec::new();
    for entry in &manifest.results {
        let target = Path::new(&up).join(&entry.folder);
        moved.extend(link(&target, &folder.join(&entry.name))?);
    }
    for entry in outdated {
        let path = folder.join(entry.name);
        if file::is_link(&path)? {
            fs::remove_file(&path).map_err(FileError::new(&path, "remove"))?;
        }
    }
    Ok(moved)
}

/// Gives a manifest the time of now: what was begun and stopped before is outdated, although no
/// result is new. In a read-only store it keeps its time.
fn renew_time(path: &Path) {
    if let Ok(file) = file::open_no_link(path) {
        let _ = file.set_modified(SystemTime::now());
    }
}

/// What the manifest of a pipeline becomes.
struct Renewed {
    manifest: Manifest,
    /// Names that are no longer in it.
    outdated: Vec<Entry>,
    /// Whether it differs from what is there.
    changes: bool,
}

/// The manifest with these results: see [`finish`].
fn renewed(
    store: &Store,
    pipeline: &str,
    reports: &[Report],
    whole: bool,
) -> Result<Renewed, FileError> {
    let old = match read(store, pipeline) {
        Ok(old) => old.unwrap_or_default(),
        // Its content follows from the links and is written again.
        Err(ManifestError::Invalid { .. }) => Manifest::default(),
        Err(ManifestError::File(error)) => return Err(error),
    };
    let mut results: Vec<Entry> = reports.iter().map(entry).collect();
    let is_new = |name: &str| results.iter().any(|entry| entry.name == name);
    let others = old.results.iter().filter(|entry| !is_new(&entry.name));
    let others: Vec<Entry> = others.cloned().collect();
    let kept = match whole {
        true => Vec::new(),
        false => fitting(store, &results, others.clone()),
    };
    let outdated = others.into_iter().filter(|entry| !kept.contains(entry));
    let outdated = outdated.collect();
    results.extend(kept);
    let manifest = Manifest {
        pipeline: pipeline.to_string(),
        results,
    };
    Ok(Renewed {
        changes: manifest != old,
        manifest,
        outdated,
    })
}

/// Those of `others` that were made from `results` and from each other: an evaluation of an older
/// impact must not stand beside a newer one. As in keys, inputs count by their content.
fn fitting(store: &Store, results: &[Entry], others: Vec<Entry>) -> Vec<Entry> {
    let stamped = |entry: Entry| {
        let stamp = Stamp::read(&store.root().join(&entry.folder));
        Some((stamp.ok()??, entry))
    };
    let mut others: Vec<(Stamp, Entry)> = others.into_iter().filter_map(stamped).collect();
    loop {
        let count = others.len();
        let mut here: Vec<Digest> = results.iter().map(|entry| entry.digest).collect();
        here.extend(others.iter().map(|(stamp, _)| stamp.digest));
        let is_here = |input: &InputStamp| here.contains(&input.digest);
        others.retain(|(stamp, _)| stamp.inputs.iter().all(is_here));
        if others.len() == count {
            return others.into_iter().map(|(_, entry)| entry).collect();
        }
    }
}

/// Forgets a pipeline: its results stay until a clean-up. Other files in its folder stay.
///
/// # Errors
/// If its folder cannot be read or written, or is a symbolic link.
pub fn forget(store: &Store, pipeline: &str) -> Result<(), FileError> {
    let folder = folder(store, pipeline);
    store.refuse_links(&folder)?;
    for entry in entries(&folder)? {
        let path = entry.path();
        if path.is_symlink() || entry.file_name() == MANIFEST {
            fs::remove_file(&path).map_err(FileError::new(&path, "remove"))?;
        }
    }
    // Those that are empty: a name can have several parts.
    let latest = store.root().join(LATEST);
    let mut folders = folder.ancestors().take_while(|folder| **folder != latest);
    let _ = folders.try_for_each(fs::remove_dir);
    Ok(())
}

/// Removes temporary files of killed writers, those below `latest/` when they are old: whoever
/// writes there need not hold the store.
///
/// # Errors
/// If a folder cannot be listed.
pub(super) fn clean_up(store: &Store) -> Result<(), FileError> {
    sweep(store.root(), Duration::ZERO)?;
    let mut folders = folders_in(&store.root().join(LATEST))?;
    while let Some(folder) = folders.pop() {
        sweep(&folder, LEFT_OVER)?;
        folders.extend(folders_in(&folder)?);
    }
    Ok(())
}

/// Prevents other processes from writing links in a folder; `None` where folders cannot be locked.
fn lock(folder: &Path) -> Option<File> {
    let file = File::open(folder).ok()?;
    file.lock().ok()?;
    Some(file)
}

fn entry(report: &Report) -> Entry {
    let name = match report.body.as_str() {
        "" => report.stage.clone(),
        body => format!("{}-{}", report.stage, body.replace(['/', '\\'], "_")),
    };
    Entry {
        name,
        folder: Path::new(&report.stage).join(report.stamp.key.hex()),
        key: report.stamp.key,
        digest: report.stamp.digest,
    }
}

fn write(folder: &Path, manifest: &Manifest) -> Result<(), FileError> {
    let json = serde_json::to_string_pretty(manifest).expect("plain data");
    write_file(&folder.join(MANIFEST), seal::seal(&json).as_bytes())
}

/// Makes `path` a link to `target`, atomically: the name always leads to the old or the new target.
/// A file or folder at `path` that is not a link is set aside.
#[cfg(unix)]
fn link(target: &Path, path: &Path) -> Result<Option<PathBuf>, FileError> {
    if fs::read_link(path).is_ok_and(|old| old == target) {
        return Ok(None);
    }
    let mut moved = None;
    match path.symlink_metadata() {
        Ok(metadata) if !metadata.is_symlink() => {
            let aside = free_name(path, "copy")?;
            fs::rename(path, &aside).map_err(FileError::new(path, "set aside"))?;
            moved = Some(aside);
        }
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return Err(FileError::new(path, "examine")(error));
        }
        _ => {}
    }
    let temporary = temporary_name(path);
    std::os::unix::fs::symlink(target, &temporary)
        .and_then(|()| fs::rename(&temporary, path))
        .inspect_err(|_| drop(fs::remove_file(&temporary)))
        .map_err(FileError::new(path, "link"))?;
    Ok(moved)
}

/// Where links need a privilege, a text file contains the path of the folder.
#[cfg(not(unix))]
fn link(target: &Path, path: &Path) -> Result<Option<PathBuf>, FileError> {
    let text = target.display().to_string();
    write_file(&path.with_extension("txt"), text.as_bytes())?;
    Ok(None)
}
