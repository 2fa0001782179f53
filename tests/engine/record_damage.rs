//! Checkpoints that are damaged, cut off, foreign, newer or hostile: a clear error, never a panic.

use std::fs;
use std::path::Path;

use coronet::record::checkpoint::{FORMAT_VERSION, LEVEL, peek, read};
use coronet::record::{Array, Checkpoint, CheckpointError};
use sha2::{Digest as _, Sha256};

use crate::allocation::peak;
use crate::record_checkpoint::example;

/// Builds files from the description of the format, independently of the writer.
struct Craft {
    header: Vec<u8>,
    sections: Vec<u8>,
}

impl Craft {
    /// A header without scalars and texts; rows: name, element variant, count, compressed, SHA-256.
    fn new(rows: &[(&str, u32, u64, u64, [u8; 32])]) -> Self {
        let mut header = Vec::new();
        let text = |header: &mut Vec<u8>, text: &str| {
            header.extend((text.len() as u64).to_le_bytes());
            header.extend(text.as_bytes());
        };
        text(&mut header, "state");
        header.extend(0.5f64.to_le_bytes());
        header.extend(7u64.to_le_bytes());
        header.extend(0u64.to_le_bytes());
        header.extend(0u64.to_le_bytes());
        header.extend((rows.len() as u64).to_le_bytes());
        for (name, element, count, compressed, digest) in rows {
            text(&mut header, name);
            header.extend(element.to_le_bytes());
            header.extend(count.to_le_bytes());
            header.extend(compressed.to_le_bytes());
            header.extend(digest);
        }
        Craft {
            header,
            sections: Vec::new(),
        }
    }

    fn file(&self) -> Vec<u8> {
        let mut bytes = b"\x89CRN\r\n\x1a\n".to_vec();
        bytes.extend(FORMAT_VERSION.to_le_bytes());
        bytes.extend((self.header.len() as u64).to_le_bytes());
        let hash = Sha256::new()
            .chain_update(&bytes[8..])
            .chain_update(&self.header);
        bytes.extend(hash.finalize());
        bytes.extend(&self.header);
        bytes.extend(&self.sections);
        bytes
    }

    fn read(&self, folder: &Path) -> Result<Checkpoint, CheckpointError> {
        read_bytes(folder, &self.file())
    }
}

fn read_bytes(folder: &Path, bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let path = folder.join("crafted");
    fs::write(&path, bytes).unwrap();
    let peeked = peek(&path);
    let whole = read(&path);
    assert!(
        peeked.is_ok() || whole.is_err(),
        "read trusts what peek refuses"
    );
    whole
}

#[test]
fn a_file_crafted_from_the_description_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let values = [1.0f64, -2.5, 1e300];
    let plain: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    let planes: Vec<u8> = (0..8)
        .flat_map(|k| plain.chunks(8).map(move |element| element[k]))
        .collect();
    let packed = zstd::bulk::compress(&planes, 5).unwrap();
    let row = (
        "v",
        0,
        3,
        packed.len() as u64,
        Sha256::digest(&plain).into(),
    );
    let mut craft = Craft::new(&[row]);
    craft.sections = packed;
    let back = craft.read(folder.path()).unwrap();
    assert_eq!(
        (back.kind.as_str(), back.time, back.step),
        ("state", 0.5, 7)
    );
    assert_eq!(back.array("v"), Some(&Array::F64(values.to_vec())));

    // One bit of the table's hash: damage in that array, by name.
    let at = craft.header.len() - 1;
    craft.header[at] ^= 1;
    let error = craft.read(folder.path()).unwrap_err();
    assert!(
        matches!(&error, CheckpointError::Corrupt { section, .. } if section == "v"),
        "{error}"
    );
}

#[test]
fn every_flipped_bit_is_found_or_harmless() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    let digest = example().write(&path, 1).unwrap();
    let good = fs::read(&path).unwrap();
    let arrays: u64 = peek(&path)
        .unwrap()
        .arrays
        .iter()
        .map(|a| a.compressed)
        .sum();
    let header_end = good.len() - arrays as usize;
    let mut harmless = 0;
    for at in 0..good.len() {
        let mut bad = good.clone();
        bad[at] ^= 1 << (at % 8);
        match read_bytes(folder.path(), &bad) {
            // A zstd frame has a few bits that nobody reads.
            Ok(content) => {
                assert!(at >= header_end && content.digest() == digest, "byte {at}");
                harmless += 1;
            }
            Err(CheckpointError::NotACheckpoint { .. }) => assert!(at < 8, "byte {at}"),
            Err(error) => assert!(at >= 8 && error.is_damage(), "byte {at}: {error}"),
        }
    }
    assert!(harmless < 20, "{harmless} flipped bits unnoticed");
}

