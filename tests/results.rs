//! The documents: generated tables, links, lengths of pages.
//!
//! A table in a page stands between two comments and is written by
//! `UPDATE=1 cargo test --release --test results`:
//!
//! ```text
//! <!-- table NAME -->                       all columns of docs/results/data/NAME.csv
//! <!-- table NAME columns="a; b" -->        these columns
//! <!-- table NAME where="method=MPS" -->    these rows
//! <!-- table NAME rows="method" columns="spacing" cells="error %; cpu_s s" -->
//!                                           one row a method, one column a spacing; a unit is %,
//!                                           s, MB, deg, `sci`, or `all`: whether all rows are true
//! <!-- end -->
//! ```
//!
//! A CSV starts with lines `# key: value`: `version` of the numerics, `machine`, `date`, any number
//! of `command` and `note`, and where they are known `flow`, the number of `version::FLOW` in
//! `stages/jobs.rs`, and `parts`, those of the named versions there, as `isph 2, wcsph 1`. `trial`
//! marks what the program does not repeat; only `docs/lab.md` shows it.

use std::fs;
use std::path::{Path, PathBuf};

#[path = "results/page.rs"]
mod page;
#[path = "results/table.rs"]
mod table;

const WORDS_OF_PAGE: usize = 1_500;
const WORDS_OF_ALL: usize = 12_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn data() -> PathBuf {
    root().join("docs/results/data")
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn shown(path: &Path) -> String {
    let path = path.strip_prefix(root()).unwrap_or(path);
    path.display().to_string()
}

/// All files with this ending in a folder and below, sorted.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let entries = fs::read_dir(&folder).unwrap();
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

/// The pages of `docs/`.
fn pages() -> Vec<PathBuf> {
    files(&root().join("docs"), "md")
}

fn none(faults: &[String]) {
    let list = faults.join("\n");
    assert!(faults.is_empty(), "{} faults:\n{list}", faults.len());
}

#[test]
fn every_block_is_that_of_its_table() {
    let mut faults = Vec::new();
    let mut count = 0;
    for path in pages() {
        let before = text(&path);
        let folder = path.parent().unwrap();
        let to_data = match folder == root().join("docs/results") {
            true => "data",
            false => "results/data",
        };
        let (after, blocks) = match page::rewritten(&before, &data(), to_data) {
            Ok(done) => done,
            Err(error) => {
                faults.push(format!("{}: {error}", shown(&path)));
                continue;
            }
        };
        count += blocks;
        if before != after && std::env::var_os("UPDATE").is_some() {
            // Other tests may read the page meanwhile.
            let new = path.with_extension("new");
            fs::write(&new, &after).unwrap();
            fs::rename(&new, &path).unwrap();
        } else if before != after {
            faults.push(format!("{}: differs from its tables", shown(&path)));
        }
    }
    assert!(count > 40, "only {count} blocks found");
    assert!(
        faults.is_empty(),
        "{}\nrun UPDATE=1 cargo test --release --test results",
        faults.join("\n")
    );
}

#[test]
fn every_table_has_an_origin_and_a_page() {
    let all: String = pages().iter().map(|path| text(path)).collect();
    let results = files(&root().join("docs/results"), "md");
    let results: String = results.iter().map(|path| text(path)).collect();
    let mut faults = Vec::new();
    for path in files(&data(), "csv") {
        let table = match table::Table::read(&path) {
            Ok(table) => table,
            Err(error) => {
                faults.push(error);
                continue;
            }
        };
        for key in ["version", "machine", "date"] {
            if table.head(key).next().is_none() {
                faults.push(format!("{}: no `# {key}:`", shown(&path)));
            }
        }
        let name = path.file_stem().unwrap().to_str().unwrap();
        let block = format!("<!-- table {name} ");
        if !all.contains(&block) {
            faults.push(format!("{}: in no page", shown(&path)));
        }
        if table.is_trial() == results.contains(&block) {
            faults.push(format!("{}: trials are for docs/lab.md", shown(&path)));
        }
    }
    none(&faults);
}

/// Version of the flow in the program as it is.
fn current() -> u32 {
    let jobs = text(&root().join("stages/jobs.rs"));
    let (_, rest) = jobs.split_once("pub const FLOW: u32 = ").unwrap();
    rest.split(';').next().unwrap().parse().unwrap()
}

/// Whether named versions, as `isph 2, wcsph 1`, are those of the program.
fn is_current(parts: &str) -> bool {
    let jobs = text(&root().join("stages/jobs.rs"));
    let parts = parts.split(',').filter(|part| !part.trim().is_empty());
    parts.map(str::trim).all(|part| {
        let (name, version) = part.rsplit_once(' ').unwrap();
        jobs.contains(&format!("part(\"{name}\", {version})"))
    })
}

#[test]
fn versions_of_parts_are_those_of_the_program() {
    assert!(is_current("") && is_current("vibration 1, wcsph 1"));
    assert!(!is_current("vibration 1, wcsph 1000"));
}

/// Prints the tables of an older version; `cargo test --test results older -- --nocapture`. With
/// `CORONET_RELEASE=1` they fail the test.
#[test]
fn tables_of_an_older_version_are_listed() {
    let mut older = Vec::new();
    for path in files(&data(), "csv") {
        let table = table::Table::read(&path).unwrap();
        if table.is_trial() {
            continue;
        }
        let version: Vec<&str> = table.head("version").collect();
        let flow = table.head("flow").next().map(|flow| flow.parse::<u32>());
        let flow = flow.map(|flow| flow.unwrap_or_else(|_| panic!("{}: flow", shown(&path))));
        let is_newer = flow.is_some_and(|flow| flow > current());
        assert!(!is_newer, "{}: newer than the program", shown(&path));
        let parts: Vec<&str> = table.head("parts").collect();
        let has_parts = !parts.is_empty() && parts.iter().all(|parts| is_current(parts));
        if flow != Some(current()) || !has_parts {
            let flow = flow.map_or("unknown".to_string(), |flow| flow.to_string());
            older.push(format!(
                "{}: FLOW {flow}, {} {}",
                shown(&path),
                version.join(", "),
                parts.join(", ")
            ));
        }
    }
    println!("FLOW of the program: {}", current());
    older.iter().for_each(|line| println!("{line}"));
    if std::env::var_os("CORONET_RELEASE").is_some() {
        none(&older);
    }
}

#[test]
fn links_resolve() {
    let mut faults = Vec::new();
    let mut count = 0;
    let others = "README.md CONTRIBUTING.md CHANGELOG.md python/README.md fuzz/README.md";
    let others = others.split(' ').map(|name| root().join(name));
    for path in pages().into_iter().chain(others) {
        for link in page::links(&text(&path)) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            count += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => path.clone(),
                _ => path.parent().unwrap().join(file),
            };
            let is_there = target.exists();
            let is_page = target.extension().is_some_and(|ending| ending == "md");
            let has_anchor = anchor.is_empty()
                || is_there && is_page && page::anchors(&text(&target)).contains(&anchor.into());
            if !is_there || !has_anchor {
                faults.push(format!("{}: {link}", shown(&path)));
            }
        }
    }
    assert!(count > 100, "only {count} links found");
    none(&faults);
}

