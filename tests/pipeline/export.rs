//! `export` of a run: frames at instants, particles of a body, and what it refuses.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::program::Program;

/// A column of a table of particles.
pub fn column(path: &Path, name: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    let place = reader.headers().unwrap().iter().position(|n| n == name);
    let place = place.unwrap_or_else(|| panic!("no column {name}"));
    let rows = reader.records();
    rows.map(|row| row.unwrap()[place].parse().unwrap())
        .collect()
}

#[test]
fn a_body_at_some_instants_with_its_mass() {
    let program = Program::new();
    program.run(&[]);
    let run = "artifacts/latest/tiny";
    let export = |more: &[&str]| {
        let arguments = [&["export", run, "--to", "csv", "--json"], more].concat();
        program.call(&arguments).well().objects().remove(0)
    };
    let whole = export(&["--at", "1.1 ms, 3 ms", "--at", "0 ms"]);
    let times: Vec<f64> = whole["times_s"]
        .as_array()
        .unwrap()
        .iter()
        .map(number)
        .collect();
    // Frames are 0.5 ms apart, each at the first step that reaches its instant.
    for (time, instant) in times.iter().zip([0.0, 1e-3, 3e-3]) {
        assert!((time - instant).abs() < 0.1e-3, "{times:?}");
    }
    assert_eq!((times.len(), &whole["removed"]), (3, &Value::from(0)));
    let index = program.path("export/frames.csv");
    assert_eq!(column(&index, "time_s"), times);
    let frame = program.path("export/frame-00002.csv");
    let total: f64 = column(&frame, "mass").iter().sum();
    let expected = column(&index, "mass_kg")[2];
    assert!((total / expected - 1.0).abs() < 1e-5, "{total} {expected}");
    // Discs of radius r that hold the mass: their areas are those of the liquid.
    let area: f64 = column(&frame, "radius").iter().map(|r| r * r).sum();
    let area = std::f64::consts::PI * area;
    assert!(
        (area / (12e-3 * 3e-3 + 4.52e-6) - 1.0).abs() < 0.03,
        "{area}"
    );

    let drop = export(&["--every", "2 ms", "--body", "drop"]);
    assert_eq!(drop["times_s"].as_array().unwrap().len(), 3);
    assert_eq!(drop["removed"], 4);
    let body = column(&frame, "body");
    let list = fs::read_to_string(program.path("export/coronet-export.json")).unwrap();
    let list: Value = serde_json::from_str(&list).unwrap();
    assert_eq!(list["bodies"][body[0] as usize], "drop");
    assert!(body.iter().all(|other| *other == body[0]) && body.len() < 100);
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn what_is_not_there_is_refused_and_removes_nothing() {
    let program = Program::new();
    program.run(&[]);
    let run = "artifacts/latest/tiny";
    program.call(&["export", run, "--to", "npz"]).well();
    let before = fs::read_dir(program.path("export")).unwrap().count();
    for (more, words) in [
        (&["--at", "9 ms"][..], &["9 ms", "from 0 to 4"][..]),
        (&["--body", "drip"], &["`drip`", "pool, drop"]),
        (&["--every", "0 ms"], &["above zero", "\"5 ms\""]),
        (&["--at", "1 mm"], &["1 mm"]),
        (&["--at", "1 ms", "--every", "1 ms"], &["--every"]),
    ] {
        let arguments = [&["export", run, "--to", "npz"], more].concat();
        program.call(&arguments).badly(2, words);
    }
    let state = "artifacts/latest/tiny/impact/state.checkpoint";
    let ended = program.call(&["export", state, "--to", "npz", "--body", "drop"]);
    ended.badly(2, &["state.checkpoint", "--body", "folder of a run"]);
    assert_eq!(
        fs::read_dir(program.path("export")).unwrap().count(),
        before
    );
    let arguments = [
        "export", run, "--to", "csv", "--at", "9 ms", "--output", "new",
    ];
    program.call(&arguments).badly(2, &["9 ms"]);
    assert!(!program.path("new").exists());
}
