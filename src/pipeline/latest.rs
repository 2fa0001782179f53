//! `artifacts/latest/<pipeline>/`: the newest results by name, as links, and `manifest.json`, which
//! tells a clean-up what the pipeline reaches.

use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Report;
use super::store::{LATEST, Store};
use crate::record::Digest;
use crate::record::atomic::{FileError, write_file};

const MANIFEST: &str = "manifest.json";

/// What a named pipeline reaches.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    pub pipeline: String,
    pub results: Vec<Entry>,
    /// Folders of results on which work has begun, from the root of the store.
    pub unfinished: Vec<PathBuf>,
}

/// One result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// Name of the link: `relax-drop`.
    pub name: String,
    /// From the root of the store.
    pub folder: PathBuf,
    pub key: Digest,
    pub digest: Digest,
}

/// Folder of a pipeline's newest results.
pub fn folder(store: &Store, pipeline: &str) -> PathBuf {
    store.root().join(LATEST).join(pipeline)
}

/// Names of all pipelines with results here.
pub fn pipelines(store: &Store) -> Vec<String> {
    let entries = fs::read_dir(store.root().join(LATEST))
        .into_iter()
        .flatten()
        .flatten();
    let folders = entries.filter(|entry| entry.path().join(MANIFEST).is_file());
    let mut names: Vec<_> = folders
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    names.sort();
    names
}

/// The manifest of a pipeline; `None` if there is none or it cannot be read.
pub fn read(store: &Store, pipeline: &str) -> Option<Manifest> {
    let bytes = fs::read(folder(store, pipeline).join(MANIFEST)).ok()?;
    serde_json::from_slice(&bytes).ok()
}

/// Notes that work begins in the folder of a key, so that a clean-up spares it.
pub(super) fn begin(store: &Store, pipeline: &str, stage: &str, folder_of_key: &Path) {
    let mut manifest = read(store, pipeline).unwrap_or_default();
    manifest.pipeline = pipeline.to_string();
    let name = folder_of_key.file_name().unwrap_or_default();
    let path = Path::new(stage).join(name);
    if !manifest.unfinished.contains(&path) {
        manifest.unfinished.push(path);
        // At worst, a clean-up after a kill removes what could have been resumed.
        let _ = write(store, pipeline, &manifest);
    }
}

/// Points the names at these results. `whole`: they are all that the pipeline has, so that other
/// names are outdated.
pub(super) fn finish(
    store: &Store,
    pipeline: &str,
    reports: &[Report],
    whole: bool,
) -> Result<(), FileError> {
    let old = read(store, pipeline).unwrap_or_default();
    let mut results: Vec<Entry> = reports.iter().map(entry).collect();
    let is_new = |name: &str| results.iter().any(|entry| entry.name == name);
    let (outdated, kept): (Vec<_>, Vec<_>) = old
        .results
        .iter()
        .filter(|entry| !is_new(&entry.name))
        .cloned()
        .partition(|_| whole);
    results.extend(kept);
    let finished = |path: &PathBuf| results.iter().any(|entry| entry.folder == *path);
    let mut unfinished = old.unfinished.clone();
    unfinished.retain(|path| !whole && !finished(path));
    let manifest = Manifest {
        pipeline: pipeline.to_string(),
        results,
        unfinished,
    };
    // A second run must end well where nothing can be written.
    if manifest != old {
        write(store, pipeline, &manifest)?;
    }
    let folder = folder(store, pipeline);
    for entry in &manifest.results {
        link(
            &Path::new("../..").join(&entry.folder),
            &folder.join(&entry.name),
        )?;
    }
    for entry in outdated {
        let _ = fs::remove_file(folder.join(entry.name));
    }
    Ok(())
}

/// Forgets a pipeline: its results stay until a clean-up.
pub fn forget(store: &Store, pipeline: &str) -> Result<(), FileError> {
    let folder = folder(store, pipeline);
    fs::remove_dir_all(&folder).map_err(FileError::new(&folder, "remove"))
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

fn write(store: &Store, pipeline: &str, manifest: &Manifest) -> Result<(), FileError> {
    let folder = folder(store, pipeline);
    fs::create_dir_all(&folder).map_err(FileError::new(&folder, "create the folder"))?;
    let json = serde_json::to_string_pretty(manifest).expect("plain data");
    write_file(&folder.join(MANIFEST), json.as_bytes())
}

/// Makes `path` lead to `target`, atomically: the name always leads to the old or the new one.
#[cfg(unix)]
fn link(target: &Path, path: &Path) -> Result<(), FileError> {
    if fs::read_link(path).is_ok_and(|old| old == target) {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let temporary = path.with_file_name(format!(".{name}.{}", std::process::id()));
    let _ = fs::remove_file(&temporary);
    std::os::unix::fs::symlink(target, &temporary)
        .and_then(|()| fs::rename(&temporary, path))
        .map_err(FileError::new(path, "link"))
}

/// Where links need a privilege, a text file names the folder.
#[cfg(not(unix))]
fn link(target: &Path, path: &Path) -> Result<(), FileError> {
    let text = target.display().to_string();
    write_file(&path.with_extension("txt"), text.as_bytes())
}
