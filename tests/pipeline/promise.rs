//! `coronet study` with cases and promises, from outside.

use super::program::Program;
use std::fs;

const STUDY: &str = r#"
title = "Cases"
pipeline = "tiny.toml"
set = ["impact.end=1 ms", "post.panels=[]", "post.fields=[]"]

[[axis]]
name = "speed of sound"
points = [
    { label = "adaptive" },
    { label = "constant", set = ["method.wcsph.sound_speed=constant"] },
]

[[case]]
name = "plain"
promise = { energy_growth = 10 }

[[case]]
name = "too slow a sound"
set = ["method.wcsph.reference_speed=0.01 m/s"]
only = ["constant"]
ends = "diverged"
says = ["sound speed"]

[[case]]
name = "nothing there"
set = ["body.drop.disc.diameter=0.1 mm"]
only = ["adaptive"]
ends = "refused"
says = ["fewer than 2 particles", "drop"]
"#;

fn program(study: &str) -> Program {
    Program::with("cases.toml", study)
}

fn page(program: &Program) -> String {
    fs::read_to_string(program.path("artifacts/latest/cases/promises.md")).unwrap()
}

#[test]
fn kept_promises_are_told() {
    let program = program(STUDY);
    let said = program.call(&["study", "cases.toml"]).well();
    assert!(said.out.contains("4 of 4 points keep"), "{}", said.out);
    let page = page(&program);
    assert!(
        page.contains("| case | adaptive | constant |"),
        "the columns are the points: {page}"
    );
    assert!(page.contains("| too slow a sound |  | kept |"), "{page}");
    let table = program.path("artifacts/latest/cases/promises.csv");
    let table = fs::read_to_string(table).unwrap();
    for figure in ["not_a_number", "mass_error", "energy_growth"] {
        let row = |line: &&str| line.contains("plain,adaptive") && line.contains(figure);
        let row = table.lines().find(row).expect(figure);
        assert!(row.contains("true"), "{row}");
    }
    // Mass and numbers are promised whether a case says so or not.
    assert!(table.contains("mass_error,<= 0,0,true"), "{table}");
}

/// A broken promise fails the study unless it is known; a known one that is kept fails it, too.
#[test]
fn broken_promises_are_seen() {
    let broken = STUDY.replace("energy_growth = 10", "energy_growth = -1");
    let first = program(&broken);
    let said = first.call(&["study", "cases.toml"]);
    said.badly(1, &["2 of 4 points", "cases.toml"]);
    assert!(said.out.contains("BROKEN: plain, adaptive: energy_growth"));
    let told = "promise = { energy_growth = -1 }\nknown = { adaptive = \"it must\", \
                constant = \"likewise\" }";
    let known = broken.replace("promise = { energy_growth = -1 }", told);
    let second = program(&known);
    let said = second.call(&["study", "cases.toml"]).well();
    assert!(said.out.contains("known: plain, constant"), "{}", said.out);
    assert!(page(&second).contains("likewise"));
    let third = program(&known.replace("energy_growth = -1", "energy_growth = 10"));
    let said = third.call(&["study", "cases.toml"]);
    said.badly(1, &["2 of 4 points"]);
    assert!(said.out.contains("remove it from `known`"), "{}", said.out);
}

#[test]
fn mistakes_are_named_before_anything_runs() {
    let cases = [
        ("energy_growth = 10", "energy_growht = 10", "energy_growth"),
        ("only = [\"constant\"]", "only = [\"konstant\"]", "konstant"),
        ("ends = \"refused\"", "ends = \"refuse\"", "refuse"),
        ("pipeline = \"tiny.toml\"", "", "pipeline"),
        ("promise =", "known = { other = \"x\" }\npromise =", "other"),
    ];
    for (old, new, word) in cases {
        let program = program(&STUDY.replacen(old, new, 1));
        program
            .call(&["study", "cases.toml"])
            .badly(2, &["cases.toml", word]);
        assert!(!program.path("artifacts").exists());
    }
}
