//! Checkpoints: what stages exchange and what a run resumes from.
//!
//! A file is
//!
//! | bytes | what |
//! |---|---|
//! | 8 | magic `89 43 52 4E 0D 0A 1A 0A` (as PNG does: text-mode transfers break it visibly) |
//! | 4 | format version, u32 little-endian |
//! | 8 | length of the header, u64 little-endian |
//! | 32 | SHA-256 of version, length and header |
//! | ... | header: kind, time, step, scalars, texts, table of sections (bincode, fixed ints) |
//! | ... | sections, one an array, back to back |
//!
//! A section is one zstd frame with checksum; in it, blocks of 131072 elements with their bytes
//! shuffled (all first bytes, all second bytes ...). The table contains name, element type, number
//! of elements, compressed length and SHA-256 of the *uncompressed* little-endian bytes of each.
//! The digest of a checkpoint hashes the header's facts and the sections' hashes, so it identifies
//! the content independently of compression, and the header alone suffices to compute it.

mod codec;
mod content;
mod error;
mod file;
mod section;

pub use codec::{ElementType, FORMAT_VERSION};
pub use error::CheckpointError;
pub use file::{Peek, PeekArray, peek, read};

use std::path::Path;

use rayon::prelude::*;

use super::digest::{Digest, Hasher};
use crate::particle::Shares;

/// Default compression level: level 3 costs 30 % more time for 0.3 % less space.
pub const LEVEL: i32 = 1;

/// One array of a checkpoint.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    /// 64-bit floating point.
    F64(Vec<f64>),
    /// 32-bit floating point.
    F32(Vec<f32>),
    /// 64-bit unsigned integers.
    U64(Vec<u64>),
    /// 32-bit unsigned integers.
    U32(Vec<u32>),
    /// Bytes.
    U8(Vec<u8>),
}

impl Array {
    /// Number of elements.
    pub fn len(&self) -> usize {
        match self {
            Array::F64(values) => values.len(),
            Array::F32(values) => values.len(),
            Array::U64(values) => values.len(),
            Array::U32(values) => values.len(),
            Array::U8(values) => values.len(),
        }
    }

    /// Whether there is no element.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named snapshot: scalars, texts and arrays, each list in a significant order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checkpoint {
    /// What it holds: `state`, `particles`, `calibration` ...
    pub kind: String,
    /// Simulated time, s.
    pub time: f64,
    /// Number of time steps done.
    pub step: u64,
    /// Named numbers.
    pub scalars: Vec<(String, f64)>,
    /// Named texts.
    pub texts: Vec<(String, String)>,
    /// Named arrays.
    pub arrays: Vec<(String, Array)>,
}

impl Checkpoint {
    /// The scalar of that name.
    pub fn scalar(&self, name: &str) -> Option<f64> {
        find(&self.scalars, name).copied()
    }

    /// The text of that name.
    pub fn text(&self, name: &str) -> Option<&str> {
        find(&self.texts, name).map(String::as_str)
    }

    /// The array of that name.
    pub fn array(&self, name: &str) -> Option<&Array> {
        find(&self.arrays, name)
    }

    /// Digest of the uncompressed content.
    pub fn digest(&self) -> Digest {
        let sections: Vec<_> = self
            .arrays
            .par_iter()
            .map(|(name, array)| codec::Section {
                name: name.clone(),
                element: section::element(array),
                count: array.len() as u64,
                compressed: 0,
                digest: section::digest(array).0,
            })
            .collect();
        content_digest(&self.header(sections))
    }

    /// Writes the checkpoint to `path`, atomically, at zstd level `level` (1 to 19), and returns
    /// its digest.
    ///
    /// # Errors
    /// If the file cannot be written, as on a full disk; an older file of that name stays.
    pub fn write(&self, path: &Path, level: i32) -> Result<Digest, CheckpointError> {
        file::write(self, None, path, level)
    }

    /// The same of a state of which this is the part of the first of several ranks, and `more` has
    /// those of the others. No rank holds more than a few arrays of another at a time.
    ///
    /// # Errors
    /// As [`Checkpoint::write`].
    pub fn write_with(
        &self,
        more: Option<&dyn Shares>,
        path: &Path,
        level: i32,
    ) -> Result<Digest, CheckpointError> {
        file::write(self, more, path, level)
    }

    fn header(&self, sections: Vec<codec::Section>) -> codec::Header {
        codec::Header {
            kind: self.kind.clone(),
            time: self.time,
            step: self.step,
            scalars: self.scalars.clone(),
            texts: self.texts.clone(),
            sections,
        }
    }
}

/// The two-level digest: facts of the header and hashes of the sections, without compressed
/// lengths.
fn content_digest(header: &codec::Header) -> Digest {
    let mut hasher = Hasher::new("coronet checkpoint 1");
    hasher.text(&header.kind).real(header.time);
    hasher.number(header.step);
    hasher.number(header.scalars.len() as u64);
    for (name, value) in &header.scalars {
        hasher.text(name).real(*value);
    }
    hasher.number(header.texts.len() as u64);
    for (name, text) in &header.texts {
        hasher.text(name).text(text);
    }
    hasher.number(header.sections.len() as u64);
    for section in &header.sections {
        hasher.text(&section.name).number(section.element as u64);
        hasher.number(section.count);
        hasher.digest(&Digest(section.digest));
    }
    hasher.finish()
}

fn find<'a, T>(list: &'a [(String, T)], name: &str) -> Option<&'a T> {
    list.iter()
        .find(|(key, _)| key == name)
        .map(|(_, value)| value)
}
