//! Decides which jobs are fresh or stale, and why. `plan` shows these decisions; `run` acts on
//! them.

use std::path::{Path, PathBuf};

use super::content::CHECKPOINT;
use super::context::Relative;
use super::stamp::{InputStamp, SettingStamp, Stamp};
use super::store::{Found, Store, WORK, entries};
use super::{Pipeline, Stage, Work, key, label};
use crate::file::FileError;
use crate::record::Digest;

/// The decision about one job.
#[derive(Clone, Debug)]
pub struct Decision {
    /// Place in the pipeline.
    pub job: usize,
    /// Name of the stage.
    pub stage: String,
    /// What the stage is applied to, or empty.
    pub body: String,
    /// The settings that the stage reads.
    pub settings: Vec<SettingStamp>,
    /// `None` while an input is stale: its digest is not known yet.
    pub key: Option<Digest>,
    /// The finished result, if there is one.
    pub fresh: Option<Box<Stamp>>,
    /// Why there is none.
    pub reasons: Vec<String>,
    /// What the work can start from, if not from the beginning.
    pub start: Option<String>,
    /// Expected wall time, s, from the stage's own estimate or from earlier runs.
    pub seconds: Option<f64>,
    /// The stage's own estimate of the work; `None` also for a result that is there.
    pub work: Option<Work>,
}

impl Decision {
    /// Name of the job in messages: `relax drop`.
    pub fn label(&self) -> String {
        super::stamp::label(&self.stage, &self.body)
    }

    /// `fresh`, `resumes` or `stale`.
    pub fn word(&self) -> &'static str {
        match (&self.fresh, &self.start) {
            (Some(_), _) => "fresh",
            (None, Some(_)) => "resumes",
            (None, None) => "stale",
        }
    }
}

/// Settings that earlier results share with one whose time they correct: rings and quarters have
/// other costs than whole boxes.
const KIND: [&str; 3] = ["method.name", "dimension", "box.x"];

/// A finished input: its key and the digest of what it contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Key of the result.
    pub key: Digest,
    /// Digest of its content.
    pub digest: Digest,
}

/// Decisions for all jobs, as far as they are known before anything runs.
///
/// # Errors
/// If something in the store cannot be read.
pub fn plan(store: &Store, pipeline: &Pipeline) -> Result<Vec<Decision>, FileError> {
    let mut done: Vec<Option<Done>> = Vec::new();
    let mut decisions = Vec::new();
    for job in 0..pipeline.jobs.len() {
        let decision = decide(store, pipeline, job, &done)?;
        done.push(decision.fresh.as_ref().map(|stamp| Done {
            key: stamp.key,
            digest: stamp.digest,
        }));
        decisions.push(decision);
    }
    Ok(decisions)
}

/// Decides about one job. `done[i]` is the result of job `i`, if it is finished.
///
/// # Errors
/// If something in the store cannot be read.
pub fn decide(
    store: &Store,
    pipeline: &Pipeline,
    job: usize,
    done: &[Option<Done>],
) -> Result<Decision, FileError> {
    let stage = pipeline.jobs[job].as_ref();
    let settings = stage.settings();
    let inputs: Vec<_> = stage
        .inputs()
        .into_iter()
        .map(|input| done[input])
        .collect();
    let digests: Option<Vec<_>> = inputs
        .iter()
        .map(|done| done.map(|done| done.digest))
        .collect();
    let mut decision = Decision {
        job,
        stage: stage.name().to_string(),
        body: stage.part().to_string(),
        settings: settings.iter().map(SettingStamp::from).collect(),
        key: digests
            .as_ref()
            .map(|digests| key::key(stage, &settings, digests)),
        fresh: None,
        reasons: Vec::new(),
        start: None,
        seconds: None,
        work: None,
    };
    let family = digests.and_then(|digests| key::family(stage, &settings, &digests));
    let mut from = None;
    if let Some(key) = decision.key {
        match store.find(stage.name(), &key)? {
            Found::Finished(stamp) => {
                decision.fresh = Some(stamp);
                return Ok(decision);
            }
            Found::Unusable(what) => decision.reasons.push(what),
            Found::Nothing => {}
        }
        if has_checkpoint(&store.folder(stage.name(), &key).join(WORK))? {
            decision.start = Some("an unfinished run".to_string());
        } else if let Some(relative) = start(store, stage, family)? {
            let free = stage.extends().unwrap_or_default();
            let value = relative.setting(free).unwrap_or("?");
            decision.start = Some(format!("the result for {free} = {value}"));
            from = Some(relative.stamp);
        }
    }
    decision.work = stage.work();
    let stamps: Vec<Stamp> = store
        .stamps(stage.name())?
        .into_iter()
        .map(|(_, s)| s)
        .collect();
    decision.seconds = estimate(decision.work, stage, &stamps);
    if decision.reasons.is_empty() {
        // What it continues, if that is a result.
        let known = from.map_or(stamps, |from| vec![from]);
        decision.reasons = reasons(pipeline, stage, &decision.settings, &inputs, &known);
    }
    Ok(decision)
}

