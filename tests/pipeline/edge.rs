//! The edges of the program: what becomes of its output, signals, other users, links and names.

use std::fs;
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Ended, Program, TINY, hearing, install, members};

const RUN: &str = "run tiny.toml --threads 1";

/// Runs a line of bash in the folder of `program`; `coronet` is the program.
fn bash(program: &Program, line: &str) -> Ended {
    let binary = env!("CARGO_BIN_EXE_coronet");
    let script = format!("program='{binary}'; coronet() {{ \"$program\" \"$@\"; }}; {line}");
    let mut command = Command::new("bash");
    command.current_dir(program.folder.path());
    hearing(command.args(["-c", &script]))
        .output()
        .unwrap()
        .into()
}

/// As the user `nobody`; `None` if this process may not become one.
fn as_nobody(program: &Program, line: &str) -> Option<Ended> {
    // SAFETY: asks for a number.
    if unsafe { libc::geteuid() } != 0 {
        eprintln!("not root: other users are not tested");
        return None;
    }
    let binary = env!("CARGO_BIN_EXE_coronet");
    let copy = program.path("coronet");
    install(Path::new(binary), &copy);
    fs::set_permissions(program.folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
    let line = line.replace("coronet ", &format!("'{}' ", copy.display()));
    let mut command = Command::new("su");
    command.current_dir(program.folder.path());
    let arguments = ["-s", "/bin/bash", "nobody", "-c", &line];
    Some(command.args(arguments).output().unwrap().into())
}

fn mode(path: &Path, mode: u32) {
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
}

/// Gives the store to `nobody`, and all permissions to all.
fn open_to_all(program: &Program) {
    let done = bash(program, "chown -R nobody . && chmod -R a+rwX .");
    done.well();
}

#[test]
fn the_work_is_done_whatever_becomes_of_the_output() {
    let program = Program::new();
    let redirections = [
        ("| true; exit ${PIPESTATUS[0]}", 0),
        ("> /dev/full", 5),
        (">&-", 0),
        ("2>&-", 0),
        ("2>/dev/full", 0),
        ("2>&1 >/dev/null | true; exit ${PIPESTATUS[0]}", 0),
    ];
    for (number, (redirection, code)) in redirections.into_iter().enumerate() {
        let line = format!("coronet {RUN} --until calibrate --artifacts s{number} {redirection}");
        let ended = bash(&program, &line);
        assert_eq!(ended.code, Some(code), "{redirection}: {}", ended.err);
        assert!(program.path(&format!("s{number}/calibrate")).is_dir());
    }
    let checks = [
        (
            "coronet verify --artifacts s0 | true; exit ${PIPESTATUS[0]}",
            0,
        ),
        ("coronet verify --artifacts s0 > /dev/full", 5),
        ("coronet --help | true; exit ${PIPESTATUS[0]}", 0),
        ("coronet --help > /dev/full", 5),
        ("coronet show s0/latest/tiny > /dev/full", 5),
    ];
    for (line, code) in checks {
        assert_eq!(bash(&program, line).code, Some(code), "{line}");
    }
    let body = program.path("s0/latest/tiny/pack-drop/body.checkpoint");
    let mut bytes = fs::read(&body).unwrap();
    bytes[700] ^= 1;
    fs::write(&body, bytes).unwrap();
    let line = "coronet verify --artifacts s0 | true; exit ${PIPESTATUS[0]}";
    assert_eq!(bash(&program, line).code, Some(4));
}

#[test]
fn a_hang_up_that_is_ignored_stays_ignored() {
    let program = Program::new();
    // It listens before it makes the store.
    let line = "trap '' HUP; $program run tiny.toml --artifacts s --set impact.end='20 ms' & \
                for i in $(seq 3000); do [ -e s/store.json ] && break; sleep 0.01; done; \
                kill -HUP $!; wait $!";
    bash(&program, line).well();
    let heard = line
        .replace("trap '' HUP; ", "")
        .replace("--artifacts s", "--artifacts t")
        .replace("s/store.json", "t/store.json");
    // Without that, a hang-up stops the run after a checkpoint.
    assert_eq!(bash(&program, &heard).code, Some(130));
}

const STUDY: &str = r#"
title = "Long"
pipeline = "tiny.toml"
set = ["pack.spacing=0.1 mm", "impact.end=400 ms"]
[[axis]]
name = "speed"
key = "body.drop.velocity"
values = ["1 m/s", "1.1 m/s"]
[[figure]]
name = "depth"
column = "crater_depth_m"
"#;

#[test]
fn a_table_of_a_study_that_cannot_be_read_is_no_mistake_in_it() {
    let text = STUDY.replace("depth_m\"", "depth_m\"\nreference = \"table.csv\"");
    let program = Program::with("long.toml", &text);
    fs::write(program.path("table.csv"), "time_s,crater_depth_m\n0,0\n").unwrap();
    open_to_all(&program);
    mode(&program.path("table.csv"), 0);
    let Some(ended) = as_nobody(&program, "coronet study long.toml --look") else {
        return;
    };
    ended.badly(5, &["table.csv", "Permission denied"]);
    fs::remove_file(program.path("table.csv")).unwrap();
    let ended = as_nobody(&program, "coronet study long.toml --look").unwrap();
    ended.badly(2, &["table.csv", "No such file"]);
}

/// Processes whose command line holds `text`.
fn processes(text: &str) -> usize {
    let list = fs::read_dir("/proc").unwrap().flatten();
    let lines = list.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok());
    lines
        .filter(|line| {
            String::from_utf8_lossy(line)
                .replace('\0', " ")
                .contains(text)
        })
        .count()
}

