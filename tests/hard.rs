//! The stability suite, some five minutes on two cores:
//! `cargo test --release --test hard -- --nocapture`.
//!
//! Fails if a hard case breaks a promise that `scenes/study/hard-cases.toml` does not say is
//! broken, or keeps one that it says is.

use std::process::Command;

#[test]
fn hard_cases_do_what_their_study_says() {
    let store = tempfile::tempdir().unwrap();
    let ended = Command::new(env!("CARGO_BIN_EXE_coronet"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["study", "scenes/study/hard-cases.toml", "--jobs", "2"])
        .arg("--artifacts")
        .arg(store.path())
        .status()
        .unwrap();
    let page = store.path().join("latest/hard-cases/promises.md");
    println!("{}", std::fs::read_to_string(page).unwrap_or_default());
    assert!(ended.success());
}
