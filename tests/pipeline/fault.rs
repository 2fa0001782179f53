//! Damaged, foreign and hostile files: a clear error or a rerun.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::{Program, members};

const STATE: &str = "state.checkpoint";
const BODY: &str = "body.checkpoint";

/// Ways to spoil a checkpoint of at least 200 bytes.
fn spoiled(good: &[u8], other: &[u8]) -> Vec<(&'static str, Vec<u8>)> {
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = good.to_vec();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        file
    };
    let flip = |at: usize| changed(at, &[good[at] ^ 0x10]);
    vec![
        ("empty", Vec::new()),
        ("cut in the magic", good[..5].to_vec()),
        ("cut in the header", good[..100].to_vec()),
        ("cut in an array", good[..good.len() - 40].to_vec()),
        ("longer", [good, b"more"].concat()),
        ("flipped in the magic", flip(1)),
        ("flipped in the header", flip(90)),
        ("flipped in an array", flip(good.len() - 9)),
        ("newer version", changed(8, &99u32.to_le_bytes())),
        ("huge header", changed(12, &u64::MAX.to_le_bytes())),
        (
            "huge text in the header",
            changed(52, &(1u64 << 50).to_le_bytes()),
        ),
        (
            "something else",
            b"PK\x03\x04 no checkpoint at all".repeat(40),
        ),
        ("zeros", vec![0; good.len()]),
        ("another checkpoint", other.to_vec()),
    ]
}

#[test]
fn a_spoiled_result_is_kept_aside_and_made_anew() {
    let program = Program::new();
    let first = program.run(&["--until", "calibrate"]);
    let digests = members(&first, "digest");
    let path = program.latest("relax-drop").join(BODY);
    let good = fs::read(&path).unwrap();
    let other = fs::read(program.latest("relax-pool").join(BODY)).unwrap();
    let cases = spoiled(&good, &other);
    for (number, (name, bytes)) in cases.iter().enumerate() {
        fs::write(&path, bytes).unwrap();
        // Calibration reads the body, so even damage that a glance does not see is found.
        let calibration = program.latest("calibrate");
        fs::remove_dir_all(calibration).unwrap();
        let arguments = ["run", "tiny.toml", "--json", "--until", "calibrate"];
        let ended = program.call(&arguments);
        ended.no_panic();
        let objects = ended.well().objects();
        assert_eq!(members(&objects, "digest"), digests, "{name}");
        let kept = path.with_file_name(format!("{BODY}.bad-{}", number + 1));
        assert_eq!(&fs::read(kept).unwrap(), bytes, "{name}");
        assert_eq!(fs::read(&path).unwrap(), good, "{name}");
    }
}

#[test]
fn a_spoiled_checkpoint_in_flight_is_passed_over() {
    let undisturbed = Program::new();
    let expected = undisturbed.fingerprint(&undisturbed.run(&[]));
    let program = Program::new();
    program.run(&["--until", "calibrate"]);
    let work = interrupted(&program);
    let other = fs::read(program.latest("relax-pool").join(BODY)).unwrap();
    let newest = newest_checkpoint(&work);
    let good = fs::read(&newest).unwrap();
    for (name, bytes) in spoiled(&good, &other) {
        // Whatever the last attempt made of it, start from the same folder.
        let copy = Program::new();
        copy_folder(program.folder.path(), copy.folder.path());
        let newest = copy.path("artifacts").join(
            newest
                .strip_prefix(program.path("artifacts").canonicalize().unwrap())
                .unwrap(),
        );
        fs::write(newest, bytes).unwrap();
        let ended = copy.call(&["run", "tiny.toml", "--json"]);
        ended.no_panic();
        assert!(ended.err.contains("is skipped"), "{name}: {}", ended.err);
        assert_eq!(
            copy.fingerprint(&ended.well().objects()),
            expected,
            "{name}"
        );
    }
}

#[test]
fn a_spoiled_segment_of_the_log_means_a_new_start() {
    let undisturbed = Program::new();
    let expected = undisturbed.fingerprint(&undisturbed.run(&[]));
    let program = Program::new();
    program.run(&["--until", "calibrate"]);
    let work = interrupted(&program);
    let segment = work.join("segment-000.mcap");
    let bytes = fs::read(&segment).unwrap();
    // So early that the frame at t = 0 is lost, whatever came after it.
    fs::write(&segment, &bytes[..64]).unwrap();
    let ended = program.call(&["run", "tiny.toml", "--json"]);
    ended.no_panic();
    assert!(
        ended.err.contains("starting from the beginning"),
        "{}",
        ended.err
    );
    assert_eq!(program.fingerprint(&ended.well().objects()), expected);
}

/// Stops the impact of `program` on its way; returns its work folder.
fn interrupted(program: &Program) -> PathBuf {
    let mut child = program.start(&["run", "tiny.toml", "--json"]);
    let work = program.in_flight(&mut child);
    child.kill().unwrap();
    child.wait().unwrap();
    work
}

