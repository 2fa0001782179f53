//! Checkpoints and logs for other programs: ParaView and PyVista (`.vtp`, with a `.pvd` index of
//! times), spreadsheets (`.csv`), mesh viewers (`.ply`).

mod csv;
mod ply;
mod pvd;
mod table;
mod vtp;

pub use table::{Column, Table};

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::atomic::{AtomicFile, FileError};
use super::checkpoint::{self, CheckpointError};
use super::log::{self, LogError};

/// An export that failed.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    #[error(transparent)]
    Io(#[from] FileError),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[error(transparent)]
    Log(#[from] LogError),
    #[error("{name:?} is no export format; choose vtk, csv or ply")]
    Format { name: String },
}

/// A format to export to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// VTK XML PolyData, appended raw data, and ParaView's index of times.
    Vtk,
    /// One line a particle, SI units.
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

    /// Writes one table of particles to `path`, atomically.
    pub fn write(self, table: &Table, path: &Path) -> Result<(), ExportError> {
        let mut file = AtomicFile::create(path)?;
        let mut out = BufWriter::with_capacity(1 << 20, &mut file);
        let written = match self {
            Format::Vtk => vtp::write(table, &mut out),
            Format::Csv => csv::write(table, &mut out),
            Format::Ply => ply::write(table, &mut out),
        };
        let flushed = written.and_then(|()| out.flush());
        // The buffer keeps what could not be written and would try again.
        drop(out.into_parts());
        flushed.map_err(FileError::new(path, "write"))?;
        Ok(file.commit()?)
    }
}

/// Exports the checkpoint at `path` to `folder/STEM.EXTENSION`; returns the new file.
pub fn export_checkpoint(
    path: &Path,
    folder: &Path,
    format: Format,
) -> Result<PathBuf, ExportError> {
    let table = Table::try_from(checkpoint::read(path)?)?;
    let stem = path.file_stem().unwrap_or_default();
    let out = folder.join(stem).with_extension(format.extension());
    format.write(&table, &out)?;
    Ok(out)
}

/// Exports every frame of the log at `path` to `folder/frame-00000.EXTENSION` ..., and an index:
/// `frames.pvd` for VTK, else `frames.csv` with the scalars. Returns the new files, the index
/// first.
pub fn export_log(path: &Path, folder: &Path, format: Format) -> Result<Vec<PathBuf>, ExportError> {
    let mut files = Vec::new();
    let mut index = Vec::new();
    for (number, frame) in log::read_frames(path)?.enumerate() {
        let frame = frame?;
        let name = format!("frame-{number:05}.{}", format.extension());
        index.push(pvd::Entry {
            time: frame.time,
            file: name.clone(),
            scalars: frame.scalars.clone(),
        });
        let out = folder.join(name);
        format.write(&Table::from(frame), &out)?;
        files.push(out);
    }
    let (name, text) = match format {
        Format::Vtk => ("frames.pvd", pvd::text(&index)),
        Format::Csv | Format::Ply => ("frames.csv", csv::index(&index)),
    };
    let out = folder.join(name);
    super::atomic::write_file(&out, text.as_bytes())?;
    files.insert(0, out);
    Ok(files)
}
