//! `show`, `export` and `recover` on files that are damaged, foreign or in the wrong place.

use std::fs;

use coronet::particle::Frame;
use coronet::record::Checkpoint;
use coronet::record::log::{LogBody, LogError, LogSetup, LogWriter, recover_unless};
use coronet::scene::{Colouring, Dimension};
use serde_json::json;

use crate::program::Program;

/// Writes `count` frames of two particles to `segment-<number>.mcap`.
fn write_log(program: &Program, number: u32, count: usize) -> Vec<u8> {
    let body = LogBody {
        name: "drop".into(),
        colour: [1, 2, 3],
    };
    let setup = LogSetup {
        bodies: vec![body],
        wall: Default::default(),
        spacing: 1e-3,
        dimension: Dimension::Three,
        time_scale: 1.0,
        contact: None,
        colour: Colouring::Body,
        speed_scale: 1.0,
        pressure_scale: 1.0,
        scene_text: String::new(),
        provenance: Vec::new(),
    };
    let mut log = LogWriter::create(program.folder.path(), number, None, &setup).unwrap();
    for k in 0..count {
        let reals = || vec![k as f32, 0.5];
        let frame = Frame {
            time: k as f64 * 0.5,
            id: vec![0, 1],
            body: vec![0, 0],
            position: [reals(), reals(), reals()],
            velocity: [reals(), reals(), reals()],
            pressure: reals(),
            density: reals(),
            surface: vec![0, 1],
            mass: Vec::new(),
            scalars: vec![("mass_kg".into(), 1.0)],
        };
        log.frame(frame).unwrap();
        log.flush(0.5 * k as f64).unwrap().wait().unwrap();
    }
    let path = log.path().to_path_buf();
    log.finish().unwrap();
    fs::read(path).unwrap()
}

