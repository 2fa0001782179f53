//! `coronet study`: a table of runs over one store: the cost of accuracy, figures of each run, or
//! the promises that hard cases keep.
//!
//! The points are the product of the axes, for each case. Each is an ordinary run, so finished
//! points are never computed again, a killed study continues, and points share packed and relaxed
//! bodies.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::{Result, bail};
use coronet::measure::tradeoff::growth;
use coronet::pipeline::lock::Lock;
use coronet::pipeline::name::is_plain_name;
use coronet::pipeline::{Store, latest};
use coronet::record::atomic::{create_folder, write_file};
use coronet::scene::FigureStyle;
use serde_json::json;

use crate::arguments::{On, StudyArguments};
use crate::batch;
use crate::fault::{self, Failed, Stopped, Usage};
use crate::print::{note, out};
use crate::signals;
use crate::study::copies::Figures;
use crate::study::finding::{comparison, figure, groups, on_front, samples, sentence, table};
use crate::study::points::{Study, load};
use crate::study::promise::Verdict;
use crate::study::target::Target;
use crate::study::trial::{Outcome, Place, Trial};
use crate::study::{columns, copies, doubt, figures, finding, verdict};
use crate::watch::duration;

/// The table, one row for each point.
const TABLE: &str = "study.csv";
const FIGURE: &str = "error-against-time";
/// Results against theory, where theory differs between points.
const COMPARISON: &str = "found-against-theory";
/// The table as a page.
const COSTS: &str = "study.md";
/// The table of figures, one row for each point, and the table as a page.
const FIGURES: &str = "figures.csv";
const READ: &str = "figures.md";
/// The table of promises, one row for each, and its summary page.
const PROMISES: &str = "promises.csv";
const PAGE: &str = "promises.md";

/// Answer to a first signal.
pub const STOPPING: &str = "stopping all points after their next checkpoint";

pub fn study(arguments: &StudyArguments) -> Result<()> {
    let (study, trials) = load(&arguments.study)?;
    let out = folder(&arguments.study, &arguments.store.artifacts)?;
    if let Some(number) = arguments.batch.point {
        return batch::point::run(&trials, number, arguments, &out);
    }
    // Points under way can be looked at and stopped, whatever the file asks for by now.
    if !arguments.batch.look && !arguments.batch.cancel {
        columns::check(&study, &trials, &arguments.study)?;
    }
    batch::record::claim(&out, &arguments.study, false)?;
    if let (On::Local, Some(option)) = (arguments.batch.on, arguments.batch.of_jobs()) {
        bail!(Usage(format!("{option} needs --on slurm or --on hq")));
    }
    if let Some(folder) = &arguments.into {
        create_folder(folder)?;
        copies::check(folder, &arguments.study)?;
    }
    if !arguments.batch.look && !arguments.batch.cancel {
        Store::new(&arguments.store.artifacts).create(&out)?;
        batch::record::claim(&out, &arguments.study, true)?;
    }
    let failed = match arguments.batch.on {
        On::Local if !arguments.batch.look => Vec::new(),
        _ => match batch::collect(&trials, arguments, &out)? {
            Some(failed) => failed,
            None => return Ok(()),
        },
    };
    let outcomes = || run_rest(&study, &trials, failed, arguments);
    match &study.error {
        Some(target) => tell_costs((&study, target), &trials, outcomes, arguments, &out),
        None if study.case.is_empty() => {
            tell_figures(&study, &trials, &outcomes()?, arguments, &out)
        }
        None => tell_promises(&study, &trials, &outcomes()?, arguments, &out),
    }
}

/// Prefix of the names of a study's results.
fn folder(path: &Path, artifacts: &Path) -> Result<PathBuf> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if !is_plain_name(&stem) {
        let path = path.display();
        bail!(Usage(format!(
            "{path}: {stem:?} cannot be a name of results; rename the file"
        )));
    }
    Ok(latest::folder(&Store::new(artifacts), &stem))
}

/// Makes the folder of a study's results, without what it had of another form than `own`; no
/// clean-up begins while it is written.
fn make(out: &Path, arguments: &StudyArguments, own: [&str; 2]) -> Result<Option<Lock>> {
    let store = Store::new(&arguments.store.artifacts);
    let shared = store.share(&mut |_| true)?;
    store.create(out)?;
    let all = [TABLE, COSTS, FIGURES, READ, PROMISES, PAGE];
    copies::remove(out, all.iter().filter(|name| !own.contains(name)))?;
    Ok(shared)
}

