//! `coronet export`: tables and files for other programs.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::file::exists;
use coronet::pipeline::content::CHECKPOINT;
use coronet::pipeline::{Stamp, Store};
use coronet::record::CheckpointError;
use coronet::record::export::{self, ExportError, Exported, Selection, Which};
use coronet::record::log::Reel;
use serde_json::json;

use super::footage;
use super::place::{Thing, keep_results, thing};
use crate::arguments::{ExportArguments, Format};
use crate::fault::Usage;
use crate::journal::FRAMES;
use crate::print::{counted, out, shown};
use crate::runs::{Run, meant};

pub const EXAMPLES: &str = "\
Examples:
  coronet export pipeline --to vtk
  coronet export pipeline --to npz --at \"10 ms\" --body drop
  coronet export pipeline --to csv --every \"5 ms\" --output tables
  coronet export rings --to vtk --revolve

Times count from the start of the run. SI units.";

pub fn export(arguments: &ExportArguments) -> Result<()> {
    let format = match arguments.to {
        Format::Vtk => export::Format::Vtk,
        Format::Csv => export::Format::Csv,
        Format::Ply => export::Format::Ply,
        Format::Npz => export::Format::Npz,
    };
    let order = Order {
        folder: &arguments.output,
        format,
        selection: Selection {
            which: match arguments.every {
                Some(step) => Which::Every(step),
                None if arguments.at.is_empty() => Which::All,
                None => Which::Nearest(arguments.at.clone()),
            },
            bodies: arguments.body.clone(),
            revolve: arguments.revolve,
        },
    };
    keep_results(&arguments.output, &arguments.store.artifacts)?;
    let store = Store::new(&arguments.store.artifacts);
    let name = arguments.path.to_string_lossy();
    let thing = match footage::under_way(&store, &name)? {
        Some(reel) => Thing::Log(reel),
        None => thing(&meant(&store, &arguments.path)?)?,
    };
    let is_new = !exists(order.folder)?;
    fs::create_dir_all(order.folder)
        .with_context(|| format!("cannot create the folder {}", order.folder.display()))?;
    let exported = match thing {
        Thing::Checkpoint(path) => order.checkpoints(&[path], &arguments.path),
        Thing::Log(reel) => order.log(&reel),
        Thing::Result(path) => order.result(&path),
        Thing::Latest(results) => {
            let run = Run::meant(&store, &name);
            let gone = run.map_or(Ok(()), |run| footage::check_gone(&run));
            gone.and_then(|()| order.run(&results, &arguments.path))
        }
    };
    if exported.is_err() && is_new {
        // Only if it is empty.
        let _ = fs::remove_dir(order.folder);
    }
    print(arguments, &exported?);
    Ok(())
}

fn print(arguments: &ExportArguments, exported: &Exported) {
    let (files, times) = (&exported.files, &exported.times);
    if arguments.store.json {
        let files: Vec<_> = files.iter().map(|file| shown(file)).collect();
        let object = json!({"files": files, "times_s": times, "removed": exported.removed});
        out!("{object}");
        return;
    }
    let mut line = shown(&files[0]);
    if files.len() > 1 {
        line += &format!(" and {} more", files.len() - 1);
    }
    if !arguments.at.is_empty() {
        let times = times.iter().map(|time| format!("{:.4} ms", 1e3 * time));
        line += &format!("; frames at {}", times.collect::<Vec<_>>().join(", "));
    }
    if exported.removed > 0 {
        let files = counted(exported.removed, "file");
        line += &format!("; {files} of an earlier export removed");
    }
    out!("{line}");
}

/// What is exported, and where to.
struct Order<'a> {
    folder: &'a Path,
    format: export::Format,
    selection: Selection,
}

impl Order<'_> {
    fn log(&self, reel: &Reel) -> Result<Exported> {
        let exported = export::export_log(reel, self.folder, self.format, &self.selection);
        exported.map_err(|error| match error.is_usage() {
            true => Usage(format!("{}: {error}", reel.path().display())).into(),
            false => error.into(),
        })
    }

    /// The run among the results of the pipeline at `path`.
    fn run(&self, results: &[PathBuf], path: &Path) -> Result<Exported> {
        for result in results {
            if exists(&result.join(FRAMES))? {
                return self.log(&Reel::finished(&result.join(FRAMES)));
            }
        }
        bail!(Usage(format!("{} has no run", path.display())));
    }

    /// Checkpoints of the thing at `path`.
    fn checkpoints(&self, files: &[PathBuf], path: &Path) -> Result<Exported> {
        if self.selection != Selection::default() {
            bail!(Usage(format!(
                "{} is one state without names of bodies; --at, --every, --body and --revolve \
                 need the folder of a run or its log",
                path.display()
            )));
        }
        let exported = export::export_checkpoints(files, self.folder, self.format);
        exported.map_err(|error| match &error {
            ExportError::Checkpoint(of @ CheckpointError::WrongContent { .. }) => Usage(format!(
                "{}: {of}; give the folder of a packing, a relaxation or an impact",
                path.display()
            ))
            .into(),
            _ if error.is_usage() => Usage(error.to_string()).into(),
            _ => error.into(),
        })
    }

    /// Exports the frames of a run, or else each checkpoint of a result.
    fn result(&self, path: &Path) -> Result<Exported> {
        if exists(&path.join(FRAMES))? {
            return self.log(&Reel::finished(&path.join(FRAMES)));
        }
        let stamp = Stamp::read(path)?.context("no stamp")?;
        let outputs = stamp.outputs.iter().map(|output| &output.file);
        let checkpoints = outputs.filter(|file| file.ends_with(CHECKPOINT));
        let checkpoints: Vec<PathBuf> = checkpoints.map(|file| path.join(file)).collect();
        if checkpoints.is_empty() {
            bail!(Usage(format!("{} contains no particles", path.display())));
        }
        self.checkpoints(&checkpoints, path)
    }
}
