//! The runs of a loop with `--set`: each keeps a name of its own.

use std::fs;

use serde_json::Value;

use crate::program::{Program, members};

/// Speeds of a loop, and the names of its runs.
const LOOP: [(&str, &str); 3] = [
    ("1.2 m/s", "tiny,body.drop.velocity=1.2_m_s"),
    ("1.4 m/s", "tiny,body.drop.velocity=1.4_m_s"),
    ("160 cm/s", "tiny,body.drop.velocity=1.6_m_s"),
];

fn names(list: &[Value]) -> Vec<&str> {
    list.iter()
        .map(|run| run["name"].as_str().unwrap())
        .collect()
}

/// Runs the loop's run of that speed; returns what it prints.
fn run(program: &Program, speed: &str) -> Vec<Value> {
    let speed = format!("body.drop.velocity={speed}");
    let sets = [&speed[..], "post.panels=[]", "impact.end=2 ms"];
    program.run(&sets.map(|set| ["--set", set]).concat())
}

fn list(program: &Program) -> Vec<Value> {
    program.call(&["list", "--json"]).well().objects()
}

#[test]
fn all_runs_of_a_loop_are_listed_compared_and_kept() {
    let program = Program::new();
    let end = ",impact.end=2_ms,post.panels=";
    for (speed, name) in LOOP {
        let objects = run(&program, speed);
        let told = objects.last().unwrap()["name"].as_str().unwrap();
        assert!(told.starts_with(&format!("{name}{end}")), "{told}");
    }
    let runs = list(&program);
    let found = names(&runs);
    for ((_, name), found) in LOOP.iter().rev().zip(&found) {
        assert!(found.starts_with(name), "the newest first: {found}");
    }
    let why = "the name of the file is that of the newest";
    assert_eq!(found.len(), 3, "{why}: {found:?}");
    for run in &runs {
        assert_eq!(run["state"], "finished");
        let settings = run["settings"].as_object().unwrap();
        assert_eq!(settings.len(), 1, "{settings:?}");
    }
    assert_eq!(runs[0]["settings"]["body.drop.velocity"], "1.6 m/s");
    let text = program.call(&["list"]).well().out;
    assert_eq!(text.lines().count(), 4, "{text}");

    // The name of the file is that of the newest run, as before.
    let own = format!("artifacts/latest/{}/impact", found[0]);
    let own = program.path(&own).canonicalize().unwrap();
    assert_eq!(program.latest("impact"), own);
    let diff = ["diff", found[2], found[0], "--json"];
    let diff = program.call(&diff).well().objects();
    assert_eq!(diff[0]["settings"][0]["first"], "1.2 m/s");
    assert_eq!(diff[0]["settings"][0]["second"], "1.6 m/s");
    let shown = program.call(&["show", &format!("artifacts/latest/{}/post", found[1])]);
    assert!(shown.well().out.contains("1.4 m/s"));
    all_are_kept(&program);
}

/// Whatever their age, until a name is forgotten.
fn all_are_kept(program: &Program) {
    program.call(&["gc", "--yes"]).well();
    program.call(&["gc", "--yes", "--older-than", "0s"]).well();
    for (speed, _) in LOOP {
        let statuses = members(&run(program, speed), "status");
        let mut statuses = statuses.values();
        assert!(statuses.all(|status| status == "fresh"), "{speed}");
    }
    // Equal settings have the equal name.
    run(program, "1200 mm/s");
    let runs = list(program);
    let found = names(&runs);
    assert_eq!(found.len(), 3, "{found:?}");
    let middle = found.iter().find(|name| name.starts_with(LOOP[1].1));
    let forget = ["gc", "--yes", "--forget", middle.unwrap()];
    program.call(&forget).well();
    assert_eq!(list(program).len(), 2);
}

#[test]
fn only_a_run_with_settings_and_without_a_name_has_one_of_its_own() {
    let program = Program::new();
    let pack = |more: &[&str]| {
        let objects = program.run(&[&["--until", "pack"], more].concat());
        objects.last().unwrap()["name"]
            .as_str()
            .unwrap()
            .to_string()
    };
    assert_eq!(pack(&[]), "tiny");
    assert_eq!(pack(&["--set", "pack.seed=2", "--name", "other"]), "other");
    let all = || {
        let entries = fs::read_dir(program.path("artifacts/latest")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    assert_eq!(all(), ["other", "tiny"]);
    let title = format!("title={}", "../ a very long title, ".repeat(20));
    let long = pack(&["--set", &title, "--set", "pack.seed=3"]);
    assert!(
        long.len() < 130 && long.starts_with("tiny,pack.seed=3,title="),
        "{long}"
    );
    assert_eq!(all(), ["other", "tiny", &long]);
    assert_eq!(pack(&["--set", "pack.seed=3", "--set", &title]), long);
    let told = program.call(&[
        "run",
        "tiny.toml",
        "--until",
        "pack",
        "--set",
        "pack.seed=4",
    ]);
    assert!(told.well().out.contains("name     tiny,pack.seed=4"));
}

#[test]
fn a_lattice_that_does_not_fit_its_shape_is_told() {
    let program = Program::new();
    let lattice = [
        "run",
        "tiny.toml",
        "--until",
        "pack",
        "--set",
        "pack.arrangement=lattice",
    ];
    let packed = |depth: &str| {
        let depth = format!("body.pool.layer.depth={depth}");
        program
            .call(&[&lattice[..], &["--set", &depth]].concat())
            .well()
            .err
    };
    assert!(!packed("3 mm").contains("of mass beside"));
    // Two and a half layers.
    let told = packed("0.75 mm");
    assert!(
        told.contains("`pool` has +20.0 % of mass beside its shape"),
        "{told}"
    );
}
