//! Which settings make which results stale, and what the reason says.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use coronet::pipeline::Stamp;
use serde_json::Value;

use crate::program::{Program, TINY, label, members};

/// All jobs of the scene.
const ALL: &[&str] = &[
    "pack pool",
    "relax pool",
    "pack drop",
    "relax drop",
    "calibrate",
    "impact",
    "post",
];
const RELAX: &[&str] = &["relax pool", "relax drop", "calibrate", "impact", "post"];
const POOL: &[&str] = &["pack pool", "relax pool", "calibrate", "impact", "post"];
const DROP: &[&str] = &["pack drop", "relax drop", "calibrate", "impact", "post"];
const IMPACT: &[&str] = &["impact", "post"];
const POST: &[&str] = &["post"];
const NONE: &[&str] = &[];

/// What is set; what gets stale; the job whose reason is checked; the reason.
type Row = (
    &'static str,
    &'static [&'static str],
    &'static str,
    &'static str,
);

/// On the scene as it is.
const TABLE: &[Row] = &[
    (
        "pack.spacing=0.25 mm",
        ALL,
        "pack drop",
        "pack.spacing 0.3 mm -> 0.25 mm",
    ),
    (
        "pack.arrangement=lattice",
        ALL,
        "pack pool",
        "pack.arrangement poisson -> lattice",
    ),
    ("pack.seed=2", ALL, "pack drop", "pack.seed 1 -> 2"),
    (
        "pack.tolerance=3 kg/m^3",
        ALL,
        "pack drop",
        "pack.tolerance 2 kg/m^3 -> 3 kg/m^3",
    ),
    (
        "body.drop.disc.diameter=2.2 mm",
        DROP,
        "pack drop",
        "body.drop.disc.diameter 2.4 mm -> 2.2 mm",
    ),
    (
        "body.drop.disc.gap=0.7 mm",
        IMPACT,
        "impact",
        "body.drop.disc.centre [6 mm, 4.7 mm] -> [6 mm, 4.9 mm]",
    ),
    (
        "body.drop.velocity=1.2 m/s",
        IMPACT,
        "impact",
        "body.drop.velocity 1 m/s -> 1.2 m/s",
    ),
    ("body.drop.velocity=100 cm/s", NONE, "", ""),
    (
        "body.drop.colour=#00ff00",
        IMPACT,
        "impact",
        "body.drop.colour #d9772e -> #00ff00",
    ),
    (
        "body.pool.layer.depth=2.7 mm",
        POOL,
        "pack pool",
        "body.pool.layer.depth 3 mm -> 2.7 mm",
    ),
    (
        "box.x=wall",
        POOL,
        "relax pool",
        "box.x [periodic, periodic] -> [wall, wall]",
    ),
    (
        "liquid.density=1010 kg/m^3",
        ALL,
        "relax drop",
        "liquid.density 1000 kg/m^3 -> 1010 kg/m^3",
    ),
    (
        "effects.gravity.acceleration=5 m/s^2",
        &["relax pool", "calibrate", "impact", "post"],
        "relax pool",
        "effects.gravity.acceleration 9.81 m/s^2 -> 5 m/s^2",
    ),
    (
        "effects.viscosity.dynamic=2 mPa s",
        RELAX,
        "relax drop",
        "effects.viscosity.dynamic 1 mPa s -> 2 mPa s",
    ),
    (
        "effects.viscosity.form=two-term",
        RELAX,
        "impact",
        "effects.viscosity.form morris -> two-term",
    ),
    (
        "effects.tension.coefficient=60 mN/m",
        RELAX,
        "calibrate",
        "effects.tension.coefficient 73 mN/m -> 60 mN/m",
    ),
    (
        "effects.tension.smoothing=1.6",
        RELAX,
        "relax pool",
        "effects.tension.smoothing 1.8 -> 1.6",
    ),
    (
        "relax.time=3 ms",
        RELAX,
        "relax drop",
        "relax.time 4 ms -> 3 ms",
    ),
    (
        "relax.damping=400 1/s",
        RELAX,
        "relax pool",
        "relax.damping 500 1/s -> 400 1/s",
    ),
    (
        "relax.kinetic_energy=2 uJ/kg",
        RELAX,
        "relax drop",
        "relax.kinetic_energy 1 uJ/kg -> 2 uJ/kg",
    ),
    (
        "relax.density_spread=2 kg/m^3",
        RELAX,
        "relax drop",
        "relax.density_spread 1 kg/m^3 -> 2 kg/m^3",
    ),
    (
        "impact.end=5 ms",
        IMPACT,
        "impact",
        "impact.end 4 ms -> 5 ms",
    ),
    ("impact.checkpoint_every=1 s", NONE, "", ""),
    (
        "frames.interval=0.4 ms",
        IMPACT,
        "impact",
        "frames.interval 500 us -> 400 us",
    ),
    (
        "frames.time_scale=10",
        IMPACT,
        "impact",
        "frames.time_scale 1 -> 10",
    ),
    (
        "frames.colour=speed",
        IMPACT,
        "impact",
        "frames.colour body -> speed",
    ),
    (
        "post.panels=[\"1 ms\"]",
        POST,
        "post",
        "post.panels [0 s, 4 ms] -> [1 ms]",
    ),
    (
        "post.fields=[\"1 ms\"]",
        POST,
        "post",
        "post.fields [] -> [1 ms]",
    ),
    (
        "title=Another",
        POST,
        "post",
        "title A tiny drop -> Another",
    ),
    (
        "method.wcsph.smoothing=1.4",
        ALL,
        "impact",
        "method.wcsph.smoothing 1.5 -> 1.4",
    ),
    (
        "method.wcsph.sound_speed_factor=12",
        IMPACT,
        "impact",
        "method.wcsph.sound_speed_factor 10 -> 12",
    ),
];

