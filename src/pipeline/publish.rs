//! Publishes the files of a work folder as a stamped result.
//!
//! Files are made durable and renamed into place first, the stamp last: a kill in between leaves an
//! unfinished folder, never a wrong one.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use super::content::{ContentError, bytes, content, free_name, rename_aside};
use super::context::{Context, Input};
use super::key::contradiction;
use super::machine::{Machine, peak_memory};
use super::stamp::{self, OutputStamp, SettingStamp, Stamp, StampError};
use super::store::{WORK, entries, refuse_links_below};
use super::{Decision, Output, PipelineError, Setting, Stage};
use crate::record::Digest;
use crate::record::atomic::{FileError, create_folder, sync_folder_of};
use crate::record::checkpoint::FORMAT_VERSION;

/// The output of a stage, with the data of the stamp.
pub struct Made<'a> {
    /// Name and version of the program, and how many threads it had.
    pub program: &'a str,
    pub threads: usize,
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
    if let Some(first) = contradicted(made.folder, &stamp)? {
        let other = free_name(&made.folder.join("result"), "other")?;
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
    // The result is complete; the rest of the work is not needed.
    let _ = fs::remove_dir_all(&work);
    Ok(stamp)
}

fn hash(made: &Made, out: &Path) -> Result<Vec<OutputStamp>, PipelineError> {
    let outputs = made.outputs.iter();
    outputs.map(|output| hash_one(made, out, output)).collect()
}

fn hash_one(made: &Made, out: &Path, output: &Output) -> Result<OutputStamp, PipelineError> {
    let path = out.join(&output.file);
    let metadata = match fs::metadata(&path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(PipelineError::NoOutput {
                job: made.decision.label(),
                file: output.file.clone(),
            });
        }
        other => other.map_err(FileError::new(&path, "examine"))?,
    };
    let failed = |error: ContentError| match error {
        ContentError::File(error) => PipelineError::File(error),
        ContentError::Damaged(what) => PipelineError::Stage {
            job: made.decision.label(),
            source: what.into(),
        },
    };
    let digest = content(&path).map_err(failed)?;
    let sha256 = Some(bytes(&path).map_err(failed)?).filter(|found| *found != digest);
    Ok(OutputStamp {
        file: output.file.clone(),
        bytes: metadata.len(),
        digest,
        sha256,
        counted: output.counted,
    })
}

fn stamp_of(made: &Made, outputs: Vec<OutputStamp>) -> Stamp {
    let spent = made.context.spent_now();
    Stamp {
        stamp: Stamp::layout(),
        stage: made.decision.stage.clone(),
        body: made.decision.body.clone(),
        version: made.stage.version(),
        format: FORMAT_VERSION,
        key: made.decision.key.expect("known when it ran"),
        family: made.family,
        settings: made.settings.iter().map(SettingStamp::from).collect(),
        inputs: made.context.inputs.iter().map(Input::stamp_of).collect(),
        digest: stamp::digest_of(&outputs),
        outputs,
        notes: made.context.notes.clone(),
        program: made.program.to_string(),
        machine: Machine::here(),
        threads: made.threads,
        started: spent.started,
        resumptions: spent.attempts - 1,
        wall_seconds: milliseconds(spent.wall_seconds),
        cpu_seconds: milliseconds(spent.cpu_seconds),
        memory_bytes: peak_memory(),
        forecast_seconds: made.stage.work().map(|work| work.amount),
    }
}

/// Seconds, rounded to a thousandth.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}

/// Digest of an earlier result of the same key that differs, from the present stamp or from one
/// that was set aside. Inconsistent stamps do not count.
pub fn contradicted(folder: &Path, new: &Stamp) -> Result<Option<Digest>, FileError> {
    for entry in entries(folder)? {
        let name = entry.file_name();
        if !name.to_string_lossy().starts_with(stamp::FILE) {
            continue;
        }
        match stamp::read_file(&entry.path()) {
            Ok(old) if old.key == new.key && old.digest != new.digest => {
                if contradiction(&old).is_none() {
                    return Ok(Some(old.digest));
                }
            }
            Ok(_) | Err(StampError::Invalid { .. }) => {}
            Err(StampError::File(error)) => return Err(error),
        }
    }
    Ok(None)
}

/// Makes the files of a result durable, moves them into place and writes the stamp.
pub fn move_outputs(from: &Path, to: &Path, stamp: &Stamp) -> Result<(), FileError> {
    for output in &stamp.outputs {
        let (source, target) = (from.join(&output.file), to.join(&output.file));
        refuse_links_below(to, &target)?;
        create_folder(target.parent().unwrap_or(to))?;
        match content(&target) {
            Ok(digest) if digest == output.digest => {}
            Ok(_) | Err(ContentError::Damaged(_)) => drop(rename_aside(&target)?),
            Err(ContentError::File(error)) => return Err(error),
        }
        let file = File::open(&source).map_err(FileError::new(&source, "open"))?;
        file.sync_all()
            .map_err(FileError::new(&source, "flush to disk"))?;
        fs::rename(&source, &target).map_err(FileError::new(&target, "rename into place"))?;
        sync_folder_of(&target)?;
    }
    match stamp::read_file(&to.join(stamp::FILE)) {
        Ok(old) if old.key == stamp.key && contradiction(&old).is_none() => {}
        Err(StampError::File(error)) if !error.is_not_found() => return Err(error),
        _ => drop(rename_aside(&to.join(stamp::FILE))?),
    }
    stamp.write(to)
}
