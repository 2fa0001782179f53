//! `coronet show`: the content of a file or a result.

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Error, Result};
use coronet::pipeline::{Stamp, Store, stamp};
use coronet::record::checkpoint::{self, Array};
use coronet::record::log::{self};
use coronet::scene::error::SceneError;
use serde_json::{Value, json};

use super::place::{Thing, thing};
use crate::answer;
use crate::arguments::ShowArguments;
use crate::print::{note, out, shown, size};
use crate::runs::meant;

/// Facts in the order of printing.
type Facts = Vec<(&'static str, Value)>;

pub fn show(arguments: &ShowArguments) -> Result<()> {
    let json = arguments.json;
    // What else a result holds is shown whatever becomes of its figures.
    let mut lacks = None;
    let store = Store::new(&arguments.artifacts);
    let things: Vec<Facts> = match thing(&meant(&store, &arguments.path)?)? {
        Thing::Checkpoint(path) => vec![checkpoint_facts(&path)?],
        Thing::Log(reel) => vec![log_facts(reel.path())?],
        Thing::Result(folder) => vec![result_facts(&folder, json, &mut lacks)?],
        Thing::Latest(folders) => {
            let facts = folders
                .iter()
                .map(|folder| result_facts(folder, json, &mut lacks));
            facts.collect::<Result<_>>()?
        }
    };
    for facts in things {
        if json {
            let named = facts
                .into_iter()
                .map(|(name, value)| (name.to_string(), value));
            out!("{}", Value::Object(named.collect()));
        } else {
            write_facts(&facts);
        }
    }
    lacks.map_or(Ok(()), Err)
}

/// Reads and thereby verifies a whole checkpoint.
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
        ("bytes", json!(peek.file_size)),
        ("scalars", checkpoint.scalars.iter().map(scalar).collect()),
        ("texts", checkpoint.texts.iter().map(text).collect()),
        ("arrays", checkpoint.arrays.iter().map(array).collect()),
    ])
}

/// Minimum and maximum; NaN if there is no value.
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
        ("bytes", json!(length)),
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

/// `lacks`: why the first result without the figures that it should have has none.
fn result_facts(folder: &Path, json: bool, lacks: &mut Option<Error>) -> Result<Facts> {
    let stamp = Stamp::read(folder)?.context("no stamp")?;
    let figures = answer::of_result(folder, &stamp).unwrap_or_else(|error| {
        let error = error.context(format!("{} has no figures", shown(folder)));
        // Those of a scene of another version need that version.
        match error.chain().any(|cause| cause.is::<SceneError>()) || lacks.is_some() {
            true => note!("warning: {error:#}"),
            false => *lacks = Some(error),
        }
        None
    });
    let setting =
        |setting: &stamp::SettingStamp| json!({"name": setting.name, "value": setting.value});
    let input = |input: &stamp::InputStamp| {
        let name = stamp::label(&input.stage, &input.body);
        json!({"name": name, "digest": input.digest})
    };
    let output = |output: &stamp::OutputStamp| {
        let (file, bytes) = (&output.file, output.bytes);
        json!({"file": file, "bytes": bytes, "digest": output.digest})
    };
    let mut facts = vec![
        ("result", json!(stamp.label())),
        ("folder", json!(shown(folder))),
    ];
    facts.extend(figures.map(|figures| match json {
        true => ("figures", answer::json(&figures)),
        false => ("figures", json!(answer::lines(&figures))),
    }));
    facts.extend([
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
    ]);
    Ok(facts)
}

/// One line for each fact; lists below their names.
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
            value => {
                let (name, text) = pair(name, value);
                out!("{name:18} {text}");
            }
        }
    }
    out!("");
}

/// A name and its value in one line; sizes are for readers.
fn pair<'a>(name: &'a str, value: &Value) -> (&'a str, String) {
    match (name, value.as_u64()) {
        ("bytes", Some(bytes)) => ("size", size(bytes)),
        _ => (name, line(value)),
    }
}

/// A value in one line; an object starts with its name.
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
            let pairs = tail.map(|(name, value)| pair(name, value));
            parts.extend(pairs.map(|(name, text)| format!("{name} {text}")));
            parts.join("  ")
        }
        other => other.to_string(),
    }
}
