//! Removal of results that are certainly unused. All others are kept, with the reason.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::context::Spent;
use super::decide::has_checkpoint;
use super::latest;
use super::lock::LOCK;
use super::stamp::{self, InputStamp, SettingStamp, Stamp, StampError};
use super::store::{Found, LATEST, MARK, Store, WORK, clean_up, entries};
use super::{Decision, PipelineError};
use crate::file::{self, FileError};

/// Options of a clean-up.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Finished results older than this that no name reaches; without it, all finished results
    /// stay.
    pub older_than: Option<Duration>,
    /// Also remove stopped runs with checkpoints of that age.
    pub unfinished: bool,
    /// Names to forget, with the results that only they reach.
    pub forgotten: Vec<String>,
    /// Pipelines whose results stay, besides those that have a name.
    pub planned: Vec<(String, Vec<Decision>)>,
    /// Continue even if no name reaches any result.
    pub without_names: bool,
}

/// The folders that a clean-up removes or keeps.
#[derive(Debug, Default)]
pub struct Swept {
    /// Folder, label and bytes.
    pub removed: Vec<(PathBuf, String, u64)>,
    /// Folder, and why it is kept.
    pub kept: Vec<(PathBuf, String)>,
    /// Folders that are kept because they cannot be read.
    pub unknown: Vec<FileError>,
}

/// Results that must stay, with the names of those that reach them.
type Roots = BTreeMap<PathBuf, Vec<String>>;

/// Decision about a folder.
enum Fate {
    Remove(String),
    Keep(String),
    /// It cannot be read, so it is kept.
    Unknown(FileError),
}

/// What [`sweep`] would remove. Nothing is written.
///
/// # Errors
/// If the store or a name in it cannot be read: then nothing is certainly unused.
pub fn plan(store: &Store, options: &Options) -> Result<Swept, PipelineError> {
    check(store)?;
    let roots = roots(store, options)?;
    let released = released(store, options)?;
    let mut swept = Swept::default();
    let mut finished = false;
    for stage in store.stages()? {
        for folder in store.folders(&stage)? {
            let judge = Judge {
                store,
                options,
                roots: &roots,
                released: &released,
            };
            match judge.fate(&stage, &folder) {
                Fate::Keep(why) => swept.kept.push((folder, why)),
                Fate::Unknown(error) => swept.unknown.push(error),
                Fate::Remove(label) => {
                    finished |= file::is_there(&folder.join(stamp::FILE))?;
                    let bytes = size(&folder);
                    swept.removed.push((folder, label, bytes));
                }
            }
        }
    }
    let unnamed = options.forgotten.is_empty() && latest::pipelines(store)?.is_empty();
    if finished && unnamed && !options.without_names {
        return Err(PipelineError::NoNames {
            path: store.root().to_path_buf(),
        });
    }
    Ok(swept)
}

/// Removes the folders of [`plan`] that are in `approved`, and files of killed writers. Fails while
/// a pipeline runs.
///
/// # Errors
/// As [`plan`]; if a pipeline runs, or something cannot be removed.
pub fn sweep(
    store: &Store,
    options: &Options,
    approved: &[PathBuf],
) -> Result<Swept, PipelineError> {
    let _lock = hold(store)?;
    let mut swept = plan(store, options)?;
    let planned = std::mem::take(&mut swept.removed);
    for name in &options.forgotten {
        latest::forget(store, name)?;
    }
    for removal in planned {
        let folder = &removal.0;
        if !approved.contains(folder) {
            let why = "it changed meanwhile".to_string();
            swept.kept.push((removal.0, why));
        } else if remove(store, folder)? {
            swept.removed.push(removal);
        } else {
            swept.kept.push((removal.0, "in use".to_string()));
        }
    }
    for (folder, _) in &swept.kept {
        tidy(store, folder);
    }
    latest::clean_up(store)?;
    Ok(swept)
}

/// Locks the store exclusively.
///
/// # Errors
/// [`PipelineError::Busy`] if a pipeline runs.
pub fn hold(store: &Store) -> Result<super::lock::Lock, PipelineError> {
    check(store)?;
    store.lock_all()?.ok_or_else(|| PipelineError::Busy {
        path: store.root().to_path_buf(),
        holder: "a running pipeline".to_string(),
    })
}

