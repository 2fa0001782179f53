//! Inputs count by their content: a stage that ran again with an equal result spoils nothing after
//! it.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use coronet::pipeline::sweep::{self, Options};
use coronet::pipeline::*;

use crate::laboratory::{Lab, go, grow, pipeline, store};
use crate::program::{Program, members};

/// The toy pipeline, of which the first job has another key and the same result.
fn idle(lab: &Lab) -> Pipeline<'_> {
    let mut pipeline = pipeline(lab, 1, 0);
    pipeline.jobs[0] = grow(lab, "drop", 1, 1);
    pipeline
}

#[test]
fn a_part_of_a_run_leaves_the_names_of_what_is_fresh() {
    let (_folder, store) = store();
    let lab = Lab::default();
    go(&store, &pipeline(&lab, 1, 0)).unwrap();
    run(&Run {
        store: &store,
        pipeline: &idle(&lab),
        also: None,
        until: Some("grow"),
        stop: &AtomicBool::new(false),
        watch: &Silent,
        remote: None,
        threads: 1,
        program: "toy".into(),
    })
    .unwrap();
    let named = latest::read(&store, "toy").unwrap().unwrap().results;
    let names: Vec<&str> = named.iter().map(|entry| entry.name.as_str()).collect();
    assert_eq!(names, ["grow-drop", "grow-pool", "sum"]);
    let options = Options {
        older_than: Some(Duration::ZERO),
        ..Options::default()
    };
    assert!(sweep::plan(&store, &options).unwrap().removed.is_empty());
}

/// Neither limit is reached, so both end with the same particles.
#[test]
fn a_limit_that_changes_no_particle_changes_the_verdict_on_rest() {
    let program = Program::new();
    let run = |limit: &str| {
        let limit = format!("relax.kinetic_energy={limit} J/kg");
        let quick = ["relax.time=0.01 ms", "impact.end=0.5 ms", "post.panels=[]"];
        let sets = [&quick[..], &[&limit]].concat();
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        program.run(&[&["--name", "u"], &sets[..]].concat())
    };
    run("1e-12");
    let objects = run("3e-12");
    let status = members(&objects, "status");
    assert_eq!(status["impact"], "fresh");
    assert_eq!((&*status["relax pool"], &*status["post"]), ("ran", "ran"));
    let notes = &members(&objects, "notes")["post"];
    assert!(notes.contains("body `pool` begins the impact not at rest"));
    assert!(notes.contains("(limit 3.000e-12)") && !notes.contains("(limit 1.000e-12)"));
    let list = program.call(&["list", "--json"]).well().objects();
    assert_eq!(list[0]["state"], "finished");
}
