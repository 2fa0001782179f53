//! The named runs of a store: what each has reached, with which settings, and what it came to.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use anyhow::{Context as _, Error, Result};
use coronet::file::{changed, exists};
use coronet::measure::answer::Figures;
use coronet::pipeline::latest;
use coronet::pipeline::name::{MANIFEST, is_name};
use coronet::pipeline::progress::Unfinished;
use coronet::pipeline::{Stamp, Store};

use crate::answer;
use crate::command::place::{Thing, thing};
use crate::fault::Usage;
use crate::print::note;

/// Start of the names of settings that are versions of parts of the program.
const VERSION: &str = "version.";

/// Start of the names of settings of bodies, which are at rest where they relax and where the
/// tension is calibrated.
const BODY: &str = "body.";

/// How much earlier than its name's last change a job of the same try may have ended.
const SAME_TRY: Duration = Duration::from_secs(10);

/// A run: its results, each with its stamp.
pub struct Run {
    pub name: String,
    pub results: Vec<(PathBuf, Stamp)>,
    /// Folders of results that are gone, or were set aside.
    pub gone: Vec<PathBuf>,
    /// When its name was last given to results.
    pub named: Option<SystemTime>,
}

/// How far a run is.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    Finished,
    /// Nobody works at it; the job that comes next.
    Unfinished(String),
    /// The job under way, and the part of it that is done.
    Running(String, Option<f64>),
}

impl Run {
    /// The run of that name.
    ///
    /// # Errors
    /// If its manifest or a stamp cannot be read.
    pub fn named(store: &Store, name: &str) -> Result<Run> {
        let manifest = latest::read(store, name)?.unwrap_or_default();
        let (mut results, mut gone) = (Vec::new(), Vec::new());
        for entry in manifest.results {
            let folder = store.root().join(entry.folder);
            match Stamp::read(&folder)? {
                Some(stamp) => results.push((folder, stamp)),
                None => gone.push(folder),
            }
        }
        let path = latest::folder(store, name).join(MANIFEST);
        Ok(Run {
            name: name.to_string(),
            results,
            gone,
            named: changed(&path)?,
        })
    }

    /// The run that a user means: a name under `latest/`, or a path of results.
    ///
    /// # Errors
    /// If there is neither; if something cannot be read.
    pub fn meant(store: &Store, text: &str) -> Result<Run> {
        if folder_named(store, text)?.is_some() {
            return Run::named(store, text);
        }
        let path = Path::new(text);
        if !exists(path)? {
            return Err(unknown(store, text));
        }
        let folders = match thing(path)? {
            Thing::Result(folder) => vec![folder],
            Thing::Latest(folders) => folders,
            Thing::Log(_) | Thing::Checkpoint(_) => {
                let text = format!("{text:?} is a file; give the folder of a result");
                return Err(Usage(text).into());
            }
        };
        let mut results = BTreeMap::new();
        for folder in folders {
            gather(&folder, &mut results)?;
        }
        Ok(Run {
            name: text.to_string(),
            results: results.into_iter().collect(),
            gone: Vec::new(),
            named: None,
        })
    }

    /// Warns of results that are gone.
    pub fn tell_gone(&self) {
        for folder in &self.gone {
            let folder = folder.display();
            note!("warning: {}: the result in {folder} is gone", self.name);
        }
    }

    /// The result of a stage that has one for the whole scene.
    pub fn result(&self, stage: &str) -> Option<&(PathBuf, Stamp)> {
        self.results.iter().find(|(_, stamp)| stamp.stage == stage)
    }

    /// The figures, if there is an evaluation.
    ///
    /// # Errors
    /// If its files cannot be read.
    pub fn figures(&self) -> Result<Option<Figures>> {
        let post = self.result("post");
        post.map(|(folder, stamp)| answer::read(folder, stamp))
            .transpose()
    }