/// Fails unless the folder is marked as a store.
fn check(store: &Store) -> Result<(), PipelineError> {
    if store.is_marked()? {
        return Ok(());
    }
    let remedy = if file::is_folder(&store.root().join(LATEST))? {
        "; if it is one of an earlier version, `coronet run` marks it"
    } else {
        ""
    };
    Err(PipelineError::NotAStore {
        path: store.root().to_path_buf(),
        mark: MARK,
        remedy,
    })
}

/// All that must stay: results of the names in `artifacts/latest/`, except those to forget, results
/// of the planned pipelines, inputs of unfinished runs, and finished results that are not old, each
/// with its inputs.
fn roots(store: &Store, options: &Options) -> Result<Roots, PipelineError> {
    let known = latest::pipelines(store)?;
    let is_unknown = |name: &&String| !known.contains(name);
    if let Some(name) = options.forgotten.iter().find(is_unknown) {
        return Err(PipelineError::UnknownPipeline {
            name: name.clone(),
            path: store.root().join(LATEST),
        });
    }
    let mut roots = Roots::new();
    for name in known
        .iter()
        .filter(|name| !options.forgotten.contains(name))
    {
        for folder in named(store, name)? {
            add(store, &mut roots, name, folder)?;
        }
    }
    for (name, decisions) in &options.planned {
        for decision in decisions {
            for folder in wanted(store, decision)? {
                add(store, &mut roots, name, folder)?;
            }
        }
    }
    for stage in store.stages()? {
        for folder in store.folders(&stage)? {
            for input in read_by_unfinished(&folder)? {
                let input = store.folder(&input.stage, &input.key);
                add(store, &mut roots, "an unfinished run", input)?;
            }
            if let Some(age) = options.older_than
                && is_young(&folder, age)?
            {
                add(store, &mut roots, "newer results", folder)?;
            }
        }
    }
    Ok(roots)
}

/// Folders of the results that a decision may be about: as long as the key is not known, because an
/// input is stale, all that have its settings.
fn wanted(store: &Store, decision: &Decision) -> Result<Vec<PathBuf>, FileError> {
    if let Some(key) = decision.key {
        return Ok(vec![store.folder(&decision.stage, &key)]);
    }
    let canonical = |of: &[SettingStamp]| -> Vec<String> {
        of.iter().map(|setting| setting.canonical.clone()).collect()
    };
    let settings = canonical(&decision.settings);
    let stamps = store.stamps(&decision.stage)?.into_iter();
    let mine = stamps.filter(|(_, stamp)| canonical(&stamp.settings) == settings);
    Ok(mine.map(|(folder, _)| folder).collect())
}

/// Folders that the manifest of a name reaches directly.
fn named(store: &Store, name: &str) -> Result<Vec<PathBuf>, PipelineError> {
    let manifest = latest::read(store, name)?.unwrap_or_default();
    let folders = manifest.results.into_iter().map(|entry| entry.folder);
    Ok(folders.map(|folder| store.root().join(folder)).collect())
}

/// Folders that the forgotten names reach.
fn released(store: &Store, options: &Options) -> Result<Roots, PipelineError> {
    let mut released = Roots::new();
    for name in &options.forgotten {
        for folder in named(store, name)? {
            add(store, &mut released, name, folder)?;
        }
    }
    Ok(released)
}

/// Adds a folder and its inputs.
fn add(store: &Store, roots: &mut Roots, name: &str, folder: PathBuf) -> Result<(), PipelineError> {
    let holders = roots.entry(folder.clone()).or_default();
    if holders.iter().any(|holder| holder == name) {
        return Ok(());
    }
    holders.push(name.to_string());
    match Stamp::read(&folder) {
        Ok(Some(stamp)) => {
            for input in &stamp.inputs {
                add(store, roots, name, store.folder(&input.stage, &input.key))?;
            }
            Ok(())
        }
        Err(StampError::File(error)) => Err(error.into()),
        // The judge keeps a damaged one.
        Ok(None) | Err(_) => Ok(()),
    }
}

/// Inputs of an unfinished run, from its work folder.
fn read_by_unfinished(folder: &Path) -> Result<Vec<InputStamp>, FileError> {
    let spent = Spent::read(&folder.join(WORK))?;
    Ok(spent.map_or(Vec::new(), |spent| spent.inputs))
}

