//! `coronet show`, `export`, `recover` and `schema`: looking at what there is.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::pipeline::content::{CHECKPOINT, LOG};
use coronet::pipeline::{Stamp, stamp};
use coronet::record::checkpoint::{self, Array};
use coronet::record::export;
use coronet::record::log::{self, LogError};
use serde_json::{Value, json};

use crate::arguments::{
    ExportArguments, FileKind, Format, RecoverArguments, SchemaArguments, ShowArguments,
};
use crate::fault::{Untrusted, Usage};
use crate::journal::FRAMES;
use crate::keep::size;
use crate::print::out;

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
    let cannot = |what| move || format!("cannot {what} {}", path.display());
    let metadata = fs::metadata(path).with_context(cannot("read"))?;
    if metadata.is_dir() {
        if is_there(&path.join(stamp::FILE))? {
            return Ok(Thing::Result(path.to_path_buf()));
        }
        let mut results = Vec::new();
        for entry in fs::read_dir(path).with_context(cannot("list"))? {
            let folder = entry.with_context(cannot("list"))?.path();
            if folder.is_dir() && is_there(&folder.join(stamp::FILE))? {
                results.push(folder);
            }
        }
        results.sort();
        if results.is_empty() {
            let text = format!("{} is neither a result nor holds one", path.display());
            bail!(Usage(text));
        }
        return Ok(Thing::Latest(results));
    }
    match extension {
        Some(LOG) => Ok(Thing::Log(path.to_path_buf())),
        Some(CHECKPOINT) => Ok(Thing::Checkpoint(path.to_path_buf())),
        _ => bail!(Usage(format!(
            "{} is no checkpoint (.{CHECKPOINT}), log (.{LOG}) or folder of a result",
            path.display()
        ))),
    }
}

fn is_there(path: &Path) -> Result<bool> {
    path.try_exists()
        .with_context(|| format!("cannot read {}", path.display()))
}

/// A path for people and for JSON, which has no other texts than Unicode.
fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// What is known about a thing, in an order for people.
type Facts = Vec<(&'static str, Value)>;

pub fn show(arguments: &ShowArguments) -> Result<()> {
    let things: Vec<Facts> = match thing(&arguments.path)? {
        Thing::Checkpoint(path) => vec![checkpoint_facts(&path)?],
        Thing::Log(path) => vec![log_facts(&path)?],
        Thing::Result(folder) => vec![result_facts(&folder)?],
        Thing::Latest(folders) => {
            let facts = folders.iter().map(|folder| result_facts(folder));
            facts.collect::<Result<_>>()?
        }
    };
    for facts in things {
        if arguments.json {
            let named = facts
                .into_iter()
                .map(|(name, value)| (name.to_string(), value));
            out!("{}", Value::Object(named.collect()));
        } else {
            write_facts(&facts);
        }
    }
    Ok(())
}

/// Reads, and so verifies, a whole checkpoint.
fn checkpoint_facts(path: &Path) -> Result<Facts> {
    let peek = checkpoint::peek(path)?;
    let checkpoint = checkpoint::read(path)?;
    let array = |(name, array): &(String, Array)| {
        let (least, greatest) = range(array);
        json!({"name": name, "length": array.len(), "least": least, "greatest": greatest})
    };
    let scalar = |(name, value): &(String, f64)| json!({"name": name, "value": value});
    let text = |(name, value): &(String, String)| json!({"name": name, "value": value});
    Ok(vec![
        ("checkpoint", json!(shown(path))),
        ("kind", json!(checkpoint.kind)),
        ("time_s", json!(checkpoint.time)),
        ("step", json!(checkpoint.step)),
        ("digest", json!(peek.digest)),
        ("format", json!(peek.version)),
        ("size", json!(size(peek.file_size))),
        ("scalars", checkpoint.scalars.iter().map(scalar).collect()),
        ("texts", checkpoint.texts.iter().map(text).collect()),
        ("arrays", checkpoint.arrays.iter().map(array).collect()),
    ])
}

/// Least and greatest value; NaN if there is none.
fn range(array: &Array) -> (f64, f64) {
    fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
        values.fold((f64::NAN, f64::NAN), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    }
    match array {
        Array::F64(values) => ends(values.iter().copied()),
        Array::F32(values) => ends(values.iter().map(|value| f64::from(*value))),
        Array::U64(values) => ends(values.iter().map(|value| *value as f64)),
        Array::U32(values) => ends(values.iter().map(|value| f64::from(*value))),
        Array::U8(values) => ends(values.iter().map(|value| f64::from(*value))),
    }
}

fn log_facts(path: &Path) -> Result<Facts> {
    let info = log::info(path)?;
    let (mut frames, mut first, mut last, mut particles) = (0u64, f64::NAN, f64::NAN, 0);
    for frame in log::read_frames(path)? {
        let frame = frame?;
        if frames == 0 {
            first = frame.time;
        }
        (frames, last, particles) = (frames + 1, frame.time, frame.id.len());
    }
    let length = fs::metadata(path)
        .with_context(|| format!("cannot read {}", path.display()))?
        .len();
    let bodies: Vec<_> = info.bodies.iter().map(|body| body.name.as_str()).collect();
    let fact = |(name, value): (&String, &String)| json!({"name": name, "value": value});
    Ok(vec![
        ("log", json!(shown(path))),
        ("size", json!(size(length))),
        ("digest", json!(log::content_digest(path)?)),
        ("bodies", json!(bodies)),
        ("frames", json!(frames)),
        ("first_s", json!(first)),
        ("last_s", json!(last)),
        ("particles_at_last", json!(particles)),
        ("time_scale", json!(info.time_scale)),
        ("provenance", info.provenance.iter().map(fact).collect()),
    ])
}

fn result_facts(folder: &Path) -> Result<Facts> {
    let stamp = Stamp::read(folder)?.context("no stamp")?;
    let setting =
        |setting: &stamp::SettingStamp| json!({"name": setting.name, "value": setting.value});
    let input = |input: &stamp::InputStamp| {
        let name = stamp::label(&input.stage, &input.body);
        json!({"name": name, "digest": input.digest})
    };
    let output = |output: &stamp::OutputStamp| {
        let size = size(output.bytes);
        json!({"file": output.file, "size": size, "digest": output.digest})
    };
    Ok(vec![
        ("result", json!(stamp.label())),
        ("folder", json!(shown(folder))),
        ("key", json!(stamp.key)),
        ("digest", json!(stamp.digest)),
        ("version", json!(stamp.version)),
        ("settings", stamp.settings.iter().map(setting).collect()),
        ("inputs", stamp.inputs.iter().map(input).collect()),
        ("outputs", stamp.outputs.iter().map(output).collect()),
        ("notes", json!(stamp.notes)),
        ("program", json!(stamp.program)),
        ("machine", json!(stamp.machine)),
        ("threads", json!(stamp.threads)),
        ("started", json!(stamp.started)),
        ("resumptions", json!(stamp.resumptions)),
        ("wall_seconds", json!(stamp.wall_seconds)),
        ("cpu_seconds", json!(stamp.cpu_seconds)),
        ("memory_bytes", json!(stamp.memory_bytes)),
    ])
}

/// One line a fact; lists below their names.
fn write_facts(facts: &Facts) {
    for (name, value) in facts {
        match value {
            Value::Array(list) if list.is_empty() => {}
            Value::Array(list) => {
                out!("{name}");
                for item in list {
                    out!("  {}", line(item));
                }
            }
            value => out!("{name:18} {}", line(value)),
        }
    }
    out!("");
}

/// A value in one line: of an object first its name, then the rest.
fn line(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Object(map) => {
            let head = ["name", "file", "value"]
                .into_iter()
                .filter_map(|name| map.get(name));
            let named = |name: &&String| !["name", "file", "value"].contains(&name.as_str());
            let tail = map.iter().filter(|(name, _)| named(name));
            let mut parts: Vec<String> = Vec::new();
            for (index, value) in head.enumerate() {
                let width = if index == 0 { 32 } else { 0 };
                parts.push(format!("{:width$}", line(value)));
            }
            parts.extend(tail.map(|(name, value)| format!("{name} {}", line(value))));
            parts.join("  ")
        }
        other => other.to_string(),
    }
}

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

