//! All readers of logs: `info`, `read_frames`, `content_digest`, `recover`, and the list and merger
//! of segments. The first byte of an input chooses: even, the rest is the file; odd, the checksums
//! of its chunks are set to "none", so that what is in them is looked at.

#![no_main]

use coronet::record::log;
use coronet_fuzz::{file, scratch};
use libfuzzer_sys::fuzz_target;

const CHUNK: u8 = 6;
/// Where a chunk has its checksum: after two times and the length of its content.
const CHECKSUM: std::ops::Range<usize> = 24..28;

fuzz_target!(|bytes: &[u8]| {
    let Some((mode, bytes)) = bytes.split_first() else {
        return;
    };
    let mut bytes = bytes.to_vec();
    if mode % 2 == 1 {
        repair(&mut bytes);
    }
    let path = file("segment-001.mcap", &bytes);
    let _ = log::info(&path);
    let whole = log::read_frames(&path).is_ok_and(|mut frames| frames.all(|frame| frame.is_ok()));
    let digest = log::content_digest(&path);
    let out = scratch().join("recovered.mcap");
    if let Ok(recovered) = log::recover(&path, &out) {
        assert_eq!(recovered.damage.is_none(), whole && digest.is_ok());
        let frames = log::read_frames(&out).expect("it was written just now");
        let frames: Vec<_> = frames.map(|frame| frame.expect("whole frames")).collect();
        assert_eq!(frames.len() as u64, recovered.frames);
    }
    if let Ok(segments) = log::segments(scratch()) {
        let _ = log::merge(&segments, &scratch().join("merged.mcap"));
    }
});

/// Walks the records of the file: each has an opcode, a length and that many bytes.
fn repair(bytes: &mut [u8]) {
    let mut start = 8;
    while let Some(head) = bytes.get(start..start + 9) {
        let opcode = head[0];
        let length = u64::from_le_bytes(head[1..].try_into().expect("8 bytes"));
        start += 9;
        if opcode == CHUNK
            && let Some(checksum) = bytes.get_mut(start + CHECKSUM.start..start + CHECKSUM.end)
        {
            checksum.fill(0);
        }
        let next = usize::try_from(length).ok();
        let Some(next) = next.and_then(|length| start.checked_add(length)) else {
            return;
        };
        start = next;
    }
}
