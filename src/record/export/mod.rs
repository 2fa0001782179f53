//! Export of checkpoints and logs: for ParaView and PyVista (`.vtp`, with a `.pvd` index of times),
//! spreadsheets (`.csv`), mesh viewers (`.ply`) and NumPy (`.npz`).
//!
//! Besides what a frame or checkpoint holds, each particle has `mass`, kg (kg/m in 2-D), and
//! `radius`, m: that of a sphere (2-D: a disc) of its volume, mass over density; of a ring that of
//! a disc of its area in the half-plane. Rings can be exported as points about their axis.

mod choice;
mod csv;
mod folder;
mod npz;
mod ply;
mod pvd;
mod table;
mod vtp;

pub use self::csv::cell;
pub use choice::Which;
pub use folder::LIST;
pub use table::{Column, Table};

use std::path::{Path, PathBuf};

use super::atomic;
use super::checkpoint::{self, CheckpointError};
use super::log::{LogError, Reel};
use crate::file::FileError;
use crate::particle::{Frame, ring};
use crate::scene::{Clock, Dimension};
use folder::List;

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
    /// The run has no frame near an instant.
    #[error(
        "there is no frame at {} ms: the frames are from {} to {} ms", 1e3 * at, 1e3 * first,
        1e3 * last
    )]
    Outside {
        /// The instant, s.
        at: f64,
        /// Time of the first frame, s.
        first: f64,
        /// Time of the last frame, s.
        last: f64,
    },
    /// The run has no such body.
    #[error("there is no body `{name}`; the bodies are {known}")]
    Body {
        /// Its name as given.
        name: String,
        /// Names of the bodies.
        known: String,
    },
    /// The run has no axis.
    #[error("the run has no rings to revolve: its scene has no `box.symmetry = \"axis\"`")]
    Plain,
    /// A file that no export has written.
    #[error(
        "{} is not of an earlier export: move it, or export to another folder",
        path.display()
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The list of an earlier export is not one.
    #[error(
        "{} is not the list of an export ({problem}): remove it, or export to another folder",
        path.display()
    )]
    List {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
}

impl ExportError {
    /// Whether a file was read and its content is wrong. False for an I/O error.
    pub fn is_damage(&self) -> bool {
        match self {
            ExportError::Checkpoint(error) => error.is_damage(),
            ExportError::Log(error) => error.is_damage(),
            _ => false,
        }
    }

    /// Whether something was asked for that does not exist.
    pub fn is_usage(&self) -> bool {
        use ExportError::{Body, Foreign, List, Outside, Plain};
        matches!(
            self,
            Body { .. } | Foreign { .. } | List { .. } | Outside { .. } | Plain
        )
    }
}

/// Result of an export.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exported {
    /// The new files, the index first.
    pub files: Vec<PathBuf>,
    /// Times of the exported frames, s from the start of the run; of a log only.
    pub times: Vec<f64>,
    /// Number of files of an earlier export that were removed.
    pub removed: usize,
}

/// What of a log is exported; by default all of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Which frames.
    pub which: Which,
    /// Names of the bodies whose particles are exported; all if empty.
    pub bodies: Vec<String>,
    /// Into how many points about the axis a ring is divided at most; rings stay whole if `None`.
    pub revolve: Option<usize>,
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
    /// NumPy's archive of arrays.
    Npz,
}

impl Format {
    const ALL: [Format; 4] = [Format::Vtk, Format::Csv, Format::Ply, Format::Npz];

    fn extension(self) -> &'static str {
        match self {
            Format::Vtk => "vtp",
            Format::Csv => "csv",
            Format::Ply => "ply",
            Format::Npz => "npz",
        }
    }

    /// Name of the index of a series.
    fn index(self) -> &'static str {
        match self {
            Format::Vtk => "frames.pvd",
            Format::Csv => "frames.csv",
            Format::Ply => "frames-ply.csv",
            Format::Npz => "frames-npz.csv",
        }
    }

    /// Endings of all its files.
    fn extensions(self) -> [&'static str; 2] {
        let index = self.index();
        [self.extension(), &index[index.len() - 3..]]
    }

    fn frame(self, number: usize) -> String {
        format!("frame-{number:05}.{}", self.extension())
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
            Format::Npz => npz::write(table, out),
        })?)
    }
}

