//! `coronet run`.

use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, Result};
use coronet::pipeline::{self, Report, Run, Store, latest};
use coronet::scene::numbers;
use serde_json::json;

use crate::arguments::RunArguments;
use crate::watch::Screen;
use crate::{PROGRAM, impact, jobs, plan, post};

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
    let decisions = pipeline::plan(&store, &pipeline);
    plan::fits(&decisions)?;
    if !arguments.store.json {
        let mut out = std::io::stdout().lock();
        writeln!(out, "{}", loaded.scene.title)?;
        write!(out, "{}", numbers::of(&loaded.scene))?;
        writeln!(out, "Plan")?;
        write!(out, "{}", plan::text(&decisions))?;
        writeln!(out, "Run with {threads} threads")?;
    }
    let stop = stop_on_signals()?;
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
    // On one of the threads: from outside, each pass would wait for another thread to wake up.
    let reports = rayon::scope(|_| pipeline::run(&all))?;
    let name = &pipeline.name;
    finish(&store, name, &reports, arguments.store.json).context("cannot print the summary")
}

fn threads(arguments: &RunArguments) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    arguments.threads.map_or(cores, usize::from)
}

/// A flag that Ctrl-C and termination signals set. A second one ends the program at once: the last
/// checkpoint is as good as after a kill.
fn stop_on_signals() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(crate::fault::INTERRUPTED));
        }
        eprintln!("stopping after the next checkpoint; once more to stop at once");
    })
    .context("cannot listen to signals")?;
    Ok(stop)
}

/// Where the results are and how to look at them.
fn finish(store: &Store, name: &str, reports: &[Report], json: bool) -> std::io::Result<()> {
    let find = |stage: &str, file: &str| {
        let report = reports.iter().find(|report| report.stage == stage)?;
        let mut outputs = report.stamp.outputs.iter();
        outputs
            .find(|output| output.file == file)
            .map(|_| report.folder.join(file))
    };
    let page = find("post", post::REPORT);
    let log = find("impact", impact::FRAMES);
    let layout = find("impact", impact::LAYOUT);
    let measures = find("post", post::MEASURES);
    let state = find("impact", impact::STATE);
    let latest = latest::folder(store, name);
    let mut out = std::io::stdout().lock();
    if json {
        let object = json!({
            "summary": name,
            "artifacts": store.root(),
            "latest": latest,
            "report": page,
            "measures": measures,
            "frames": log,
            "layout": layout,
            "state": state,
        });
        return writeln!(out, "{object}");
    }
    writeln!(out, "latest   {}", latest.display())?;
    // Names are for people; scripts get the folders, which never change what they hold.
    let named = |path: PathBuf, stage: &str, file: &str| {
        let name = latest.join(stage).join(file);
        if name.exists() { name } else { path }
    };
    if let Some(page) = page {
        writeln!(
            out,
            "report   {}",
            named(page, "post", post::REPORT).display()
        )?;
    }
    if let (Some(log), Some(layout)) = (log, layout) {
        writeln!(
            out,
            "frames   {}",
            named(log, "impact", impact::FRAMES).display()
        )?;
        writeln!(
            out,
            "layout   {}",
            named(layout, "impact", impact::LAYOUT).display()
        )?;
        writeln!(
            out,
            "look     open the frames in Foxglove or Lichtblick and import the layout there, \
             or `rerun <frames>`"
        )?;
    }
    Ok(())
}
