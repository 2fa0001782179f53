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
    let mut mended = false;
    for output in &stamp.outputs {
        // Of what is there a file may have gone, as by a rule of age, or be damaged.
        let object = sha256(output).map(|sha256| file_name(&sha256));
        let there = object.map(|object| objects.size(&object)).transpose()?;
        let is_there = there.is_none_or(|bytes| bytes == Some(output.bytes));
        if known.is_some() && is_there {
            continue;
        }
        mended |= known.is_some();
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
        if replace || !is_there {
            objects.put(&object, &path, true)?;
        }
    }
    if let Some(known) = known {
        return Ok(if mended { Put::New } else { known });
    }
    match objects.put(&name, &folder.join(stamp::FILE), replace)? {
        true => Ok(Put::New),
        false => other(objects, &name, stamp),
    }
}

/// The result of this key that is there already must be the same one.
fn other(objects: &dyn Objects, name: &str, stamp: &Stamp) -> Result<Put, RemoteError> {
    let mut bytes = Vec::new();
    if !objects.get(name, stamp::LONGEST, &mut bytes)? {
        return Err(RemoteError::bad(name, "has gone"));
    }
    match stamp::parse(bytes, name) {
        Ok(there) if there.key == stamp.key && contradiction(&there).is_none() => {
            if there.digest == stamp.digest {
                return Ok(Put::Known);
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