#[test]
fn recover_saves_frames_or_fails_and_never_writes_over_a_file() {
    let program = Program::new();
    let whole = write_log(&program, 0, 4);
    let cut = &whole[..whole.len() - 30];
    let log = program.path("cut.mcap");
    fs::write(&log, cut).unwrap();
    let read = |name: &str| fs::read(program.path(name)).unwrap();

    let saved = program.call(&["recover", "cut.mcap"]).well();
    assert!(
        saved.out.contains("4 frames up to t = 1.5 s"),
        "{}",
        saved.out
    );
    let saved = program.call(&["recover", "cut.mcap", "--json"]).well();
    let expected = json!({"log": "cut-recovered.mcap", "frames": 4, "last_s": 1.5,
        "damage": "it ends too early"});
    assert_eq!(saved.objects(), [expected]);

    fs::hard_link(&log, program.path("hard.mcap")).unwrap();
    fs::write(program.path("notes.txt"), "notes").unwrap();
    for taken in ["cut.mcap", "./cut.mcap", "hard.mcap", "notes.txt"] {
        let ended = program.call(&["recover", "cut.mcap", taken]);
        ended.badly(2, &[taken, "name another file"]);
    }
    fs::create_dir(program.path("result")).unwrap();
    fs::write(program.path("result/stamp.json"), "{}").unwrap();
    let ended = program.call(&["recover", "cut.mcap", "result/frames.mcap"]);
    ended.badly(2, &["result/frames.mcap", "that of a result"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("cut.mcap", program.path("link.mcap")).unwrap();
        program
            .call(&["recover", "cut.mcap", "link.mcap"])
            .badly(2, &["link.mcap"]);
        assert!(program.path("link.mcap").is_symlink());
    }
    assert_eq!(read("cut.mcap"), cut);
    assert_eq!(read("notes.txt"), b"notes");

    let before = fs::read_dir(program.folder.path()).unwrap().count();
    for nothing in [&whole[..200], b"no log at all", b""] {
        fs::write(&log, nothing).unwrap();
        let ended = program.call(&["recover", "cut.mcap", "new.mcap"]);
        ended.badly(4, &["cut.mcap", "Run the pipeline again"]);
        assert_eq!(fs::read_dir(program.folder.path()).unwrap().count(), before);
    }
    program
        .call(&["recover", "missing.mcap"])
        .badly(2, &["missing.mcap"]);
    // One that was asked to stop leaves nothing, either.
    fs::write(&log, &whole).unwrap();
    let stopped = recover_unless(&true.into(), &log, &program.path("new.mcap"));
    assert!(matches!(stopped, Err(LogError::Stopped)));
    assert_eq!(fs::read_dir(program.folder.path()).unwrap().count(), before);
}

#[test]
fn an_export_over_a_longer_one_leaves_no_stale_frame() {
    let program = Program::new();
    write_log(&program, 0, 26);
    write_log(&program, 1, 2);
    let export = |log: &str| program.call(&["export", log, "--to", "vtk"]).well();
    export("segment-000.mcap");
    fs::write(program.path("export/mine.vtp"), "mine").unwrap();
    let second = export("segment-001.mcap");
    assert!(
        second.out.contains("27 files of an earlier export"),
        "{}",
        second.out
    );
    let entries = fs::read_dir(program.path("export")).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(
        names,
        [
            "coronet-export.json",
            "frame-00000.vtp",
            "frame-00001.vtp",
            "frames.pvd",
            "mine.vtp"
        ]
    );

    // A frame cannot be written: the exit code says so.
    fs::remove_file(program.path("export/frame-00001.vtp")).unwrap();
    fs::create_dir(program.path("export/frame-00001.vtp")).unwrap();
    let ended = program.call(&["export", "segment-001.mcap", "--to", "vtk"]);
    ended.badly(5, &["frame-00001.vtp"]);
    assert!(!program.path("export/frames.pvd").exists());
}

#[test]
fn damage_and_what_cannot_be_read_have_their_own_exit_codes() {
    let program = Program::new();
    let whole = write_log(&program, 0, 3);
    fs::write(program.path("bad.mcap"), &whole[..whole.len() / 2]).unwrap();
    fs::write(program.path("bad.checkpoint"), "no checkpoint").unwrap();
    fs::create_dir(program.path("empty")).unwrap();
    for name in ["bad.mcap", "bad.checkpoint"] {
        program.call(&["show", name]).badly(4, &[name]);
        program
            .call(&["export", name, "--to", "csv"])
            .badly(4, &[name]);
    }
    for name in ["missing.mcap", "missing"] {
        program.call(&["show", name]).badly(2, &[name]);
        program
            .call(&["export", name, "--to", "csv"])
            .badly(2, &[name]);
    }
    for name in ["empty", "tiny.toml", "/dev/null"] {
        program.call(&["show", name]).badly(2, &[name]);
    }
    #[cfg(unix)]
    for name in ["pipe.mcap", "pipe.checkpoint"] {
        let pipe = program.path(name);
        let made = std::process::Command::new("mkfifo").arg(pipe).status();
        assert!(made.unwrap().success());
        program
            .call(&["show", name])
            .badly(5, &[name, "not a regular file"]);
        program
            .call(&["export", name, "--to", "ply"])
            .badly(5, &[name, "not a regular file"]);
    }
}

/// JSON has no such texts; whatever is done with them, it is no panic.
#[cfg(unix)]
#[test]
fn a_path_that_is_not_unicode_does_not_panic() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let program = Program::new();
    let whole = write_log(&program, 0, 2);
    let name = |bytes: &[u8]| program.folder.path().join(OsStr::from_bytes(bytes));
    let (log, checkpoint) = (name(b"l\xff.mcap"), name(b"c\xff.checkpoint"));
    fs::write(&log, &whole[..whole.len() - 5]).unwrap();
    let written = Checkpoint::default().write(&checkpoint, 1);
    written.unwrap();
    for json in [&["--json"][..], &[]] {
        for (command, path) in [("show", &checkpoint), ("show", &log), ("recover", &log)] {
            let output = program.command(&[command]).arg(path).args(json).output();
            crate::program::Ended::from(output.unwrap()).no_panic();
        }
        let mut export = program.command(&["export", "--to", "csv", "--output"]);
        let output = export.arg(name(b"o\xff")).arg(&log).args(json).output();
        crate::program::Ended::from(output.unwrap()).no_panic();
    }
}
