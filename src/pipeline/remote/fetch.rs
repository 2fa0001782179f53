//! From a remote store into the folder of a key: the same way as a result that was made here, after
//! every byte has been checked.

use std::collections::HashSet;
use std::fs;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use super::{Objects, RemoteError, Wanted, file_name, sha256, stamp_name};
use crate::file::{self, FileError};
use crate::pipeline::content::{CHECKPOINT, ContentError, bytes};
use crate::pipeline::key::contradiction;
use crate::pipeline::lock::LOCK;
use crate::pipeline::name::{is_inside, is_plain_name};
use crate::pipeline::stamp::{self, InputStamp, OutputStamp, Stamp, StampError};
use crate::pipeline::store::{OUT, WORK, refuse_links_below};
use crate::pipeline::{machine, publish, verify};
use crate::record::atomic::{create_folder, write_with};
use crate::record::checkpoint;

/// Part of the free disk that a result may need.
const OF_DISK: f64 = 0.9;
/// Bytes that no result has.
const HUGE: f64 = 1e15;
/// Part of the memory that a decoded checkpoint may need.
const OF_MEMORY: f64 = 0.5;

/// Fetches a result and publishes it.
pub fn fetch(
    objects: &dyn Objects,
    wanted: &Wanted,
    inputs: Option<&[InputStamp]>,
) -> Result<Option<Stamp>, RemoteError> {
    let work = wanted.folder.join(WORK);
    let out = work.join(OUT);
    refuse_links_below(wanted.folder, &out)?;
    let had_work = file::is_there(&work)?;
    empty(&out)?;
    create_folder(&out)?;
    let done = arrive(objects, wanted, inputs, &out);
    // A run that was interrupted here goes on from its own files, if nothing arrived.
    let rest = match (&done, had_work) {
        (Ok(None) | Err(_), true) => &out,
        _ => &work,
    };
    match empty(rest) {
        // The next run removes it.
        Err(error) if !matches!(done, Ok(Some(_))) => Err(error.into()),
        _ => done,
    }
}

fn empty(folder: &Path) -> Result<(), FileError> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(FileError::new(folder, "empty")(error))
        }
        _ => Ok(()),
    }
}

fn arrive(
    objects: &dyn Objects,
    wanted: &Wanted,
    inputs: Option<&[InputStamp]>,
    out: &Path,
) -> Result<Option<Stamp>, RemoteError> {
    let name = stamp_name(wanted.stage, &wanted.key);
    let path = out.join(stamp::FILE);
    if !download(objects, &name, stamp::LONGEST, &path)? {
        return Ok(None);
    }
    let bad = |what: String| RemoteError::bad(&name, what);
    let mut stamp = match stamp::read_file(&path) {
        Err(StampError::File(error)) => return Err(error.into()),
        other => other.map_err(|error| bad(format!("is damaged: {error}")))?,
    };
    check_stamp(&stamp, wanted).map_err(bad)?;
    check_room(&stamp, wanted.folder)?;
    for output in &stamp.outputs {
        fetch_file(objects, output, out)?;
    }
    if let Some(inputs) = inputs {
        // Equal results can come from other keys: those of this store count.
        stamp.inputs = inputs.to_vec();
        if contradiction(&stamp).is_some() {
            return Err(bad("names other inputs".into()));
        }
    }
    match publish::contradicted(wanted.folder, &stamp)? {
        Some(first) => Err(bad(format!("gives {}, not {first} as here", stamp.digest))),
        None => {
            publish::move_outputs(out, wanted.folder, &stamp)?;
            Ok(Some(stamp))
        }
    }
}

/// Downloads an object to a new file; false if there is none.
fn download(
    objects: &dyn Objects,
    name: &str,
    limit: u64,
    path: &Path,
) -> Result<bool, RemoteError> {
    let mut got = Ok(false);
    let written = write_with(path, |to: &mut BufWriter<_>| {
        got = objects.get(name, limit, to);
        match &got {
            Err(_) => Err(std::io::Error::other("it did not arrive")),
            Ok(_) => Ok(()),
        }
    });
    let got = got?;
    written?;
    Ok(got)
}

