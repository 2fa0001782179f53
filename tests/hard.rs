//! The stability suite, some minutes on two cores:
//! `cargo test --release --test hard -- --nocapture`.
//!
//! Fails if a hard case breaks a promise that its study does not say is broken, or keeps one that
//! it says is.

use std::process::Command;

#[test]
fn hard_cases_do_what_their_study_says() {
    keeps("hard-cases");
}

#[test]
fn water_does_what_its_study_says() {
    keeps("water-cases");
}

#[test]
fn rings_do_what_their_study_says() {
    keeps("hard-rings");
}

/// Runs the study `name` of `scenes/study`.
fn keeps(name: &str) {
    let store = tempfile::tempdir().unwrap();
    let ended = Command::new(env!("CARGO_BIN_EXE_coronet"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["study", &format!("scenes/study/{name}.toml"), "--jobs", "2"])
        .arg("--artifacts")
        .arg(store.path())
        .status()
        .unwrap();
    let page = store.path().join(format!("latest/{name}/promises.md"));
    println!("{}", std::fs::read_to_string(page).unwrap_or_default());
    assert!(ended.success());
}
