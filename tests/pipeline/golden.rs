//! Guards of VERSION: digests of tiny results, by stage and VERSION.
//!
//! When this test fails, the same settings give other numbers than before. If that is meant, raise
//! the stage's VERSION in `stages/jobs.rs` and renew them with
//! `UPDATE=1 cargo test --release --test pipeline golden`; if not, a change of the code has changed
//! results without intent. Digests of a stage change with those
//! of the stages before it: only the first needs another VERSION.

use std::fs;

use coronet::pipeline::Stamp;

use crate::program::Program;
use crate::rings::RINGS;

const GOLDEN: &str = include_str!("golden.txt");

/// Every job of the scene but `post`, whose pictures change more often than its numbers.
const JOBS: [&str; 6] = [
    "pack-pool",
    "relax-pool",
    "pack-drop",
    "relax-drop",
    "calibrate",
    "impact",
];

#[test]
fn results_change_only_with_their_version() {
    let mut found = String::new();
    for (method, preset, kind) in [
        ("wcsph", "corrected", ""),
        ("wcsph", "modern", ""),
        ("isph", "modern", ""),
        ("mps", "modern", ""),
        ("mps", "corrected", ""),
        ("wcsph", "modern", " wet"),
        ("isph", "modern", " wet"),
        ("wcsph", "modern", " rings"),
        ("isph", "modern", " rings"),
        ("mps", "modern", " rings"),
    ] {
        let program = match kind {
            " rings" => Program::with("tiny.toml", RINGS),
            _ => Program::new(),
        };
        let [method_set, preset_set] = [("name", method), ("preset", preset)]
            .map(|(key, value)| format!("method.{key}={value}"));
        let mut sets = vec!["--set", &method_set, "--set", &preset_set];
        if method == "mps" {
            // Its viscosity has one form.
            sets.extend(["--set", "effects.viscosity={ dynamic = \"1 mPa s\" }"]);
        }
        if kind == " wet" {
            // The pool has contact lines.
            sets.extend([
                "--set",
                "box.x=wall",
                "--set",
                "effects.wetting.angle=60 deg",
            ]);
        }
        if kind == " rings" {
            // Until some have merged.
            sets.extend(["--set", "impact.end=4 ms", "--set", "relax.time=2 ms"]);
        }
        program.run(&sets);
        for job in JOBS {
            let stamp = Stamp::read(&program.latest(job)).unwrap().unwrap();
            found += &format!(
                "{method} {preset}{kind} {job} {} {}\n",
                stamp.version, stamp.digest
            );
        }
        let measures = fs::read(program.latest("post").join("measures.csv")).unwrap();
        let stamp = Stamp::read(&program.latest("post")).unwrap().unwrap();
        let digest = coronet::record::Digest::of(&measures);
        found += &format!(
            "{method} {preset}{kind} measures {} {digest}\n",
            stamp.version
        );
    }
    if std::env::var_os("UPDATE").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/pipeline/golden.txt");
        return fs::write(path, found).unwrap();
    }
    assert!(found == GOLDEN, "found\n{found}expected\n{GOLDEN}");
}
