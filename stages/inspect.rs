//! `coronet show`, `export`, `recover` and `schema`: looking at what there is.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::pipeline::store::{CHECKPOINT, LOG};
use coronet::pipeline::{Stamp, stamp};
use coronet::record::checkpoint::{self, Array};
use coronet::record::{export, log};
use serde_json::{Value, json};

use crate::arguments::{ExportArguments, Format, RecoverArguments, ShowArguments};
use crate::fault::Usage;
use crate::impact::FRAMES;
use crate::keep::size;

/// What a path leads to.
enum Thing {
    Checkpoint(PathBuf),
    Log(PathBuf),
    Result(PathBuf),
    /// A folder of results: `artifacts/latest/NAME`.
    Latest(Vec<PathBuf>),
}

fn thing(path: &Path) -> Result<Thing> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    if path.is_dir() {
        if path.join(stamp::FILE).exists() {
            return Ok(Thing::Result(path.to_path_buf()));
        }
        let entries =
            fs::read_dir(path).with_context(|| format!("cannot list {}", path.display()))?;
        let folders = entries.flatten().map(|entry| entry.path());
        let mut results: Vec<_> = folders
            .filter(|path| path.join(stamp::FILE).exists())
            .collect();
        results.sort();
        if results.is_empty() {
            let text = format!("{} is no result and holds none", path.display());
            bail!(Usage(text));
        }
        return Ok(Thing::Latest(results));
    }
    fs::metadata(path).with_context(|| format!("cannot read {}", path.display()))?;
    match extension {
        Some(LOG) => Ok(Thing::Log(path.to_path_buf())),
        Some(CHECKPOINT) => Ok(Thing::Checkpoint(path.to_path_buf())),
        _ => bail!(Usage(format!(
            "{} is no checkpoint (.{CHECKPOINT}), log (.{LOG}) or folder of a result",
            path.display()
        ))),
    }
}

pub fn show(arguments: &ShowArguments) -> Result<()> {
    let mut out = std::io::stdout().lock();
    let object = match thing(&arguments.path)? {
        Thing::Checkpoint(path) => checkpoint_object(&path)?,
        Thing::Log(path) => log_object(&path)?,
        Thing::Result(folder) => result_object(&folder)?,
        Thing::Latest(folders) => {
            let objects: Result<Vec<_>> = folders.iter().map(|path| result_object(path)).collect();
            Value::Array(objects?)
        }
    };
    if arguments.json {
        writeln!(out, "{object}")?;
    } else {
        write_text(&mut out, &object, 0)?;
    }
    Ok(())
}

/// Reads, and so verifies, a whole checkpoint.
fn checkpoint_object(path: &Path) -> Result<Value> {
    let peek = checkpoint::peek(path)?;
    let checkpoint = checkpoint::read(path)?;
    let arrays: Vec<_> = checkpoint
        .arrays
        .iter()
        .map(|(name, array)| range(name, array))
        .collect();
    let pairs = |list: Vec<(String, Value)>| Value::Object(list.into_iter().collect());
    let scalars = checkpoint
        .scalars
        .iter()
        .map(|(name, value)| (name.clone(), json!(value)));
    let texts = checkpoint
        .texts
        .iter()
        .map(|(name, value)| (name.clone(), json!(value)));
    Ok(json!({
        "checkpoint": path,
        "digest": peek.digest,
        "format": peek.version,
        "size": size(peek.file_size),
        "kind": checkpoint.kind,
        "time_s": checkpoint.time,
        "step": checkpoint.step,
        "scalars": pairs(scalars.collect()),
        "texts": pairs(texts.collect()),
        "arrays": arrays,
    }))
}

/// Name, length and range of an array.
fn range(name: &str, array: &Array) -> Value {
    fn ends<T: Copy + Into<f64>>(values: &[T]) -> (f64, f64) {
        let values = values.iter().map(|value| (*value).into());
        values.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(low, high), value: f64| (low.min(value), high.max(value)),
        )
    }
    let (low, high) = match array {
        Array::F64(values) => ends(values),
        Array::F32(values) => ends(values),
        Array::U32(values) => ends(values),
        Array::U8(values) => ends(values),
        Array::U64(values) => values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
                (l.min(*v as f64), h.max(*v as f64))
            }),
    };
    json!({"name": name, "length": array.len(), "least": low, "greatest": high})
}

fn log_object(path: &Path) -> Result<Value> {
    let info = log::info(path)?;
    let (mut frames, mut first, mut last, mut particles) = (0u64, f64::NAN, f64::NAN, 0);
    for frame in log::read_frames(path)? {
        let frame = frame?;
        if frames == 0 {
            first = frame.time;
        }
        (frames, last, particles) = (frames + 1, frame.time, frame.id.len());
    }
    let bodies: Vec<_> = info.bodies.iter().map(|body| body.name.as_str()).collect();
    Ok(json!({
        "log": path,
        "size": size(fs::metadata(path)?.len()),
        "bodies": bodies,
        "frames": frames,
        "first_s": first,
        "last_s": last,
        "particles_at_last": particles,
        "time_scale": info.time_scale,
        "provenance": info.provenance,
    }))
}