fn stale(plan: &[Value]) -> BTreeSet<String> {
    let stale = plan.iter().filter(|job| job["status"] != "fresh");
    stale.map(label).collect()
}

#[test]
fn each_setting_reaches_exactly_the_stages_that_read_it() {
    let program = Program::new();
    let objects = program.run(&[]);
    let jobs = members(&objects, "status");
    assert_eq!(jobs.len(), ALL.len(), "{jobs:?}");
    assert!(TABLE.len() >= 25);
    for (set, expected, job, reason) in TABLE {
        let plan = program.plan(&["--set", set]);
        let expected: BTreeSet<_> = expected.iter().map(|job| job.to_string()).collect();
        assert_eq!(stale(&plan), expected, "{set}");
        if job.is_empty() {
            continue;
        }
        let found = plan.iter().find(|object| label(object) == *job).unwrap();
        let reasons = found["reasons"].as_array().unwrap();
        let reasons: Vec<_> = reasons.iter().filter_map(Value::as_str).collect();
        assert!(
            reasons.iter().any(|found| found.starts_with(reason)),
            "{set}: {reasons:?}"
        );
    }
}

#[test]
fn the_order_of_the_file_and_where_it_lies_reach_nothing() {
    let program = Program::new();
    program.run(&["--threads", "1"]);
    // The last table first, under another name, in another folder, with comments.
    let (head, tail) = TINY.split_at(TINY.find("[impact]").unwrap());
    let title = head.find("[box]").unwrap();
    let text = format!("# moved\n{}{tail}\n{}", &head[..title], &head[title..]);
    fs::create_dir(program.path("elsewhere")).unwrap();
    fs::write(program.path("elsewhere/other.toml"), text).unwrap();
    let arguments = ["run", "elsewhere/other.toml", "--json", "--threads", "2"];
    let objects = program.call(&arguments).well().objects();
    let statuses = members(&objects, "status");
    assert!(
        statuses.values().all(|status| status == "fresh"),
        "{statuses:?}"
    );
}

/// Settings of absent effects are in no key: not in one of the stamps.
#[test]
fn an_absent_effect_is_in_no_key() {
    let program = Program::new();
    let (head, tail) = TINY.split_at(TINY.find("[effects.gravity]").unwrap());
    let text = format!("{head}{}", &tail[tail.find("[body.pool]").unwrap()..]);
    fs::write(program.path("tiny.toml"), text).unwrap();
    program.run(&[]);
    for name in ["relax-pool", "impact", "post"] {
        let text = fs::read_to_string(program.latest(name).join("stamp.json")).unwrap();
        assert!(!text.contains("effects."), "{name}: {text}");
    }
    assert!(!program.path("artifacts/calibrate").exists());
}

/// Its own tension crushes what it relaxes: the strength is that of the packing.
#[test]
fn a_stress_inside_does_not_read_the_relaxation() {
    let program = Program::new();
    let inside = ["--set", "effects.tension.level=inside"];
    program.run(&[&inside[..], &["--until", "calibrate"]].concat());
    let plan = program.plan(&[&inside[..], &["--set", "relax.time=3 ms"]].concat());
    let stale = stale(&plan);
    assert!(stale.contains("relax drop"), "{stale:?}");
    assert!(!stale.contains("calibrate"), "{stale:?}");
}

