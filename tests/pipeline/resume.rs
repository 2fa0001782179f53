//! Kills, threads, and other ends: the result is the same, bit for bit.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::time::{Duration, Instant};

use coronet::pipeline::Stamp;

use crate::program::{Program, label, members};

/// Kills over the test, at least; more if these hit fewer than [`STAGES`].
const KILLS: usize = 20;

/// Stages that must be hit.
const STAGES: usize = 3;

/// Delays that look random and are the same in every run (a 64-bit linear congruential generator,
/// Knuth's MMIX constants).
struct Delays(u64);

impl Delays {
    /// Between `low` and `high`.
    fn next(&mut self, low: Duration, high: Duration) -> Duration {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let part = (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low).mul_f64(part)
    }
}

#[test]
fn killed_runs_end_as_undisturbed_ones() {
    let undisturbed = Program::new();
    let start = Instant::now();
    let expected = undisturbed.fingerprint(&undisturbed.run(&[]));
    // On average each attempt gets a sixth of the way, so the kills go over all stages. Other tests
    // may have slowed this one run: the time is shortened whenever an attempt gets to the end.
    let mut longest = start.elapsed() / 3;
    let killed = Program::new();
    let mut delays = Delays(1);
    let mut hit = BTreeSet::new();
    let (mut kills, mut idle) = (0, 0);
    while kills < KILLS || hit.len() < STAGES {
        assert!(kills < 20 * KILLS, "kills hit only {hit:?}");
        let mut child = killed.start(&["run", "tiny.toml", "--json"]);
        std::thread::sleep(delays.next(Duration::from_millis(2), longest));
        if child.try_wait().unwrap().is_some() {
            // It had ended already: compare, then once more from nothing.
            let objects = killed.run(&[]);
            assert_eq!(
                killed.fingerprint(&objects),
                expected,
                "after {kills} kills"
            );
            fs::remove_dir_all(killed.path("artifacts")).unwrap();
            longest = longest.mul_f64(0.7);
            continue;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        let plan = killed.plan(&[]);
        let next = plan.iter().find(|job| job["status"] != "fresh");
        let is_new = next.is_some_and(|next| hit.insert(next["stage"].to_string()));
        idle = if is_new { 0 } else { idle + 1 };
        // A stage that begins anew each time, as `post`, may need longer than an attempt has.
        if idle >= KILLS {
            (idle, longest) = (0, longest.mul_f64(1.5));
        }
    }
    let objects = killed.run(&[]);
    assert_eq!(killed.fingerprint(&objects), expected);
    killed.call(&["verify"]).well();
    let folder = killed.latest("impact");
    assert!(!folder.join("work").exists());
}

#[test]
fn threads_do_not_change_results() {
    for preset in ["paper", "corrected", "modern"] {
        let preset = format!("method.preset={preset}");
        // The paper's fixed step is short: a part of the way is enough.
        let more = [
            "--set",
            &preset,
            "--set",
            "impact.end=1 ms",
            "--set",
            "relax.time=1 ms",
        ];
        let fingerprint = |threads| {
            let program = Program::new();
            let objects = program.run(&[&more[..], &["--threads", threads]].concat());
            program.fingerprint(&objects)
        };
        let expected = fingerprint("1");
        for threads in ["2", "4"] {
            assert_eq!(
                fingerprint(threads),
                expected,
                "{preset}, {threads} threads"
            );
        }
    }
}

#[test]
fn another_end_continues_and_equals_a_run_from_the_start() {
    let ends = [
        "impact.end=2.3 ms",
        "impact.end=5.1 ms",
        "impact.end=3.7 ms",
    ];
    let from_start: Vec<_> = ends
        .iter()
        .map(|end| {
            let program = Program::new();
            program.fingerprint(&program.run(&["--set", end]))
        })
        .collect();
    let program = Program::new();
    let mut costs = Vec::new();
    for (index, end) in ends.iter().enumerate() {
        let objects = program.run(&["--set", end]);
        assert_eq!(program.fingerprint(&objects), from_start[index], "{end}");
        // The longer one continues; the shorter one starts from a checkpoint on the way.
        let status = &members(&objects, "status")["impact"];
        assert_eq!(status, if index == 0 { "ran" } else { "resumed" }, "{end}");
        let stamp = Stamp::read(&program.latest("impact")).unwrap().unwrap();
        costs.push(stamp.cpu_seconds);
    }
    // With the part that another run had made.
    assert!(
        costs[1] > costs[0] && costs[2] > 0.2 * costs[1],
        "{costs:?}"
    );
}

#[test]
fn a_signal_or_a_kill_in_flight_leaves_a_checkpoint_from_which_the_same_command_goes_on() {
    let long = ["--set", "impact.end=8 ms"];
    let undisturbed = Program::new();
    let expected = undisturbed.fingerprint(&undisturbed.run(&long));
    for signal in [libc::SIGINT, libc::SIGKILL] {
        goes_on_after(signal, &long, &expected);
    }
}

fn goes_on_after(signal: i32, long: &[&str], expected: &BTreeMap<String, String>) {
    let program = Program::new();
    program.run(&["--until", "calibrate"]);
    let mut child = program.start(&[&["run", "tiny.toml", "--json"], long].concat());
    program.in_flight(&mut child);
    let pid = i32::try_from(child.id()).unwrap();
    // SAFETY: sends a signal to a child that was not waited for, so the number is still its own.
    assert_eq!(unsafe { libc::kill(pid, signal) }, 0);
    let ended = crate::program::Ended::from(child.wait_with_output().unwrap());
    if signal == libc::SIGINT {
        ended.badly(130, &["the same command continues"]);
    }
    let plan = program.plan(long);
    let next = plan.iter().find(|job| job["status"] != "fresh").unwrap();
    assert_eq!(
        (label(next).as_str(), next["status"].as_str()),
        ("impact", Some("resumes"))
    );
    let objects = program.run(long);
    assert_eq!(members(&objects, "status")["impact"], "resumed");
    assert_eq!(program.fingerprint(&objects), *expected);
}

#[test]
fn a_signal_stops_a_packing() {
    let program = Program::new();
    // Density sums in f32 never get there.
    let endless = [
        "run",
        "tiny.toml",
        "--set",
        "pack.tolerance=1e-9 kg/m^3",
        "--set",
        "pack.iterations=1000000000",
    ];
    let mut child = program.start(&endless);
    while !program.path("artifacts/pack").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended");
        std::thread::sleep(Duration::from_millis(2));
    }
    std::thread::sleep(Duration::from_millis(100));
    let pid = i32::try_from(child.id()).unwrap();
    // SAFETY: sends a signal to a child that was not waited for, so the number is still its own.
    assert_eq!(unsafe { libc::kill(pid, libc::SIGINT) }, 0);
    let ended = crate::program::Ended::from(child.wait_with_output().unwrap());
    ended.badly(
        130,
        &[
            "pack pool: stopped on request",
            "the same command continues",
        ],
    );
    let plan = program.plan(&[]);
    assert!(
        plan.iter()
            .filter(|job| job["stage"] == "pack")
            .all(|job| job["status"] != "fresh")
    );
    program.run(&["--until", "pack"]);
}

