//! `checkpoint::peek` and `read`, and what a stage makes of the content. The first byte of an input
//! chooses: even, the rest is the file; odd, its header gets the length and the SHA-256 that make
//! the reader go on to what the header says.

#![no_main]

use coronet::particle::{Particles, State};
use coronet::record::checkpoint::{self, Checkpoint};
use coronet_fuzz::{file, sha256};
use libfuzzer_sys::fuzz_target;

/// Magic and version; then length of the header, SHA-256, header.
const LENGTH: std::ops::Range<usize> = 12..20;
const HASH: std::ops::Range<usize> = 20..52;

fuzz_target!(|bytes: &[u8]| {
    let Some((mode, bytes)) = bytes.split_first() else {
        return;
    };
    let mut bytes = bytes.to_vec();
    if mode % 2 == 1 {
        repair(&mut bytes);
    }
    let path = file("input.checkpoint", &bytes);
    let peek = checkpoint::peek(&path);
    let read = checkpoint::read(&path);
    if let Err(error) = &peek {
        assert!(error.is_damage() && read.is_err(), "{error}");
    }
    let Ok(read) = read else { return };
    assert_eq!(peek.expect("it can be read").digest, read.digest());
    let _ = State::try_from(read.clone());
    let _ = Particles::try_from(read.clone());
    again(&read);
});

/// What was read can be written and read again.
fn again(checkpoint: &Checkpoint) {
    let path = file("again.checkpoint", &[]);
    let digest = checkpoint.write(&path, 1).expect("it was read");
    assert_eq!(digest, checkpoint.digest());
}

fn repair(bytes: &mut [u8]) {
    if bytes.len() < HASH.end {
        return;
    }
    let rest = (bytes.len() - HASH.end) as u64;
    let length = u64::from_le_bytes(bytes[LENGTH].try_into().expect("8 bytes")).min(rest);
    bytes[LENGTH].copy_from_slice(&length.to_le_bytes());
    let header = &bytes[HASH.end..HASH.end + length as usize];
    let hashed = [&bytes[8..20], header].concat();
    bytes[HASH].copy_from_slice(&sha256(&hashed));
}