/// What only a Poisson packing reads is in no key of a lattice.
#[test]
fn a_lattice_has_no_seed() {
    let program = Program::new();
    let lattice = ["--until", "pack", "--set", "pack.arrangement=lattice"];
    program.run(&lattice);
    for set in [
        "pack.seed=2",
        "pack.tolerance=3 kg/m^3",
        "pack.iterations=900",
    ] {
        let objects = program.run(&[&lattice[..], &["--set", set]].concat());
        let statuses = members(&objects, "status");
        assert!(
            statuses.values().all(|status| status == "fresh"),
            "{set}: {statuses:?}"
        );
    }
}

/// Particles of a lattice are numbered along the cells of the kernel, so methods of different
/// kernels share none.
#[test]
fn a_lattice_out_of_a_shared_store_is_that_of_its_own_kernel() {
    let lattice = ["--until", "pack", "--set", "pack.arrangement=lattice"];
    let (shared, mut packed) = (Program::new(), BTreeSet::new());
    for smoothing in ["1.2", "1.5", "2"] {
        let set = format!("method.wcsph.smoothing={smoothing}");
        let set = [&lattice[..], &["--set", &set]].concat();
        let (found, own) = (shared.run(&set), Program::new().run(&set));
        let found = members(&found, "digest");
        assert_eq!(found, members(&own, "digest"), "{smoothing}");
        packed.insert(found["pack pool"].clone());
    }
    assert!(packed.len() > 1, "order does not depend on the kernel");
}

/// A key is honest if what it leaves out really does not matter: what a setting leaves fresh is
/// made from nothing under that setting, with the same digest.
#[test]
fn what_stays_fresh_would_come_out_the_same() {
    let program = Program::new();
    let expected = members(&program.run(&["--until", "calibrate"]), "digest");
    let honest = |(set, stale, ..): &&Row| stale.len() < ALL.len() && !set.starts_with("post.");
    let mut compared = 0;
    for (set, stale, ..) in TABLE.iter().filter(honest) {
        let other = Program::new();
        let found = members(
            &other.run(&["--until", "calibrate", "--set", set]),
            "digest",
        );
        for (job, digest) in found
            .iter()
            .filter(|(job, _)| !stale.contains(&job.as_str()))
        {
            assert_eq!(digest, &expected[job], "{set} changed {job}");
            compared += 1;
        }
    }
    assert!(compared > 50, "{compared}");
}

#[test]
fn a_stamp_names_the_build() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let stamp = Stamp::read(&program.latest("pack-drop")).unwrap().unwrap();
    let version = format!("coronet {} (", env!("CARGO_PKG_VERSION"));
    let build = stamp.program.strip_prefix(&version).expect(&stamp.program);
    assert!(
        build.contains("rustc 1.") && build.ends_with(')'),
        "{build}"
    );
    if Path::new(env!("CARGO_MANIFEST_DIR")).join(".git").exists() {
        let commit = build.strip_prefix("commit ").expect(build);
        let digits = commit.chars().take_while(char::is_ascii_hexdigit).count();
        assert!(digits >= 12, "{build}");
    }
}

#[test]
fn names_that_would_break_the_store_are_refused() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let named = |name: &str| program.call(&["run", "tiny.toml", "--name", name]);
    named("manifest.json").badly(2, &["manifest.json"]);
    named("tiny/pack").badly(2, &["tiny/pack", "\"tiny\""]);
    let inner = ["run", "tiny.toml", "--until", "pack", "--name", "x/y"];
    program.call(&inner).well();
    // It was there before the name that it is inside of.
    let outer = ["run", "tiny.toml", "--until", "pack", "--name", "x"];
    program.call(&outer).well();
    program.call(&inner).well();
    named("x/z").badly(2, &["\"x/z\"", "\"x\""]);
    program.call(&["verify"]).well();
}

#[test]
fn a_store_of_a_newer_program_is_left_alone() {
    let program = Program::new();
    program.run(&["--until", "pack"]);
    let mark = program.path("artifacts/store.json");
    fs::write(&mark, "{ \"coronet_store\": 2 }").unwrap();
    program
        .call(&["run", "tiny.toml"])
        .badly(5, &["newer program", "--artifacts"]);
    assert_eq!(
        fs::read_to_string(mark).unwrap(),
        "{ \"coronet_store\": 2 }"
    );
}
