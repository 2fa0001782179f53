//! `coronet run`.

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use coronet::pipeline::{self, Report, Run, Store, latest};
use coronet::scene::numbers;
use serde_json::json;

use super::plan;
use crate::arguments::RunArguments;
use crate::print::out;
use crate::watch::Screen;
use crate::{PROGRAM, impact, jobs, journal, post, signals};

/// Answer to a first signal.
const STOPPING: &str = "stopping after the next checkpoint";

pub fn run(arguments: &RunArguments) -> Result<()> {
    let mut loaded = plan::load(&arguments.pipeline)?;
    if let Some(name) = &arguments.name {
        loaded.scene.name = name.clone();
    }
    plan::warn(&loaded.scene);
    let pipeline = jobs::pipeline(&loaded)?;
    let store = Store::new(&arguments.store.artifacts);
    let threads = threads(arguments);
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .context("cannot start the threads")?;
    let decisions = pipeline::plan(&store, &pipeline)?;
    plan::fits(&decisions)?;
    if !arguments.store.json {
        let text = format!(
            "{}Plan\n{}",
            numbers::of(&loaded.scene),
            plan::text(&decisions)
        );
        out!("{}\n{text}Run with {threads} threads", loaded.scene.title);
    }
    let stop = signals::stop_flag(STOPPING)?;
    if arguments.stop_at_end_of_input {
        signals::stop_at_end_of_input(&stop)?;
    }
    let screen = Screen::new(arguments.store.json);
    let all = Run {
        store: &store,
        pipeline: &pipeline,
        until: arguments.until.as_deref(),
        stop: &stop,
        watch: &screen,
        threads,
        program: PROGRAM.to_string(),
    };
    // On one of the threads: outside, each parallel loop would wait for another thread to wake up.
    let ended = rayon::scope(|_| pipeline::run(&all))?;
    finish(&store, &pipeline.name, &ended.reports, arguments.store.json);
    let unnamed = ended.unnamed.map_or(Ok(()), Err);
    unnamed.context("the results are finished and kept, but have no names in latest/")
}

fn threads(arguments: &RunArguments) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    arguments.threads.map_or(cores, usize::from)
}

/// Where the results are and how to look at them.
fn finish(store: &Store, name: &str, reports: &[Report], json: bool) {
    let find = |stage: &str, file: &str| {
        let report = reports.iter().find(|report| report.stage == stage)?;
        let mut outputs = report.stamp.outputs.iter();
        outputs
            .find(|output| output.file == file)
            .map(|_| report.folder.join(file))
    };
    let page = find("post", post::REPORT);
    let log = find("impact", journal::FRAMES);
    let layout = find("impact", impact::LAYOUT);
    let latest = latest::folder(store, name);
    if json {
        let text = |path: Option<PathBuf>| path.map(|path| path.to_string_lossy().into_owned());
        let object = json!({
            "summary": name,
            "artifacts": store.root().to_string_lossy(),
            "latest": latest.to_string_lossy(),
            "report": text(page),
            "measures": text(find("post", post::MEASURES)),
            "frames": text(log),
            "layout": text(layout),
            "state": text(find("impact", impact::STATE)),
        });
        return out!("{object}");
    }
    out!("latest   {}", latest.display());
    // Names are for users; scripts get the folders, whose content never changes.
    let named = |path: PathBuf, stage: &str, file: &str| {
        let name = latest.join(stage).join(file);
        let same = name.canonicalize().ok() == path.canonicalize().ok();
        if same { name } else { path }
    };
    if let Some(page) = page {
        let path = named(page, "post", post::REPORT);
        out!("report   {}", path.display());
    }
    if let (Some(log), Some(layout)) = (log, layout) {
        let log = named(log, "impact", journal::FRAMES);
        let layout = named(layout, "impact", impact::LAYOUT);
        out!("frames   {}", log.display());
        out!("layout   {}", layout.display());
        out!(
            "look     open the frames in Foxglove or Lichtblick and import the layout there, \
             or `rerun <frames>`"
        );
    }
}
