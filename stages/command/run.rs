//! `coronet run`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::{Context as _, Error, Result};
use coronet::measure::answer::Figures;
use coronet::pipeline::name::is_name;
use coronet::pipeline::remote::Remote;
use coronet::pipeline::{
    self, Decision, Pipeline, PipelineError, Report, Run, Status, Store, latest,
};
use coronet::scene::file::Loaded;
use coronet::scene::{Scene, numbers, variant};
use serde_json::json;

use super::plan;
use super::rest::Rest;
use crate::answer;
use crate::arguments::RunArguments;
use crate::fault::Usage;
use crate::print::{counted, note, out};
use crate::watch::Screen;
use crate::{PROGRAM, impact, jobs, journal, live, post, ranks, remote, signals, stop};

/// Answer to a first signal.
const STOPPING: &str = "stopping after the next checkpoint";

pub fn run(arguments: &RunArguments) -> Result<()> {
    let objects = remote::open(arguments.remote.url(), &arguments.store.artifacts)?;
    bring(arguments, objects.as_deref().map(Remote::new))
}

/// `coronet pull`: as `run`, but what is not there is not made.
pub fn pull(arguments: &RunArguments) -> Result<()> {
    let objects = remote::open(arguments.remote.url(), &arguments.store.artifacts)?;
    let objects = objects.ok_or_else(no_remote)?;
    if arguments.live.is_some() {
        return Err(Usage("--live: `pull` runs no impact; use `run`".to_string()).into());
    }
    bring(arguments, Some(Remote::only(&*objects)))
}

/// For commands that need one.
pub fn no_remote() -> Usage {
    Usage("which remote store? Name it with --remote URL or in CORONET_REMOTE".to_string())
}

/// What the other ranks do.
fn help(arguments: &RunArguments, scene: &Scene) -> Result<()> {
    signals::leave_to_another()?;
    start_threads(arguments)?;
    rayon::scope(|_| ranks::help(scene))
}

fn bring(arguments: &RunArguments, remote: Option<Remote>) -> Result<()> {
    let mut loaded = plan::load(&arguments.pipeline)?;
    if ranks::is_helper() {
        return help(arguments, &loaded.scene);
    }
    ranks::check(&loaded.scene)?;
    if let Some(name) = &arguments.name {
        loaded.scene.name = name.clone();
    }
    plan::warn(&loaded.scene);
    let viewers = live::open(arguments.live.as_deref())?;
    let pipeline = jobs::watched(&loaded, viewers)?;
    let store = Store::new(&arguments.store.artifacts);
    let threads = start_threads(arguments)?;
    let decisions = pipeline::plan(&store, &pipeline)?;
    let makes = remote.as_ref().is_none_or(|remote| !remote.only);
    if makes {
        plan::fits(&decisions, plan::shared_here(&loaded.scene))?;
    }
    let also = own_name(arguments, &pipeline.name);
    let stop = stop_flag(arguments)?;
    let screen = Screen::new(arguments.store.json);
    let all = Run {
        store: &store,
        pipeline: &pipeline,
        also: also.as_deref(),
        until: arguments.until.as_deref(),
        stop: &stop,
        watch: &screen,
        remote: remote.as_ref(),
        threads,
        program: PROGRAM.to_string(),
    };
    all.check()?;
    if makes && !arguments.store.json {
        announce(&loaded, &decisions, threads);
    }
    // On one of the threads: outside, each parallel loop would wait for another thread to wake up.
    let ended = match rayon::scope(|_| pipeline::run(&all)) {
        Err(stopped @ PipelineError::Interrupted { .. }) => {
            match Rest::of(&store, &pipeline) {
                Ok(rest) => rest.iter().for_each(Rest::tell),
                Err(error) => note!("warning: what is missing is not known: {error}"),
            }
            return Err(stopped.into());
        }
        ended => ended?,
    };
    let (rest, unknown) = still_missing(arguments, &store, &pipeline);
    let told = Told {
        figures: figures(&loaded.scene, &ended.reports)?,
        rest,
        ended: self::ended(&ended.reports),
        also,
    };
    finish(
        &store,
        &pipeline.name,
        &ended.reports,
        &told,
        arguments.store.json,
    );
    if let Some(error) = unknown {
        return Err(Error::from(error).context("what is missing is not known"));
    }
    let unnamed = ended.unnamed.map_or(Ok(()), Err);
    unnamed.context("the results are finished and kept, but have no names in latest/")
}

/// What `--until` left out, or why that is not known: what was made is told whatever becomes of it.
fn still_missing(
    arguments: &RunArguments,
    store: &Store,
    pipeline: &Pipeline,
) -> (Option<Rest>, Option<PipelineError>) {
    match arguments.until.as_ref().map(|_| Rest::of(store, pipeline)) {
        None => (None, None),
        Some(Ok(rest)) => (rest, None),
        Some(Err(error)) => (None, Some(error)),
    }
}

/// Set when the run shall stop.
fn stop_flag(arguments: &RunArguments) -> Result<Arc<AtomicBool>> {
    let stop = signals::stop_flag(STOPPING)?;
    if arguments.stop_at_end_of_input {
        signals::stop_at_end_of_input(&stop)?;
    }
    Ok(stop)
}

