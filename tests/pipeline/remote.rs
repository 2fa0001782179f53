//! One remote store for several stores: what arrives is what was made, or is made again.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::Ordering;

use coronet::pipeline::remote::{Folder, Put, Remote, RemoteError};
use coronet::pipeline::*;
use tempfile::TempDir;

use crate::laboratory::{FILE, Lab, Notes, grow, pipeline, shared, store, watched, words};

/// A folder as remote store, with the results of one run in it.
struct Shared {
    folder: TempDir,
    made: Vec<Report>,
    _first: (TempDir, Store),
}

impl Shared {
    fn new() -> Shared {
        let folder = tempfile::tempdir().unwrap();
        let (home, first) = store();
        let objects = Folder::new(folder.path());
        let (lab, notes) = (Lab::default(), Notes::default());
        let remote = Remote::new(&objects);
        let made = shared(&first, &pipeline(&lab, 1, 0), &notes, Some(&remote)).unwrap();
        assert_eq!(words(&made), ["ran"; 3]);
        assert!(notes.0.lock().unwrap().is_empty());
        Shared {
            folder,
            made,
            _first: (home, first),
        }
    }

    /// A run in a new store: what its stages did, and the warnings.
    fn again(&self) -> (Vec<&'static str>, Vec<String>) {
        let (_home, second) = store();
        let objects = Folder::new(self.folder.path());
        let (lab, notes) = (Lab::default(), Notes::default());
        let remote = Remote::new(&objects);
        let reports = shared(&second, &pipeline(&lab, 1, 0), &notes, Some(&remote)).unwrap();
        for (report, made) in reports.iter().zip(&self.made) {
            assert_eq!(report.stamp.digest, made.stamp.digest);
            assert!(!report.folder.join("work").exists());
        }
        let ran = words(&reports)
            .iter()
            .filter(|word| **word == "ran")
            .count();
        assert_eq!(lab.calls.load(Ordering::Relaxed) as usize, ran);
        let findings = verify::verify(&second, &mut |_| {}).unwrap();
        assert!(findings.iter().all(|finding| finding.problems.is_empty()));
        assert_eq!(findings.len(), 3);
        (words(&reports), notes.0.into_inner().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The stamp of `grow drop` there.
    fn stamp(&self) -> PathBuf {
        self.path(&format!(
            "results/grow/{}.json",
            self.made[0].stamp.key.hex()
        ))
    }

    /// The object of its checkpoint.
    fn file(&self) -> PathBuf {
        let sha256 = self.made[0].stamp.outputs[0].sha256.unwrap();
        self.path(&format!("files/{}", sha256.hex()))
    }

    /// Puts another stamp there, with a valid seal.
    fn forge(&self, change: impl Fn(&mut Stamp)) {
        let mut stamp = self.made[0].stamp.clone();
        change(&mut stamp);
        let place = tempfile::tempdir().unwrap();
        stamp.write(place.path()).unwrap();
        fs::copy(place.path().join("stamp.json"), self.stamp()).unwrap();
    }
}

#[test]
fn a_second_store_computes_nothing() {
    let shared = Shared::new();
    let (words, warnings) = shared.again();
    assert_eq!(words, ["fetched"; 3]);
    assert!(warnings.is_empty(), "{warnings:?}");
}

/// Spoils what is there of one result: it is made again, told, and good there afterwards.
fn is_made_again(what: &str, word: &str, spoil: impl Fn(&Shared)) {
    let shared = Shared::new();
    let victim = shared.path("../victim");
    let before = fs::read(&victim).ok();
    spoil(&shared);
    let (words, warnings) = shared.again();
    assert_eq!(words, ["ran", "fetched", "fetched"], "{what}");
    assert_eq!(warnings.len(), 1, "{what}: {warnings:?}");
    assert!(warnings[0].contains(word), "{what}: {warnings:?}");
    assert!(warnings[0].contains("made here"), "{what}: {warnings:?}");
    assert_eq!(fs::read(&victim).ok(), before, "{what}");
    let (words, warnings) = shared.again();
    assert_eq!(words, ["fetched"; 3], "{what}");
    assert!(warnings.is_empty(), "{what}: {warnings:?}");
}

/// Changes the bytes of a file.
pub fn change(path: &Path, change: impl Fn(&mut Vec<u8>)) {
    let mut bytes = fs::read(path).unwrap();
    change(&mut bytes);
    fs::write(path, bytes).unwrap();
}

#[test]
fn a_bad_file_is_made_again() {
    is_made_again("a flipped bit", "SHA-256", |shared| {
        change(&shared.file(), |bytes| bytes[100] ^= 1);
    });
    is_made_again("cut off", "SHA-256", |shared| {
        change(&shared.file(), |bytes| bytes.truncate(70));
    });
    is_made_again("empty", "SHA-256", |shared| {
        change(&shared.file(), Vec::clear)
    });
    is_made_again("missing", "is missing", |shared| {
        fs::remove_file(shared.file()).unwrap();
    });
    is_made_again("too long", "is longer than", |shared| {
        change(&shared.file(), |bytes| bytes.push(0));
    });
    is_made_again("a pipe", "not a regular file", |shared| {
        fs::remove_file(shared.file()).unwrap();
        let made = Command::new("mkfifo").arg(shared.file()).status();
        assert!(made.unwrap().success());
    });
    is_made_again("another object", "SHA-256", |shared| {
        let other = shared.made[1].stamp.outputs[0].sha256.unwrap().hex();
        fs::copy(shared.path(&format!("files/{other}")), shared.file()).unwrap();
    });
}

#[test]
fn a_bad_stamp_is_made_again() {
    let cases: [(&str, &[u8]); 4] = [
        ("is damaged", b""),
        ("is damaged", b"{}"),
        ("is damaged", b"\xff\xfe"),
        ("is longer than", &[b'['; (16 << 20) + 1]),
    ];
    for (word, bytes) in cases {
        is_made_again("garbage", word, |shared| {
            fs::write(shared.stamp(), bytes).unwrap();
        });
    }
    is_made_again("of another key", "belongs to grow pool", |shared| {
        let other = shared.made[1].stamp.key.hex();
        let other = shared.path(&format!("results/grow/{other}.json"));
        fs::copy(other, shared.stamp()).unwrap();
    });
    is_made_again("that contradicts itself", "contradicts itself", |shared| {
        shared.forge(|stamp| stamp.digest = shared.made[1].stamp.digest);
    });
    is_made_again("of other settings", "contradicts itself", |shared| {
        shared.forge(|stamp| stamp.settings[0].canonical = "00".into());
    });
    is_made_again("with a wrong digest", "it holds", |shared| {
        let other = shared.made[1].stamp.digest;
        shared.forge(|stamp| (stamp.outputs[0].digest, stamp.digest) = (other, other));
    });
    is_made_again("with a wrong SHA-256", "(number.checkpoint)", |shared| {
        let other = shared.made[1].stamp.outputs[0].sha256;
        shared.forge(|stamp| stamp.outputs[0].sha256 = other);
    });
    is_made_again("without a SHA-256", "has no SHA-256", |shared| {
        shared.forge(|stamp| stamp.outputs[0].sha256 = None);
    });
    is_made_again("with a huge size", "claims", |shared| {
        shared.forge(|stamp| stamp.outputs[1].bytes = 1 << 62);
    });
    is_made_again(
        "with a size that is too small",
        "is longer than",
        |shared| {
            shared.forge(|stamp| stamp.outputs[0].bytes -= 1);
        },
    );
}

#[test]
fn names_from_elsewhere_stay_inside() {
    for name in [
        "../victim",
        "../../../victim",
        "a/../../victim",
        "/tmp/victim",
        "",
        ".",
        "a\\b",
        "a\n",
        ".hidden",
        "a/.hidden",
        "lock",
        "work/out",
        "stamp.json",
        "stamp.json.bad-1",
        FILE,
    ] {
        is_made_again(name, "", |shared| {
            shared.forge(|stamp| stamp.outputs[1].file = name.into());
        });
    }
}

#[test]
fn links_are_not_followed() {
    let outside = tempfile::tempdir().unwrap();
    let whole = outside.path().join("whole");
    // Even if it leads to the right bytes: they can change while they are read.
    for path in [Shared::file, Shared::stamp] {
        let shared = Shared::new();
        fs::rename(path(&shared), &whole).unwrap();
        symlink(&whole, path(&shared)).unwrap();
        let (words, warnings) = shared.again();
        assert_eq!(words, ["ran", "fetched", "fetched"]);
        assert!(warnings[0].contains("symbolic link"), "{warnings:?}");
    }
}

#[test]
fn a_folder_that_is_not_there_is_told_once() {
    let mut shared = Shared::new();
    shared.folder = tempfile::tempdir().unwrap();
    fs::remove_dir(shared.folder.path()).unwrap();
    let (words, warnings) = shared.again();
    assert_eq!(words, ["ran"; 3]);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("there is no folder"), "{warnings:?}");
    assert!(warnings[0].contains("goes on without it"), "{warnings:?}");
    assert!(!shared.folder.path().exists());
}

#[test]
fn what_is_half_made_here_goes_on_if_nothing_arrives() {
    let (_home, here) = store();
    let (lab, notes) = (Lab::default(), Notes::default());
    lab.interrupt.store(true, Ordering::Relaxed);
    watched(&here, &pipeline(&lab, 1, 0), &notes).unwrap_err();
    lab.interrupt.store(false, Ordering::Relaxed);
    let folder = tempfile::tempdir().unwrap();
    let objects = Folder::new(folder.path());
    let remote = Remote::new(&objects);
    let reports = shared(&here, &pipeline(&lab, 1, 0), &notes, Some(&remote)).unwrap();
    assert_eq!(words(&reports), ["fresh", "fresh", "resumed"]);
}

/// An equal input can come from another key here: the result is the same and names that one.
#[test]
fn a_result_names_the_inputs_of_its_store() {
    let there = Shared::new();
    let (_home, here) = store();
    let (lab, notes) = (Lab::default(), Notes::default());
    let objects = Folder::new(there.folder.path());
    let remote = Remote::new(&objects);
    let mut other = pipeline(&lab, 1, 0);
    other.jobs[0] = grow(&lab, "drop", 1, 5);
    let reports = shared(&here, &other, &notes, Some(&remote)).unwrap();
    assert_eq!(words(&reports), ["ran", "fetched", "fetched"]);
    assert_eq!(reports[2].stamp.inputs[0].key, reports[0].stamp.key);
    assert_ne!(reports[2].stamp.inputs[0].key, there.made[0].stamp.key);
    assert_eq!(reports[2].stamp.key, there.made[2].stamp.key);
}

/// Two results of one key: what was there first stays, and a run here is not disturbed.
#[test]
fn another_result_of_the_same_key_is_told_and_not_put() {
    let there = Shared::new();
    let before = fs::read(there.stamp()).unwrap();
    let (_home, here) = store();
    let (lab, notes) = (Lab::default(), Notes::default());
    lab.drift.store(3, Ordering::Relaxed);
    let made = watched(&here, &pipeline(&lab, 1, 0), &notes).unwrap();
    let objects = Folder::new(there.folder.path());
    let remote = Remote::new(&objects);
    let error = remote.put(&made[0].folder, &made[0].stamp).unwrap_err();
    assert!(matches!(error, RemoteError::Bad { .. }), "{error}");
    assert!(error.to_string().contains("as here"), "{error}");
    assert_eq!(fs::read(there.stamp()).unwrap(), before);
}

#[test]
fn what_another_put_is_left_or_mended_as_a_whole() {
    let there = Shared::new();
    let (_home, here) = store();
    let (lab, notes) = (Lab::default(), Notes::default());
    let made = watched(&here, &pipeline(&lab, 1, 0), &notes).unwrap();
    // As of a machine whose report reads otherwise.
    let mut own = made[0].stamp.clone();
    let report = made[0].folder.join("report.html");
    fs::write(&report, "own").unwrap();
    own.outputs.push(stamp::OutputStamp {
        file: "report.html".into(),
        bytes: 3,
        digest: content::content(&report).unwrap(),
        sha256: None,
        counted: false,
    });
    own.write(&made[0].folder).unwrap();
    let objects = Folder::new(there.folder.path());
    let remote = Remote::new(&objects);
    let files = || fs::read_dir(there.path("files")).unwrap().count();
    let before = files();
    assert_eq!(remote.put(&made[0].folder, &own).unwrap(), Put::Known);
    assert_eq!(files(), before);
    fs::remove_file(there.file()).unwrap();
    assert_eq!(remote.put(&made[0].folder, &own).unwrap(), Put::New);
    assert_eq!(files(), before + 1);
}

#[test]
fn many_at_once_put_one_result() {
    let folder = tempfile::tempdir().unwrap();
    let digests = || {
        let (_home, here) = store();
        let (lab, notes) = (Lab::default(), Notes::default());
        let objects = Folder::new(folder.path());
        let remote = Remote::new(&objects);
        let reports = shared(&here, &pipeline(&lab, 1, 0), &notes, Some(&remote)).unwrap();
        let warnings = notes.0.into_inner().unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        let digests = reports.iter().map(|report| report.stamp.digest);
        digests.collect::<Vec<_>>()
    };
    let all: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(digests)).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert!(all.windows(2).all(|pair| pair[0] == pair[1]));
    let results = ["results/grow", "results/sum"].map(|name| folder.path().join(name));
    let count = |folder: &PathBuf| fs::read_dir(folder).unwrap().count();
    assert_eq!(results.each_ref().map(count), [2, 1]);
}