/// What in a stamp from elsewhere cannot be used.
fn check_stamp(stamp: &Stamp, wanted: &Wanted) -> Result<(), String> {
    if stamp.stage != wanted.stage || stamp.key != wanted.key {
        return Err(format!("belongs to {} {}", stamp.label(), stamp.key));
    }
    if let Some(what) = contradiction(stamp) {
        return Err(format!("contradicts itself: {what}"));
    }
    let mut names = HashSet::new();
    for output in &stamp.outputs {
        let name = &output.file;
        if !is_harmless(name) || !names.insert(Path::new(name).components().collect::<PathBuf>()) {
            return Err(format!("names a file {name:?}, which cannot be one"));
        }
    }
    for name in &names {
        if name
            .ancestors()
            .skip(1)
            .any(|folder| names.contains(folder))
        {
            return Err(format!("names {name:?} inside another file"));
        }
    }
    let size = size(stamp);
    match size > HUGE {
        true => Err(format!("claims {size:.2e} bytes")),
        false => Ok(()),
    }
}

/// Of all files of a result, bytes.
fn size(stamp: &Stamp) -> f64 {
    let sizes = stamp.outputs.iter().map(|output| output.bytes as f64);
    sizes.sum()
}

/// Whether the disk has room for a result.
fn check_room(stamp: &Stamp, folder: &Path) -> Result<(), RemoteError> {
    let (size, free) = (size(stamp), machine::free_disk(folder));
    match size > OF_DISK * free {
        true => Err(RemoteError::TooLarge(format!(
            "{} has {size:.2e} bytes; the disk here has {free:.2e} free",
            stamp.label()
        ))),
        false => Ok(()),
    }
}

/// Longest name from elsewhere, bytes: shorter than the path of a file may be.
const LONGEST: usize = 1000;

/// Whether a name from elsewhere is one of a file of a result, and not one that the store uses.
fn is_harmless(name: &str) -> bool {
    let first = name.split('/').next().unwrap_or_default();
    let is_own = [LOCK, WORK].contains(&first) || first.starts_with(stamp::FILE);
    name.len() <= LONGEST && is_inside(name) && name.split('/').all(is_plain_name) && !is_own
}

/// Fetches a file and compares it with the stamp: size, all bytes, content.
fn fetch_file(objects: &dyn Objects, output: &OutputStamp, out: &Path) -> Result<(), RemoteError> {
    let Some(sha256) = sha256(output) else {
        let what = format!("has no SHA-256 of {:?}", output.file);
        return Err(RemoteError::bad("the stamp", what));
    };
    let name = file_name(&sha256);
    let path = out.join(&output.file);
    create_folder(path.parent().unwrap_or(out))?;
    if !download(objects, &name, output.bytes, &path)? {
        return Err(RemoteError::bad(&name, "is missing"));
    }
    let bad = |what: String| RemoteError::bad(&name, format!("({}): {what}", output.file));
    let failed = |error: ContentError| match error {
        ContentError::File(error) => RemoteError::File(error),
        ContentError::Damaged(what) => bad(what),
    };
    let found = bytes(&path).map_err(failed)?;
    if found != sha256 {
        return Err(bad(format!("its bytes have the SHA-256 {found}")));
    }
    if path.extension().is_some_and(|found| found == CHECKPOINT) {
        let peek = checkpoint::peek(&path).map_err(|error| failed(error.into()))?;
        let sizes = peek.arrays.iter();
        let decoded: f64 = sizes
            .map(|array| array.count as f64 * array.element.size() as f64)
            .sum();
        let memory = machine::memory();
        if decoded > OF_MEMORY * memory {
            return Err(RemoteError::TooLarge(format!(
                "{name} ({}): needs {decoded:.2e} bytes decoded; memory has {memory:.2e}",
                output.file
            )));
        }
    }
    verify::check(out, &path, output).map_err(failed)
}
