//! `coronet init`: a scene to begin with, from those that are compiled in.

use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use coronet::file::FileError;
use coronet::record::atomic::create_folder;

use crate::arguments::InitArguments;
use crate::fault::Usage;
use crate::print::{out, quoted};
use crate::table;

/// A scene: its name, what it is, and its text.
struct Sample {
    name: &'static str,
    about: &'static str,
    text: &'static str,
}

/// All scenes that are compiled in; the first is the default.
const SAMPLES: [Sample; 5] = [
    Sample {
        name: "default",
        about: "with every setting explained; some minutes",
        text: include_str!("../../pipeline.toml"),
    },
    Sample {
        name: "tiny",
        about: "in miniature; some ten seconds",
        text: include_str!("../../scenes/tiny.toml"),
    },
    Sample {
        name: "collision",
        about: "two drops meet in free space; some ten seconds",
        text: include_str!("../../scenes/hard/collision.toml"),
    },
    Sample {
        name: "dry-wall",
        about: "a drop spreads on a wall, in two dimensions; seconds",
        text: include_str!("../../scenes/xie-2007/fukai-a.toml"),
    },
    Sample {
        name: "rebound",
        about: "a drop leaves a wall that it does not wet; seconds",
        text: include_str!("../../scenes/hard/rebound.toml"),
    },
];

/// Start of a line that tells editors where the schema is, relative to the file.
const SCHEMA: &str = "#:schema ";

pub fn init(arguments: &InitArguments) -> Result<()> {
    if arguments.list {
        let row = |sample: &Sample| {
            let title = title(sample.text).to_string();
            vec![sample.name.to_string(), title, sample.about.to_string()]
        };
        let rows: Vec<_> = SAMPLES.iter().map(row).collect();
        let lines = table::lines(&rows, &[]);
        lines.iter().for_each(|line| out!("{line}"));
        return Ok(());
    }
    let known = || SAMPLES.map(|sample| sample.name).join(", ");
    let found = SAMPLES.iter().find(|sample| sample.name == arguments.name);
    let sample = found.ok_or_else(|| {
        let name = &arguments.name;
        Usage(format!("there is no scene {name:?}; there are {}", known()))
    })?;
    let path = match (&arguments.path, sample.name) {
        (Some(path), _) => path.clone(),
        (None, "default") => PathBuf::from("pipeline.toml"),
        (None, name) => PathBuf::from(format!("{name}.toml")),
    };
    write(&path, &text(sample))?;
    out!("wrote    {} ({})", path.display(), title(sample.text));
    let shown = quoted(&path.to_string_lossy());
    out!("next     `coronet plan {shown}` tells how long it takes, `coronet run {shown}` runs it");
    Ok(())
}

/// The scene as it is written: a line about the schema would lead nowhere.
fn text(sample: &Sample) -> String {
    let lines = sample.text.lines();
    let kept = lines.filter(|line| !line.starts_with(SCHEMA));
    kept.map(|line| format!("{line}\n")).collect()
}

/// What the scene says that it is about.
fn title(text: &str) -> &str {
    let line = text.lines().find_map(|line| line.strip_prefix("title = "));
    line.unwrap_or_default().trim_matches('"')
}

/// An error if there is something at `path` already.
pub fn check_new(path: &Path) -> Result<()> {
    match path.symlink_metadata() {
        Ok(_) => bail!(taken(path)),
        Err(_) => Ok(()),
    }
}

fn taken(path: &Path) -> Usage {
    let path = path.display();
    Usage(format!(
        "{path} exists already and stays as it is; give another path, or remove it"
    ))
}

/// Writes a new file. An existing one stays as it is.
pub fn write(path: &Path, text: &str) -> Result<()> {
    create_folder(path.parent().unwrap_or(Path::new("")))?;
    let mut file = match OpenOptions::new().write(true).create_new(true).open(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => bail!(taken(path)),
        opened => opened.map_err(FileError::new(path, "create"))?,
    };
    file.write_all(text.as_bytes()).map_err(|error| {
        // Half a scene would be in the way of the next try.
        let _ = fs::remove_file(path);
        FileError::new(path, "write")(error)
    })?;
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_sample_has_a_title() {
        for sample in super::SAMPLES {
            assert!(!super::title(sample.text).is_empty(), "{}", sample.name);
        }
    }
}
