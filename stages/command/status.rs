//! `coronet status`: the jobs of a store that have begun and not ended, from another terminal.

use std::io::IsTerminal as _;
use std::time::{Duration, SystemTime};

use anyhow::Result;
use coronet::pipeline::Store;
use coronet::pipeline::progress::{Unfinished, unfinished};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

use crate::arguments::StatusArguments;
use crate::print::{is_closed, out, plain, shown};
use crate::table::{age, lines};
use crate::watch::duration;

/// Time between two looks with `--watch`: on a terminal, and elsewhere.
const QUICK: Duration = Duration::from_secs(1);
const SLOW: Duration = Duration::from_secs(10);

pub fn status(arguments: &StatusArguments) -> Result<()> {
    let store = Store::new(&arguments.store.artifacts);
    let mut jobs = unfinished(&store)?;
    if arguments.watch && is_running(&jobs) {
        jobs = watch(&store, arguments.store.json, jobs)?;
    }
    print(&store, &jobs, arguments.store.json);
    Ok(())
}

fn is_running(jobs: &[Unfinished]) -> bool {
    jobs.iter().any(|job| job.holder.is_some())
}

/// Shows the jobs again and again until none is under way or nobody reads.
fn watch(store: &Store, json: bool, mut jobs: Vec<Unfinished>) -> Result<Vec<Unfinished>> {
    let bar = (!json && std::io::stderr().is_terminal()).then(|| {
        let style = ProgressStyle::with_template("{msg}").expect("a valid template");
        ProgressBar::new_spinner().with_style(style)
    });
    // Between two jobs of a run, none is under way for an instant.
    let mut gone = 0;
    while gone < 2 {
        match &bar {
            Some(bar) => bar.set_message(plain(&text(&jobs).join("\n"))),
            None => print(store, &jobs, json),
        }
        if is_closed() {
            break;
        }
        std::thread::sleep(if bar.is_some() { QUICK } else { SLOW });
        jobs = unfinished(store)?;
        gone = if is_running(&jobs) { 0 } else { gone + 1 };
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    Ok(jobs)
}

fn print(store: &Store, jobs: &[Unfinished], json: bool) {
    if json {
        return jobs.iter().for_each(|job| out!("{}", object(job)));
    }
    if jobs.is_empty() {
        let root = store.root().display();
        return out!("no job in {root} is under way, was interrupted or failed");
    }
    text(jobs).iter().for_each(|line| out!("{line}"));
}

/// A row a job.
fn text(jobs: &[Unfinished]) -> Vec<String> {
    let head = ["job", "run", "done", "left", "speed", "checkpoint", "state"];
    let mut rows = vec![head.map(str::to_string).to_vec()];
    rows.extend(jobs.iter().map(row));
    let mut all = lines(&rows, &[2, 3]);
    // Where it is, is too long for a column.
    for (index, job) in jobs.iter().enumerate().rev() {
        let told = job.told.as_ref().map(|(told, _)| told.text.as_str());
        let told = told.filter(|text| !text.is_empty());
        let below = told.into_iter().chain(failure(job));
        all.splice(index + 2..index + 2, below.map(|text| format!("  {text}")));
    }
    all
}

fn row(job: &Unfinished) -> Vec<String> {
    let told = job.told.as_ref().map(|(told, _)| told);
    let done = told.filter(|told| told.first.is_some());
    let left = done.and_then(|told| told.left());
    let speed = done.filter(|told| told.speed > 0.0);
    let none = || "-".to_string();
    let state = match (&job.holder, failure(job)) {
        (Some(holder), _) => holder.clone(),
        (None, Some(_)) => format!("failed {} ago", since(job.touched())),
        (None, None) => format!("interrupted {} ago", since(job.touched())),
    };
    vec![
        job.label(),
        told.map_or_else(none, |told| told.pipeline.clone()),
        done.map_or_else(none, |told| format!("{:.1} %", 100.0 * told.fraction)),
        left.filter(|_| job.holder.is_some())
            .map_or_else(none, duration),
        speed.map_or_else(none, |told| format!("{:.2e} {}", told.speed, told.unit)),
        match job.checkpoint {
            Some(_) => format!("{} ago", since(job.checkpoint)),
            None => none(),
        },
        state,
    ]
}

/// Why it ended, if neither a stop nor a kill ended it.
fn failure(job: &Unfinished) -> Option<&str> {
    let told = job.told.as_ref().filter(|_| job.holder.is_none());
    told.and_then(|(told, _)| told.failure.as_deref())
}

fn since(instant: Option<SystemTime>) -> String {
    seconds(instant).map_or("some time".to_string(), age)
}

/// s; a clock of another machine can be ahead.
fn seconds(instant: Option<SystemTime>) -> Option<f64> {
    let elapsed = instant?.elapsed();
    Some(elapsed.map_or(0.0, |elapsed| elapsed.as_secs_f64()))
}

fn object(job: &Unfinished) -> Value {
    let told = job.told.as_ref().map(|(told, _)| told);
    let is_running = job.holder.is_some();
    json!({
        "stage": job.stage,
        "body": told.map(|told| &told.body),
        "name": told.map(|told| &told.pipeline),
        "state": match (is_running, failure(job)) {
            (true, _) => "running",
            (false, Some(_)) => "failed",
            (false, None) => "interrupted",
        },
        "failure": failure(job),
        "fraction": told.and_then(|told| told.first.map(|_| told.fraction)),
        "text": told.map(|told| &told.text),
        "speed": told.map(|told| told.speed),
        "unit": told.map(|told| &told.unit),
        "left_s": told.and_then(|told| told.left()).filter(|_| is_running),
        "checkpoint_age_s": seconds(job.checkpoint),
        "told_age_s": seconds(job.told.as_ref().map(|(_, at)| *at)),
        "process": told.map(|told| told.process),
        "host": told.map(|told| &told.host),
        "started": told.map(|told| &told.started),
        "holder": job.holder,
        "folder": shown(&job.folder),
    })
}
