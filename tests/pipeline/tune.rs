//! `coronet tune` from outside.

use super::program::Program;
use std::fs;

const STUDY: &str = r#"
title = "Kinetic energy of a tiny splash"
pipeline = "tiny.toml"
set = ["impact.end=1 ms", "post.panels=[]", "post.fields=[]"]

[[axis]]
name = "spacing"
key = "pack.spacing"
values = ["0.6 mm", "0.4 mm", "0.3 mm"]

[error]
column = "kinetic_energy_J"
finest = true
"#;

fn program() -> Program {
    Program::with("study.toml", STUDY)
}

/// Errors of the points with one, by spacing, coarse to fine.
fn errors(program: &Program) -> Vec<f64> {
    let path = program.path("artifacts/latest/study/study.csv");
    let text = fs::read_to_string(path).unwrap();
    let cell = |line: &str| line.split(',').nth(5).unwrap().parse().ok();
    text.lines().skip(1).filter_map(cell).collect()
}

#[test]
fn the_cheapest_settings_run_as_they_are_printed() {
    let program = program();
    program.call(&["study", "study.toml"]).well();
    let [coarse, fine] = errors(&program)[..] else {
        panic!("two points have an error");
    };
    assert!(fine < coarse, "{fine} {coarse}");
    let wanted = format!("{}", (fine * coarse).sqrt());
    let arguments = ["tune", "study.toml", "--json", "--error", &wanted];
    let with_file = [&arguments[..], &["--output", "tuned.toml"]].concat();
    let tuned = program.call(&with_file).well().objects().pop().unwrap();
    let spacing = tuned["spacing_m"].as_f64().unwrap();
    assert!((0.4e-3 - 1e-9..0.6e-3).contains(&spacing), "{tuned}");
    let error = tuned["error"].as_f64().unwrap();
    assert!((fine..=coarse).contains(&error), "{tuned}");
    // The command and the file are the same run.
    let sets: Vec<&str> = tuned["set"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s.as_str().unwrap())
        .collect();
    let mut command = vec!["run", "tiny.toml", "--json"];
    sets.iter().for_each(|set| command.extend(["--set", set]));
    program.call(&command).well();
    let again = program.call(&["run", "tuned.toml", "--json"]).well();
    let stages = again.objects();
    let impact = stages
        .iter()
        .find(|line| line["stage"] == "impact")
        .unwrap();
    assert_eq!(impact["status"], "fresh", "{impact}");
}

#[test]
fn an_error_above_the_whole_is_refused() {
    let ended = program().call(&["tune", "study.toml", "--error", "5"]);
    ended.badly(2, &["--error `5`", "\"5 %\" or 0.05"]);
}

/// Where a measured point is chosen, running it gives what was predicted.
#[test]
fn a_prediction_is_checked() {
    let program = program();
    program.call(&["study", "study.toml"]).well();
    let most = errors(&program)[0] * 1.001;
    let wanted = format!("{most}");
    let arguments = [
        "tune",
        "study.toml",
        "--check",
        "--json",
        "--error",
        &wanted,
    ];
    let tuned = program.call(&arguments).well().objects().pop().unwrap();
    assert_eq!(tuned["spacing_m"].as_f64(), Some(0.6e-3), "{tuned}");
    let found = tuned["checked"]["error"].as_f64().unwrap();
    assert!(
        (found / tuned["error"].as_f64().unwrap() - 1.0).abs() < 1e-9,
        "{tuned}"
    );
}

/// Between two points errors are only guessed; what it ends with is measured all the same.
#[test]
fn what_is_checked_meets_the_error() {
    let program = program();
    program.call(&["study", "study.toml"]).well();
    let found = errors(&program);
    let (fine, coarse) = (found[1].min(found[0]), found[1].max(found[0]));
    for part in [0.25, 0.5, 0.75] {
        let wanted = fine * (coarse / fine).powf(part);
        let error = format!("{wanted}");
        let arguments = ["tune", "study.toml", "--check", "--json", "--error", &error];
        let tuned = program.call(&arguments).well().objects().pop().unwrap();
        let checked = tuned["checked"]["error"].as_f64().unwrap();
        assert!(checked <= wanted, "{part}: {tuned}");
        for miss in tuned["missed"].as_array().unwrap() {
            assert!(miss["error"].as_f64().unwrap() > wanted, "{tuned}");
        }
    }
}

#[test]
fn what_cannot_be_met_is_said() {
    let program = program();
    let none = program.call(&["tune", "study.toml", "--error", "0.0001 %"]);
    none.badly(1, &["kinetic_energy_J", "the best point", "finer"]);
    program
        .call(&["tune", "study.toml", "--error", "much"])
        .badly(2, &["--error", "much", "5 %"]);
}
