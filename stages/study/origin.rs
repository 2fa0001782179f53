//! Where the figures of a study come from, as lines `# key: value` before its table, as the tables
//! of `docs/results` need them.

use std::path::Path;

use crate::jobs::version;
use crate::study::trial::{Made, Outcome};

/// A table with its origin: versions, machines and dates of the points, and the command.
pub fn headed(study: &Path, outcomes: &[Outcome], table: &[u8]) -> Vec<u8> {
    let made: Vec<&Made> = outcomes.iter().filter_map(Outcome::made).collect();
    let all = |of: &dyn Fn(&Made) -> String| {
        let mut values: Vec<String> = made.iter().map(|made| of(made)).collect();
        values.sort();
        values.dedup();
        match values.is_empty() {
            true => "not recorded".to_string(),
            false => values.join("; "),
        }
    };
    let mut head = format!("# version: {}\n", all(&|made| made.program.clone()));
    let flow = all(&|made| made.version.to_string());
    if flow == version::FLOW.to_string() {
        let mut parts: Vec<&str> = made
            .iter()
            .flat_map(|made| &made.parts)
            .map(String::as_str)
            .collect();
        parts.sort_unstable();
        parts.dedup();
        head += &format!("# flow: {flow}\n# parts: {}\n", parts.join(", "));
    }
    head += &format!("# machine: {}\n", all(&|made| made.machine.clone()));
    head += &format!("# date: {}\n", all(&|made| made.date.clone()));
    head += &format!("# command: coronet study {}\n", study.display());
    [head.into_bytes(), table.to_vec()].concat()
}
