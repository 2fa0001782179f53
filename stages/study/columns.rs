//! Whether the points of a study will measure what it asks for: found before they run.

use std::path::Path;

use anyhow::{Result, bail};

use super::points::Study;
use super::trial::Trial;
use crate::fault::Usage;
use crate::probe;

/// An error about the first column of the study at `path` that no point measures. Says nothing if
/// there is a point of which that is not known.
pub fn check(study: &Study, trials: &[Trial], path: &Path) -> Result<()> {
    let of_error = study.error.as_ref().map(|target| target.column.as_str());
    let mut needed: Vec<&str> = study.columns().chain(of_error).collect();
    let mut known: Vec<String> = Vec::new();
    for trial in trials {
        if needed.is_empty() {
            return Ok(());
        }
        // Scenes that must be rejected measure nothing.
        let Ok(scene) = trial.scene() else {
            continue;
        };
        let Some(columns) = probe::columns(&scene) else {
            return Ok(());
        };
        needed.retain(|column| !columns.iter().any(|name| name == column));
        for name in columns {
            if !known.contains(&name) {
                known.push(name);
            }
        }
    }
    let Some(column) = needed.first() else {
        return Ok(());
    };
    let (path, names) = (path.display(), known.join(", "));
    bail!(Usage(format!(
        "{path}: no point measures `{column}`; columns are {names}"
    )))
}