#[test]
fn children_of_a_study_stop_with_it() {
    for signal in [libc::SIGTERM, libc::SIGKILL] {
        let program = Program::with("long.toml", STUDY);
        let store = program.path("store").display().to_string();
        let arguments = ["study", "long.toml", "--artifacts", &store];
        let mut child = program.start(&arguments);
        let run = format!("long-01 --artifacts {store}");
        while processes(&run) == 0 {
            assert!(child.try_wait().unwrap().is_none());
            std::thread::sleep(Duration::from_millis(5));
        }
        let pid = libc::pid_t::try_from(child.id()).unwrap();
        // SAFETY: the child was not waited for, so the number is still its own.
        assert_eq!(unsafe { libc::kill(pid, signal) }, 0);
        let ended = Ended::from(child.wait_with_output().unwrap());
        if signal == libc::SIGTERM {
            ended.badly(130, &["the same command continues"]);
        }
        let since = Instant::now();
        while processes(&run) > 0 {
            assert!(
                since.elapsed() < Duration::from_secs(30),
                "the point goes on"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn what_another_user_may_not_read_is_neither_damaged_nor_touched() {
    let program = Program::new();
    program.run(&[]);
    open_to_all(&program);
    let state = program.latest("impact").join("state.checkpoint");
    bash(
        &program,
        &format!("chown root {0} && chmod 600 {0}", state.display()),
    )
    .well();
    let Some(ended) = as_nobody(&program, "coronet verify") else {
        return;
    };
    ended.badly(5, &["files that cannot be read: 1"]);
    let ended = as_nobody(&program, &format!("coronet {RUN}")).unwrap();
    ended.badly(5, &["state.checkpoint", "Permission denied"]);
    assert!(state.exists());
    mode(&state, 0o644);
    program.call(&["verify"]).well();

    mode(&program.path("artifacts/latest"), 0o000);
    let ended = as_nobody(&program, "coronet gc --older-than 0s").unwrap();
    // Its owner may not list it, either.
    let folder = program.path("artifacts/latest");
    mode(&folder, 0o755);
    ended.badly(5, &["latest"]);
    program.call(&["verify"]).well();
}

#[test]
fn a_lock_that_another_user_may_only_read_keeps_a_clean_up_out() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    open_to_all(&program);
    bash(
        &program,
        "chown root artifacts/lock && chmod 644 artifacts/lock",
    )
    .well();
    // As a run does that can open it for reading only.
    let Some(ended) = as_nobody(&program, &format!("coronet {RUN} --until relax")) else {
        return;
    };
    ended.well();
    let line = "exec 9<artifacts/lock; flock -s 9; $program gc --older-than 0s";
    bash(&program, line).badly(6, &["in use"]);
    program.call(&["gc", "--older-than", "0s"]).well();
}

/// A folder outside the store with something in it, and where it must not be touched.
fn home(program: &Program) -> std::path::PathBuf {
    let home = program.path("home");
    fs::create_dir(&home).unwrap();
    fs::write(home.join("thesis.tex"), "precious").unwrap();
    home
}

#[test]
fn links_in_a_store_are_never_followed() {
    let reference = Program::new();
    reference.run(&["--until", "pack"]);
    let key = reference.latest("pack-drop");
    let key = key.file_name().unwrap().to_str().unwrap();
    let folder = format!("artifacts/pack/{key}");
    // Link, where it leads, and what must be said.
    let cases = [
        ("artifacts/pack", "home"),
        (folder.as_str(), "home"),
        (&format!("{folder}/lock"), "home/thesis.tex"),
        (&format!("{folder}/work"), "home"),
        (&format!("{folder}/stamp.json"), "home/thesis.tex"),
        ("artifacts/lock", "home/thesis.tex"),
        ("artifacts/store.json", "home/thesis.tex"),
    ];
    for (link, target) in cases {
        let program = Program::new();
        let home = home(&program);
        let link = program.path(link);
        fs::create_dir_all(link.parent().unwrap()).unwrap();
        symlink(program.path(target), &link).unwrap();
        let ended = program.call(&["run", "tiny.toml", "--until", "pack"]);
        ended.badly(5, &["is a symbolic link"]);
        program
            .call(&["gc", "--older-than", "0s", "--without-names"])
            .no_panic();
        let found: Vec<_> = fs::read_dir(&home).unwrap().flatten().collect();
        assert_eq!(found.len(), 1, "{}: {found:?}", link.display());
        assert_eq!(fs::read(home.join("thesis.tex")).unwrap(), b"precious");
    }
}

#[test]
fn a_name_that_is_a_link_is_an_error_after_the_work_is_done() {
    let program = Program::new();
    let home = home(&program);
    fs::create_dir_all(program.path("artifacts/latest")).unwrap();
    symlink(&home, program.path("artifacts/latest/tiny")).unwrap();
    let ended = program.call(&["run", "tiny.toml", "--until", "pack"]);
    ended.badly(5, &["is a symbolic link"]);
    assert!(program.path("artifacts/pack").is_dir());
    assert_eq!(fs::read_dir(&home).unwrap().count(), 1);
    program
        .call(&["gc", "--older-than", "0s"])
        .badly(5, &["symbolic link"]);
    program
        .call(&["run", "tiny.toml", "--name", "../out"])
        .badly(2, &["--name"]);
    fs::write(program.path("...toml"), TINY).unwrap();
    program.call(&["run", "...toml"]).badly(2, &["--name"]);
}

#[test]
fn a_copied_store_shows_its_new_results() {
    let program = Program::new();
    program.run(&[]);
    bash(&program, "cp -rL artifacts copy").well();
    let arguments = [
        "run",
        "tiny.toml",
        "--artifacts",
        "copy",
        "--set",
        "impact.end=3 ms",
    ];
    program.call(&arguments).well();
    let shown = program.call(&["show", "copy/latest/tiny/impact"]).well();
    assert!(shown.out.contains("3 ms"), "{}", shown.out);
    program.call(&["verify", "--artifacts", "copy"]).well();
}

#[test]
fn a_loop_over_speeds_survives_the_clean_up() {
    let program = Program::new();
    let speeds = ["1 m/s", "1.2 m/s", "1.4 m/s"].map(|v| format!("body.drop.velocity={v}"));
    for set in &speeds {
        program.run(&["--set", set]);
    }
    program.call(&["gc"]).well();
    program.call(&["gc", "--older-than", "30days"]).well();
    for set in &speeds {
        let statuses = members(&program.run(&["--set", set]), "status");
        assert!(
            statuses.values().all(|s| s == "fresh"),
            "{set}: {statuses:?}"
        );
    }
}

#[test]
fn a_name_of_several_parts_leads_to_its_results_and_keeps_them() {
    let program = Program::new();
    let arguments = ["run", "tiny.toml", "--until", "pack", "--name"];
    for name in ["sweep/a", "sweep/b", "sweep"] {
        program.call(&[&arguments[..], &[name]].concat()).well();
    }
    program.call(&["gc", "--older-than", "0s"]).well();
    program.call(&["gc", "--forget", "sweep"]).well();
    for name in ["sweep/a", "sweep/b"] {
        let stamp = format!("artifacts/latest/{name}/pack-drop/stamp.json");
        assert!(program.path(&stamp).is_file(), "{name}");
    }
    assert!(!program.path("artifacts/latest/sweep/pack-drop").exists());
    // A name that is of no run means the points of a study.
    program.call(&["gc", "--forget", "sweep"]).well();
    assert!(!program.path("artifacts/latest/sweep").exists());
    assert!(program.path("artifacts/latest").exists());
}

#[test]
fn what_is_not_utf8_works_or_is_refused_in_words() {
    let program = Program::new();
    let line = format!("coronet {RUN} --artifacts $'s\\xff'");
    bash(&program, &line).well();
    bash(&program, "coronet verify --artifacts $'s\\xff'").well();
    for more in [
        &format!("{line} --json"),
        "coronet verify --json --artifacts $'s\\xff'",
    ] {
        bash(&program, more).badly(2, &["is not UTF-8"]);
    }
}

#[test]
fn pipes_and_devices_are_refused_in_words() {
    let program = Program::new();
    bash(&program, "mkfifo pipe.toml pipe.checkpoint pipe.mcap").well();
    for arguments in [
        &["show", "pipe.checkpoint"][..],
        &["show", "pipe.mcap"],
        &["export", "pipe.mcap", "--to", "csv"],
    ] {
        let mut command = program.command(arguments);
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        let since = Instant::now();
        while child.try_wait().unwrap().is_none() {
            assert!(
                since.elapsed() < Duration::from_secs(20),
                "{arguments:?} waits"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
        let ended = Ended::from(child.wait_with_output().unwrap());
        ended.badly(5, &["not a regular file"]);
    }
}

#[test]
fn completions_and_manual_pages_name_every_command() {
    let program = Program::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = program.call(&["completions", shell]).well().out.clone();
        assert!(
            script.contains("recover") && script.contains("artifacts"),
            "{shell}"
        );
    }
    program.call(&["man", "new/man1"]).well();
    let page = fs::read_to_string(program.path("new/man1/coronet-run.1")).unwrap();
    assert!(page.contains("coronet") && page.contains("until"), "{page}");
    assert!(program.path("new/man1/coronet.1").is_file());
}