#[test]
fn every_cut_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    example().write(&path, 1).unwrap();
    let good = fs::read(&path).unwrap();
    for length in 0..good.len() {
        let error = read_bytes(folder.path(), &good[..length]).unwrap_err();
        let found = matches!(
            error,
            CheckpointError::Truncated { expected, found, .. }
                if found == length as u64 && expected > found
        );
        assert!(found, "{length} bytes: {error}");
    }
    let longer = [good, vec![0]].concat();
    let error = read_bytes(folder.path(), &longer).unwrap_err();
    assert!(matches!(error, CheckpointError::Corrupt { .. }), "{error}");
}

#[test]
fn foreign_and_newer_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for foreign in [&b"PK\x03\x04"[..], &[0; 4096], b"{\"json\": true}\n"] {
        let error = read_bytes(folder.path(), foreign).unwrap_err();
        assert!(
            matches!(error, CheckpointError::NotACheckpoint { .. }),
            "{error}"
        );
    }
    let mut newer = Craft::new(&[]).file();
    newer[8..12].copy_from_slice(&(FORMAT_VERSION + 1).to_le_bytes());
    let error = read_bytes(folder.path(), &newer).unwrap_err();
    let version = FORMAT_VERSION + 1;
    assert!(
        matches!(error, CheckpointError::NewerVersion { found, .. } if found == version),
        "{error}"
    );
    let missing = read(&folder.path().join("missing")).unwrap_err();
    assert!(matches!(missing, CheckpointError::Io(_)), "{missing}");
    assert!(!missing.is_damage());
}

#[test]
fn hostile_lengths_are_refused_before_anything_is_allocated() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let digest = [0; 32];
    let too_large = |error: &CheckpointError| matches!(error, CheckpointError::TooLarge { .. });
    for (count, compressed) in [
        (1 << 50, 8),
        (u64::MAX, 8),
        (u64::MAX, u64::MAX),
        (8, 1 << 40),
        (1 << 61, 0),
    ] {
        let mut craft = Craft::new(&[("v", 0, count, compressed, digest)]);
        craft.sections = vec![0; 8];
        let error = craft.read(folder).unwrap_err();
        assert!(too_large(&error), "{count} in {compressed}: {error}");
    }
    let sums = Craft::new(&[("v", 0, 1, u64::MAX, digest), ("w", 0, 1, u64::MAX, digest)]);
    assert!(too_large(&sums.read(folder).unwrap_err()));

    let mut long_header = Craft::new(&[]).file();
    long_header[12..20].copy_from_slice(&(1u64 << 60).to_le_bytes());
    assert!(too_large(&read_bytes(folder, &long_header).unwrap_err()));

    // A bomb: 64 MiB of zeros in a few bytes, tabled as 8 elements.
    let bomb = zstd::bulk::compress(&vec![0; 64 << 20], 1).unwrap();
    let zeros = Sha256::digest([0; 64]).into();
    let mut craft = Craft::new(&[("v", 0, 8, bomb.len() as u64, zeros)]);
    craft.sections = bomb;
    let error = craft.read(folder).unwrap_err();
    assert!(matches!(error, CheckpointError::Corrupt { .. }), "{error}");
}

/// Reads on one thread, so that its allocations are seen.
fn held_while_reading(folder: &Path, bytes: &[u8]) -> (usize, Result<Checkpoint, CheckpointError>) {
    let work = || {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .use_current_thread();
        let pool = pool.build().unwrap();
        let mut result = None;
        let held = peak(|| result = Some(pool.install(|| read_bytes(folder, bytes))));
        (held, result.unwrap())
    };
    std::thread::scope(|scope| scope.spawn(work).join().unwrap())
}

#[test]
fn a_small_hostile_file_takes_no_more_memory_than_it_may_claim() {
    let folder = tempfile::tempdir().unwrap();
    let zeros = |count: u64, size: usize| {
        zstd::bulk::compress(&vec![0; size], 1).map(|packed| (count, packed))
    };
    // Many arrays that compress well, one that does so honestly, and claims without data.
    let (count, packed) = zeros(8 << 20, 64 << 20).unwrap();
    let digest = Sha256::digest(vec![0; 64 << 20]).into();
    for arrays in [1, 4, 40] {
        let rows = vec![("v", 0, count, packed.len() as u64, digest); arrays];
        let mut craft = Craft::new(&rows);
        craft.sections = packed.repeat(arrays);
        let bytes = craft.file();
        let may_claim = (16 << 20) + 4096 * bytes.len();
        let (held, result) = held_while_reading(folder.path(), &bytes);
        assert!(result.is_err_and(|error| matches!(error, CheckpointError::TooLarge { .. })));
        assert!(
            held < may_claim + (8 << 20),
            "{arrays} arrays: {held} bytes"
        );
    }
    // Within the limit by its claim, but there is nothing behind it.
    let mut craft = Craft::new(&[("v", 0, 2 << 20, 4096, digest)]);
    craft.sections = vec![0; 4096];
    let (held, result) = held_while_reading(folder.path(), &craft.file());
    assert!(result.unwrap_err().is_damage());
    assert!(held < 4 << 20, "{held} bytes for nothing");
    // A text, a table and a header that are longer than the file.
    for at in [0, 24, 32, 40] {
        let mut craft = Craft::new(&[]);
        let start = craft.header.len() - 24;
        let at = if at == 0 { 0 } else { start + at - 24 };
        craft.header[at..at + 8].copy_from_slice(&(1u64 << 19).to_le_bytes());
        let (held, result) = held_while_reading(folder.path(), &craft.file());
        assert!(result.unwrap_err().is_damage());
        assert!(held < 8 << 20, "{held} bytes for a claim at {at}");
    }
}

