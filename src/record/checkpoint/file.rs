//! Writing and reading checkpoint files, and reading their headers alone.
//!
//! A file may be untrusted, so the sizes that it declares are limited. The arrays of a file
//! together have at most [`SMALL`] + [`EXPANSION`] times its length, bytes, and the header has at
//! most [`HEADER_LIMIT`]. A single array may compress more, zeros by 30,000, but the arrays of one
//! checkpoint share the number of particles, and identifiers and positions do not compress like
//! that: at [`LEVEL`](super::LEVEL), a lattice at rest of a million particles with a dozen arrays
//! of zeros compresses by 1,200, one of a hundred million by 1,900. A checkpoint that compresses
//! more is not written. Memory grows only as data are decoded, also below these limits.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

use rayon::prelude::*;
use sha2::{Digest as _, Sha256};

use super::codec::{self, ElementType, FORMAT_VERSION, HEADER_LIMIT, Header, Section};
use super::section::{self, Packer, Unreadable};
use super::{Array, Checkpoint, CheckpointError, content_digest};
use crate::file::{self, FileError};
use crate::particle::Shares;
use crate::record::atomic::AtomicFile;
use crate::record::digest::Digest;

const MAGIC: [u8; 8] = *b"\x89CRN\r\n\x1a\n";

/// Magic, version, header length, SHA-256 of the rest of this and of the header.
const PREAMBLE: usize = 8 + 4 + 8 + 32;

/// Permitted size of the arrays of any checkpoint, bytes.
const SMALL: u64 = 16 << 20;

/// Permitted size of the arrays beyond that, over the length of the file.
const EXPANSION: u64 = 4096;

/// Elements of arrays of several processes that are compressed together.
const TOGETHER: usize = 32 << 20;

/// The header of a checkpoint, without its arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct Peek {
    /// Format version.
    pub version: u32,
    /// What it holds: see [`Checkpoint::kind`].
    pub kind: String,
    /// Simulated time, s.
    pub time: f64,
    /// Number of time steps done.
    pub step: u64,
    /// Named numbers.
    pub scalars: Vec<(String, f64)>,
    /// Named texts.
    pub texts: Vec<(String, String)>,
    /// Names, types and sizes of the arrays.
    pub arrays: Vec<PeekArray>,
    /// Digest of the content, if the arrays agree with the table ([`read`] checks that).
    pub digest: Digest,
    /// Length of the file, bytes.
    pub file_size: u64,
}

/// One array of a [`Peek`].
#[derive(Clone, Debug, PartialEq)]
pub struct PeekArray {
    /// Name of the array.
    pub name: String,
    /// Type of its elements.
    pub element: ElementType,
    /// Number of elements.
    pub count: u64,
    /// Length in the file, bytes.
    pub compressed: u64,
}

/// Writes a checkpoint; `more`: where the rest of its arrays is.
pub fn write(
    checkpoint: &Checkpoint,
    more: Option<&dyn Shares>,
    path: &Path,
    level: i32,
) -> Result<Digest, CheckpointError> {
    let mut file = AtomicFile::create(path)?;
    let io = FileError::new(path, "write");
    // Integers have fixed width: a header with blank lengths and hashes is as long as the final
    // one.
    let blank = checkpoint.arrays.iter().map(|(name, array)| Section {
        name: name.clone(),
        element: section::element(array),
        count: more.map_or(array.len(), Shares::count) as u64,
        compressed: 0,
        digest: [0; 32],
    });
    let mut header = checkpoint.header(blank.collect());
    let length = encode(&header, path)?.len();
    file.write_all(&vec![0; PREAMBLE + length]).map_err(&io)?;
    write_sections(checkpoint, more, &mut file, &mut header, (path, level))?;
    let bytes = encode(&header, path)?;
    // Only a readable checkpoint is written.
    let packed: u64 = header
        .sections
        .iter()
        .map(|section| section.compressed)
        .sum();
    check_size(path, &header, (PREAMBLE + length) as u64 + packed)?;
    let mut start = Vec::with_capacity(PREAMBLE + bytes.len());
    start.extend(MAGIC);
    start.extend(FORMAT_VERSION.to_le_bytes());
    start.extend((bytes.len() as u64).to_le_bytes());
    start.extend(header_hash(&start[8..20], &bytes));
    start.extend(bytes);
    file.file().seek(SeekFrom::Start(0)).map_err(&io)?;
    file.write_all(&start).map_err(&io)?;
    file.commit()?;
    Ok(content_digest(&header))
}

