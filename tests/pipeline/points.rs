//! Points of a study that are killed or cannot be trusted, and figures of studies that share the
//! folder of `--into`.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use crate::program::{Ended, Program};

const STUDY: &str = r#"
title = "Drops"
pipeline = "tiny.toml"
set = ["impact.end=0.5 ms", "post.panels=[]", "pack.spacing=0.6 mm", "relax.time=0.1 ms"]

[[axis]]
name = "speed"
key = "body.drop.velocity"
values = ["1 m/s", "1.1 m/s"]

[[figure]]
name = "depth"
column = "crater_depth_m"
"#;

const CURVES: &str = "[[curves]]\ncolumn = \"kinetic_energy_J\"\n";

/// The states in the table of figures of a study.
fn states(program: &Program, study: &str) -> Vec<String> {
    let path = program.path(&format!("artifacts/latest/{study}/figures.csv"));
    let table = fs::read_to_string(path).unwrap();
    let rows = table.lines().skip(1);
    rows.map(|row| row.split(',').nth(2).unwrap().to_string())
        .collect()
}

#[test]
fn a_killed_point_has_failed_and_the_study_goes_on() {
    let slow = STUDY
        .replace("body.drop.velocity", "relax.time")
        .replace(", \"relax.time=0.1 ms\"", "")
        .replace("[\"1 m/s\", \"1.1 m/s\"]", "[\"10 s\", \"0.1 ms\"]");
    let calm = ", \"relax.kinetic_energy=1e-30 J/kg\"]";
    let program = Program::with("long.toml", &slow.replacen("]\n", &format!("{calm}\n"), 1));
    let mut child = program.start(&["study", "long.toml"]);
    let point = loop {
        let jobs = program.call(&["status", "--json"]).objects();
        let first = jobs
            .iter()
            .find(|job| job["name"] == "long-01" && job["stage"] == "relax");
        if let Some(id) = first.and_then(|job| job["process"].as_i64()) {
            break libc::pid_t::try_from(id).unwrap();
        }
        assert!(child.try_wait().unwrap().is_none());
        sleep(Duration::from_millis(5));
    };
    // SAFETY: the study waits for its point, so the number is still that of the point.
    assert_eq!(unsafe { libc::kill(point, libc::SIGKILL) }, 0);
    let ended = Ended::from(child.wait_with_output().unwrap()).well();
    assert!(
        ended.err.contains("failed: killed by signal 9"),
        "{}",
        ended.err
    );
    assert_eq!(states(&program, "long"), ["failed", "done"]);
}

#[test]
fn a_point_that_cannot_be_trusted_ends_the_study_and_leaves_its_table() {
    let program = Program::with("drops.toml", STUDY);
    program.call(&["study", "drops.toml"]).well();
    let path = program.path("artifacts/latest/drops-01/post/measures.csv");
    let text = fs::read_to_string(&path).unwrap();
    let last = text.trim_end().rfind(|c: char| c.is_ascii_digit()).unwrap();
    let other = if &text[last..=last] == "1" { "2" } else { "1" };
    fs::write(&path, [&text[..last], other, &text[last + 1..]].concat()).unwrap();
    program
        .call(&["study", "drops.toml"])
        .badly(4, &["point drops-01", "measures.csv", "coronet verify"]);
    assert_eq!(states(&program, "drops"), ["done", "done"]);
}

#[test]
fn figures_in_a_shared_folder_are_those_of_their_studies() {
    let program = Program::with("pool.toml", &format!("{STUDY}{CURVES}"));
    let axis = format!("{STUDY}{CURVES}");
    fs::write(program.path("pool-axis.toml"), axis).unwrap();
    let study = |name: &str| {
        program.call(&["study", name, "--into", "tables"]).well();
    };
    study("pool-axis.toml");
    // Whose names begin as those of the other one.
    study("pool.toml");
    let photo = program.path("tables/pool-photo.svg");
    fs::write(&photo, "<svg>").unwrap();
    let plot = program.path("tables/pool-kinetic-energy.svg");
    let stored = program.path("artifacts/latest/pool/kinetic-energy.svg");
    assert!(plot.is_file() && stored.is_file());
    // Without curves, the old figure must not stand beside the new table.
    fs::write(program.path("pool.toml"), STUDY).unwrap();
    study("pool.toml");
    assert!(!plot.exists() && !stored.exists() && !stored.with_extension("pdf").exists());
    assert!(photo.is_file());
    let other = program.path("tables/pool-axis-kinetic-energy.svg");
    assert!(other.is_file());
}
