//! `coronet list`: the named runs of a store, one a row.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::time::SystemTime;

use anyhow::Result;
use coronet::measure::answer::{Figures, names as names_of};
use coronet::pipeline::name::is_name;
use coronet::pipeline::progress::{Unfinished, unfinished};
use coronet::pipeline::{Store, latest, sweep};
use serde_json::{Map, Value, json};

use crate::answer;
use crate::arguments::StoreArguments;
use crate::fault::{self, Unreadable};
use crate::print::{note, out, size};
use crate::runs::{Run, State};
use crate::table::{age, cut, lines};

/// Most columns of figures, and of settings.
const FIGURES: usize = 3;
const SETTINGS: usize = 4;

/// Most characters of a value.
const LONGEST: usize = 24;

/// Tables of settings in the order in which they tell most; others come after them, the title last.
const ORDER: [&str; 8] = [
    "body.", "liquid.", "effects.", "method.", "pack.", "box.", "impact.", "relax.",
];

/// What a row shows.
struct Row {
    run: Run,
    state: State,
    figures: Option<Figures>,
    bytes: u64,
    /// s.
    age: f64,
}

pub fn list(arguments: &StoreArguments) -> Result<()> {
    let store = Store::new(&arguments.artifacts);
    let jobs = unfinished(&store)?;
    let (mut rows, mut unread) = (Vec::new(), None);
    for name in names(&store, &jobs)? {
        match Run::named(&store, &name) {
            Ok(run) => {
                run.tell_gone();
                rows.push(row(&store, run, &jobs, &mut unread));
            }
            Err(error) if fault::exit_code(&error) == fault::FILES => {
                unread.get_or_insert(Unreadable(format!("{name}: {error:#}")));
            }
            Err(error) => note!("warning: {name}: {error:#}"),
        }
    }
    let twins: Vec<bool> = rows.iter().map(|row| is_twin(row, &rows)).collect();
    let mut twins = twins.into_iter();
    rows.retain(|_| !twins.next().unwrap_or(false));
    rows.sort_by(|a, b| a.age.total_cmp(&b.age));
    let differing = differing(&rows);
    if arguments.json {
        rows.iter()
            .for_each(|row| out!("{}", object(row, &differing)));
    } else if !rows.is_empty() {
        print(&rows, &differing);
    } else if unread.is_none() {
        let root = store.root().display();
        out!("there are no runs in {root}; `coronet run` makes one");
    }
    unread.map_or(Ok(()), |unread| Err(unread.into()))
}

/// Names of runs with results, and of those that have begun.
fn names(store: &Store, jobs: &[Unfinished]) -> Result<Vec<String>> {
    let mut names = latest::pipelines(store)?;
    let told = jobs.iter().filter_map(|job| job.told.as_ref());
    let begun = told.map(|(told, _)| told.pipeline.clone());
    names.extend(begun.filter(|name| is_name(name)));
    names.sort();
    names.dedup();
    Ok(names)
}

/// `unread`: set if its figures cannot be read.
fn row(store: &Store, run: Run, jobs: &[Unfinished], unread: &mut Option<Unreadable>) -> Row {
    let state = run.state(jobs);
    let mine = jobs.iter().filter(|job| {
        let told = job.told.as_ref();
        told.is_some_and(|(told, _)| told.pipeline == run.name)
    });
    let touched = mine.clone().filter_map(Unfinished::touched).max();
    let newest = touched.max(run.named).unwrap_or(SystemTime::UNIX_EPOCH);
    let figures = match state {
        State::Finished => run.figures(),
        _ => Ok(None),
    };
    let figures = figures.unwrap_or_else(|error| {
        note!("warning: {} has no figures: {error:#}", run.name);
        if fault::exit_code(&error) == fault::FILES {
            unread.get_or_insert(Unreadable(format!("{}: {error:#}", run.name)));
        }
        None
    });
    let folders = run.results.iter().map(|(folder, _)| folder);
    let folders = folders.chain(mine.map(|job| &job.folder));
    let mut folders: Vec<_> = folders
        .filter(|path| path.starts_with(store.root()))
        .collect();
    folders.sort();
    folders.dedup();
    let bytes = folders.into_iter().map(|folder| sweep::size(folder)).sum();
    let age = newest.elapsed().map_or(0.0, |age| age.as_secs_f64());
    Row {
        run,
        state,
        figures,
        bytes,
        age,
    }
}