/// Writes the arrays one after the other, and completes their sections.
fn write_sections(
    checkpoint: &Checkpoint,
    more: Option<&dyn Shares>,
    file: &mut AtomicFile,
    header: &mut Header,
    (path, level): (&Path, i32),
) -> Result<(), CheckpointError> {
    let [io, compress] = ["write", "compress"].map(|what| FileError::new(path, what));
    // As many arrays at a time as there are threads, and few of long ones: only their compressed
    // bytes take memory, of the first nothing.
    let threads = rayon::current_num_threads().max(1);
    let few = more.map_or(threads, |more| (TOGETHER / more.count().max(1)).max(1));
    let batch = threads.min(few);
    let arrays = checkpoint.arrays.chunks(batch).enumerate();
    for ((k, arrays), sections) in arrays.zip(header.sections.chunks_mut(batch)) {
        let made: Result<Vec<_>, _> = sections
            .iter()
            .map(|s| Packer::new(s.element, s.count as usize, level))
            .collect();
        let mut packers = made.map_err(&compress)?;
        let mut add = |packers: &mut [Packer], arrays: &[(String, Array)]| {
            let pairs = packers.par_iter_mut().zip(arrays);
            let added: Result<(), _> = pairs
                .map(|(packer, (_, array))| packer.add(array))
                .collect();
            added.map_err(&compress)?;
            let ready = packers[0].ready();
            sections[0].compressed += ready.len() as u64;
            file.write_all(&ready).map_err(&io)
        };
        let mut added = add(&mut packers, arrays);
        let columns = k * batch..k * batch + arrays.len();
        if let Some(more) = more {
            more.each(&columns, &mut |part| {
                if added.is_ok() {
                    let part = Checkpoint::from(part).arrays;
                    added = add(&mut packers, &part[columns.clone()]);
                }
            });
        }
        added?;
        let packed: Vec<_> = packers.into_par_iter().map(Packer::finish).collect();
        for (packed, section) in packed.into_iter().zip(sections) {
            let packed = packed.map_err(&compress)?;
            section.compressed += packed.bytes.len() as u64;
            section.digest = packed.digest.0;
            file.write_all(&packed.bytes).map_err(&io)?;
        }
    }
    Ok(())
}

/// Reads and verifies a whole checkpoint.
///
/// # Errors
/// See [`CheckpointError`].
pub fn read(path: &Path) -> Result<Checkpoint, CheckpointError> {
    let (mut file, header, _) = open(path)?;
    let mut arrays = Vec::with_capacity(header.sections.len());
    for batch in header.sections.chunks(rayon::current_num_threads().max(1)) {
        let mut packed = Vec::with_capacity(batch.len());
        for section in batch {
            // `open` has checked that the file is long enough.
            let mut bytes = vec![0; section.compressed as usize];
            read_exact(&mut file, &mut bytes, path)?;
            packed.push((section, bytes));
        }
        let unpacked: Vec<_> = packed
            .into_par_iter()
            .map(|(section, bytes)| section::unpack(section, &bytes))
            .collect();
        for (array, section) in unpacked.into_iter().zip(batch) {
            let array = array.map_err(|why| match why {
                Unreadable::TooLarge(what) => too_large(path, what),
                Unreadable::Corrupt(what) => corrupt(path, &section.name, what),
            })?;
            arrays.push((section.name.clone(), array));
        }
    }
    Ok(Checkpoint {
        kind: header.kind,
        time: header.time,
        step: header.step,
        scalars: header.scalars,
        texts: header.texts,
        arrays,
    })
}

/// Reads and verifies only the header.
///
/// # Errors
/// See [`CheckpointError`].
pub fn peek(path: &Path) -> Result<Peek, CheckpointError> {
    let (_, header, file_size) = open(path)?;
    let digest = content_digest(&header);
    let array = |section: Section| PeekArray {
        name: section.name,
        element: section.element,
        count: section.count,
        compressed: section.compressed,
    };
    Ok(Peek {
        version: FORMAT_VERSION,
        kind: header.kind,
        time: header.time,
        step: header.step,
        scalars: header.scalars,
        texts: header.texts,
        arrays: header.sections.into_iter().map(array).collect(),
        digest,
        file_size,
    })
}

