//! The mark in pictures, films and meshes by which the program knows its own files.
//! Test: tests/pipeline/render.rs.

use crate::file::{self, FileError};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Is near the beginning of each of them, of MP4 at the end.
pub const MARK: &str = "coronet";

/// Bytes that are looked at from the beginning.
const HEAD: u64 = 4096;
/// And at the end.
const TAIL: i64 = 32;

/// What an MP4 ends with: a box that players skip.
pub fn tail() -> Vec<u8> {
    let size = 8 + MARK.len() as u32;
    [&size.to_be_bytes()[..], b"free", MARK.as_bytes()].concat()
}

/// Whether a new file may take this place: nothing is there, or one with the mark.
///
/// # Errors
/// If the file that is there cannot be read.
pub fn may_replace(path: &Path) -> Result<bool, FileError> {
    let mut found = match file::open(path) {
        Err(error) if error.is_not_found() => return Ok(true),
        found => found?,
    };
    let mut read = || {
        let mut bytes = Vec::new();
        found.by_ref().take(HEAD).read_to_end(&mut bytes)?;
        let length = found.seek(SeekFrom::End(0))?;
        found.seek(SeekFrom::End(-TAIL.min(length as i64)))?;
        found.read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    let bytes = read().map_err(FileError::new(path, "read"))?;
    Ok(bytes
        .windows(MARK.len())
        .any(|part| part == MARK.as_bytes()))
}
