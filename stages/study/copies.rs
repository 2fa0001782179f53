//! Files of a study's results: tables and figures in the store, and copies in the folder of
//! `--into`.

use std::fs;
use std::path::Path;

use anyhow::{Result, bail};
use coronet::draw::sheet::Sheet;
use coronet::file::{self, FileError};
use coronet::record::atomic::write_file;

use crate::arguments::StudyArguments;
use crate::fault::Usage;
use crate::study::origin::{ORIGIN, headed};
use crate::study::trial::Outcome;

/// An error if a file that a study would replace in the folder of `--into` is not that of a study.
pub fn check(folder: &Path, study: &Path) -> Result<()> {
    let stem = study.file_stem().unwrap_or_default().to_string_lossy();
    let table = folder.join(format!("{stem}.csv"));
    if let Some(content) = file::read_if_there(&table, u64::MAX)? {
        if content.starts_with(ORIGIN.as_bytes()) {
            return Ok(());
        }
        bail!(Usage(format!(
            "{} is not the table of a study and stays as it is; move it, or give --into another \
             folder",
            table.display()
        )));
    }
    for entry in fs::read_dir(folder).map_err(FileError::new(folder, "list"))? {
        let path = entry.map_err(FileError::new(folder, "list"))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let is_plot = name.starts_with(&*stem) && name.ends_with(".svg");
        if is_plot {
            bail!(Usage(format!(
                "{} may not be of this study and stays as it is, for there is no table {}; move \
                 it, or give --into another folder",
                path.display(),
                table.display()
            )));
        }
    }
    Ok(())
}

/// Writes a table, and with its origin into the folder that `--into` names.
pub fn write_table(
    path: &Path,
    table: &[u8],
    arguments: &StudyArguments,
    outcomes: &[Outcome],
) -> Result<()> {
    write_file(path, table)?;
    if let Some(folder) = &arguments.into {
        let name = arguments.study.with_extension("csv");
        let name = name.file_name().expect("a study file has a name");
        let text = headed(&arguments.study, outcomes, table);
        write_file(&folder.join(name), &text)?;
    }
    Ok(())
}

/// Removes a figure of before, which would stand beside another table.
pub fn remove_figure(path: &Path) {
    for extension in ["svg", "pdf"] {
        let _ = fs::remove_file(path.with_extension(extension));
    }
}

/// Writes a figure as SVG to `path` and as PDF beside it, and as `STUDY.svg` or `STUDY-FIGURE.svg`
/// into the folder that `--into` names.
pub fn write_figure(
    figure: &Sheet,
    path: &Path,
    arguments: &StudyArguments,
    is_only: bool,
) -> Result<()> {
    let svg = figure.svg();
    write_file(path, svg.as_bytes())?;
    write_file(&path.with_extension("pdf"), &figure.pdf())?;
    if let Some(folder) = &arguments.into {
        let stem = |path: &Path| path.file_stem().unwrap_or_default().display().to_string();
        let name = match is_only {
            true => format!("{}.svg", stem(&arguments.study)),
            false => format!("{}-{}.svg", stem(&arguments.study), stem(path)),
        };
        write_file(&folder.join(name), svg.as_bytes())?;
    }
    Ok(())
}