    /// Names and values of all settings. Where stages differ in one, the impact counts, then the
    /// evaluation.
    pub fn settings(&self) -> Vec<(String, String)> {
        let order = ["impact", "post", "pack", "relax", "calibrate"];
        let place = |stage: &str| order.iter().position(|known| *known == stage);
        let mut stamps: Vec<&Stamp> = self.results.iter().map(|(_, stamp)| stamp).collect();
        stamps.sort_by_key(|stamp| place(&stamp.stage).unwrap_or(order.len()));
        let (mut all, mut seen) = (Vec::new(), BTreeSet::new());
        for stamp in stamps {
            // Bodies lie elsewhere there.
            let is_at_rest = ["pack", "relax", "calibrate"].contains(&&*stamp.stage);
            for setting in &stamp.settings {
                let name = &setting.name;
                let is_hidden = name.starts_with(VERSION) || is_at_rest && name.starts_with(BODY);
                if !is_hidden && seen.insert(name) {
                    all.push((name.clone(), setting.value.clone()));
                }
            }
        }
        all
    }

    /// How far it is; `jobs`: all that have begun and not ended in this store.
    pub fn state(&self, jobs: &[Unfinished]) -> State {
        let is_mine = |job: &&Unfinished| {
            let told = job.told.as_ref();
            told.is_some_and(|(told, _)| told.pipeline == self.name)
        };
        let mine = jobs.iter().filter(is_mine);
        if let Some(job) = mine.clone().find(|job| job.holder.is_some()) {
            let part = job.told.as_ref().map(|(told, _)| told.fraction);
            return State::Running(job.label(), part);
        }
        // A job that stands still since long before the name was last given is of an earlier try.
        let is_of_this = |job: &&Unfinished| {
            let ended = job.touched().map(|touched| touched + SAME_TRY);
            ended > self.named
        };
        let last = mine.filter(is_of_this).max_by_key(|job| job.touched());
        let gone = self
            .gone
            .first()
            .and_then(|folder| folder.parent()?.file_name());
        let unfinished = |stage: &str| match (last, gone) {
            (Some(job), _) => State::Unfinished(job.label()),
            (None, Some(gone)) => State::Unfinished(gone.to_string_lossy().into_owned()),
            (None, None) => State::Unfinished(stage.into()),
        };
        // As in keys, inputs count by their content.
        let is_here = |digest| self.results.iter().any(|(_, stamp)| stamp.digest == digest);
        let whole = |stamp: &Stamp| stamp.inputs.iter().all(|input| is_here(input.digest));
        for stage in ["calibrate", "impact", "post"] {
            match self.result(stage) {
                Some((_, stamp)) if !whole(stamp) => return unfinished(stage),
                None if stage != "calibrate" => return unfinished(stage),
                _ => {}
            }
        }
        match last.filter(|job| job.touched() > self.named) {
            Some(job) => State::Unfinished(job.label()),
            None => State::Finished,
        }
    }
}

/// The folder of the run with that name; `None` if there is none.
///
/// # Errors
/// If it cannot be examined.
pub fn folder_named(store: &Store, text: &str) -> Result<Option<PathBuf>> {
    if !is_name(text) {
        return Ok(None);
    }
    let folder = latest::folder(store, text);
    Ok(exists(&folder.join(MANIFEST))?.then_some(folder))
}

/// What a user means: the folder of a name under `latest/`, or a path that exists.
///
/// # Errors
/// If there is neither.
pub fn meant(store: &Store, path: &Path) -> Result<PathBuf> {
    let text = path.to_string_lossy();
    match folder_named(store, &text)? {
        Some(folder) => Ok(folder),
        None if exists(path)? => Ok(path.to_path_buf()),
        None => Err(unknown(store, &text)),
    }
}

/// That a text is neither a name nor a path.
fn unknown(store: &Store, text: &str) -> Error {
    let known = latest::pipelines(store).unwrap_or_default();
    let known = match known.is_empty() {
        true => "no names".to_string(),
        false => known.join(", "),
    };
    let latest = latest::folder(store, "");
    let latest = latest.display();
    let text =
        format!("{text:?} is neither a name in {latest} nor a path of results; there are {known}");
    Usage(text).into()
}

/// Adds a result and all that it was made from.
fn gather(folder: &Path, results: &mut BTreeMap<PathBuf, Stamp>) -> Result<()> {
    let store = answer::store_of(folder)?;
    let mut folders = vec![folder.canonicalize().context("it is gone")?];
    while let Some(folder) = folders.pop() {
        if results.contains_key(&folder) {
            continue;
        }
        // What it was made from may have been removed since.
        let Some(stamp) = Stamp::read(&folder)? else {
            continue;
        };
        let inputs = stamp.inputs.iter();
        folders.extend(inputs.map(|input| store.folder(&input.stage, &input.key)));
        results.insert(folder, stamp);
    }
    Ok(())
}
