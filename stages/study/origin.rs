//! Where the figures of a study come from, as lines `# key: value` before its table, as the tables
//! of `docs/results` need them.

use std::collections::BTreeSet;
use std::path::Path;

use crate::jobs::version;
use crate::print::quoted;
use crate::study::trial::{Made, Outcome};

/// How a table with its origin begins.
pub const ORIGIN: &str = "# version: ";

/// A table with its origin: versions, machines and dates of the points, and the command.
pub fn headed(study: &Path, outcomes: &[Outcome], table: &[u8]) -> Vec<u8> {
    let made: Vec<&Made> = outcomes.iter().filter_map(Outcome::made).collect();
    let all = |of: &dyn Fn(&Made) -> String| distinct(made.iter().map(|made| of(made)), "; ");
    let mut head = format!("{ORIGIN}{}\n", all(&|made| made.program.clone()));
    let flow = all(&|made| made.version.to_string());
    if flow == version::FLOW.to_string() {
        let parts = made.iter().flat_map(|made| made.parts.iter().cloned());
        head += &format!("# flow: {flow}\n# parts: {}\n", distinct(parts, ", "));
    }
    head += &format!("# machine: {}\n", all(&|made| made.machine.clone()));
    head += &format!("# date: {}\n", all(&|made| made.date.clone()));
    let study = quoted(&study.display().to_string());
    head += &format!("# command: coronet study {study}\n");
    [head.into_bytes(), table.to_vec()].concat()
}

/// Each value once, in order.
fn distinct(values: impl Iterator<Item = String>, separator: &str) -> String {
    let values: BTreeSet<String> = values.collect();
    match values.is_empty() {
        true => "not recorded".to_string(),
        false => values.into_iter().collect::<Vec<_>>().join(separator),
    }
}
