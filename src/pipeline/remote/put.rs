//! From the folder of a key to a remote store: files first, the stamp last.

use std::path::Path;

use super::{Objects, Put, RemoteError, file_name, sha256, stamp_name};
use crate::pipeline::content::ContentError;
use crate::pipeline::key::contradiction;
use crate::pipeline::stamp::{self, Stamp, StampError};
use crate::pipeline::verify;

/// Puts a finished result; with `replace`, what is there of it is bad.
pub fn put(
    objects: &dyn Objects,
    folder: &Path,
    stamp: &Stamp,
    replace: bool,
) -> Result<Put, RemoteError> {
    if let Some(what) = contradiction(stamp) {
        let what = format!("contradicts itself: {what}");
        return Err(RemoteError::bad("its stamp", what));
    }
    let name = stamp_name(&stamp.stage, &stamp.key);
    let known = match !replace && objects.size(&name)?.is_some() {
        true => Some(other(objects, &name, stamp)?),
        false => None,
    };
    // Of what is there a file may have gone, as by a rule of age, or be damaged.
    if let Some(known) = &known
        && are_there(objects, known)?
    {
        return Ok(Put::Known);
    }
    // Files that hold no numbers, as a report, may differ from those of another machine.
    let replace_stamp = replace || known.is_some();
    for output in &stamp.outputs {
        let path = folder.join(&output.file);
        let local = |error: ContentError| match error {
            ContentError::File(error) => RemoteError::File(error),
            ContentError::Damaged(what) => RemoteError::bad(&path.display().to_string(), what),
        };
        verify::check(folder, &path, output).map_err(local)?;
        let Some(sha256) = sha256(output) else {
            let what = format!("has no SHA-256 of {:?}: an early result", output.file);
            return Err(RemoteError::bad("its stamp", what));
        };
        let object = file_name(&sha256);
        // An object of this name and size holds these bytes, unless it was found bad.
        if replace || objects.size(&object)? != Some(output.bytes) {
            objects.put(&object, &path, true)?;
        }
    }
    match objects.put(&name, &folder.join(stamp::FILE), replace_stamp)? {
        true => Ok(Put::New),
        false => other(objects, &name, stamp).map(|_| Put::Known),
    }
}

/// Whether all files of a result are there.
fn are_there(objects: &dyn Objects, stamp: &Stamp) -> Result<bool, RemoteError> {
    for output in &stamp.outputs {
        let object = sha256(output).map(|sha256| file_name(&sha256));
        let there = object.map(|object| objects.size(&object)).transpose()?;
        if there.is_some_and(|bytes| bytes != Some(output.bytes)) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The result of this key that is there already must be the same one.
fn other(objects: &dyn Objects, name: &str, stamp: &Stamp) -> Result<Stamp, RemoteError> {
    let mut bytes = Vec::new();
    if !objects.get(name, stamp::LONGEST, &mut bytes)? {
        return Err(RemoteError::bad(name, "has gone"));
    }
    match stamp::parse(bytes, name) {
        Ok(there) if there.key == stamp.key && contradiction(&there).is_none() => {
            if there.digest == stamp.digest {
                return Ok(there);
            }
            let what = format!("gives {}, not {} as here", there.digest, stamp.digest);
            Err(RemoteError::bad(name, what))
        }
        Err(StampError::File(error)) => Err(error.into()),
        Ok(_) | Err(StampError::Invalid { .. }) => {
            Err(RemoteError::bad(name, "is not a stamp of this result"))
        }
    }
}
