//! From files in the work folder to a stamped result.
//!
//! Files are made durable and renamed into place first, the stamp last: a kill in between leaves an
//! unfinished folder, never a wrong one.

use std::fs::{self, File};
use std::path::Path;

use super::context::Context;
use super::machine::{Machine, peak_memory};
use super::run::Run;
use super::stamp::{self, InputStamp, OutputStamp, SettingStamp, Stamp};
use super::store::{WORK, content, free_name, rename_aside};
use super::{Decision, Output, PipelineError, Setting, Stage};
use crate::record::Digest;
use crate::record::atomic::{FileError, sync_folder_of};
use crate::record::checkpoint::FORMAT_VERSION;
use crate::record::digest::Hasher;

/// What a stage has made, with all that the stamp tells.
pub struct Made<'a> {
    pub run: &'a Run<'a>,
    pub stage: &'a dyn Stage,
    pub settings: &'a [Setting],
    pub family: Option<Digest>,
    pub decision: &'a Decision,
    pub folder: &'a Path,
    pub outputs: Vec<Output>,
    pub context: &'a Context<'a>,
}

/// Hashes the files, moves them into place and writes the stamp. A result that differs from an
/// earlier one of the same key is kept beside it and reported.
pub fn publish(made: Made) -> Result<Stamp, PipelineError> {
    let out = made.context.output();
    let outputs = hash(&made, &out)?;
    let stamp = stamp_of(&made, outputs);
    if let Some(first) = contradicted(made.folder, &stamp) {
        let other = free_name(&made.folder.join("result"), "other");
        move_outputs(&out, &other, &stamp)?;
        return Err(PipelineError::Nondeterministic {
            job: stamp.label(),
            key: stamp.key,
            first,
            folder: made.folder.to_path_buf(),
            second: stamp.digest,
            other,
        });
    }
    move_outputs(&out, made.folder, &stamp)?;
    let work = made.folder.join(WORK);
    // The result is complete; what remains of the work is only in the way.
    let _ = fs::remove_dir_all(&work);
    Ok(stamp)
}

fn hash(made: &Made, out: &Path) -> Result<Vec<OutputStamp>, PipelineError> {
    let mut stamps = Vec::with_capacity(made.outputs.len());
    for output in &made.outputs {
        let path = out.join(&output.file);
        let Ok(metadata) = fs::metadata(&path) else {
            return Err(PipelineError::NoOutput {
                job: made.decision.label(),
                file: output.file.clone(),
            });
        };
        let digest = content(&path).map_err(|what| PipelineError::Stage {
            job: made.decision.label(),
            source: what.into(),
        })?;
        stamps.push(OutputStamp {
            file: output.file.clone(),
            bytes: metadata.len(),
            digest,
            counted: output.counted,
        });
    }
    Ok(stamps)
}

/// Digest of a result: of its only counted file, or of all their names and digests.
fn digest(outputs: &[OutputStamp]) -> Digest {
    let counted: Vec<_> = outputs.iter().filter(|output| output.counted).collect();
    if let [only] = counted[..] {
        return only.digest;
    }
    let mut hasher = Hasher::new("coronet result 1");
    for output in counted {
        hasher.text(&output.file).digest(&output.digest);
    }
    hasher.finish()
}

fn stamp_of(made: &Made, outputs: Vec<OutputStamp>) -> Stamp {
    let spent = made.context.spent_now();
    let input = |input: &super::Input| InputStamp {
        stage: input.stamp.stage.clone(),
        body: input.stamp.body.clone(),
        key: input.stamp.key,
        digest: input.stamp.digest,
    };
    Stamp {
        stamp: Stamp::layout(),
        stage: made.decision.stage.clone(),
        body: made.decision.body.clone(),
        version: made.stage.version(),
        format: FORMAT_VERSION,
        key: made.decision.key.expect("known when it ran"),
        family: made.family,
        settings: made.settings.iter().map(SettingStamp::from).collect(),
        inputs: made.context.inputs.iter().map(input).collect(),
        digest: digest(&outputs),
        outputs,
        notes: made.context.notes.clone(),
        program: made.run.program.clone(),
        machine: Machine::here(),
        threads: made.run.threads,
        started: spent.started,
        resumptions: spent.attempts - 1,
        wall_seconds: milliseconds(spent.wall_seconds),
        cpu_seconds: milliseconds(spent.cpu_seconds),
        memory_bytes: peak_memory(),
        work: made.stage.work().map(|work| work.amount),
    }
}

/// Seconds to a thousandth: more digits only hide the first ones.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

/// Digest of an earlier result of the same key that differs, from the stamp in place or from one
/// that was set aside.
fn contradicted(folder: &Path, new: &Stamp) -> Option<Digest> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let stamps = entries.filter(|entry| {
        let name = entry.file_name();
        name.to_string_lossy().starts_with(stamp::FILE)
    });
    stamps
        .filter_map(|entry| stamp::read_file(&entry.path()).ok())
        .filter(|old| old.key == new.key && old.digest != new.digest)
        .map(|old| old.digest)
        .next()
}

fn move_outputs(from: &Path, to: &Path, stamp: &Stamp) -> Result<(), FileError> {
    for output in &stamp.outputs {
        let (source, target) = (from.join(&output.file), to.join(&output.file));
        let parent = target.parent().unwrap_or(to);
        fs::create_dir_all(parent).map_err(FileError::new(parent, "create the folder"))?;
        keep_stranger(&target, |path| content(path) == Ok(output.digest))?;
        let file = File::open(&source).map_err(FileError::new(&source, "open"))?;
        file.sync_all()
            .map_err(FileError::new(&source, "flush to disk"))?;
        fs::rename(&source, &target).map_err(FileError::new(&target, "rename into place"))?;
        sync_folder_of(&target)?;
    }
    keep_stranger(&to.join(stamp::FILE), |path| {
        stamp::read_file(path).is_ok_and(|old| old.key == stamp.key)
    })?;
    stamp.write(to)
}

/// Sets aside a file in the way, unless it is what will take its place.
fn keep_stranger(path: &Path, same: impl Fn(&Path) -> bool) -> Result<(), FileError> {
    if path.exists() && !same(path) {
        rename_aside(path)?;
    }
    Ok(())
}