/// What is done before the stages run.
fn announce(loaded: &Loaded, decisions: &[Decision], threads: usize) {
    let (plan, threads) = (plan::text(decisions), counted(threads, "thread"));
    out!(
        "{}\n{}Plan\n{plan}Run with {threads}",
        loaded.scene.title,
        numbers::of(&loaded.scene)
    );
}

/// The name of a run with `--set` and without `--name`. It keeps the results when the name of the
/// file goes to the next ones.
fn own_name(arguments: &RunArguments, file: &str) -> Option<String> {
    let sets = &arguments.pipeline.set;
    if arguments.name.is_some() || sets.is_empty() {
        return None;
    }
    let name = format!("{file},{}", variant::name(sets));
    is_name(&name).then_some(name)
}

/// What the end of a run tells besides where its results are.
struct Told {
    figures: Option<Figures>,
    /// Stages after `--until`.
    rest: Option<Rest>,
    /// Of the impact, if conditions could end it before its end.
    ended: Option<String>,
    /// The name of its own.
    also: Option<String>,
}

/// The note of an impact about the conditions that could end it.
fn ended(reports: &[Report]) -> Option<String> {
    let impact = reports.iter().find(|report| report.stage == "impact")?;
    let mut notes = impact.stamp.notes.iter();
    notes.find(|note| note.contains(stop::CONDITIONS)).cloned()
}

fn figures(scene: &Scene, reports: &[Report]) -> Result<Option<Figures>> {
    let post = reports.iter().find(|report| report.stage == "post");
    let measures = post.map(|report| answer::measures(&report.folder, &report.stamp));
    Ok(measures
        .transpose()?
        .map(|measures| Figures::new(scene, measures)))
}

/// Starts the threads of the run and returns their number.
fn start_threads(arguments: &RunArguments) -> Result<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = arguments.threads.map_or(cores, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global().context("cannot start the threads")?;
    Ok(threads)
}

/// What the run came to, where the results are and how to look at them.
fn finish(store: &Store, name: &str, reports: &[Report], told: &Told, json: bool) {
    let find = |stage: &str, file: &str| {
        let report = reports.iter().find(|report| report.stage == stage)?;
        let mut outputs = report.stamp.outputs.iter();
        outputs
            .find(|output| output.file == file)
            .map(|_| report.folder.join(file))
    };
    let warnings = answer::warnings(reports, told.figures.as_ref());
    if json {
        let text = |stage: &str, file: &str| {
            let path = find(stage, file)?;
            Some(path.to_string_lossy().into_owned())
        };
        let object = json!({
            "summary": name,
            "artifacts": store.root().to_string_lossy(),
            "latest": latest::folder(store, name).to_string_lossy(),
            "name": told.also.as_deref().unwrap_or(name),
            "report": text("post", post::REPORT),
            "measures": text("post", post::MEASURES),
            "frames": text("impact", journal::FRAMES),
            "layout": text("impact", impact::LAYOUT),
            "state": text("impact", impact::STATE),
            "figures": told.figures.as_ref().map(answer::json),
            "warnings": warnings,
            "ended": told.ended,
            "missing": told.rest.as_ref().map(|rest| &rest.missing),
            "continue": told.rest.as_ref().map(|rest| &rest.command),
        });
        return out!("{object}");
    }
    if let Some(text) = &told.ended {
        out!("ended    {text}");
    }
    if let Some(figures) = &told.figures {
        out!("Figures");
        answer::lines(figures)
            .iter()
            .for_each(|line| out!("  {line}"));
    }
    // A relaxation that ran has told its own.
    let told_before = |warning: &&String| {
        let mut ran = reports
            .iter()
            .filter(|report| report.status != Status::Fresh);
        ran.any(|report| report.stage == "relax" && warning.starts_with(&report.label()))
    };
    let warnings = warnings.iter().filter(|warning| !told_before(warning));
    warnings.for_each(|warning| note!("warning: {warning}"));
    places(store, name, find);
    if let Some(name) = &told.also {
        out!("name     {name}");
    }
    if let Some(rest) = &told.rest {
        rest.print();
    }
}

/// Places of the results. Names are for users; scripts get the folders, whose content never
/// changes.
fn places(store: &Store, name: &str, find: impl Fn(&str, &str) -> Option<PathBuf>) {
    let latest = latest::folder(store, name);
    out!("latest   {}", latest.display());
    let named = |stage: &str, file: &str| {
        let path = find(stage, file)?;
        let name = latest.join(stage).join(file);
        let same = name.canonicalize().ok() == path.canonicalize().ok();
        Some(if same { name } else { path })
    };
    if let Some(path) = named("post", post::REPORT) {
        out!("report   {}", path.display());
    }
    let log = named("impact", journal::FRAMES);
    if let (Some(log), Some(layout)) = (log, named("impact", impact::LAYOUT)) {
        out!("frames   {}", log.display());
        out!("layout   {}", layout.display());
        out!(
            "look     open the frames in Foxglove or Lichtblick and import the layout there, \
             or `rerun <frames>`"
        );
    }
}