#[test]
fn pages_are_short() {
    let mut faults = Vec::new();
    let mut sum = 0;
    for path in pages() {
        let words = page::words(&text(&path));
        println!("{words:6} {}", shown(&path));
        sum += words;
        if words > WORDS_OF_PAGE {
            faults.push(format!("{}: {words} words", shown(&path)));
        }
    }
    println!("{sum:6} words without tables and code");
    if sum > WORDS_OF_ALL {
        faults.push(format!("docs: {sum} words"));
    }
    let readme = text(&root().join("README.md")).lines().count();
    if readme > 120 {
        faults.push(format!("README.md: {readme} lines"));
    }
    none(&faults);
}

/// In `docs/results`, decimal numbers and percentages of the prose are settings in code spans;
/// what was measured stands in a generated table.
#[test]
fn results_have_no_figures_in_prose() {
    let mut faults = Vec::new();
    for path in files(&root().join("docs/results"), "md") {
        for line in page::prose(&text(&path)) {
            for figure in page::figures(&line) {
                faults.push(format!("{}: {figure}: {line}", shown(&path)));
            }
        }
    }
    none(&faults);
}

/// The arguments of the program, as they are declared.
fn arguments() -> String {
    let of = |name: &str| text(&root().join("stages/arguments").join(name));
    of("mod.rs") + &of("output.rs") + &of("cluster.rs")
}