/// Exports checkpoints to `folder/STEM.EXTENSION`, in place of an earlier export there.
///
/// # Errors
/// If a checkpoint cannot be read or contains no particles, or a file cannot be written or removed.
pub fn export_checkpoints(
    paths: &[PathBuf],
    folder: &Path,
    format: Format,
) -> Result<Exported, ExportError> {
    let mut tables = Vec::new();
    let mut names = Vec::new();
    for path in paths {
        tables.push(Table::try_from(checkpoint::read(path)?)?);
        // Not `with_extension`: a stem may contain a dot.
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        names.push(format!("{stem}.{}", format.extension()));
    }
    let removed = folder::clear(folder, &names)?;
    List::new(Vec::new(), names.clone()).write(folder)?;
    let mut exported = Exported {
        removed,
        ..Exported::default()
    };
    for (table, name) in tables.iter().zip(names) {
        let out = folder.join(name);
        format.write(table, &out)?;
        exported.files.push(out);
    }
    Ok(exported)
}

/// Exports frames of a run to `folder/frame-00000.EXTENSION` ..., and an index:
/// `frames.pvd` for VTK, `frames.csv`, `frames-ply.csv` and `frames-npz.csv` with the scalars for
/// the others.
///
/// The files of an earlier export to the folder are removed first, whatever their format; other
/// files stay. The index is written last: an export without one is incomplete.
///
/// # Errors
/// If the log cannot be read to its end, then no file is removed; if what is selected is not in the
/// log; or if a file cannot be written or removed.
pub fn export_log(
    reel: &Reel,
    folder: &Path,
    format: Format,
    selection: &Selection,
) -> Result<Exported, ExportError> {
    let info = reel.info()?;
    let bodies = choice::bodies(&selection.bodies, &info.bodies)?;
    let times = reel.times()?;
    let chosen = selection.which.of(&times)?;
    let mut names = vec![format.index().to_string()];
    names.extend((0..chosen.len()).map(|number| format.frame(number)));
    if selection.revolve.is_some() {
        let first = reel.frames()?.next().transpose()?;
        first
            .filter(|frame| !frame.mass.is_empty())
            .ok_or(ExportError::Plain)?;
    }
    let removed = folder::clear(folder, &names)?;
    let known = info.bodies.iter().map(|body| body.name.clone()).collect();
    List::new(known, names.clone()).write(folder)?;

    let mut index = Vec::new();
    let mut left = chosen.iter().peekable();
    for (number, frame) in reel.frames()?.enumerate() {
        if left.peek().is_none() {
            break;
        }
        let frame = frame?;
        if left.next_if(|next| **next == number).is_none() {
            continue;
        }
        let after = Clock::after_contact(frame.time, info.contact);
        let mut table = match selection.revolve {
            Some(most) => Table::of_frame(revolved(&frame, info.spacing, most), Dimension::Three),
            None => Table::of_frame(frame, info.dimension),
        };
        table.after_contact = after;
        if let Some(bodies) = &bodies {
            table.keep_bodies(bodies);
        }
        let file = names[index.len() + 1].clone();
        format.write(&table, &folder.join(&file))?;
        index.push(pvd::Entry {
            time: table.time,
            after_contact: after,
            file,
            scalars: table.scalars,
        });
    }
    let out = folder.join(format.index());
    let text = match format {
        Format::Vtk => pvd::text(&index).into_bytes(),
        _ => csv::index(&index).map_err(FileError::new(&out, "write"))?,
    };
    atomic::write_file(&out, &text)?;
    Ok(Exported {
        files: names.iter().map(|name| folder.join(name)).collect(),
        times: index.iter().map(|entry| entry.time).collect(),
        removed,
    })
}

/// The rings of a frame as points a spacing apart, `most` of each at most.
fn revolved(frame: &Frame, spacing: f64, most: usize) -> Frame {
    let [r, ..] = &frame.position;
    let mut points = ring::points(frame, |i| ring::point_count(r[i], spacing as f32).min(most));
    // Across the axis that of the rings is a sum over radii, of which none is left about the axis.
    let across = ["momentum_x_kg_m_s", "momentum_y_kg_m_s"];
    let momenta = points.scalars.iter_mut();
    momenta
        .filter(|(name, _)| across.contains(&name.as_str()))
        .for_each(|(_, value)| *value = 0.0);
    points
}
