//! Rows of a CSV with its origin, as the tables of `docs/results` need it: CORONET_INTO names the
//! file. A file that exists is extended.

use coronet::pipeline::machine::{Machine, now};
use std::fs::{self, File};
use std::path::Path;

/// Adds a row to the file, if one is named: what `command` found, under the heads `columns`.
pub fn keep(command: &str, columns: &[&str], row: &[&str]) {
    let Some(path) = std::env::var_os("CORONET_INTO") else {
        return;
    };
    add(Path::new(&path), command, columns, row).expect("CORONET_INTO can be written");
}

fn add(path: &Path, command: &str, columns: &[&str], row: &[&str]) -> std::io::Result<()> {
    if !path.exists() {
        fs::write(path, format!("{}{}\n", head(command), columns.join(",")))?;
    }
    let file = File::options().append(true).open(path)?;
    let mut table = csv::Writer::from_writer(file);
    table.write_record(row)?;
    table.flush()
}

fn head(command: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let jobs = fs::read_to_string(root.join("stages/jobs.rs")).expect("jobs.rs is there");
    let between = |begin: &str, end: char| {
        let rest = jobs.split(begin).nth(1);
        rest.and_then(|rest| rest.split(end).next()).unwrap_or("?")
    };
    let flow = between("pub const FLOW: u32 = ", ';');
    let parts = ["isph", "mps", "surface-energy", "wcsph", "wetting"].map(|name| {
        let begin = format!("part(\"{name}\", ");
        let found = jobs.split(&begin).skip(1);
        let mut versions: Vec<_> = found.filter_map(|rest| rest.split(')').next()).collect();
        versions.sort();
        let versions = versions.iter().map(|version| format!("{name} {version}"));
        versions.collect::<Vec<_>>().join(", ")
    });
    let parts = parts.join(", ");
    let here = Machine::here();
    let version = env!("CARGO_PKG_VERSION");
    let day: String = now().chars().take(10).collect();
    let machine = format!("{}, {} cores, {}", here.processor, here.cores, here.system);
    format!(
        "# version: coronet {version}, FLOW {flow}\n# flow: {flow}\n\
         # parts: {parts}\n# machine: {machine}\n\
         # date: {day}\n# command: {command}\n"
    )
}

#[test]
fn rows_are_kept_with_their_origin() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.csv");
    add(&path, "try it", &["one", "two"], &["a, b", "d"]).unwrap();
    add(&path, "try it", &["one", "two"], &["c", "e"]).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("# version: coronet "), "{text}");
    assert_eq!(text.matches("# machine: ").count(), 1);
    assert!(text.contains("\n# command: try it\none,two\n"), "{text}");
    let mut table = csv::ReaderBuilder::new();
    let table = table.comment(Some(b'#')).from_reader(text.as_bytes());
    let rows: Vec<_> = table.into_records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 2);
    assert_eq!((&rows[0][0], &rows[1][1]), ("a, b", "e"));
}
