//! `impact.stop_when`: a run ends by what its frames show, at the same frame through any
//! interruption.

use std::collections::BTreeMap;
use std::fs;

use coronet::measure::series::Series;
use coronet::pipeline::Stamp;
use serde_json::Value;

use crate::program::{Ended, Program, members};

/// Long enough for the crater of `tiny.toml` to be deepest and to rise.
const END: &str = "impact.end=60 ms";
const LATER: &str = "impact.end=80 ms";
const STOP: &str = "impact.stop_when=['crater-deepest', 'rest']";
/// Particle spacing of `tiny.toml`, m.
const SPACING: f64 = 0.3e-3;

fn measures(program: &Program) -> Series {
    Series::read(&program.latest("post").join("measures.csv")).unwrap()
}

/// Place of the frame at which the crater counts as deepest, as the manual tells it.
fn deepest(series: &Series) -> usize {
    let (mut lowest, mut held) = (0.0f64, 0);
    for (place, z) in series.column("axis_level_m").unwrap().iter().enumerate() {
        lowest = lowest.min(*z);
        let rise = SPACING.max(-0.1 * lowest);
        let holds = lowest <= -2.0 * SPACING && z - lowest >= rise;
        held = if holds { held + 1 } else { 0 };
        if held == 3 {
            return place;
        }
    }
    panic!("the crater never rises: {series:?}");
}

/// Digest of every result but of the report, whose input contains the end.
fn results(program: &Program, objects: &[Value]) -> BTreeMap<String, String> {
    let mut all = program.fingerprint(objects);
    all.remove("post").unwrap();
    all
}

#[test]
fn until_a_stage_runs_only_what_that_needs() {
    let program = Program::new();
    let packed = members(&program.run(&["--until", "pack"]), "status");
    let names: Vec<&str> = packed.keys().map(String::as_str).collect();
    assert_eq!(names, ["pack drop", "pack pool"]);
    let relaxed = members(&program.run(&["--until", "relax"]), "status");
    assert_eq!(relaxed.len(), 4);
    let told = program.call(&["show", "tiny", "--json"]).well();
    assert_eq!(told.objects().len(), 4);
}

#[test]
fn a_run_ends_with_the_frame_that_shows_it() {
    let program = Program::new();
    program.run(&["--set", END]);
    let whole = measures(&program);
    let place = deepest(&whole);
    assert!(place + 8 < whole.len(), "it would end anyway");

    let objects = program.run(&["--set", END, "--set", STOP]);
    let short = measures(&program);
    assert_eq!(short.len(), place + 1);
    for (name, column) in short.names.iter().zip(&short.columns) {
        // The evaluation blanks jets before the deepest crater, which both runs have.
        let long = &whole.column(name).unwrap()[..=place];
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(column), bits(long), "{name}");
    }

    // The end of a run, the note and the report tell it, also when nothing runs.
    let at = format!(
        "stopped at t = {:.3} ms by `crater-deepest`",
        1e3 * short.time()[place]
    );
    let ended = objects.last().unwrap()["ended"].as_str().unwrap();
    assert!(
        ended.starts_with(&at) && ended.ends_with("before impact.end = 60 ms"),
        "{ended}"
    );
    let stamp = Stamp::read(&program.latest("impact")).unwrap().unwrap();
    assert_eq!(stamp.notes, [ended]);
    let page = fs::read_to_string(program.latest("post").join("report.html")).unwrap();
    let shown = ended.replacen('`', "<code>", 1).replacen('`', "</code>", 1);
    assert!(page.contains(&format!("The run {shown}.")), "the report");
    let again = program
        .call(&["run", "tiny.toml", "--set", END, "--set", STOP])
        .well();
    assert!(
        again.out.contains(&format!("ended    {at}")),
        "{}",
        again.out
    );
}

#[test]
fn a_run_that_meets_no_condition_says_so_and_is_that_without_conditions() {
    let plain = Program::new();
    let expected = plain.fingerprint(&plain.run(&[]));
    let program = Program::new();
    let objects = program.run(&["--set", "impact.stop_when=['level-crossed']"]);
    let ended = objects.last().unwrap()["ended"].as_str().unwrap();
    assert!(
        ended.starts_with("ran to impact.end = 4 ms") && ended.contains("impact.stop_when"),
        "{ended}"
    );
    let found = program.fingerprint(&objects);
    for name in ["frames", "measures"] {
        assert_eq!(found[name], expected[name], "{name}");
    }
    assert_eq!(plain.run(&[]).last().unwrap()["ended"], Value::Null);
}

