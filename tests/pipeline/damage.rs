//! Files of finished results that are gone, or folders in their place: told by path, made again.

use std::fs;
use std::path::Path;

use crate::program::{Program, members};

const SETS: [&str; 6] = [
    "--set",
    "impact.end=1 ms",
    "--set",
    "post.panels=[]",
    "--set",
    "pack.spacing=0.6 mm",
];

/// Puts a folder in place of a file.
fn folder(path: &Path) {
    fs::remove_file(path).unwrap();
    fs::create_dir(path).unwrap();
}

#[test]
fn measures_that_are_gone_are_told_by_path() {
    let program = Program::new();
    program.run(&SETS);
    let path = program.latest("post").join("measures.csv");
    for (make, what) in [
        (folder as fn(&Path), "it is a folder"),
        (|path| fs::remove_dir(path).unwrap(), "it is missing"),
    ] {
        make(&path);
        let words = ["measures.csv", what, "makes it again"];
        program.call(&["diff", "tiny", "tiny"]).badly(4, &words);
        program.call(&["show", "tiny"]).badly(4, &words);
    }
    assert_eq!(members(&program.run(&SETS), "status")["post"], "ran");
    program.call(&["show", "tiny"]).well();
}

#[test]
fn a_folder_in_place_of_a_state_is_made_again() {
    let program = Program::new();
    let digests = members(&program.run(&SETS), "digest");
    let impact = program.latest("impact");
    for start in ["state", ""] {
        let files = fs::read_dir(&impact).unwrap();
        let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
        let is_meant = |name: &String| name.starts_with(start) && name.ends_with(".checkpoint");
        let states: Vec<String> = names.filter(is_meant).collect();
        assert!(start == "state" || states.len() > 2, "{states:?}");
        states.iter().for_each(|name| folder(&impact.join(name)));
        let objects = program.run(&SETS);
        assert_ne!(members(&objects, "status")["impact"], "fresh");
        assert_eq!(members(&objects, "digest"), digests);
    }
}

#[test]
fn frames_or_an_impact_that_are_gone_are_told_in_one_way() {
    let program = Program::new();
    program.run(&SETS);
    let impact = program.latest("impact");
    fs::remove_file(impact.join("frames.mcap")).unwrap();
    let list = program.call(&["list"]).well();
    let words = ["frames.mcap: it is missing", "makes it again"];
    assert!(
        words.iter().all(|word| list.err.contains(word)),
        "{}",
        list.err
    );
    fs::remove_file(impact.join("stamp.json")).unwrap();
    let words = ["impact/", "is gone; `coronet run` makes it again"];
    program
        .call(&["export", "tiny", "--to", "csv"])
        .badly(1, &words);
    assert!(!program.path("export").exists());
    program.call(&["render", "tiny"]).badly(1, &words);
}
