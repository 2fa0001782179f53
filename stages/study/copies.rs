//! Files of a study's results: tables and figures in the store, and copies in the folder of
//! `--into`.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use coronet::draw::sheet::Sheet;
use coronet::file::{self, FileError};
use coronet::pipeline::store::entries;
use coronet::record::atomic::write_file;

use crate::arguments::StudyArguments;
use crate::fault::Usage;
use crate::study::origin::{ORIGIN, headed};
use crate::study::trial::Outcome;

/// Ending of the figures in the folder of `--into`, and how those of this program begin.
const SVG: &str = "svg";
const START: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" \
                     xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=";

/// An error if a file that a study would replace in the folder of `--into` is not that of a study.
pub fn check(folder: &Path, study: &Path) -> Result<()> {
    let stem = stem(study);
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
    if let Some(path) = figures(folder, &stem)?.first() {
        bail!(Usage(format!(
            "{} may not be of this study and stays as it is, for there is no table {}; move it, \
             or give --into another folder",
            path.display(),
            table.display()
        )));
    }
    Ok(())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().display().to_string()
}

/// Whether a study can have drawn a figure, from the stems of both: `pool` and `pool-depth`.
fn draws(study: &str, figure: &str) -> bool {
    let rest = figure.strip_prefix(study);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
}

/// The figures of a study in the folder of `--into`: those that it can have drawn, unless the table
/// of another one whose name begins with its name claims them.
fn figures(folder: &Path, study: &str) -> Result<Vec<PathBuf>> {
    let mut figures = with_ending(folder, SVG)?;
    figures.retain(|path| draws(study, &stem(path)));
    for table in with_ending(folder, "csv")? {
        let other = stem(&table);
        let is_longer = other != study && draws(study, &other);
        if is_longer && begins(&table, ORIGIN)? {
            figures.retain(|path| !draws(&other, &stem(path)));
        }
    }
    Ok(figures)
}

/// Paths in a folder that end in `.ENDING`.
fn with_ending(folder: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let paths = entries(folder)?.into_iter().map(|entry| entry.path());
    let is_meant = |path: &PathBuf| path.is_file() && path.extension().is_some_and(|e| e == ending);
    Ok(paths.filter(is_meant).collect())
}

/// Whether the text of a file begins so.
fn begins(path: &Path, start: &str) -> Result<bool> {
    let content = file::read_if_there(path, u64::MAX)?;
    Ok(content.is_some_and(|content| content.starts_with(start.as_bytes())))
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

/// Removes files of a folder, if they are there.
pub fn remove<'a>(folder: &Path, names: impl Iterator<Item = &'a &'a str>) -> Result<()> {
    for path in names.map(|name| folder.join(name)) {
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(FileError::new(&path, "remove")(error).into());
            }
            _ => {}
        }
    }
    Ok(())
}

/// The figures of a study, which take the place of those of before.
pub struct Figures<'a> {
    out: &'a Path,
    arguments: &'a StudyArguments,
    drawn: Vec<PathBuf>,
}

impl<'a> Figures<'a> {
    /// None yet; `out`: where they are written.
    pub fn new(out: &'a Path, arguments: &'a StudyArguments) -> Self {
        let drawn = Vec::new();
        Figures {
            out,
            arguments,
            drawn,
        }
    }

    /// Writes a figure as `NAME.svg` and `NAME.pdf`, and as `STUDY.svg` or `STUDY-NAME.svg` into
    /// the folder that `--into` names.
    pub fn write(&mut self, figure: &Sheet, name: &str, is_only: bool) -> Result<()> {
        let svg = figure.svg();
        let [path, pdf] = [SVG, "pdf"].map(|ending| self.out.join(format!("{name}.{ending}")));
        write_file(&path, svg.as_bytes())?;
        write_file(&pdf, &figure.pdf())?;
        self.drawn.extend([path, pdf]);
        if let Some(folder) = &self.arguments.into {
            let study = stem(&self.arguments.study);
            let path = folder.join(match is_only {
                true => format!("{study}.{SVG}"),
                false => format!("{study}-{name}.{SVG}"),
            });
            write_file(&path, svg.as_bytes())?;
            self.drawn.push(path);
        }
        Ok(())
    }

    /// Removes the figures of before that were not drawn again, which would stand beside another
    /// table.
    pub fn finish(self) -> Result<()> {
        let mut old = with_ending(self.out, SVG)?;
        old.extend(with_ending(self.out, "pdf")?);
        if let Some(folder) = &self.arguments.into {
            for path in figures(folder, &stem(&self.arguments.study))? {
                // Not one of another program.
                if begins(&path, START)? {
                    old.push(path);
                }
            }
        }
        for path in old.iter().filter(|path| !self.drawn.contains(path)) {
            fs::remove_file(path).map_err(FileError::new(path, "remove"))?;
        }
        Ok(())
    }
}
