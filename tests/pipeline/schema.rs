//! The schema of study files: as shipped, and named by every study.

use std::fs;
use std::path::{Path, PathBuf};

use crate::program::Program;

const STUDIES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/study");

#[test]
fn the_shipped_schema_of_studies_is_that_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/study.schema.json");
    let schema = Program::new().call(&["schema", "study"]).well().out;
    if std::env::var_os("UPDATE").is_some() {
        fs::write(&path, &schema).unwrap();
    }
    let shipped = fs::read_to_string(&path).unwrap();
    let remedy = "UPDATE=1 cargo test --release --test pipeline schema";
    assert_eq!(
        shipped, schema,
        "the format of studies changed: run {remedy}"
    );
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema["additionalProperties"], false);
    for key in ["title", "axis", "error", "figure", "curves", "case"] {
        assert!(schema["properties"][key].is_object(), "{key}");
    }
}

#[test]
fn the_shipped_page_of_settings_is_that_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/reference/settings.md");
    let page = Program::new().call(&["schema", "--markdown"]).well().out;
    if std::env::var_os("UPDATE").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let shipped = fs::read_to_string(&path).unwrap();
    let remedy = "UPDATE=1 cargo test --release --test pipeline schema";
    assert_eq!(shipped, page, "the format of scenes changed: run {remedy}");
    for part in [
        "## `[effects.wetting]`",
        "| `spacing` |",
        "wendland-c2",
        "of the preset",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn mistakes_of_a_study_are_reported_all_at_once() {
    let program = Program::new();
    let study =
        "titel = 'x'\n[[axis]]\nname = 'n'\nvalues = 3\n[error]\ncolumn = 'a'\nof = 'lst'\n";
    fs::write(program.path("study.toml"), study).unwrap();
    program.call(&["study", "study.toml"]).badly(
        2,
        &[
            "3 mistakes",
            "study.toml:1:1: unknown key `titel`; did you mean `title`?",
            "study.toml:4:10: `axis[0].values` = 3",
            "study.toml:7:6: `error.of` = \"lst\": is not known; did you mean \"last\"?",
        ],
    );
}

#[test]
fn a_file_for_another_command_is_recognized() {
    let program = Program::new();
    let study = Path::new(STUDIES).join("pool.toml").display().to_string();
    for command in ["run", "plan"] {
        let remedy = format!("pool.toml: is a study; run `coronet study {study}`");
        program.call(&[command, &study]).badly(2, &[&remedy]);
    }
    let scene = Path::new(STUDIES)
        .join("../tiny.toml")
        .display()
        .to_string();
    let remedy = format!("tiny.toml: is a scene; run `coronet run {scene}`, or name it");
    program.call(&["study", &scene]).badly(2, &[&remedy]);
}

/// The study files as shipped.
fn studies() -> Vec<PathBuf> {
    let files = fs::read_dir(STUDIES)
        .unwrap()
        .map(|file| file.unwrap().path());
    let studies: Vec<_> = files
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    assert!(studies.len() > 20);
    studies
}

#[test]
fn every_study_loads_and_has_a_forecast() {
    let program = Program::new();
    for path in studies() {
        let path = path.display().to_string();
        let looked = program.call(&["study", &path, "--look", "--json"]).well();
        let points = looked.objects().pop().unwrap()["points"].clone();
        let points = points.as_array().unwrap();
        assert!(!points.is_empty(), "{path}");
        let seconds = |point: &serde_json::Value| point["cpu_seconds"].as_f64().unwrap();
        assert!(points.iter().map(seconds).sum::<f64>() > 0.0, "{path}");
    }
}

#[test]
fn every_study_names_its_schema() {
    for path in studies() {
        let text = fs::read_to_string(&path).unwrap();
        let first = text.lines().next().unwrap();
        assert_eq!(
            first,
            "#:schema ../../docs/study.schema.json",
            "{}",
            path.display()
        );
    }
}
