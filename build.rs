//! Tells the program what it was built from: `CORONET_BUILD`, for stamps and logs.

use std::process::Command;

fn main() {
    for place in ["build.rs", "src", "Cargo.toml", "Cargo.lock"] {
        println!("cargo:rerun-if-changed={place}");
    }
    // A release names its commit. Elsewhere a new commit or a change of `stages` alone need not
    // build the engine again.
    if std::env::var("PROFILE").is_ok_and(|profile| profile == "release") {
        let moves = output("git", &["rev-parse", "--git-path", "logs/HEAD"]);
        let moves = moves.filter(|path| std::path::Path::new(path).exists());
        for place in moves.into_iter().chain(["stages".to_string()]) {
            println!("cargo:rerun-if-changed={place}");
        }
    }
    let compiler = std::env::var("RUSTC").unwrap_or("rustc".to_string());
    let version = output(&compiler, &["--version"]).unwrap_or_default();
    // `rustc 1.96.0 (59807616e 2026-04-14)`
    let compiler = version.split(" (").next().unwrap_or_default();
    let build = match commit() {
        Some(commit) => format!("commit {commit}, {compiler}"),
        None => compiler.to_string(),
    };
    println!("cargo:rustc-env=CORONET_BUILD={build}");
}

/// Commit of the checkout that this is the root of, with `+` if the sources differ from it.
fn commit() -> Option<String> {
    let inside = output("git", &["rev-parse", "--show-prefix"])?;
    if !inside.is_empty() {
        return None;
    }
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"])?;
    let places = ["status", "--porcelain", "--", "src", "stages", "Cargo.lock"];
    let changed = output("git", &places)?;
    Some(if changed.is_empty() {
        commit
    } else {
        format!("{commit}+")
    })
}

/// What a command prints, if it ends well.
fn output(command: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(command).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}