/// Whether the newest of the stamp and the files of the work folder is younger than `age`; an
/// unknown age counts as young.
fn is_young(folder: &Path, age: Duration) -> Result<bool, FileError> {
    let mut paths = vec![folder.join(stamp::FILE)];
    let work = entries(&folder.join(WORK))?;
    paths.extend(work.iter().map(fs::DirEntry::path));
    let mut newest = SystemTime::UNIX_EPOCH;
    for path in paths {
        match path.symlink_metadata().and_then(|found| found.modified()) {
            Ok(modified) => newest = newest.max(modified),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(FileError::new(&path, "examine")(error)),
        }
    }
    // After a clock was set back, files may have times in the future.
    let is_new = newest.elapsed().is_ok_and(|elapsed| elapsed < age);
    Ok(is_new || newest > SystemTime::now())
}

struct Judge<'a> {
    store: &'a Store,
    options: &'a Options,
    roots: &'a Roots,
    released: &'a Roots,
}

impl Judge<'_> {
    fn fate(&self, stage: &str, folder: &Path) -> Fate {
        match self.store.is_locked(folder) {
            Ok(None) => {}
            Ok(Some(holder)) => return Fate::Keep(format!("in use by {holder}")),
            Err(error) => return Fate::Unknown(error),
        }
        match Stamp::read(folder) {
            Err(StampError::File(error)) => Fate::Unknown(error),
            Err(error) => Fate::Keep(error.to_string()),
            Ok(None) => self.unfinished(stage, folder),
            Ok(Some(stamp)) => {
                let name = folder.file_name().unwrap_or_default().to_string_lossy();
                if stamp.stage != stage || stamp.key.hex() != name {
                    return Fate::Keep("its stamp belongs to another folder".to_string());
                }
                self.finished(folder, stamp.label())
            }
        }
    }

    fn finished(&self, folder: &Path, label: String) -> Fate {
        if let Some(holders) = self.roots.get(folder) {
            return Fate::Keep(format!("for {}", holders.join(", ")));
        }
        if self.options.older_than.is_some() || self.released.contains_key(folder) {
            return Fate::Remove(label);
        }
        Fate::Keep("finished; to remove it, give --older-than".to_string())
    }

    fn unfinished(&self, stage: &str, folder: &Path) -> Fate {
        if let Some(holders) = self.roots.get(folder) {
            return Fate::Keep(format!("unfinished, for {}", holders.join(", ")));
        }
        let names = match entries(folder) {
            Ok(names) => names,
            Err(error) => return Fate::Unknown(error),
        };
        let name = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        if let Some(entry) = names.iter().find(|e| ![LOCK, WORK].contains(&&*name(e))) {
            return Fate::Keep(format!("it holds {}", name(entry)));
        }
        if names.is_empty() {
            return Fate::Keep("it is empty".to_string());
        }
        match has_checkpoint(&folder.join(WORK)) {
            Err(error) => Fate::Unknown(error),
            Ok(false) => Fate::Remove(format!("{stage}, unfinished, without a checkpoint")),
            Ok(true) => {
                let age = self.options.older_than.filter(|_| self.options.unfinished);
                match age.map(|age| is_young(folder, age)) {
                    Some(Err(error)) => Fate::Unknown(error),
                    Some(Ok(false)) => Fate::Remove(format!("{stage}, unfinished")),
                    _ => Fate::Keep("unfinished, with usable checkpoints".to_string()),
                }
            }
        }
    }
}

/// Removes temporary files from the folder of a result that stays. Errors are ignored.
fn tidy(store: &Store, folder: &Path) {
    let Ok(Some(stamp)) = Stamp::read(folder) else {
        return;
    };
    let Ok(Some(_lock)) = store.lock(folder, &mut |_| false) else {
        return;
    };
    let _ = clean_up(folder);
    if matches!(store.find(&stamp.stage, &stamp.key), Ok(Found::Finished(_))) {
        let _ = fs::remove_dir_all(folder.join(WORK));
    }
}

/// Removes a folder, unless a process uses it. The stamp is removed first, so that a kill leaves an
/// unfinished folder, not a wrong one.
fn remove(store: &Store, folder: &Path) -> Result<bool, FileError> {
    let Some(_lock) = store.lock(folder, &mut |_| false)? else {
        return Ok(false);
    };
    let stamp = folder.join(stamp::FILE);
    match fs::remove_file(&stamp) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(FileError::new(&stamp, "remove")(error));
        }
        _ => {}
    }
    fs::remove_dir_all(folder).map_err(FileError::new(folder, "remove"))?;
    Ok(true)
}

/// Bytes of all files in a folder; what cannot be read counts nothing.
pub fn size(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .map(|entry| match entry.metadata() {
            Ok(metadata) if metadata.is_dir() => size(&entry.path()),
            Ok(metadata) => metadata.len(),
            Err(_) => 0,
        })
        .sum()
}