#[test]
fn it_ends_at_the_same_frame_after_interruptions_and_with_other_ends() {
    let undisturbed = Program::new();
    let run = |program: &Program, end: &str, threads: &str| {
        program.run(&["--set", end, "--set", STOP, "--threads", threads])
    };
    let expected = results(&undisturbed, &run(&undisturbed, END, "1"));

    let stopped = Program::new();
    let arguments = ["run", "tiny.toml", "--json", "--set", END, "--set", STOP];
    for attempt in 0..3 {
        let mut child = stopped.start(&arguments);
        stopped.in_flight(&mut child);
        // Frames are taken meanwhile.
        std::thread::sleep(std::time::Duration::from_millis(30));
        let signal = [libc::SIGINT, libc::SIGKILL][attempt % 2];
        let id = i32::try_from(child.id()).unwrap();
        // As `timeout` does, which signals the process and then its group: that is one request.
        for echo in 0..2 {
            std::thread::sleep(std::time::Duration::from_millis(20 * echo));
            // SAFETY: sends a signal to a child that was not waited for, so the number is its own.
            assert_eq!(unsafe { libc::kill(id, signal) }, 0);
        }
        let ended = Ended::from(child.wait_with_output().unwrap());
        if attempt == 0 {
            ended.badly(130, &["the same command continues"]);
        }
    }
    let objects = run(&stopped, END, "2");
    assert_eq!(results(&stopped, &objects), expected);

    // A later end does not continue it, and takes over what there is.
    let objects = run(&stopped, LATER, "2");
    assert_eq!(members(&objects, "status")["impact"], "resumed");
    assert_eq!(results(&stopped, &objects), expected);
    let ended = objects.last().unwrap()["ended"].as_str().unwrap();
    assert!(ended.ends_with("before impact.end = 80 ms"), "{ended}");

    // An earlier end comes first, and a later one then goes on to the condition.
    let short = Program::new();
    let early = "impact.end=3 ms";
    let objects = run(&short, early, "2");
    let ended = objects.last().unwrap()["ended"].as_str().unwrap();
    assert!(ended.starts_with("ran to impact.end = 3 ms"), "{ended}");
    assert_eq!(
        results(&stopped, &run(&stopped, early, "2")),
        results(&short, &objects)
    );
    let objects = run(&short, LATER, "2");
    assert_eq!(members(&objects, "status")["impact"], "resumed");
    assert_eq!(results(&short, &objects), expected);
}

#[test]
fn a_drop_that_rebounds_from_a_wall_ends_the_run() {
    let program = Program::new();
    let text = fs::read_to_string(program.path("tiny.toml")).unwrap();
    let pool = "[body.pool]\nlayer = { depth = \"3 mm\" }\ncolour = \"#2f6fb0\"\n";
    let hangs = "gap = \"0.5 mm\", above = \"pool\"";
    assert!(text.contains(pool) && text.contains(hangs));
    let text = text
        .replace(pool, "")
        .replace(hangs, "centre = [\"6 mm\", \"1.7 mm\"]");
    fs::write(program.path("tiny.toml"), text).unwrap();
    let wrong = [
        "run",
        "tiny.toml",
        "--set",
        "impact.stop_when=['crater-deepest']",
    ];
    program.call(&wrong).badly(
        2,
        &[
            "`impact.stop_when[0]` = \"crater-deepest\"",
            "is a pool",
            "remove this word",
        ],
    );
    // Water does not wet it: it bounces in a few capillary times, sqrt(rho R^3 / sigma) = 5 ms.
    let sets = [
        "effects.wetting.angle=175 deg",
        "impact.stop_when=['rebound']",
        "impact.end=60 ms",
        "body.drop.velocity=0.4 m/s",
        "post.panels=[]",
    ];
    let mut arguments = Vec::new();
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let objects = program.run(&arguments);
    let ended = objects.last().unwrap()["ended"].as_str().unwrap();
    assert!(ended.contains("by `rebound`"), "{ended}");
    let spread = measures(&program);
    let spread = spread.column("spread_factor").unwrap();
    let count = spread.len();
    assert!(
        spread[count - 3..].iter().all(|x| *x == 0.0) && spread[count - 4] > 0.0,
        "{spread:?}"
    );
}
