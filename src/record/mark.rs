//! The mark in pictures, films and meshes by which the program knows its own files.
//! Test: tests/pipeline/render.rs.

use crate::file::FileError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Is near the beginning of each of them, except MP4.
pub const MARK: &str = "coronet";

/// Bytes that are looked at.
const HEAD: u64 = 4096;

/// Whether a new file may take this place: nothing is there, or one with the mark.
///
/// # Errors
/// If the file that is there cannot be read.
pub fn may_replace(path: &Path) -> Result<bool, FileError> {
    let is_film = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("mp4"));
    let found = match File::open(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(true),
        found => found.map_err(FileError::new(path, "open"))?,
    };
    let mut head = Vec::new();
    let read = found.take(HEAD).read_to_end(&mut head);
    read.map_err(FileError::new(path, "read"))?;
    Ok(is_film || head.windows(MARK.len()).any(|part| part == MARK.as_bytes()))
}
