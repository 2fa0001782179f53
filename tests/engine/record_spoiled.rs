//! Logs that are damaged, cut off or zeroed: the same content or damage, never a panic.

use std::fs;
use std::path::Path;

use coronet::particle::Frame;
use coronet::record::log::{
    LogError, LogWriter, content_digest, info, merge, read_frames, recover, segments,
};

use crate::record_log::{frame, setup};

/// A small log: three frames of few particles, two of them durable.
fn write_log(folder: &Path) -> std::path::PathBuf {
    let mut writer = LogWriter::create(folder, 0, None, &setup()).unwrap();
    for k in 56..59 {
        writer.frame(frame(k)).unwrap();
        if k < 58 {
            writer.flush(frame(k).time).unwrap().wait().unwrap();
        }
    }
    let path = writer.path().to_path_buf();
    writer.finish().unwrap();
    path
}

/// The frames before the end or the first error, and that error.
pub fn frames(path: &Path) -> (Vec<Frame>, Option<LogError>) {
    let mut found = Vec::new();
    let read = read_frames(path).and_then(|frames| {
        for frame in frames {
            found.push(frame?);
        }
        Ok(())
    });
    (found, read.err())
}

/// Calls every reader. What they return is what `good` holds, or damage. Returns whether any of
/// them found damage.
fn try_all(path: &Path, good: &[Frame], what: &str, number: usize) -> bool {
    let at = format!("{what} {number}");
    let mut seen = false;
    let mut damaged = |error: LogError| {
        assert!(error.is_damage(), "{at}: {error}");
        seen = true;
    };
    let (found, error) = frames(path);
    assert!(good.starts_with(&found), "{at}: wrong frames");
    assert!(error.is_some() || found == good, "{at}: lost frames");
    error.map(&mut damaged);
    let _ = info(path).map_err(&mut damaged);
    let _ = content_digest(path).map_err(&mut damaged);
    let folder = path.parent().unwrap();
    let out = folder.join("merged");
    // A merge waits for the disk.
    let merged = segments(folder).and_then(|segments| {
        let merge = || merge(&segments, &out);
        number.is_multiple_of(8).then(merge).transpose()
    });
    match merged {
        Ok(None) => {}
        Ok(Some(merged)) => assert!(merged.frames <= good.len() as u64, "{at}: too many frames"),
        Err(error) => damaged(error),
    }
    seen
}

#[test]
fn a_flip_of_any_byte_is_seen_and_never_gives_wrong_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_log(folder.path());
    let whole = fs::read(&path).unwrap();
    let good = frames(&path).0;
    assert!(!try_all(&path, &good, "whole", 0));
    for at in 0..whole.len() {
        for change in [1 << (at % 8), 0xff] {
            let mut bad = whole.clone();
            bad[at] ^= change;
            fs::write(&path, bad).unwrap();
            let error = content_digest(&path).expect_err("a flip must be seen");
            assert!(error.is_damage(), "byte {at}: {error}");
        }
        // The other readers share all but their last step.
        if at % 4 == 0 {
            try_all(&path, &good, "byte inverted", at);
        }
    }
}

/// As after a kill: no index and no check sum of the whole.
#[test]
fn a_flip_in_an_unfinished_log_never_gives_wrong_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_log(folder.path());
    let whole = fs::read(&path).unwrap();
    let good = frames(&path).0;
    let end = whole
        .windows(9)
        .position(|w| w == [0x0f, 4, 0, 0, 0, 0, 0, 0, 0]);
    let cut = &whole[..end.expect("a record for the end of the data")];
    for at in 0..cut.len() {
        let mut bad = cut.to_vec();
        bad[at] ^= 1 << (at % 8);
        fs::write(&path, bad).unwrap();
        assert!(
            try_all(&path, &good, "byte flipped", at),
            "byte {at} goes unseen"
        );
    }
}

#[test]
fn any_cut_and_any_zeroed_tail_is_damage() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_log(folder.path());
    let whole = fs::read(&path).unwrap();
    let good = frames(&path).0;
    for at in 0..whole.len() {
        fs::write(&path, &whole[..at]).unwrap();
        assert!(try_all(&path, &good, "cut at", at), "cut at {at}");
    }
    for at in (0..whole.len()).step_by(7) {
        let zeroed = [&whole[..at], &vec![0; whole.len() - at]].concat();
        fs::write(&path, zeroed).unwrap();
        assert!(try_all(&path, &good, "zeros from", at), "zeros from {at}");
    }
}