/// The finished result that a stale one could start from.
fn start(
    store: &Store,
    stage: &dyn Stage,
    family: Option<Digest>,
) -> Result<Option<Relative>, FileError> {
    let mut relatives = relatives(store, stage.name(), family)?;
    let index = stage.begins_from(&relatives);
    Ok(index.map(|index| relatives.swap_remove(index)))
}

/// Results that differ in more settings, or in more than a third of all and in some, are of another
/// scene: the differences are no reasons.
const ALIKE: usize = 12;
const SOME: usize = 4;

/// Whether a work folder contains a checkpoint from which a run can continue.
pub(super) fn has_checkpoint(work: &Path) -> Result<bool, FileError> {
    let is_checkpoint = |path: PathBuf| path.extension().is_some_and(|e| e == CHECKPOINT);
    let found = entries(work)?;
    Ok(found.into_iter().any(|entry| is_checkpoint(entry.path())))
}

/// Finished results that differ only in the setting that may grow.
///
/// # Errors
/// If something in the store cannot be read.
pub fn relatives(
    store: &Store,
    stage: &str,
    family: Option<Digest>,
) -> Result<Vec<Relative>, FileError> {
    let Some(family) = family else {
        return Ok(Vec::new());
    };
    let stamps = store.stamps(stage)?.into_iter();
    let of_family = stamps.filter(|(_, stamp)| stamp.family == Some(family));
    Ok(of_family
        .map(|(folder, stamp)| Relative { folder, stamp })
        .collect())
}

fn reasons(
    pipeline: &Pipeline,
    stage: &dyn Stage,
    wanted: &[SettingStamp],
    inputs: &[Option<Done>],
    stamps: &[Stamp],
) -> Vec<String> {
    let names: Vec<String> = stage
        .inputs()
        .into_iter()
        .map(|input| label(pipeline.jobs[input].as_ref()))
        .collect();
    let mut waiting = Vec::new();
    for (name, input) in names.iter().zip(inputs) {
        if input.is_none() {
            waiting.push(format!("{name} is stale"));
        }
    }
    let same_body = |stamp: &&Stamp| stamp.body == stage.part();
    let mut candidates: Vec<_> = stamps.iter().filter(same_body).collect();
    if candidates.is_empty() {
        candidates = stamps.iter().collect();
    }
    let differences = candidates.into_iter().map(|earlier| {
        let list = differences(stage, wanted, &names, inputs, earlier);
        (list, &earlier.started)
    });
    // Of equally similar results the newest.
    let nearest = differences.min_by(|(a, at), (b, bt)| (a.len(), bt).cmp(&(b.len(), at)));
    match nearest {
        None if waiting.is_empty() => vec!["never ran".to_string()],
        None => waiting,
        Some((list, _)) => {
            let alike = ALIKE.min(SOME.max(wanted.len() / 3));
            if list.len() <= alike {
                waiting.extend(list);
            } else if waiting.is_empty() {
                waiting.push(format!(
                    "never ran; the nearest result differs in {} settings",
                    list.len()
                ));
            }
            if waiting.is_empty() {
                waiting.push("its result is gone".to_string());
            }
            waiting
        }
    }
}