fn result_object(folder: &Path) -> Result<Value> {
    let stamp = Stamp::read(folder)?.context("no stamp")?;
    let mut object = serde_json::to_value(&stamp)?;
    object["folder"] = json!(folder);
    if let Some(settings) = object["settings"].as_array_mut() {
        for setting in settings {
            setting
                .as_object_mut()
                .map(|setting| setting.remove("canonical"));
        }
    }
    Ok(object)
}

/// An object as indented lines.
fn write_text(out: &mut impl std::io::Write, value: &Value, depth: usize) -> std::io::Result<()> {
    let indent = "  ".repeat(depth);
    let is_flat = |value: &Value| !value.is_object() && !value.is_array();
    let bare = |value: &Value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    match value {
        Value::Object(map) => {
            for (name, value) in map {
                if is_flat(value) {
                    writeln!(out, "{indent}{name}: {}", bare(value))?;
                } else {
                    writeln!(out, "{indent}{name}:")?;
                    write_text(out, value, depth + 1)?;
                }
            }
        }
        Value::Array(list) => {
            for value in list {
                match value {
                    Value::Object(map) if map.values().all(is_flat) => {
                        let parts: Vec<_> = map
                            .iter()
                            .map(|(n, v)| format!("{n} {}", bare(v)))
                            .collect();
                        writeln!(out, "{indent}{}", parts.join(", "))?;
                    }
                    value if is_flat(value) => writeln!(out, "{indent}{}", bare(value))?,
                    value => {
                        write_text(out, value, depth)?;
                        writeln!(out)?;
                    }
                }
            }
        }
        value => writeln!(out, "{indent}{}", bare(value))?,
    }
    Ok(())
}

pub fn export(arguments: &ExportArguments) -> Result<()> {
    let format = match arguments.to {
        Format::Vtk => export::Format::Vtk,
        Format::Csv => export::Format::Csv,
        Format::Ply => export::Format::Ply,
    };
    let folder = &arguments.output;
    let make = || {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))
    };
    let files = match thing(&arguments.path)? {
        Thing::Checkpoint(path) => {
            make()?;
            vec![export::export_checkpoint(&path, folder, format)?]
        }
        Thing::Log(path) => {
            make()?;
            export::export_log(&path, folder, format)?
        }
        Thing::Result(path) => {
            make()?;
            export_result(&path, folder, format)?
        }
        Thing::Latest(results) => {
            let run = results.iter().find(|path| path.join(FRAMES).exists());
            let run = run.with_context(|| format!("no run in {}", arguments.path.display()))?;
            make()?;
            export::export_log(&run.join(FRAMES), folder, format)?
        }
    };
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", json!({"files": files}))?;
    } else {
        let (first, count) = (files[0].display(), files.len());
        writeln!(
            out,
            "{first}{}",
            if count > 1 {
                format!(" and {} more", count - 1)
            } else {
                String::new()
            }
        )?;
    }
    Ok(())
}

/// The frames of a run, or else each checkpoint of a result.
fn export_result(path: &Path, folder: &Path, format: export::Format) -> Result<Vec<PathBuf>> {
    if path.join(FRAMES).exists() {
        return Ok(export::export_log(&path.join(FRAMES), folder, format)?);
    }
    let stamp = Stamp::read(path)?.context("no stamp")?;
    let mut files = Vec::new();
    for output in &stamp.outputs {
        if output.file.ends_with(CHECKPOINT) {
            files.push(export::export_checkpoint(
                &path.join(&output.file),
                folder,
                format,
            )?);
        }
    }
    if files.is_empty() {
        bail!(Usage(format!("{} holds no particles", path.display())));
    }
    Ok(files)
}

pub fn recover(arguments: &RecoverArguments) -> Result<()> {
    let stem = arguments
        .log
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let beside = arguments
        .log
        .with_file_name(format!("{stem}-recovered.{LOG}"));
    let new = arguments.output.clone().unwrap_or(beside);
    let recovered = log::recover(&arguments.log, &new)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let last = recovered.last_time;
        let object = json!({"log": new, "frames": recovered.frames, "last_s": last,
            "damage": recovered.damage});
        writeln!(out, "{object}")?;
        return Ok(());
    }
    match recovered.damage {
        None => writeln!(out, "{} was complete", arguments.log.display())?,
        Some(damage) => writeln!(out, "{damage}")?,
    }
    let (frames, last) = (recovered.frames, recovered.last_time);
    writeln!(
        out,
        "{} has {frames} frames up to t = {last} s",
        new.display()
    )?;
    Ok(())
}

pub fn schema() -> Result<()> {
    let schema = String::new();
    std::io::stdout().lock().write_all(schema.as_bytes())?;
    Ok(())
}
