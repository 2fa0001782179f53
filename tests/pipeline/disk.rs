//! Full and read-only disks: a clear error, and nothing good is lost.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::program::{Ended, Program, members};

const STATE: &str = "state.checkpoint";

/// A file system mounted for one test; `None` where that is not allowed.
struct Mount(PathBuf);

impl Mount {
    fn new(folder: PathBuf, arguments: &[&str]) -> Option<Self> {
        let done = Command::new("mount").args(arguments).arg(&folder).output();
        done.is_ok_and(|done| done.status.success())
            .then_some(Mount(folder))
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// Files of at most `kilobytes`: writes beyond fail as on a full disk, for everybody.
fn limited(program: &Program, kilobytes: u32, arguments: &str) -> Ended {
    let binary = env!("CARGO_BIN_EXE_coronet");
    // Without the signal, the write itself fails.
    let script = format!("trap '' XFSZ; ulimit -f {kilobytes}; exec {binary} {arguments}");
    let mut command = Command::new("bash");
    command
        .current_dir(program.folder.path())
        .arg("-c")
        .arg(script);
    command.output().unwrap().into()
}

#[test]
fn a_full_disk_is_an_error_that_loses_nothing() {
    let program = Program::new();
    let digests = members(&program.run(&["--until", "relax"]), "digest");
    let scene = "run tiny.toml --set frames.interval='0.02 ms'";
    let ended = limited(&program, 40, scene);
    ended.badly(5, &["artifacts/impact"]);
    program.call(&["verify"]).well();
    let again = program.run(&["--until", "relax"]);
    assert_eq!(members(&again, "digest"), digests);
    let arguments = [
        "run",
        "tiny.toml",
        "--json",
        "--set",
        "frames.interval=0.02 ms",
    ];
    let objects = program.call(&arguments).well().objects();
    let fresh = Program::new();
    let expected = fresh.run(&["--set", "frames.interval=0.02 ms"]);
    assert_eq!(program.fingerprint(&objects), fresh.fingerprint(&expected));
}

#[test]
fn a_full_file_system_is_an_error_that_loses_nothing() {
    let program = Program::new();
    let folder = program.path("artifacts");
    fs::create_dir(&folder).unwrap();
    let Some(_mount) = Mount::new(folder.clone(), &["-t", "tmpfs", "-o", "size=400k", "tmpfs"])
    else {
        eprintln!("no right to mount: only the limit on file sizes is tested");
        return;
    };
    let digests = members(&program.run(&["--until", "pack"]), "digest");
    fs::write(folder.join("filler"), vec![0; 300 << 10]).unwrap();
    let ended = program.call(&["run", "tiny.toml", "--set", "frames.interval=0.02 ms"]);
    ended.badly(5, &["artifacts", "No space left"]);
    fs::remove_file(folder.join("filler")).unwrap();
    let found = members(&program.run(&["--until", "relax"]), "digest");
    for (job, digest) in digests {
        assert_eq!(found[&job], digest);
    }
    program.call(&["verify"]).well();
}

#[test]
fn a_read_only_store_serves_what_it_has_and_refuses_the_rest() {
    let program = Program::new();
    program.run(&[]);
    let folder = program.path("artifacts");
    let source = folder.display().to_string();
    let Some(_bind) = Mount::new(folder.clone(), &["--bind", &source]) else {
        eprintln!("no right to mount");
        return;
    };
    let remount = Command::new("mount")
        .args(["-o", "remount,ro,bind"])
        .arg(&folder)
        .status();
    assert!(remount.unwrap().success());
    let statuses = members(&program.run(&[]), "status");
    assert!(
        statuses.values().all(|status| status == "fresh"),
        "{statuses:?}"
    );
    let ended = program.call(&["run", "tiny.toml", "--set", "impact.end=5 ms"]);
    ended.badly(5, &["Read-only file system"]);
    program.call(&["verify"]).well();
    program.call(&["gc", "--dry-run"]).well();
    program
        .call(&["gc", "--forget", "tiny"])
        .badly(5, &["Read-only"]);
    assert!(program.latest("impact").join(STATE).exists());
}

#[test]
fn a_folder_that_is_no_store_is_not_damaged() {
    let program = Program::new();
    std::fs::create_dir_all(program.path("papers/old")).unwrap();
    let verify = program.call(&["verify", "--artifacts", "papers"]);
    verify.badly(2, &["papers", "is not a store", "--artifacts"]);
}