/// A lattice at rest with a dozen arrays of zeros: no method writes what compresses more. By how
/// much is half of what is allowed at most.
#[test]
fn what_compresses_best_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rest");
    let (n, d) = (100usize, 1e-4);
    let reals = |f: fn(usize, usize) -> usize| {
        Array::F64((0..n * n * n).map(|i| (f(i, n) as f64 + 0.5) * d).collect())
    };
    let mut arrays = vec![
        (
            "id".to_string(),
            Array::U32((0..(n * n * n) as u32).collect()),
        ),
        ("body".to_string(), Array::U8(vec![0; n * n * n])),
        ("position_x".to_string(), reals(|i, n| i % n)),
        ("position_y".to_string(), reals(|i, n| i / n % n)),
        ("position_z".to_string(), reals(|i, n| i / n / n)),
    ];
    for k in 0..12 {
        arrays.push((format!("zeros_{k}"), Array::F64(vec![0.0; n * n * n])));
    }
    let content = Checkpoint {
        arrays,
        ..Checkpoint::default()
    };
    content.write(&path, LEVEL).unwrap();
    let length = fs::metadata(&path).unwrap().len() as usize;
    let ratio = n * n * n * (5 + 15 * 8) / length;
    assert!(ratio < 2048, "compresses by {ratio}");
    assert!(read(&path).unwrap() == content);

    // What could not be read is not written.
    let zeros = Checkpoint {
        arrays: vec![("zeros".into(), Array::F64(vec![0.0; 6 << 20]))],
        ..Checkpoint::default()
    };
    let error = zeros.write(&path, LEVEL).unwrap_err();
    assert!(matches!(error, CheckpointError::TooLarge { .. }), "{error}");
    assert!(read(&path).unwrap() == content);
}

#[cfg(unix)]
#[test]
fn what_cannot_be_read_is_not_damage() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for path in [&pipe, folder.path(), "/dev/zero".as_ref()] {
        for error in [read(path).unwrap_err(), peek(path).unwrap_err()] {
            assert!(
                matches!(error, CheckpointError::Io(_)) && !error.is_damage(),
                "{error}"
            );
            let source = std::error::Error::source(&error).expect("a source");
            assert!(source.is::<std::io::Error>(), "{error}");
        }
    }
}

#[test]
fn any_zeroed_tail_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a");
    example().write(&path, 1).unwrap();
    let good = fs::read(&path).unwrap();
    for length in (0..good.len()).step_by(5) {
        let zeroed = [&good[..length], &vec![0; good.len() - length]].concat();
        match read_bytes(folder.path(), &zeroed) {
            Ok(content) => assert!(zeroed == good || content == example(), "{length} bytes"),
            Err(error) => assert!(error.is_damage(), "{length} bytes: {error}"),
        }
    }
}

#[test]
fn mutated_headers_with_a_matching_hash_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let plain = [7u8; 5];
    let packed = zstd::bulk::compress(&plain, 1).unwrap();
    let row = ("v", 4, 5, packed.len() as u64, Sha256::digest(plain).into());
    let mut craft = Craft::new(&[row]);
    craft.sections = packed;
    craft.read(folder.path()).expect("unmutated");
    let good = craft.header.clone();
    let mut refused = 0;
    for at in 0..good.len() {
        for value in [0, 1, 0x7f, 0xff, good[at] ^ 0x80, good[at].wrapping_add(1)] {
            craft.header = good.clone();
            craft.header[at] = value;
            refused += usize::from(craft.read(folder.path()).is_err());
        }
        craft.header.truncate(at);
        let error = craft.read(folder.path()).unwrap_err();
        assert!(error.is_damage(), "header of {at} bytes: {error}");
    }
    assert!(refused > good.len(), "only {refused} mutations refused");
}