/// Whether a finished run is listed by a name of its own, that of the file with settings, too.
fn is_twin(row: &Row, all: &[Row]) -> bool {
    let folders = |row: &Row| {
        let folders = row.run.results.iter().map(|(folder, _)| folder.clone());
        folders.collect::<BTreeSet<_>>()
    };
    let is_own = |name: &str| {
        let rest = name.strip_prefix(&row.run.name);
        rest.is_some_and(|rest| rest.starts_with(','))
    };
    let mut own = all.iter().filter(|other| is_own(&other.run.name));
    row.state == State::Finished && own.any(|other| folders(other) == folders(row))
}

/// The settings that are not the same in all rows, with the value of each row, if it has one: those
/// that tell most first.
fn differing(rows: &[Row]) -> Vec<(String, Vec<Option<String>>)> {
    let of_rows: Vec<_> = rows.iter().map(|row| row.run.settings()).collect();
    let mut found: Vec<(String, Vec<Option<String>>)> = Vec::new();
    for (name, _) in of_rows.iter().flatten() {
        if found.iter().any(|(known, _)| known == name) {
            continue;
        }
        let value = |settings: &Vec<(String, String)>| {
            let mut settings = settings.iter();
            let setting = settings.find(|(known, _)| known == name);
            setting.map(|(_, value)| value.clone())
        };
        found.push((name.clone(), of_rows.iter().map(value).collect()));
    }
    found.retain(|(_, values)| values.iter().any(|value| *value != values[0]));
    found.sort_by_key(|(name, values)| {
        let table = ORDER.iter().position(|table| name.starts_with(table));
        let known = values.iter().flatten().count();
        let distinct: BTreeSet<&String> = values.iter().flatten().collect();
        (
            name == "title",
            Reverse(distinct.len()),
            Reverse(known),
            table.unwrap_or(ORDER.len()),
        )
    });
    found
}

fn print(rows: &[Row], differing: &[(String, Vec<Option<String>>)]) {
    let figures = names_of_figures(rows);
    let settings = &differing[..differing.len().min(SETTINGS)];
    let mut head: Vec<String> = ["name", "age", "state"].map(str::to_string).to_vec();
    head.extend(figures.iter().map(|name| short(name).to_string()));
    head.push("size".to_string());
    head.extend(settings.iter().map(|(name, _)| name.clone()));
    let mut cells = vec![head];
    for (index, row) in rows.iter().enumerate() {
        let mut line = vec![row.run.name.clone(), age(row.age), word(&row.state)];
        for name in &figures {
            let figure = row.figures.as_ref().and_then(|figures| figures.find(name));
            line.push(figure.map_or("-".to_string(), |figure| figure.text()));
        }
        line.push(size(row.bytes));
        let values = settings.iter().map(|(_, values)| values[index].as_deref());
        line.extend(values.map(|value| cut(value.unwrap_or("-"), LONGEST)));
        cells.push(line);
    }
    let right: Vec<usize> = (3..4 + figures.len()).chain([1]).collect();
    lines(&cells, &right).iter().for_each(|line| out!("{line}"));
    if differing.len() > settings.len() {
        let more = differing.len() - settings.len();
        let differ = if more == 1 {
            "setting differs"
        } else {
            "settings differ"
        };
        out!("{more} more {differ}; `coronet diff NAME NAME` shows them all");
    }
}

/// The figures that the first rows have, without those of all runs as long as there are others.
fn names_of_figures(rows: &[Row]) -> Vec<&'static str> {
    let mut names = names_of(rows.iter().filter_map(|row| row.figures.as_ref()));
    let is_common = |name: &&str| ["mass lost", "energy unexplained"].contains(name);
    names.sort_by_key(is_common);
    names.truncate(FIGURES);
    names
}

fn short(name: &str) -> &str {
    name.strip_prefix("largest ").unwrap_or(name)
}

fn word(state: &State) -> String {
    match state {
        State::Finished => "finished".to_string(),
        State::Unfinished(job) => format!("unfinished: {job}"),
        State::Running(job, None) => format!("running: {job}"),
        State::Running(job, Some(part)) => format!("running: {job}, {:.0} %", 100.0 * part),
    }
}

fn object(row: &Row, differing: &[(String, Vec<Option<String>>)]) -> Value {
    let (state, job) = match &row.state {
        State::Finished => ("finished", None),
        State::Unfinished(job) => ("unfinished", Some(job)),
        State::Running(job, _) => ("running", Some(job)),
    };
    let own = row.run.settings();
    let own = own.into_iter().filter(|(name, _)| {
        let mut names = differing.iter().map(|(known, _)| known);
        names.any(|known| known == name)
    });
    let settings: Map<String, Value> = own.map(|(name, value)| (name, json!(value))).collect();
    json!({
        "name": row.run.name,
        "age_s": row.age,
        "state": state,
        "job": job,
        "figures": row.figures.as_ref().map(answer::json),
        "bytes": row.bytes,
        "settings": settings,
    })
}
