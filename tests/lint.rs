//! The lints: clippy without a warning, and the code as rustfmt leaves it.

use std::process::Command;

/// Runs cargo here, with a build folder of its own beside that of the tests.
fn passes(arguments: &[&str]) {
    let root = env!("CARGO_MANIFEST_DIR");
    let ended = Command::new(env!("CARGO"))
        .current_dir(root)
        .env("CARGO_TARGET_DIR", format!("{root}/target/lint"))
        .args(arguments)
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&ended.stderr);
    assert!(
        ended.status.success(),
        "cargo {}\n{text}",
        arguments.join(" ")
    );
}

#[test]
fn clippy_has_nothing_to_say() {
    let rest = ["--quiet", "--", "-D", "warnings"];
    passes(&[&["clippy", "--all-targets"], &rest[..]].concat());
    // Tests that only run when named are no part of all targets.
    let named = ["--test=validation", "--test=hard", "--test=campaign"];
    passes(&[&["clippy"], &named[..], &rest].concat());
}

#[test]
fn the_code_is_formatted() {
    passes(&["fmt", "--check"]);
}
