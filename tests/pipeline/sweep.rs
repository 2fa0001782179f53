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

#[test]
fn all_runs_of_a_loop_are_listed_compared_and_kept() {
    let program = Program::new();
    let run = |speed: &str| {
        let set = format!("body.drop.velocity={speed}");
        program.run(&[
            "--set",
            &set,
            "--set",
            "post.panels=[]",
            "--set",
            "impact.end=2 ms",
        ])
    };
    let end = ",impact.end=2_ms,post.panels=";
    for (speed, name) in LOOP {
        let told = run(speed).last().unwrap()["name"]
            .as_str()
            .unwrap()
            .to_string();
        assert!(told.starts_with(&format!("{name}{end}")), "{told}");
    }
    let list = program.call(&["list", "--json"]).well().objects();
    let found = names(&list);
    for ((_, name), found) in LOOP.iter().rev().zip(&found) {
        assert!(found.starts_with(name), "the newest first: {found}");
    }
    assert_eq!(
        found.len(),
        3,
        "the name of the file is that of the newest: {found:?}"
    );
    for run in &list {
        assert_eq!(run["state"], "finished");
        let settings = run["settings"].as_object().unwrap();
        assert_eq!(settings.len(), 1, "{settings:?}");
    }
    assert_eq!(list[0]["settings"]["body.drop.velocity"], "1.6 m/s");
    let text = program.call(&["list"]).well().out;
    assert_eq!(text.lines().count(), 4, "{text}");

    // The name of the file is that of the newest run, as before.
    let link = program.latest("impact");
    let own = program
        .path("artifacts/latest")
        .join(found[0])
        .join("impact");
    assert_eq!(link, own.canonicalize().unwrap());
    let diff = program
        .call(&["diff", found[2], found[0], "--json"])
        .well()
        .objects();
    assert_eq!(diff[0]["settings"][0]["first"], "1.2 m/s");
    assert_eq!(diff[0]["settings"][0]["second"], "1.6 m/s");
    let shown = program.call(&["show", &format!("artifacts/latest/{}/post", found[1])]);
    assert!(shown.well().out.contains("1.4 m/s"));

    // Nothing is lost, whatever its age.
    program.call(&["gc", "--yes"]).well();
    program.call(&["gc", "--yes", "--older-than", "0s"]).well();
    for (speed, _) in LOOP {
        let statuses = members(&run(speed), "status");
        assert!(
            statuses.values().all(|s| s == "fresh"),
            "{speed}: {statuses:?}"
        );
    }
    // Equal settings have the equal name.
    run("1200 mm/s");
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(list.len(), 3);

    // A forgotten name loses what only it reaches.
    let middle = list.iter().map(|run| run["name"].as_str().unwrap());
    let middle = middle
        .filter(|name| name.contains("1.4"))
        .collect::<Vec<_>>();
    program.call(&["gc", "--yes", "--forget", middle[0]]).well();
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(list.len(), 2, "{:?}", names(&list));
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