fn newest_checkpoint(work: &Path) -> PathBuf {
    let entries = fs::read_dir(work)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let checkpoints = entries.filter(|path| path.extension().is_some_and(|e| e == "checkpoint"));
    let number = |path: &PathBuf| {
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        stem.rsplit('-').next().unwrap().parse::<u64>().unwrap()
    };
    checkpoints.max_by_key(number).unwrap()
}

fn copy_folder(from: &Path, to: &Path) {
    let done = Command::new("cp")
        .arg("-a")
        .arg(from.join("."))
        .arg(to)
        .status()
        .unwrap();
    assert!(done.success());
}

#[test]
fn a_log_that_cannot_be_trusted_is_made_anew_before_it_is_evaluated() {
    let program = Program::new();
    let expected = program.fingerprint(&program.run(&[]));
    let path = program.latest("impact").join("frames.mcap");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, &bytes).unwrap();
    fs::remove_dir_all(program.latest("post")).unwrap();
    let ended = program.call(&["run", "tiny.toml", "--json"]);
    ended.no_panic();
    assert!(ended.err.contains("frames.mcap.bad-1"), "{}", ended.err);
    assert_eq!(program.fingerprint(&ended.well().objects()), expected);
}

#[test]
fn verification_finds_a_flipped_bit_and_the_next_run_repairs_it() {
    let program = Program::new();
    let expected = program.fingerprint(&program.run(&[]));
    program.call(&["verify"]).well();
    let path = program.latest("impact").join(STATE);
    let mut bytes = fs::read(&path).unwrap();
    let end = bytes.len();
    bytes[end - 9] ^= 1;
    fs::write(&path, &bytes).unwrap();
    program.call(&["verify"]).badly(4, &["damaged files: "]);
    assert_eq!(program.fingerprint(&program.run(&[])), expected);
    program.call(&["verify"]).well();
}

#[test]
fn show_and_export_refuse_what_is_spoiled() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let path = program.latest("pack-drop").join(BODY);
    let good = fs::read(&path).unwrap();
    let other = fs::read(program.latest("pack-pool").join(BODY)).unwrap();
    for (name, bytes) in spoiled(&good, &other) {
        let file = program.path("spoiled.checkpoint");
        fs::write(&file, bytes).unwrap();
        for arguments in [
            vec!["show", "spoiled.checkpoint"],
            vec!["export", "spoiled.checkpoint", "--to", "csv"],
        ] {
            let ended = program.call(&arguments);
            ended.no_panic();
            let fine = name == "another checkpoint";
            assert_eq!(ended.code == Some(0), fine, "{name}: {}", ended.err);
            assert!(
                fine || ended.err.contains("spoiled.checkpoint"),
                "{name}: {}",
                ended.err
            );
        }
    }
}

#[test]
fn wrong_arguments_and_files_end_with_code_2() {
    let program = Program::new();
    program
        .call(&["run", "tiny.toml", "--set", "impact.emd=1 s"])
        .badly(2, &["impact.end"]);
    program
        .call(&["run", "tiny.toml", "--until", "impakt"])
        .badly(
            2,
            &["impakt", "it has pack, relax, calibrate, impact, post"],
        );
    for command in [
        &["show", "nobody"][..],
        &["export", "nobody", "--to", "csv"],
    ] {
        program
            .call(command)
            .badly(2, &["\"nobody\"", "a name in artifacts/latest"]);
    }
    program
        .call(&["run", "missing.toml"])
        .badly(2, &["missing.toml"]);
    program
        .call(&["run", "--threads", "0"])
        .badly(2, &["threads"]);
    program
        .call(&["gc", "--forget", "nobody"])
        .badly(2, &["there is no store"]);
    program.call(&["verify"]).badly(2, &["there is no store"]);
    program.run(&["--until", "pack"]);
    program
        .call(&["gc", "--forget", "nobody"])
        .badly(2, &["nobody"]);
    program
        .call(&["show", "tiny.toml"])
        .badly(2, &["tiny.toml"]);
}

#[test]
fn a_store_that_cannot_be_a_folder_is_an_error() {
    let program = Program::new();
    fs::write(program.path("file"), "").unwrap();
    let ended = program.call(&["run", "tiny.toml", "--artifacts", "file/artifacts"]);
    ended.badly(5, &["file/artifacts"]);
}

#[test]
fn what_no_memory_holds_is_refused_before_it_starts() {
    let program = Program::new();
    // 2e9 particles of more than a kilobyte each.
    let fine = ["tiny.toml", "--set", "pack.spacing=0.15 um"];
    for command in [&["plan"][..], &["plan", "--json"], &["run"]] {
        let ended = program.call(&[command, &fine[..]].concat());
        ended.badly(2, &["pack pool", "TB of memory", "pack.spacing"]);
    }
    assert!(!program.path("artifacts/pack").exists());
}
