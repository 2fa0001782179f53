//! Removal of results that no named pipeline reaches.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::latest::{self, Manifest};
use super::stamp::{self, Stamp};
use super::store::{Found, Store, WORK, clean_up};
use super::{Decision, PipelineError};
use crate::record::atomic::FileError;

/// What a clean-up removed, or would remove, and what it kept.
#[derive(Clone, Debug, Default)]
pub struct Swept {
    /// Folder, label and bytes.
    pub removed: Vec<(PathBuf, String, u64)>,
    /// Folder, and the pipelines that reach it.
    pub kept: Vec<(PathBuf, Vec<String>)>,
}

/// Results that must stay, with the names of those who want them.
type Roots = BTreeMap<PathBuf, Vec<String>>;

/// All that the pipelines in `artifacts/latest/` reach, except those in `forgotten`.
fn roots(store: &Store, forgotten: &[String]) -> Result<Roots, PipelineError> {
    let known = latest::pipelines(store);
    if let Some(name) = forgotten.iter().find(|name| !known.contains(name)) {
        return Err(PipelineError::UnknownPipeline {
            name: name.clone(),
            path: store.root().join(super::store::LATEST),
        });
    }
    let mut roots = Roots::new();
    for name in known.iter().filter(|name| !forgotten.contains(name)) {
        let Some(manifest) = latest::read(store, name) else {
            // Without its manifest nobody knows what it reaches: better keep everything.
            let path = latest::folder(store, name);
            let holder = "a manifest that cannot be read".to_string();
            return Err(PipelineError::Busy { path, holder });
        };
        reach(store, &mut roots, &manifest);
    }
    Ok(roots)
}

/// Adds what a planned pipeline would find fresh or go on with.
fn reach_plan(store: &Store, roots: &mut Roots, name: &str, decisions: &[Decision]) {
    for decision in decisions {
        if let Some(key) = decision.key {
            add(store, roots, name, store.folder(&decision.stage, &key));
        }
    }
}

/// Removes every result that neither a pipeline in `artifacts/latest/` (unless it is `forgotten`)
/// nor one of the `planned` ones reaches. Refuses while a pipeline runs.
pub fn sweep(
    store: &Store,
    planned: &[(String, Vec<Decision>)],
    forgotten: &[String],
    dry_run: bool,
) -> Result<Swept, PipelineError> {
    let mut swept = Swept::default();
    if !store.root().is_dir() {
        return Ok(swept);
    }
    let lock = if dry_run { None } else { store.lock_all()? };
    if lock.is_none() && !dry_run {
        return Err(PipelineError::Busy {
            path: store.root().to_path_buf(),
            holder: "a running pipeline".to_string(),
        });
    }
    let mut roots = roots(store, forgotten)?;
    for (name, decisions) in planned {
        reach_plan(store, &mut roots, name, decisions);
    }
    for stage in store.stages() {
        for folder in store.folders(&stage) {
            if let Some(holders) = roots.get(&folder) {
                if !dry_run {
                    tidy(store, &stage, &folder);
                }
                swept.kept.push((folder, holders.clone()));
                continue;
            }
            let stamp = Stamp::read(&folder).ok().flatten();
            let label = stamp.map_or(stage.clone(), |stamp| stamp.label());
            let bytes = size(&folder);
            if !dry_run {
                remove(&folder)?;
            }
            swept.removed.push((folder, label, bytes));
        }
    }
    if !dry_run {
        for name in forgotten {
            latest::forget(store, name)?;
        }
    }
    Ok(swept)
}

fn reach(store: &Store, roots: &mut Roots, manifest: &Manifest) {
    let results = manifest.results.iter().map(|entry| &entry.folder);
    for folder in results.chain(&manifest.unfinished) {
        add(store, roots, &manifest.pipeline, store.root().join(folder));
    }
}

/// Adds a folder and what it was made from.
fn add(store: &Store, roots: &mut Roots, name: &str, folder: PathBuf) {
    let holders = roots.entry(folder.clone()).or_default();
    if holders.iter().any(|holder| holder == name) {
        return;
    }
    holders.push(name.to_string());
    if let Ok(Some(stamp)) = Stamp::read(&folder) {
        for input in &stamp.inputs {
            add(store, roots, name, store.folder(&input.stage, &input.key));
        }
    }
}

/// Removes left-overs from the folder of a result that stays.
fn tidy(store: &Store, stage: &str, folder: &Path) {
    clean_up(folder);
    let Ok(Some(stamp)) = Stamp::read(folder) else {
        return;
    };
    if matches!(store.find(stage, &stamp.key), Found::Finished(_)) {
        let _ = fs::remove_dir_all(folder.join(WORK));
    }
}

/// The stamp goes first, so that a kill on the way leaves an unfinished folder, not a wrong one.
fn remove(folder: &Path) -> Result<(), FileError> {
    let _ = fs::remove_file(folder.join(stamp::FILE));
    fs::remove_dir_all(folder).map_err(FileError::new(folder, "remove"))
}

fn size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(metadata) if metadata.is_dir() => size(&entry.path()),
            Ok(metadata) => metadata.len(),
            Err(_) => 0,
        })
        .sum()
}