/// A loss of power leaves a file of zeros, or one with nothing but its first bytes: it holds no
/// frame. Another wrong beginning is damage.
#[test]
fn a_segment_without_a_beginning_is_left_out_and_a_spoiled_one_is_damage() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_log(folder.path());
    let whole = fs::read(&path).unwrap();
    let second = folder.path().join("segment-001.mcap");
    for blank in [
        &[][..],
        &[0; 4096],
        &whole[..8],
        &[&whole[..8], &[0; 99][..]].concat(),
    ] {
        fs::write(&second, blank).unwrap();
        let listed = segments(folder.path()).unwrap();
        assert_eq!(listed.len(), 1, "{} bytes", blank.len());
    }
    let zeroed = [&[0; 8][..], &whole[8..]].concat();
    let mut flipped = whole.clone();
    flipped[3] ^= 4;
    let start = b"segment".as_slice();
    let mut renamed = whole.clone();
    let at = whole.windows(start.len()).position(|w| w == start).unwrap();
    renamed[at] = b'S';
    for spoiled in [&zeroed[..], &flipped, &renamed, b"PK\x03\x04 another file"] {
        fs::write(&second, spoiled).unwrap();
        let error = segments(folder.path()).unwrap_err();
        assert!(error.is_damage(), "{error}");
    }
}

#[cfg(unix)]
#[test]
fn what_cannot_be_read_is_not_damage() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("segment-000.mcap");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    let out = folder.path().join("out");
    let missing = folder.path().join("missing");
    let errors = [
        segments(folder.path()).unwrap_err(),
        info(&pipe).unwrap_err(),
        content_digest("/dev/zero".as_ref()).unwrap_err(),
        recover(&pipe, &out).unwrap_err(),
        read_frames(&missing).map(drop).unwrap_err(),
        recover(&missing, &out).unwrap_err(),
        content_digest(folder.path()).unwrap_err(),
    ];
    for error in errors {
        assert!(
            matches!(error, LogError::Io(_)) && !error.is_damage(),
            "{error}"
        );
        let source = std::error::Error::source(&error).expect("a source");
        assert!(source.is::<std::io::Error>(), "{error}");
    }
    assert!(!out.exists());
}

#[test]
fn recover_writes_nothing_but_a_log_with_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = write_log(folder.path());
    let whole = fs::read(&path).unwrap();
    let (cut, out) = (
        folder.path().join("cut.mcap"),
        folder.path().join("out.mcap"),
    );
    let hard = folder.path().join("hard.mcap");
    fs::write(&cut, &whole[..whole.len() - 40]).unwrap();
    fs::hard_link(&cut, &hard).unwrap();
    let roundabout = folder
        .path()
        .join("..")
        .join(folder.path().file_name().unwrap());
    for same in [&cut, &hard, &roundabout.join("cut.mcap")] {
        let error = recover(&cut, same).unwrap_err();
        assert!(matches!(error, LogError::NotReplaced { .. }), "{error}");
        assert_eq!(fs::read(&cut).unwrap(), whole[..whole.len() - 40]);
    }
    fs::write(&out, "my notes").unwrap();
    let error = recover(&cut, &out).unwrap_err();
    assert!(matches!(error, LogError::NotReplaced { .. }), "{error}");
    assert_eq!(fs::read(&out).unwrap(), b"my notes");

    // Empty files and logs are replaced; a failure leaves the old one.
    fs::write(&out, "").unwrap();
    assert_eq!(recover(&cut, &out).unwrap().frames, 3);
    assert_eq!(recover(&cut, &out).unwrap().last_time, frame(58).time);
    let saved = fs::read(&out).unwrap();
    let entries = fs::read_dir(folder.path()).unwrap().count();
    for nothing in [&whole[..300], &whole[..8], &[], b"PK\x03\x04 another file"] {
        fs::write(&cut, nothing).unwrap();
        let error = recover(&cut, &out).unwrap_err();
        assert!(error.is_damage(), "{error}");
        assert_eq!(fs::read(&out).unwrap(), saved);
        let new = folder.path().join("new.mcap");
        assert!(recover(&cut, &new).unwrap_err().is_damage());
        assert!(!new.exists());
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), entries);
}