/// The frames of a run, or else each checkpoint of a result.
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
        bail!(Usage(format!("{} holds no particles", path.display())));
    }
    Ok(export::Exported { files, removed: 0 })
}

pub fn recover(arguments: &RecoverArguments) -> Result<()> {
    let mut beside = arguments.log.file_stem().unwrap_or_default().to_os_string();
    beside.push(format!("-recovered.{LOG}"));
    let beside = arguments.log.with_file_name(beside);
    let new = arguments.output.clone().unwrap_or(beside);
    let recovered = log::recover(&arguments.log, &new).map_err(|error| match error {
        LogError::NotReplaced { .. } => Usage(error.to_string()).into(),
        error if error.is_damage() => Untrusted(format!(
            "{error}; nothing was written. Run the pipeline again to get the frames: it goes on \
             from its last checkpoint"
        ))
        .into(),
        error => anyhow::Error::from(error),
    })?;
    let (frames, last) = (recovered.frames, recovered.last_time);
    if arguments.json {
        let object = json!({"log": shown(&new), "frames": frames, "last_s": last,
            "damage": recovered.damage});
        out!("{object}");
        return Ok(());
    }
    match recovered.damage {
        None => out!("{} was complete", arguments.log.display()),
        Some(damage) => out!("{} is damaged: {damage}", arguments.log.display()),
    }
    out!("{} has {frames} frames up to t = {last} s", new.display());
    Ok(())
}

pub fn schema(arguments: &SchemaArguments) -> Result<()> {
    let schema = match (arguments.of, arguments.markdown) {
        (FileKind::Pipeline, false) => coronet::scene::file::json_schema(),
        (FileKind::Pipeline, true) => coronet::scene::reference::markdown(),
        (FileKind::Study, false) => crate::points::schema(),
        (FileKind::Study, true) => bail!(Usage(
            "--markdown: there is no page of studies; leave it out for the JSON schema".into()
        )),
    };
    out!("{}", schema.trim_end());
    Ok(())
}
