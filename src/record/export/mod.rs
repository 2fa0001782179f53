//! Export of checkpoints and logs: for ParaView and PyVista (`.vtp`, with a `.pvd` index of times),
//! spreadsheets (`.csv`) and mesh viewers (`.ply`).

mod csv;
mod ply;
mod pvd;
mod table;
mod vtp;

pub use self::csv::cell;
pub use table::{Column, Table};

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::atomic;
use super::checkpoint::{self, CheckpointError};
use super::log::{self, LogError};
use crate::file::FileError;

/// An export that failed.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// A file cannot be read or written.
    #[error(transparent)]
    Io(#[from] FileError),
    /// The checkpoint cannot be read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The format does not exist.
    #[error("{name:?} is not an export format; choose vtk, csv or ply")]
    Format {
        /// Its name as given.
        name: String,
    },
}

impl ExportError {
    /// Whether a file was read and its content is wrong. False for an I/O error.
    pub fn is_damage(&self) -> bool {
        match self {
            ExportError::Checkpoint(error) => error.is_damage(),
            ExportError::Log(error) => error.is_damage(),
            ExportError::Io(_) | ExportError::Format { .. } => false,
        }
    }
}

/// Result of the export of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The new files, the index first.
    pub files: Vec<PathBuf>,
    /// Number of frames of an earlier export that were removed.
    pub removed: usize,
}

/// A format to export to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// VTK XML PolyData, appended raw data, and ParaView's index of times.
    Vtk,
    /// One line for each particle, SI units.
    Csv,
    /// Binary little-endian polygon file, vertices only.
    Ply,
}

impl FromStr for Format {
    type Err = ExportError;

    fn from_str(name: &str) -> Result<Self, ExportError> {
        match name {
            "vtk" => Ok(Format::Vtk),
            "csv" => Ok(Format::Csv),
            "ply" => Ok(Format::Ply),
            _ => Err(ExportError::Format { name: name.into() }),
        }
    }
}

impl Format {
    fn extension(self) -> &'static str {
        match self {
            Format::Vtk => "vtp",
            Format::Csv => "csv",
            Format::Ply => "ply",
        }
    }

    /// Name of the index of a series.
    fn index(self) -> &'static str {
        match self {
            Format::Vtk => "frames.pvd",
            Format::Csv => "frames.csv",
            Format::Ply => "frames-ply.csv",
        }
    }

    fn frame(self, number: usize) -> String {
        format!("frame-{number:05}.{}", self.extension())
    }

    /// Whether `name` is that of a frame, or of a frame that a killed export was writing.
    fn is_frame(self, name: &str) -> bool {
        let number = |name: &str| name.strip_prefix("frame-")?.split('.').next()?.parse().ok();
        let is = |name: &str, whole: fn(&str, &str) -> bool| {
            number(name).is_some_and(|number| whole(name, &self.frame(number)))
        };
        match name.strip_prefix('.') {
            None => is(name, |name, frame| name == frame),
            Some(hidden) => {
                atomic::is_temporary(Path::new(name))
                    && is(hidden, |name, frame| {
                        name.strip_prefix(frame)
                            .is_some_and(|rest| rest.starts_with('.'))
                    })
            }
        }
    }

    /// Removes the index and the frames of an earlier export; returns the number of frames.
    fn clear(self, folder: &Path) -> Result<usize, FileError> {
        let mut removed = 0;
        for entry in fs::read_dir(folder).map_err(FileError::new(folder, "list"))? {
            let entry = entry.map_err(FileError::new(folder, "list"))?;
            let (name, path) = (entry.file_name(), entry.path());
            let Some(name) = name.to_str() else { continue };
            let is_frame = self.is_frame(name);
            if !is_frame && name != self.index() {
                continue;
            }
            let kind = entry
                .file_type()
                .map_err(FileError::new(&path, "examine"))?;
            if kind.is_file() {
                fs::remove_file(&path).map_err(FileError::new(&path, "remove"))?;
                removed += usize::from(is_frame && !name.starts_with('.'));
            }
        }
        Ok(removed)
    }

    /// Writes one table of particles to `path`, atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(self, table: &Table, path: &Path) -> Result<(), ExportError> {
        Ok(atomic::write_with(path, |out| match self {
            Format::Vtk => vtp::write(table, out),
            Format::Csv => csv::write(table, out),
            Format::Ply => ply::write(table, out),
        })?)
    }
}

/// Exports the checkpoint at `path` to `folder/STEM.EXTENSION`; returns the new file.
///
/// # Errors
/// If the checkpoint cannot be read, contains no particles, or the file cannot be written.
pub fn export_checkpoint(
    path: &Path,
    folder: &Path,
    format: Format,
) -> Result<PathBuf, ExportError> {
    let table = Table::try_from(checkpoint::read(path)?)?;
    // Not `with_extension`: a stem may contain a dot.
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(".");
    name.push(format.extension());
    let out = folder.join(name);
    format.write(&table, &out)?;
    Ok(out)
}

/// Exports every frame of the log at `path` to `folder/frame-00000.EXTENSION` ..., and an index:
/// `frames.pvd` for VTK, `frames.csv` and `frames-ply.csv` with the scalars for the others.
///
/// Frames of an earlier export to this format are removed first, so that the folder never contains
/// frames of two runs; other files stay. The index is written last: an export without one is
/// incomplete.
///
/// # Errors
/// If the log cannot be read to its end, or a file cannot be written or removed.
pub fn export_log(path: &Path, folder: &Path, format: Format) -> Result<Exported, ExportError> {
    let mut frames = log::read_frames(path)?;
    // If the log cannot be read, earlier frames stay.
    let mut next = frames.next().transpose()?;
    let removed = format.clear(folder)?;
    let mut files = Vec::new();
    let mut index = Vec::new();
    while let Some(frame) = next {
        let name = format.frame(files.len());
        index.push(pvd::Entry {
            time: frame.time,
            file: name.clone(),
            scalars: frame.scalars.clone(),
        });
        let out = folder.join(name);
        format.write(&Table::from(frame), &out)?;
        files.push(out);
        next = frames.next().transpose()?;
    }
    let out = folder.join(format.index());
    let text = match format {
        Format::Vtk => pvd::text(&index).into_bytes(),
        Format::Csv | Format::Ply => csv::index(&index).map_err(FileError::new(&out, "write"))?,
    };
    atomic::write_file(&out, &text)?;
    files.insert(0, out);
    Ok(Exported { files, removed })
}