fn tell_costs(
    (study, target): (&Study, &Target),
    trials: &[Trial],
    outcomes: impl FnOnce() -> Result<Vec<Outcome>>,
    arguments: &StudyArguments,
    out: &Path,
) -> Result<()> {
    let window = target.window()?;
    let outcomes = outcomes()?;
    let folder = arguments.study.parent().unwrap_or(Path::new("."));
    let found = target.measure(trials, &outcomes, folder, window)?;
    let errors: Vec<f64> = found.iter().map(|f| f.error).collect();
    let samples = samples(study.cost, trials, &outcomes, &errors);
    let on_front = on_front(&samples);
    let _shared = make(out, arguments, [TABLE, COSTS])?;
    let table = table(study, trials, &outcomes, &samples, &on_front)?;
    copies::write_table(&out.join(TABLE), &table, arguments, &outcomes)?;
    let page = finding::page(study, target, trials, &outcomes, &samples);
    let page = page + &doubt::section(trials, &outcomes);
    write_file(&out.join(COSTS), page.as_bytes())?;
    let style = FigureStyle::default();
    let figure = figure(study, target, trials, &samples, &on_front).sheet(&style)?;
    let mut figures = Figures::new(out, arguments);
    if let Some(figure) = &figure {
        figures.write(figure, FIGURE, !target.varies())?;
    }
    doubt::warn_unknown(target, &outcomes, &errors);
    let plot = target
        .varies()
        .then(|| comparison(study, target, trials, &found));
    if let Some(plot) = plot.filter(|plot| plot.has_points()) {
        figures.write(&plot.sheet(&style)?, COMPARISON, true)?;
    }
    figures.finish()?;
    let groups = groups(trials);
    if arguments.store.json {
        let row = |(g, name): (usize, &String)| {
            let growth = growth(&samples, g);
            json!({ "group": name, "order": growth.order, "work": growth.work,
                    "halving": growth.halving })
        };
        let rows: Vec<_> = groups.iter().enumerate().map(row).collect();
        let figure = figure.map(|_| text(&svg(out, FIGURE)));
        out!(
            "{}",
            json!({ "table": text(&out.join(TABLE)), "groups": rows, "figure": figure,
                    "failed": doubt::objects(trials, &outcomes) })
        );
        return some_ended(&outcomes);
    }
    for (g, name) in groups.iter().enumerate() {
        if let Some(sentence) = sentence(study.cost, name, &samples, g) {
            out!("{sentence}");
        }
    }
    out!("table    {}", out.join(TABLE).display());
    if figure.is_some() {
        out!("figure   {}", svg(out, FIGURE).display());
    }
    some_ended(&outcomes)
}

/// An error if no point ended well.
fn some_ended(outcomes: &[Outcome]) -> Result<()> {
    let failed = outcomes.iter().map(|outcome| match outcome {
        Outcome::Failed { why, code, .. } => Some((why, *code)),
        Outcome::Done { .. } => None,
    });
    let all: Option<Vec<_>> = failed.collect();
    let Some((why, code)) = all.and_then(|mut all| all.pop()) else {
        return Ok(());
    };
    let text = format!("every point failed, the last one: {why}");
    let code = if code < fault::KILLED {
        code
    } else {
        fault::FAILED
    };
    bail!(Failed(text, code))
}

