//! Names of results: what they lead to when files are missing, or when something else has the name.

use std::fs;

use super::program::{Program, members};

/// A store with the results of one name.
fn packed() -> Program {
    let program = Program::new();
    program
        .call(&["run", "tiny.toml", "--until", "pack"])
        .well();
    program
}

/// What `verify` finds wrong.
fn verified(program: &Program) -> String {
    let ended = program.call(&["verify"]);
    ended.badly(4, &[]);
    ended.out
}

#[test]
fn the_points_of_a_study_are_forgotten_by_its_name() {
    let program = packed();
    for name in ["speeds-01", "speeds-02", "speeds-old"] {
        let arguments = ["run", "tiny.toml", "--until", "pack", "--name", name];
        program.call(&arguments).well();
    }
    program.call(&["gc", "--forget", "speeds"]).well();
    let is_known = |name: &str| program.path(&format!("artifacts/latest/{name}")).exists();
    assert!(!is_known("speeds-01") && !is_known("speeds-02"));
    assert!(is_known("speeds-old") && is_known("tiny"));
}

#[test]
fn a_name_without_its_list_disturbs_no_other() {
    let program = packed();
    let arguments = ["run", "tiny.toml", "--until", "pack", "--name", "other"];
    program.call(&arguments).well();
    let manifest = program.path("artifacts/latest/tiny/manifest.json");
    fs::remove_file(&manifest).unwrap();
    let listed = program.call(&["list"]).well();
    assert!(listed.out.contains("other"), "{}", listed.out);
    assert!(listed.err.contains("tiny"), "{}", listed.err);
    // What the name led to is not known, so nothing may go.
    let remedy = "`coronet run` writes it again";
    program.call(&["gc", "--yes"]).badly(4, &[remedy]);
    assert!(verified(&program).contains("manifest.json"));
    program
        .call(&["run", "tiny.toml", "--until", "pack"])
        .well();
    assert!(manifest.is_file());
    program.call(&["gc", "--yes"]).well();
}

#[test]
fn a_name_is_meant_before_a_folder_of_that_name() {
    let program = packed();
    fs::create_dir(program.path("tiny")).unwrap();
    let shown = program.call(&["show", "tiny"]).well();
    assert!(shown.out.contains("drop"), "{}", shown.out);
}

#[test]
fn a_result_that_is_gone_or_a_folder_is_told_and_made_again() {
    let program = packed();
    let result = program.latest("pack-drop").canonicalize().unwrap();
    let file = result.join("body.checkpoint");
    fs::remove_file(&file).unwrap();
    fs::create_dir(&file).unwrap();
    let arguments = ["run", "tiny.toml", "--until", "pack", "--json"];
    let found = members(&program.call(&arguments).well().objects(), "status");
    assert!(found.values().any(|status| status == "ran"), "{found:?}");
    fs::remove_dir_all(&result).unwrap();
    assert!(verified(&program).contains("is gone"));
    // The rest of the run is there.
    let listed = program.call(&["list"]).well();
    assert!(listed.out.contains("unfinished"), "{}", listed.out);
    assert!(listed.err.contains("is gone"), "{}", listed.err);
    program.call(&["diff", "tiny", "tiny"]).well();
    program.call(&arguments).well();
    program.call(&["verify"]).well();
}