/// Opens a file, verifies its header and that its sections end where the file ends.
/// Returns the file at its first section, the header and the file's length.
fn open(path: &Path) -> Result<(File, Header, u64), CheckpointError> {
    let io = FileError::new(path, "read");
    let mut file = file::open(path)?;
    let found = file.metadata().map_err(&io)?.len();
    let truncated = |expected| CheckpointError::Truncated {
        path: path.to_path_buf(),
        expected,
        found,
    };
    let mut start = Vec::with_capacity(PREAMBLE);
    (&file)
        .take(PREAMBLE as u64)
        .read_to_end(&mut start)
        .map_err(&io)?;
    if !start.iter().zip(&MAGIC).all(|(a, b)| a == b) {
        return Err(CheckpointError::NotACheckpoint {
            path: path.to_path_buf(),
        });
    }
    if start.len() < PREAMBLE {
        return Err(truncated(PREAMBLE as u64));
    }
    let version = u32::from_le_bytes(start[8..12].try_into().expect("4 bytes"));
    if version > FORMAT_VERSION {
        return Err(CheckpointError::NewerVersion {
            path: path.to_path_buf(),
            found: version,
            supported: FORMAT_VERSION,
        });
    }
    let length = u64::from_le_bytes(start[12..20].try_into().expect("8 bytes"));
    if length > HEADER_LIMIT as u64 {
        return Err(too_large(path, format!("a header of {length} bytes")));
    }
    let after_header = PREAMBLE as u64 + length;
    if found < after_header {
        return Err(truncated(after_header));
    }
    let mut bytes = vec![0; length as usize];
    read_exact(&mut file, &mut bytes, path)?;
    if header_hash(&start[8..20], &bytes) != start[20..] {
        return Err(corrupt(path, "header", "SHA-256 does not match".into()));
    }
    let header = codec::decode(&bytes).map_err(|what| corrupt(path, "header", what))?;
    check_end(path, &header, after_header, found)?;
    Ok((file, header, found))
}

/// Fills `bytes`; the file was long enough when it was opened.
fn read_exact(file: &mut File, bytes: &mut [u8], path: &Path) -> Result<(), CheckpointError> {
    match file.read_exact(bytes) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
            let found = file.metadata().map_err(FileError::new(path, "read"))?.len();
            Err(CheckpointError::Truncated {
                path: path.to_path_buf(),
                expected: found + 1,
                found,
            })
        }
        other => Ok(other.map_err(FileError::new(path, "read"))?),
    }
}

/// Compares the sum of the sections with the length of the file.
fn check_end(path: &Path, header: &Header, start: u64, found: u64) -> Result<(), CheckpointError> {
    let mut end = start;
    for section in &header.sections {
        section::length(section).map_err(|what| too_large(path, what))?;
        end = end.checked_add(section.compressed).ok_or_else(|| {
            too_large(
                path,
                format!("array {:?}: {} bytes", section.name, section.compressed),
            )
        })?;
    }
    if found < end {
        return Err(CheckpointError::Truncated {
            path: path.to_path_buf(),
            expected: end,
            found,
        });
    }
    if found > end {
        let what = format!("{} bytes after the last array", found - end);
        return Err(corrupt(path, "end", what));
    }
    check_size(path, header, found)
}

/// Compares the declared size of the arrays with the length of the file.
fn check_size(path: &Path, header: &Header, found: u64) -> Result<(), CheckpointError> {
    let mut decoded = 0u64;
    for section in &header.sections {
        let length = section::length(section).map_err(|what| too_large(path, what))?;
        decoded = decoded.saturating_add(length);
    }
    if decoded > SMALL.saturating_add(found.saturating_mul(EXPANSION)) {
        let what = format!("arrays of {decoded} bytes in a file of {found}");
        return Err(too_large(path, what));
    }
    Ok(())
}

fn header_hash(version_and_length: &[u8], header: &[u8]) -> [u8; 32] {
    let mut hasher = Sha256::new();
    hasher.update(version_and_length);
    hasher.update(header);
    hasher.finalize().into()
}

fn encode(header: &Header, path: &Path) -> Result<Vec<u8>, CheckpointError> {
    codec::encode(header).map_err(|what| too_large(path, format!("header: {what}")))
}

fn too_large(path: &Path, what: String) -> CheckpointError {
    CheckpointError::TooLarge {
        path: path.to_path_buf(),
        what,
    }
}

fn corrupt(path: &Path, section: &str, what: String) -> CheckpointError {
    CheckpointError::Corrupt {
        path: path.to_path_buf(),
        section: section.to_string(),
        what,
    }
}