/// Each difference between an earlier result and the required one, as `name old -> new`.
fn differences(
    stage: &dyn Stage,
    wanted: &[SettingStamp],
    names: &[String],
    inputs: &[Option<Done>],
    earlier: &Stamp,
) -> Vec<String> {
    let mut list = Vec::new();
    if earlier.version != stage.version() {
        let (old, new) = (earlier.version, stage.version());
        list.push(format!("{}.VERSION {old} -> {new}", stage.name()));
    }
    let format = crate::record::checkpoint::FORMAT_VERSION;
    if earlier.format != format {
        list.push(format!("checkpoint format {} -> {format}", earlier.format));
    }
    // A body may have another name.
    let known = |list: &[SettingStamp], setting: &SettingStamp| {
        list.iter()
            .any(|other| other.canonical == setting.canonical)
    };
    for setting in wanted
        .iter()
        .filter(|setting| !known(&earlier.settings, setting))
    {
        let old = earlier.settings.iter().find(|old| old.name == setting.name);
        list.push(difference(stage, &setting.name, old, Some(setting)));
    }
    for old in earlier.settings.iter().filter(|old| !known(wanted, old)) {
        if !wanted.iter().any(|setting| setting.name == old.name) {
            list.push(difference(stage, &old.name, Some(old), None));
        }
    }
    for (index, name) in names.iter().enumerate() {
        let Some(new) = inputs[index] else {
            continue;
        };
        match earlier.inputs.get(index) {
            Some(old) if old.digest == new.digest => {}
            old => list.push(input_difference(name, old, &new)),
        }
    }
    for old in earlier.inputs.iter().skip(names.len()) {
        let name = super::stamp::label(&old.stage, &old.body);
        list.push(format!("result of {name} is no longer read"));
    }
    list
}

fn difference(
    stage: &dyn Stage,
    name: &str,
    old: Option<&SettingStamp>,
    new: Option<&SettingStamp>,
) -> String {
    let shown = |setting: Option<&SettingStamp>| {
        setting.map_or("(absent)".to_string(), |setting| setting.value.clone())
    };
    let (before, mut after) = (shown(old), shown(new));
    if before == after {
        // As the diameter of the only drop and of the first of two.
        after += ", at another place of the scene";
    }
    match stage.remark(name) {
        Some(remark) => format!("{name} {before} -> {after} ({remark})"),
        None => format!("{name} {before} -> {after}"),
    }
}

fn input_difference(name: &str, old: Option<&InputStamp>, new: &Done) -> String {
    let before = old.map_or("(absent)".to_string(), |old| old.digest.short());
    format!("result of {name} {before} -> {}", new.digest.short())
}

/// Wall time, s: the stage's estimate, corrected by the time of earlier results of the same kind;
/// without an estimate the time of its newest result.
fn estimate(work: Option<Work>, stage: &dyn Stage, stamps: &[Stamp]) -> Option<f64> {
    let stamps = stamps.iter();
    let Some(work) = work else {
        let newest = stamps.max_by_key(|stamp| &stamp.started);
        return newest.map(|stamp| stamp.wall_seconds);
    };
    // A job shorter than a second is not significant, nor is one in another unit.
    let ratio = |stamp: &Stamp| Some(stamp.cpu_seconds / stamp.forecast_seconds?);
    let known = |stamp: &&Stamp| ratio(stamp).is_some_and(|r| (0.1..10.0).contains(&r));
    let settings = stage.settings();
    let same = |stamp: &&Stamp| {
        KIND.iter().all(|name| {
            let own = stamp.settings.iter().find(|s| s.name == *name);
            let new = settings.iter().find(|s| s.name == *name);
            own.map(|s| &s.value) == new.map(|s| &s.shown)
        })
    };
    let long = |stamp: &&Stamp| stamp.cpu_seconds > 1.0;
    let longest = stamps
        .filter(|stamp| long(stamp) && known(stamp) && same(stamp))
        .max_by(|a, b| a.cpu_seconds.total_cmp(&b.cpu_seconds));
    let longer = longest.and_then(ratio).unwrap_or(1.0);
    Some(longer * work.amount / work.threads as f64)
}