fn tell_figures(
    study: &Study,
    trials: &[Trial],
    outcomes: &[Outcome],
    arguments: &StudyArguments,
    out: &Path,
) -> Result<()> {
    let folder = arguments.study.parent().unwrap_or(Path::new("."));
    let measured = figures::from_contact(trials, outcomes)?;
    let found = figures::measure(study, &measured, folder)?;
    let drawn = figures::plots(study, trials, &measured, folder)?;
    let _shared = make(out, arguments, [FIGURES, READ])?;
    let (table, read) = (out.join(FIGURES), out.join(READ));
    let rows = figures::table(study, trials, outcomes, &found)?;
    copies::write_table(&table, &rows, arguments, outcomes)?;
    let page = figures::page(study, trials, outcomes, &found);
    let whole = page.clone() + &doubt::section(trials, outcomes);
    write_file(&read, whole.as_bytes())?;
    let (mut figures, mut plots) = (Figures::new(out, arguments), Vec::new());
    for plot in drawn {
        if plot.has_points() {
            let mut names = (1..).map(|number| match number {
                1 => plot.file_name(),
                _ => format!("{}-{number}", plot.file_name()),
            });
            let is_new = |name: &String| !plots.contains(&svg(out, name));
            let name = names.find(is_new).expect("numbers without end");
            figures.write(&plot.sheet(&FigureStyle::default())?, &name, false)?;
            plots.push(svg(out, &name));
        }
    }
    figures.finish()?;
    if arguments.store.json {
        let plots: Vec<String> = plots.iter().map(|plot| text(plot)).collect();
        out!(
            "{}",
            json!({ "table": text(&table), "page": text(&read), "points": trials.len(),
                    "failed": doubt::objects(trials, outcomes), "plots": plots })
        );
        return some_ended(outcomes);
    }
    out!("{}", page.trim_end());
    out!("table    {}", table.display());
    out!("page     {}", read.display());
    for plot in plots {
        out!("plot     {}", plot.display());
    }
    some_ended(outcomes)
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

/// Path of the figure of that name.
fn svg(out: &Path, name: &str) -> PathBuf {
    out.join(format!("{name}.svg"))
}

/// Fails if a promise is broken that is not a known failure, or a known failure is kept.
fn tell_promises(
    study: &Study,
    trials: &[Trial],
    outcomes: &[Outcome],
    arguments: &StudyArguments,
    out: &Path,
) -> Result<()> {
    let judge = |(trial, outcome): (&Trial, &Outcome)| {
        let case = trial.case.expect("a study of cases");
        study.case[case].judge(trial, outcome)
    };
    let points = trials.iter().zip(outcomes);
    let verdicts = points.map(judge).collect::<Result<Vec<Verdict>>>()?;
    let _shared = make(out, arguments, [PROMISES, PAGE])?;
    let rows = verdict::table(study, trials, &verdicts)?;
    copies::write_table(&out.join(PROMISES), &rows, arguments, outcomes)?;
    let page = verdict::page(study, trials, outcomes, &verdicts);
    write_file(&out.join(PAGE), page.as_bytes())?;
    let count = |word: &str| verdicts.iter().filter(|v| v.word() == word).count();
    let (kept, known) = (count("kept"), count("known"));
    if arguments.store.json {
        out!(
            "{}",
            json!({ "table": text(&out.join(PROMISES)), "page": text(&out.join(PAGE)),
                    "points": trials.len(),
                    "kept": kept, "known": known })
        );
    } else {
        for line in verdict::broken(trials, &verdicts) {
            out!("{line}");
        }
        out!("{kept} of {} points keep all promises", trials.len());
        if known > 0 {
            out!("{known} do not, as the study states");
        }
        out!("table    {}", out.join(PROMISES).display());
        out!("page     {}", out.join(PAGE).display());
    }
    let surprises = verdicts.iter().filter(|v| !v.as_told()).count();
    if surprises > 0 {
        bail!(
            "{surprises} of {} points do not end as {} states; see {}",
            trials.len(),
            arguments.study.display(),
            out.join(PAGE).display()
        );
    }
    Ok(())
}

/// Runs all points of a study but those that failed elsewhere.
fn run_rest(
    study: &Study,
    trials: &[Trial],
    mut failed: Vec<Option<Outcome>>,
    arguments: &StudyArguments,
) -> Result<Vec<Outcome>> {
    let stop = signals::stop_flag(STOPPING)?;
    failed.resize_with(trials.len(), || None);
    let pairs = trials.iter().zip(&failed);
    let rest = pairs.filter(|(_, failed)| failed.is_none());
    let rest: Vec<Trial> = rest.map(|(trial, _)| trial.clone()).collect();
    let jobs = arguments.jobs.unwrap_or(1);
    let mut needed: Vec<_> = study.columns().collect();
    needed.sort_unstable();
    needed.dedup();
    let mut ran = run(&rest, &needed, arguments.place(), jobs, &stop)?.into_iter();
    let all = failed
        .into_iter()
        .map(|failed| failed.or_else(|| ran.next()));
    let all: Vec<Outcome> = all.flatten().collect();
    doubt::tell(trials, &all);
    Ok(all)
}

/// Runs all points, `jobs` at a time; reports the result of each, and which of the columns `needed`
/// it lacks. Points that run when `stop` is set stop after a checkpoint.
pub fn run(
    trials: &[Trial],
    needed: &[&str],
    place: Place,
    jobs: u16,
    stop: &AtomicBool,
) -> Result<Vec<Outcome>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = usize::from(jobs).min(trials.len().max(1));
    let threads = (cores / jobs).max(1);
    let (next, ended) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let slots: Vec<_> = trials.iter().map(|_| Mutex::new(None)).collect();
    let is_stopped = || stop.load(Ordering::Relaxed);
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(trial) = trials.get(k).filter(|_| !is_stopped()) else {
                        break;
                    };
                    let outcome = trial.run(place, threads, stop);
                    let done = ended.fetch_add(1, Ordering::Relaxed) + 1;
                    note!(
                        "{done}/{}  {}  {}",
                        trials.len(),
                        trial.title,
                        told(&outcome)
                    );
                    trial.warn_of_missing(needed, &outcome);
                    if outcome.is_err() {
                        next.store(trials.len(), Ordering::Relaxed);
                    }
                    *slots[k].lock().expect("nobody panics") = Some(outcome);
                }
            });
        }
    });
    let outcomes = slots
        .into_iter()
        .map(|slot| slot.into_inner().expect("nobody panics"));
    let outcomes: Vec<_> = outcomes.flatten().collect();
    if is_stopped() {
        let done = outcomes.iter().filter(|outcome| outcome.is_ok()).count();
        let text = format!(
            "stopped on request with {done} of {} points done; the same command continues there",
            trials.len()
        );
        bail!(Stopped(text));
    }
    outcomes.into_iter().collect()
}

/// What became of a point, in a line.
pub fn told(outcome: &Result<Outcome>) -> String {
    match outcome {
        Ok(Outcome::Done {
            cpu_seconds, did, ..
        }) => {
            format!("{did}, {} of CPU", duration(*cpu_seconds))
        }
        Ok(Outcome::Failed { why, .. }) => format!("failed: {why}"),
        Err(error) => format!("{error:#}"),
    }
}