/// Commands, options and scenes that code blocks of the pages name are those of the program.
#[test]
fn pages_name_commands_that_exist() {
    let arguments = arguments();
    let mut faults = Vec::new();
    let mut count = 0;
    for path in pages() {
        for command in page::commands(&text(&path), "coronet ") {
            count += 1;
            let words: Vec<&str> = command.split_whitespace().collect();
            let (first, rest) = words[0].split_at(1);
            let variant = format!("    {}{rest}(", first.to_uppercase());
            let flags = words.iter().filter_map(|word| word.strip_prefix("--"));
            let mut flags = flags.map(|flag| flag.split('=').next().unwrap_or(flag));
            let is_known = |flag: &str| {
                let field = format!("pub {}:", flag.replace('-', "_"));
                arguments.contains(&field)
            };
            let scenes = words.iter().filter(|word| word.starts_with("scenes/"));
            let mut scenes = scenes.filter(|word| word.ends_with(".toml"));
            if !arguments.contains(&variant)
                || !flags.all(is_known)
                || !scenes.all(|scene| root().join(scene).is_file())
            {
                faults.push(format!("{}: coronet {command}", shown(&path)));
            }
        }
    }
    assert!(count > 50, "only {count} commands found");
    none(&faults);
}

/// The page of the command line has every option.
#[test]
fn every_option_is_described() {
    let arguments = arguments();
    let page = text(&root().join("docs/reference/command-line.md"));
    let options = arguments.split("#[arg(long").skip(1);
    let options = options.filter(|rest| !rest.starts_with(", hide"));
    let field = |rest: &str| Some(rest.split_once("pub ")?.1.split_once(':')?.0.to_string());
    let names: Vec<String> = options.filter_map(field).collect();
    assert!(names.len() > 40, "only {} options found", names.len());
    let flag = |name: &String| format!("`--{}", name.replace('_', "-"));
    none(
        &names
            .iter()
            .map(flag)
            .filter(|flag| !page.contains(flag))
            .collect::<Vec<_>>(),
    );
}

/// The page of measures has every column that the program writes.
#[test]
fn every_measure_is_described() {
    let page = text(&root().join("docs/reference/measures.md"));
    let sources = [
        "src/measure/gauge.rs",
        "src/measure/energy.rs",
        "src/method/wcsph/report.rs",
        "src/method/projection/report.rs",
    ];
    let mut code: String = sources
        .iter()
        .map(|file| text(&root().join(file)))
        .collect();
    for (file, name) in [
        ("src/method/ledger.rs", "fn works"),
        ("src/method/liquid.rs", "fn progress"),
    ] {
        let whole = text(&root().join(file));
        let (_, function) = whole.split_once(name).unwrap();
        code += function.split("\n    }\n").next().unwrap();
    }
    let is_name = |part: &&str| {
        let is_word = part.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'_');
        is_word && part.contains('_') && !part.starts_with('_')
    };
    let names: Vec<&str> = code.split('"').skip(1).step_by(2).filter(is_name).collect();
    assert!(names.len() > 40, "only {} names found", names.len());
    let missing = names
        .iter()
        .filter(|name| !page.contains(&format!("`{name}`")));
    none(&missing.map(|name| name.to_string()).collect::<Vec<_>>());
}

/// The page of exit codes has those of `coronet --help`.
#[test]
fn every_exit_code_is_described() {
    let arguments = arguments();
    let (_, help) = arguments.split_once("Exit codes:\n").unwrap();
    let help = help.split("\";").next().unwrap();
    let starts = help
        .lines()
        .filter(|line| line.as_bytes().get(2).is_some_and(u8::is_ascii_digit));
    let codes: Vec<&str> = starts
        .map(|line| line.split_whitespace().next().unwrap())
        .collect();
    assert!(codes.len() > 5);
    let page = text(&root().join("docs/reference/exit-codes.md"));
    let missing = codes
        .iter()
        .filter(|code| !page.contains(&format!("| {code} |")));
    none(&missing.map(|code| code.to_string()).collect::<Vec<_>>());
}
