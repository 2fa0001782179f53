//! The rules of the house, executed.

use coronet::scene::{file, schema};
use std::fs;
use std::path::{Path, PathBuf};

#[path = "tidy/safety.rs"]
mod safety;
#[path = "tidy/search.rs"]
mod search;

/// Lowest first. A module may name only modules of its own row or of rows before it.
const LAYERS: &[&[&str]] = &[
    &["file"],
    &["scene", "space", "kernel"],
    &["particle"],
    &["effect"],
    &["method"],
    &["measure", "record"],
    &["draw"],
    &["pipeline", "simulate"],
];

const LINES_OF_FILE: usize = 400;
const LINES_OF_FUNCTION: usize = 70;
const COLUMNS: usize = 100;

/// What may stand in the root, besides hidden files and what is built or exported.
const ROOT: &str =
    "Cargo.toml Cargo.lock build.rs clippy.toml deny.toml rust-toolchain.toml rustfmt.toml
    README.md CHANGELOG.md CONTRIBUTING.md CITATION.cff LICENSE-MIT LICENSE-APACHE pipeline.toml
    stages src tests artifacts benches examples scenes docs fuzz python target export";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root())
        .unwrap_or(path)
        .display()
        .to_string()
}

/// All files with this ending under a folder of the root, sorted.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).into_iter().flatten();
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|found| found == ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// All Rust files of the house.
fn sources() -> Vec<PathBuf> {
    let folders = ["src", "stages", "tests", "benches"];
    let found: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| files(folder, "rs"))
        .collect();
    assert!(found.len() > 50, "only {} files found", found.len());
    found
}

/// Fails with all faults.
fn none(faults: &[String]) {
    assert!(
        faults.is_empty(),
        "{} faults:\n{}",
        faults.len(),
        faults.join("\n")
    );
}

#[test]
fn modules_only_look_down() {
    let mut faults = Vec::new();
    let mut looks = 0;
    for (rank, layer) in LAYERS.iter().enumerate() {
        let above: Vec<&str> = LAYERS[rank + 1..].concat();
        for file in layer
            .iter()
            .flat_map(|module| files(&format!("src/{module}"), "rs"))
        {
            for module in search::named(&text(&file)) {
                looks += 1;
                if above.contains(&module.as_str()) {
                    faults.push(format!("{} names {module}", shown(&file)));
                }
            }
        }
    }
    assert!(
        looks > 30,
        "only {looks} uses found: does the search still work?"
    );
    none(&faults);
}

#[test]
fn every_module_has_a_layer() {
    let layered = LAYERS.concat();
    let mut found: Vec<String> = Vec::new();
    for entry in fs::read_dir(root().join("src")).unwrap() {
        found.push(entry.unwrap().file_name().into_string().unwrap());
    }
    let stray = found
        .iter()
        .filter(|name| *name != "lib.rs" && !layered.contains(&name.as_str()));
    none(
        &stray
            .map(|name| format!("src/{name} has no layer"))
            .collect::<Vec<_>>(),
    );
    let map = text(&root().join("src/lib.rs"));
    for module in layered {
        assert!(
            map.contains(&format!("pub mod {module};")),
            "src/lib.rs lacks {module}"
        );
        assert!(found.contains(&module.to_string()), "src/{module} is gone");
    }
}

#[test]
fn files_and_lines_are_short() {
    let mut faults = Vec::new();
    let scenes = files("scenes", "toml").into_iter();
    for file in sources()
        .into_iter()
        .chain(scenes)
        .chain([root().join("pipeline.toml")])
    {
        let text = text(&file);
        let count = text.lines().count();
        if count > LINES_OF_FILE {
            faults.push(format!("{}: {count} lines", shown(&file)));
        }
        for (number, line) in text.lines().enumerate() {
            let columns = line.chars().count();
            if columns > COLUMNS {
                faults.push(format!(
                    "{}:{}: {columns} columns",
                    shown(&file),
                    number + 1
                ));
            }
        }
    }
    none(&faults);
}

#[test]
fn functions_are_short() {
    let mut faults = Vec::new();
    let mut count = 0;
    for file in sources() {
        for (name, line, length) in search::functions(&text(&file)) {
            count += 1;
            if length > LINES_OF_FUNCTION {
                faults.push(format!(
                    "{}:{line}: `{name}` has {length} lines",
                    shown(&file)
                ));
            }
        }
    }
    assert!(
        count > 300,
        "only {count} functions found: does the search still work?"
    );
    none(&faults);
}

#[test]
fn names_say_what_is_inside() {
    let mut faults = Vec::new();
    for file in sources() {
        let path = shown(&file);
        let parts = path.split(['/', '.']).flat_map(|part| part.split('_'));
        for part in parts {
            if [
                "util", "utils", "common", "helper", "helpers", "manager", "misc",
            ]
            .contains(&part)
            {
                faults.push(format!("{path}: `{part}` says nothing"));
            }
        }
    }
    none(&faults);
}

#[test]
fn nothing_is_left_undone_or_switched_off() {
    // In pieces, so that this file does not hold them.
    let marks = [
        ["todo", "!("],
        ["unimplemented", "!("],
        ["#[ig", "nore"],
        ["#[should", "_panic"],
        ["#[al", "low("],
        ["TO", "DO"],
        ["FIX", "ME"],
        ["XX", "X"],
    ];
    let mut faults = Vec::new();
    for file in sources() {
        for (number, line) in text(&file).lines().enumerate() {
            for mark in marks.map(|pieces| pieces.concat()) {
                if line.contains(&mark) {
                    faults.push(format!("{}:{}: {mark}", shown(&file), number + 1));
                }
            }
        }
    }
    none(&faults);
}

