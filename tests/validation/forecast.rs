//! What `coronet plan` says that a run will take against what the run takes, in a new store:
//! `cargo test --release --test validation forecast -- --nocapture`.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::{Figure, method_name};

/// Name, scene, overrides: both dimensions, rings, a quarter, with and without contact angles.
const CASES: [(&str, &str, &[&str]); 7] = [
    ("tiny", "scenes/tiny.toml", &[]),
    (
        "drop on a wall, 2-D",
        "scenes/xie-2007/static.toml",
        &["impact.end=20 ms"],
    ),
    ("dam break, 2-D", "scenes/verification/dam-break.toml", &[]),
    (
        "disc at rest, 2-D",
        "scenes/verification/static-drop-2d.toml",
        &[],
    ),
    ("rebound, a quarter", "scenes/hard/rebound.toml", &[]),
    (
        "pool, d/8, a quarter",
        "pipeline.toml",
        &[
            "box.symmetry=quarter",
            "pack.spacing=0.5 mm",
            "impact.end=10 ms",
        ],
    ),
    (
        "pool, d/12, rings",
        "pipeline.toml",
        &[
            "box.symmetry=axis",
            "box.x=wall",
            "box.y=wall",
            "impact.end=10 ms",
        ],
    ),
];

/// The forecast should be right within a factor of 1.5. Beyond twice that deviation, which other
/// programs on the machine do not cause, the test fails.
const TARGET: f64 = 0.5;
const WORST: f64 = 2.0;
const MEGA: f64 = 1e6;

/// Cost of all stages: CPU seconds, largest memory and size of the files, bytes.
#[derive(Default)]
struct Cost {
    cpu: f64,
    memory: f64,
    disk: f64,
}

#[test]
fn forecast() {
    println!();
    let mut all_near = true;
    for (case, scene, sets) in CASES {
        let store = tempfile::tempdir().expect("a folder for temporary files");
        let [expected, spent] = [
            planned(store.path(), scene, sets),
            ran(store.path(), scene, sets),
        ];
        let row = |what, got, theory, target| {
            let figure = Figure {
                case,
                preset: "modern",
                what,
                got,
                theory: Some(theory),
                target,
            };
            figure.row()
        };
        row("CPU time, s", spent.cpu, expected.cpu, TARGET);
        row(
            "memory, MB",
            spent.memory / MEGA,
            expected.memory / MEGA,
            TARGET,
        );
        row("files, MB", spent.disk / MEGA, expected.disk / MEGA, TARGET);
        all_near &= (1.0 / WORST..WORST).contains(&(spent.cpu / expected.cpu));
    }
    assert!(all_near, "CPU time is forecast within a factor of {WORST}");
}

/// Lines of JSON that a command prints, on one thread: its time is the CPU time.
fn lines(command: &str, store: &Path, scene: &str, sets: &[&str]) -> Vec<Value> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_coronet"));
    program.arg(command).arg(root.join(scene)).args(["--json"]);
    program
        .arg("--artifacts")
        .arg(store)
        .env("RAYON_NUM_THREADS", "1");
    if command == "run" {
        program.args(["--threads", "1"]);
    }
    let method = format!("method.name={}", method_name());
    for set in sets.iter().copied().chain([&method[..]]) {
        program.args(["--set", set]);
    }
    let ended = program.output().expect("the program starts");
    assert!(
        ended.status.success(),
        "{}",
        String::from_utf8_lossy(&ended.stderr)
    );
    let out = String::from_utf8(ended.stdout).expect("it is text");
    let parsed = out.lines().map(serde_json::from_str);
    parsed.collect::<Result<_, _>>().expect("lines are JSON")
}

fn planned(store: &Path, scene: &str, sets: &[&str]) -> Cost {
    let mut cost = Cost::default();
    let planned = lines("plan", store, scene, sets);
    for line in planned.iter().filter(|line| line["stage"].is_string()) {
        let number = |name: &str| line[name].as_f64().unwrap_or(0.0);
        cost.cpu += number("seconds");
        cost.memory = cost.memory.max(number("memory_bytes"));
        cost.disk += number("disk_bytes");
    }
    cost
}

fn ran(store: &Path, scene: &str, sets: &[&str]) -> Cost {
    let mut cost = Cost::default();
    for line in lines("run", store, scene, sets) {
        let (Some(cpu), Some(folder)) = (line["cpu_seconds"].as_f64(), line["folder"].as_str())
        else {
            continue;
        };
        cost.cpu += cpu;
        let folder = PathBuf::from(folder);
        cost.disk += size(&folder);
        let stamp = std::fs::read(folder.join("stamp.json")).expect("a result has a stamp");
        let stamp: Value = serde_json::from_slice(&stamp).expect("it is JSON");
        cost.memory = cost
            .memory
            .max(stamp["memory_bytes"].as_f64().unwrap_or(0.0));
    }
    cost
}

/// Bytes of the files in a folder.
fn size(folder: &Path) -> f64 {
    let entries = std::fs::read_dir(folder).expect("it can be read");
    let sizes = entries.map(|entry| {
        let entry = entry.expect("it can be read");
        match entry.metadata().expect("it is there") {
            kind if kind.is_dir() => size(&entry.path()),
            file => file.len() as f64,
        }
    });
    sizes.sum()
}