#[test]
fn a_second_run_is_fresh_and_quick() {
    let program = Program::new();
    program.run(&[]);
    let start = Instant::now();
    let objects = program.run(&[]);
    assert!(
        start.elapsed() < Duration::from_secs(1),
        "{:?}",
        start.elapsed()
    );
    let statuses = members(&objects, "status");
    assert!(
        statuses.values().all(|status| status == "fresh"),
        "{statuses:?}"
    );
}

/// Of several that it could continue, the reasons compare with the one that it names.
#[test]
fn a_plan_gives_the_reasons_against_what_it_continues() {
    let program = Program::new();
    let end = |end: &'static str| ["--set", "pack.spacing=0.6 mm", "--set", end];
    program.run(&end("impact.end=1.3 ms"));
    // Of another second, in which stamps tell their start.
    std::thread::sleep(Duration::from_millis(1100));
    program.run(&end("impact.end=1 ms"));
    let plan = program.plan(&end("impact.end=2 ms"));
    let impact = plan.iter().find(|job| job["stage"] == "impact").unwrap();
    assert_eq!(impact["start"], "the result for impact.end = 1.3 ms");
    let reasons = impact["reasons"].as_array().unwrap();
    assert_eq!(reasons.as_slice(), ["impact.end 1.3 ms -> 2 ms"]);
}