/// Files that no `mod` line leads to would never be compiled.
#[test]
fn no_file_is_forgotten() {
    let mut faults = Vec::new();
    for file in sources() {
        let path = shown(&file);
        let name = file.file_stem().unwrap().to_str().unwrap();
        let folder = file.parent().unwrap();
        let at_root = ["tests", "benches"].contains(&folder.file_name().unwrap().to_str().unwrap());
        if ["lib", "main"].contains(&name) || at_root {
            continue;
        }
        let (module, parents) = match name {
            "mod" => {
                let above = folder.parent().unwrap();
                (
                    folder.file_name().unwrap().to_str().unwrap(),
                    parents(above),
                )
            }
            _ => (name, parents(folder)),
        };
        let declared = parents
            .iter()
            .filter(|parent| parent.is_file())
            .any(|parent| {
                let text = text(parent);
                text.lines()
                    .any(|line| line.trim_end().ends_with(&format!("mod {module};")))
            });
        if !declared {
            faults.push(format!("{path}: no `mod {module};` leads here"));
        }
    }
    none(&faults);
}

/// Files that may declare the modules of a folder.
fn parents(folder: &Path) -> Vec<PathBuf> {
    let inside = ["mod.rs", "lib.rs", "main.rs"].map(|name| folder.join(name));
    inside
        .into_iter()
        .chain([folder.with_extension("rs")])
        .collect()
}

/// The module of a folder is the `mod.rs` in it. Tests are crates of their own.
#[test]
fn modules_have_one_style() {
    let is_beside = |file: &&PathBuf| {
        let in_tests = file.starts_with(root().join("tests"));
        !in_tests && file.with_extension("").is_dir()
    };
    let sources = sources();
    let found = sources.iter().filter(is_beside);
    let faults: Vec<String> = found.map(|file| shown(file)).collect();
    none(&faults);
}

#[test]
fn the_root_holds_what_it_should() {
    let mut faults = Vec::new();
    for entry in fs::read_dir(root()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !name.starts_with('.') && !ROOT.split_whitespace().any(|known| known == name) {
            faults.push(format!("{name} does not belong in the root"));
        }
    }
    none(&faults);
}

/// The keys of a table of the scene file.
fn keys(table: &str) -> Vec<String> {
    let found = schema::property(&file::SCHEMA, table).unwrap()["properties"].clone();
    found.as_object().unwrap().keys().cloned().collect()
}

/// The word of the file is the name of its source.
#[test]
fn every_word_has_its_room() {
    let mut faults = Vec::new();
    let mut room = |folder: &str, word: &str| {
        let file = root().join(folder).join(format!("{word}.rs"));
        let module = root().join(folder).join(word).join("mod.rs");
        if !file.is_file() && !module.is_file() {
            faults.push(format!(
                "`{word}` of the scene file has no {folder}/{word}.rs"
            ));
        }
    };
    for stage in ["pack", "relax", "impact", "post"] {
        assert!(!keys(stage).is_empty());
        room("stages", stage);
    }
    for effect in keys("effects") {
        room("src/effect", &effect);
    }
    let methods = ["isph", "mps", "wcsph"];
    let tables = keys("method").into_iter();
    let tables: Vec<String> = tables.filter(|key| methods.contains(&&key[..])).collect();
    assert_eq!(tables, methods);
    for word in tables {
        room("src/method", &word);
    }
    none(&faults);
}

#[test]
fn the_readme_gives_commands_and_files_that_exist() {
    let readme = text(&root().join("README.md"));
    let commands = search::commands(&readme);
    assert_eq!(
        commands[0],
        ["cargo run --release -- run", "cargo test --release"]
    );
    let gate = text(&root().join(".ci/run"));
    let last = gate.lines().last();
    assert_eq!(last, Some(commands[0][1]), ".ci/run calls the test command");
    let folder = files("stages/arguments", "rs");
    let arguments: String = folder.iter().map(|file| text(file)).collect();
    let mut uses = 0;
    for part in readme.split("coronet ").skip(1) {
        let code = part.split(['`', ';', '\n']).next().unwrap();
        let words: Vec<&str> = code.split_whitespace().collect();
        let Some(word) = words
            .first()
            .filter(|word| word.chars().all(char::is_alphabetic))
        else {
            continue;
        };
        if !readme.contains(&format!("`coronet {code}`")) && !code.contains("--") {
            continue;
        }
        uses += 1;
        let variant = format!("    {}{}(", word[..1].to_uppercase(), &word[1..]);
        assert!(
            arguments.contains(&variant),
            "`coronet {code}`: no such command"
        );
        for flag in words.iter().filter_map(|word| word.strip_prefix("--")) {
            let field = format!("pub {}:", flag.replace('-', "_"));
            assert!(
                arguments.contains(&field),
                "`coronet {code}`: no such option --{flag}"
            );
        }
        for file in words.iter().filter(|word| word.ends_with(".toml")) {
            assert!(
                root().join(file).is_file(),
                "`coronet {code}`: no such file"
            );
        }
    }
    assert!(
        uses >= 8,
        "only {uses} commands found: does the search still work?"
    );
}
