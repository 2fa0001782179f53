//! `coronet gc`: removes unreachable results.

use std::io::{BufRead as _, IsTerminal as _};
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use coronet::pipeline::sweep::{self, Options, Swept};
use coronet::pipeline::{self, Store, latest};
use coronet::scene::file;
use serde_json::json;

use super::verify::existing;
use crate::arguments::SweepArguments;
use crate::batch::record;
use crate::jobs;
use crate::print::{counted, note, out, size};

pub fn sweep(arguments: &SweepArguments) -> Result<()> {
    let store = existing(&arguments.store.artifacts)?;
    let options = options(&store, arguments)?;
    let json = arguments.store.json;
    if arguments.dry_run {
        return print_swept(sweep::plan(&store, &options)?, json, "would remove");
    }
    // Fails before the question.
    drop(sweep::hold(&store)?);
    let planned = sweep::plan(&store, &options)?;
    let asks = !arguments.yes && !json && std::io::stdin().is_terminal();
    if asks && !planned.removed.is_empty() {
        print_list(&planned, json, "would remove");
        if !agreed()? {
            out!("nothing was removed");
            return Ok(());
        }
    }
    let approved: Vec<PathBuf> = planned.removed.into_iter().map(|(path, ..)| path).collect();
    let swept = sweep::sweep(&store, &options, &approved)?;
    for name in &arguments.forget {
        record::release(&latest::folder(&store, name))?;
    }
    print_swept(swept, json, "removed")
}

fn options(store: &Store, arguments: &SweepArguments) -> Result<Options> {
    let mut planned = Vec::new();
    for path in &arguments.pipelines {
        let loaded = file::load(path, &[])?;
        let pipeline = jobs::pipeline(&loaded)?;
        let decisions = pipeline::plan(store, &pipeline)?;
        planned.push((path.display().to_string(), decisions));
    }
    Ok(Options {
        older_than: arguments.older_than,
        unfinished: arguments.unfinished,
        forgotten: forgotten(store, &arguments.forget)?,
        planned,
        without_names: arguments.without_names,
    })
}

/// The names of runs that are meant: a study stands for its points.
fn forgotten(store: &Store, names: &[String]) -> Result<Vec<String>> {
    let known = latest::pipelines(store)?;
    let mut all = Vec::new();
    for name in names {
        let is_point = |rest: &str| {
            let number = rest.strip_prefix('-').unwrap_or_default();
            rest.starts_with('/') || number.parse::<u32>().is_ok()
        };
        let of_study = known
            .iter()
            .filter(|known| known.strip_prefix(name.as_str()).is_some_and(is_point));
        let points: Vec<String> = of_study.cloned().collect();
        match known.contains(name) || points.is_empty() {
            true => all.push(name.clone()),
            false => all.extend(points),
        }
    }
    Ok(all)
}

/// Asks for confirmation on the terminal.
fn agreed() -> Result<bool> {
    note!("remove these results? [y/N]");
    let mut answer = String::new();
    let asked = std::io::stdin().lock().read_line(&mut answer);
    asked.context("cannot read the answer")?;
    Ok(["y", "yes"].contains(&answer.trim().to_lowercase().as_str()))
}

/// Fails if some folders could not be read.
fn print_swept(swept: Swept, json: bool, word: &str) -> Result<()> {
    print_list(&swept, json, word);
    match swept.unknown.into_iter().next() {
        Some(error) => Err(error).context("not all of the store can be read"),
        None => Ok(()),
    }
}

fn print_list(swept: &Swept, json: bool, word: &str) {
    for (folder, why) in &swept.kept {
        if json {
            out!("{}", json!({"kept": folder.to_string_lossy(), "why": why}));
        } else {
            out!("keep    {} ({why})", folder.display());
        }
    }
    for (folder, label, bytes) in &swept.removed {
        if json {
            let object = json!({"removed": folder.to_string_lossy(), "result": label,
                "bytes": bytes, "dry_run": word != "removed"});
            out!("{object}");
        } else {
            out!("{word} {} ({label}, {})", folder.display(), size(*bytes));
        }
    }
    for error in &swept.unknown {
        if json {
            let folder = error.path.to_string_lossy();
            out!("{}", json!({"kept": folder, "why": error.to_string()}));
        } else {
            out!("keep    {error}");
        }
    }
    if json {
        return;
    }
    let bytes = swept.removed.iter().map(|(_, _, bytes)| bytes).sum();
    let results = counted(swept.removed.len(), "result");
    out!("{word} {results}, {}", size(bytes));
}
