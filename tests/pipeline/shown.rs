//! What a name, a table of measures and `status` show agrees with what was computed.

use std::fs;
use std::time::{Duration, Instant};

use crate::program::Program;

/// Where the impact is new and the evaluation is missing, that of the older impact is not shown.
#[test]
fn an_older_evaluation_does_not_stand_beside_a_newer_impact() {
    let program = Program::new();
    let sets = [
        "--name",
        "a",
        "--set",
        "impact.end=1 ms",
        "--set",
        "post.panels=[]",
    ];
    program.run(&sets);
    let post = program.path("artifacts/latest/a/post");
    assert!(post.exists());
    let faster = ["--set", "body.drop.velocity=2 m/s", "--until", "impact"];
    program.run(&[&sets[..], &faster].concat());
    assert!(!post.exists() && !post.is_symlink());
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(list[0]["job"], "post");
    assert!(list[0]["figures"].is_null());
    // What fits stays: here all of it.
    program.run(&sets);
    program.run(&[&sets[..], &["--until", "pack"]].concat());
    assert!(post.exists());
    program
        .call(&["export", "a", "--to", "csv", "--at", "0 ms"])
        .well();
    assert!(program.path("export/frames.csv").exists());
}

/// Figures of a table that was changed by hand are not told as those of the run.
#[test]
fn a_changed_table_of_measures_is_not_believed() {
    let program = Program::new();
    let arguments = ["--set", "impact.end=1 ms", "--set", "post.panels=[]"];
    program.run(&arguments);
    let path = program.path("artifacts/latest/tiny/post/measures.csv");
    let text = fs::read_to_string(&path).unwrap();
    let last = text.trim_end().rfind(|c: char| c.is_ascii_digit()).unwrap();
    let other = if &text[last..=last] == "1" { "2" } else { "1" };
    fs::write(&path, [&text[..last], other, &text[last + 1..]].concat()).unwrap();
    let again = program.call(&[&["run", "tiny.toml"], &arguments[..]].concat());
    again.badly(4, &["measures.csv: it was changed", "coronet verify"]);
    assert!(!again.out.contains("largest"), "{}", again.out);
    program.call(&["verify"]);
    program.run(&arguments);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
}

/// A stage that has failed is not called interrupted.
#[test]
fn status_says_that_a_stage_has_failed() {
    let program = Program::new();
    let slow = "method.wcsph.reference_speed=0.01 m/s";
    let sets = ["--set", "method.wcsph.sound_speed=constant", "--set", slow];
    let ended = program.call(&[&["run", "tiny.toml"], &sets[..]].concat());
    ended.badly(3, &["diverged"]);
    let jobs = program.call(&["status", "--json"]).well().objects();
    assert_eq!(jobs[0]["state"], "failed");
    assert!(jobs[0]["failure"].as_str().unwrap().contains("diverged"));
    let text = program.call(&["status"]).well().out;
    assert!(
        text.contains("failed") && text.contains("diverged"),
        "{text}"
    );
}

/// As `coronet status --watch | head -n 1`.
#[test]
fn a_watch_ends_with_its_reader() {
    let program = Program::new();
    let mut run = program.start(&["run", "tiny.toml", "--set", "impact.end=400 ms"]);
    program.in_flight(&mut run);
    let mut watch = program.start(&["status", "--watch"]);
    drop(watch.stdout.take());
    let since = Instant::now();
    while watch.try_wait().unwrap().is_none() {
        // It looks again after ten, if it was quicker than this process.
        assert!(since.elapsed() < Duration::from_secs(25), "it goes on");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(run.try_wait().unwrap().is_none());
    run.kill().unwrap();
    run.wait().unwrap();
}
