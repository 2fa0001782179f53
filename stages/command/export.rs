//! `coronet export`: tables and files for other programs.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, bail};
use coronet::pipeline::Stamp;
use coronet::pipeline::content::CHECKPOINT;
use coronet::record::export;
use serde_json::json;

use super::place::{Thing, is_there, thing};
use crate::arguments::{ExportArguments, Format};
use crate::fault::Usage;
use crate::journal::FRAMES;
use crate::print::{out, shown};

pub fn export(arguments: &ExportArguments) -> Result<()> {
    let format = match arguments.to {
        Format::Vtk => export::Format::Vtk,
        Format::Csv => export::Format::Csv,
        Format::Ply => export::Format::Ply,
    };
    let folder = &arguments.output;
    let thing = thing(&arguments.path)?;
    fs::create_dir_all(folder)
        .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    let exported = match thing {
        Thing::Checkpoint(path) => export::Exported {
            files: vec![export::export_checkpoint(&path, folder, format)?],
            removed: 0,
        },
        Thing::Log(path) => export::export_log(&path, folder, format)?,
        Thing::Result(path) => export_result(&path, folder, format)?,
        Thing::Latest(results) => {
            let run = results.iter().find(|path| path.join(FRAMES).exists());
            let Some(run) = run else {
                let text = format!("{} has no run", arguments.path.display());
                bail!(Usage(text));
            };
            export::export_log(&run.join(FRAMES), folder, format)?
        }
    };
    if arguments.json {
        let files: Vec<_> = exported.files.iter().map(|file| shown(file)).collect();
        let object = json!({"files": files, "removed": exported.removed});
        out!("{object}");
        return Ok(());
    }
    let mut line = shown(&exported.files[0]);
    if exported.files.len() > 1 {
        line += &format!(" and {} more", exported.files.len() - 1);
    }
    if exported.removed > 0 {
        line += &format!("; {} frames of an earlier export removed", exported.removed);
    }
    out!("{line}");
    Ok(())
}

/// Exports the frames of a run, or else each checkpoint of a result.
fn export_result(path: &Path, folder: &Path, format: export::Format) -> Result<export::Exported> {
    if is_there(&path.join(FRAMES))? {
        return Ok(export::export_log(&path.join(FRAMES), folder, format)?);
    }
    let stamp = Stamp::read(path)?.context("no stamp")?;
    let mut files = Vec::new();
    for output in &stamp.outputs {
        if output.file.ends_with(CHECKPOINT) {
            let checkpoint = path.join(&output.file);
            let file = export::export_checkpoint(&checkpoint, folder, format);
            files.push(file?);
        }
    }
    if files.is_empty() {
        bail!(Usage(format!("{} contains no particles", path.display())));
    }
    Ok(export::Exported { files, removed: 0 })
}
