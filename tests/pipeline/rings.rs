//! A scene of revolution from outside: what a run of rings shows, and what of it is exported.

use std::fs;

use coronet::record::log;
use serde_json::Value;

use crate::export::column;
use crate::program::Program;

/// A drop on a pool in a cylinder, as rings.
pub const RINGS: &str = "dimension = 3\n\
    [box]\nsize = ['9.6 mm', '9.6 mm', '8 mm']\nx = 'wall'\ny = 'wall'\nsymmetry = 'axis'\n\
    [liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
    [effects.viscosity]\ndynamic = '1 mPa s'\n\
    [effects.tension]\ncoefficient = '73 mN/m'\n\
    [body.pool]\nlayer = { depth = '2.4 mm' }\n\
    [body.drop]\nsphere = { diameter = '2.4 mm', gap = '0.3 mm', above = 'pool' }\n\
    velocity = '1 m/s'\n\
    [pack]\nspacing = '0.3 mm'\narrangement = 'lattice'\n\
    [impact]\nend = '1 ms'\ncheckpoint_every = '20 ms'\n[frames]\ninterval = '0.5 ms'\n\
    [post]\npanels = ['0 ms', '1 ms']\n";

fn run(more: &[&str]) -> Program {
    let program = Program::with("rings.toml", RINGS);
    program
        .call(&[&["run", "rings.toml"], more].concat())
        .well();
    program
}

#[test]
fn rings_are_drawn_as_the_body_of_revolution() {
    let program = run(&[]);
    let render = |more: &[&str]| program.call(&[&["render", "rings"], more].concat()).well();
    let small = ["--size", "96x64", "--samples", "1"];
    render(&[&["--output", "water.png"], &small[..]].concat());
    render(
        &[
            &["--output", "speed.png", "--material", "speed"],
            &small[..],
        ]
        .concat(),
    );
    let [water, speed] = ["water.png", "speed.png"].map(|n| fs::read(program.path(n)).unwrap());
    assert_ne!(water, speed);
    render(&["--output", "mesh.obj", "--material", "body", "--at", "0 ms"]);
    let obj = fs::read_to_string(program.path("mesh.obj")).unwrap();
    let places = obj.lines().filter_map(|line| line.strip_prefix("v "));
    let y: Vec<f64> = places
        .map(|line| line.split_whitespace().nth(1).unwrap().parse().unwrap())
        .collect();
    let [low, high] = [f64::min, f64::max].map(|pick| y.iter().copied().reduce(pick).unwrap());
    assert!(
        low.abs() < 1e-7 && (high - 9.6e-3).abs() < 1e-7,
        "{low} to {high} m"
    );
    // The report opens with the body, and has a view of it beside each section.
    let results = program.path("artifacts/latest/rings/post");
    for name in ["picture.png", "panels/01-section.png", "panels/02-view.png"] {
        assert!(results.join(name).exists(), "no {name}");
    }
    let report = fs::read_to_string(results.join("report.html")).unwrap();
    assert!(report.contains("Section through the axis, and bird's-eye view"));
}

#[test]
fn rings_are_exported_as_they_are_or_as_points_of_the_same_mass() {
    let program = run(&[]);
    let export = |more: &[&str]| {
        let run = "artifacts/latest/rings";
        let arguments = [&["export", run, "--to", "csv", "--at", "1 ms"], more].concat();
        program.call(&arguments).well();
        let frame = program.path("export/frame-00000.csv");
        let [mass, y] = ["mass", "position_y"].map(|name| column(&frame, name));
        (mass.iter().sum::<f64>(), y)
    };
    let (mass, y) = export(&[]);
    assert!(y.iter().all(|y| *y == 0.0), "the half-plane");
    let liquid =
        1000.0 * std::f64::consts::PI * (4.8e-3f64.powi(2) * 2.4e-3 + 2.4e-3f64.powi(3) / 6.0);
    assert!((mass / liquid - 1.0).abs() < 1e-4, "{mass} {liquid}");
    for (most, per_ring) in [("--revolve", 30), ("--revolve=8", 7)] {
        let (all, points) = export(&[most]);
        assert!((all / mass - 1.0).abs() < 1e-5, "{all} {mass}");
        assert!(points.len() > per_ring * y.len(), "{} points", points.len());
        assert!(points.iter().any(|y| *y < -4e-3), "all around");
    }
    program.run(&[]);
    let plain = program.call(&[
        "export",
        "artifacts/latest/tiny",
        "--to",
        "csv",
        "--revolve",
    ]);
    plain.badly(2, &["no rings", "box.symmetry"]);
    let none = program.call(&[
        "export",
        "artifacts/latest/rings",
        "--to",
        "csv",
        "--revolve=0",
    ]);
    none.badly(2, &["--revolve", "from 1"]);
}

#[test]
fn the_log_has_the_section_and_a_cloud_of_the_body() {
    let logs = |program: &Program| program.path("artifacts/latest/rings/impact/frames.mcap");
    let program = run(&[]);
    let bytes = fs::read(logs(&program)).unwrap();
    let has = |word: &[u8]| bytes.windows(word.len()).any(|found| found == word);
    assert!(has(b"/revolved") && has(b"/body/drop"));
    let frames = log::read_frames(&logs(&program)).unwrap();
    for frame in frames.map(Result::unwrap) {
        assert!(frame.position[0].iter().all(|r| (0.0..4.8e-3).contains(r)));
        assert_eq!(frame.mass.len(), frame.id.len());
    }
    let layout = fs::read_to_string(logs(&program).with_file_name("layout.json")).unwrap();
    let layout: Value = serde_json::from_str(&layout).unwrap();
    let topics = &layout["configById"]["3D!coronet"]["topics"];
    assert_eq!(topics["/revolved"]["visible"], true);
    // A run that is stopped and goes on has the same log.
    let halves = Program::with("rings.toml", RINGS);
    halves
        .call(&["run", "rings.toml", "--set", "impact.end=0.5 ms"])
        .well();
    halves.call(&["run", "rings.toml"]).well();
    let digests = [&program, &halves].map(|p| log::content_digest(&logs(p)).unwrap());
    assert_eq!(digests[0], digests[1]);
}

#[test]
fn packing_reports_the_mass_of_the_whole_body() {
    let program = Program::with("rings.toml", RINGS);
    let ended = program.call(&["run", "rings.toml"]).well();
    let pool = 1000.0 * std::f64::consts::PI * 4.8e-3f64.powi(2) * 2.4e-3;
    let expected = format!("{pool:.6e} kg required");
    let text = format!("{}{}", ended.out, ended.err);
    assert!(text.contains(&expected), "no {expected:?} in: {text}");
}
