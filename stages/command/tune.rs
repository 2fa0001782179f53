//! `coronet tune`: from a study, the cheapest settings that meet an error.
//!
//! Missing points of the study are run first. Between two spacings of a group, error and time are
//! powers of the spacing; `--check` runs the chosen settings, and if they miss the error, chooses
//! again with one more point, so that the final settings have been measured to meet the error.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use anyhow::{Result, anyhow, bail};
use coronet::measure::tradeoff::{Choice, Sample, meeting, predict, worst};
use coronet::scene::file;
use coronet::scene::quantity::{Unit, legible, rounded};
use coronet::scene::{Scene, Side};
use serde_json::json;

use crate::arguments::TuneArguments;
use crate::command::init;
use crate::command::study::{STOPPING, run};
use crate::fault::Usage;
use crate::print::{out, quoted};
use crate::signals;
use crate::study::columns;
use crate::study::cost::Cost;
use crate::study::finding::{groups, named, samples};
use crate::study::points::load;
use crate::study::target::{Found, Target};
use crate::study::trial::{Outcome, Place, Trial};

const SPACING: &str = "pack.spacing=";

/// Settings with their expected error and cost.
struct Tuned {
    trial: Trial,
    /// Relative error and cost.
    error: f64,
    cost: f64,
    group: String,
}

pub fn tune(arguments: &TuneArguments) -> Result<()> {
    let wanted = part(&arguments.error)?;
    let (study, trials) = load(&arguments.study)?;
    let Some(target) = &study.error else {
        let path = arguments.study.display();
        return Err(Usage(format!(
            "{path}: has no [error]; tune needs a study of errors"
        ))
        .into());
    };
    columns::check(&study, &trials, &arguments.study)?;
    if let Some(path) = &arguments.output {
        init::check_new(path)?;
    }
    let stop = signals::stop_flag(STOPPING)?;
    let outcomes = run(&trials, &[], place(arguments), arguments.jobs, &stop)?;
    let cost = study.cost;
    let mut points = Points {
        cost,
        trials,
        outcomes,
    };
    let mut misses = Vec::new();
    let (tuned, checked) = loop {
        let tuned = cheapest(&points, target, arguments, wanted, misses.len() < TRIES)?;
        if !arguments.check {
            break (tuned, None);
        }
        let (error, cost) = check(&tuned, &mut points, target, arguments, &stop)?;
        if error <= wanted {
            break (tuned, Some((error, cost)));
        }
        misses.push((tuned.trial.spacing, error));
    };
    if let Some(path) = &arguments.output {
        let loaded = file::load(&tuned.trial.pipeline, &tuned.trial.sets)?;
        init::write(path, &loaded.text)?;
    }
    tell(&tuned, (target, cost), checked, &misses, arguments);
    Ok(())
}

fn place(arguments: &TuneArguments) -> Place<'_> {
    Place {
        artifacts: &arguments.store.artifacts,
        remote: arguments.remote.url(),
    }
}

/// Number of wrong predictions after which a measured point is taken instead.
const TRIES: usize = 3;

/// The points of the study, and the settings that were checked.
struct Points {
    cost: Cost,
    trials: Vec<Trial>,
    outcomes: Vec<Outcome>,
}

impl Points {
    fn errors(&self, target: &Target, arguments: &TuneArguments) -> Result<Vec<f64>> {
        let folder = arguments.study.parent().unwrap_or(Path::new("."));
        let found = target.measure(&self.trials, &self.outcomes, folder, target.window()?)?;
        let points = found.into_iter().zip(&self.outcomes);
        // A run that failed is worse than any other: no finer spacing may count without it.
        let error = |(found, outcome): (Found, &Outcome)| match outcome {
            Outcome::Failed { .. } => f64::INFINITY,
            Outcome::Done { .. } => found.error,
        };
        Ok(points.map(error).collect())
    }
}

/// The cheapest settings that meet the error: between two points, or at one that was run.
fn cheapest(
    points: &Points,
    target: &Target,
    arguments: &TuneArguments,
    wanted: f64,
    between: bool,
) -> Result<Tuned> {
    let errors = points.errors(target, arguments)?;
    let samples = samples(points.cost, &points.trials, &points.outcomes, &errors);
    // Repeats meet the error if all of them do.
    let worst = worst(&samples);
    let some: Vec<Sample> = worst.iter().map(|k| samples[*k]).collect();
    let mut choices = meeting(&some, wanted);
    for choice in &mut choices {
        choice.sample = worst[choice.sample];
        choice.coarser = choice.coarser.map(|k| worst[k]);
    }
    if !between {
        choices.iter_mut().for_each(|choice| {
            choice.coarser = None;
            choice.spacing = samples[choice.sample].spacing;
        });
    }
    let tuned = choices
        .iter()
        .map(|choice| settle(&points.trials, &samples, choice))
        .collect::<Result<Vec<Tuned>>>()?;
    let cheapest = tuned.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    cheapest.ok_or_else(|| anyhow!(miss(&points.trials, &samples, target, wanted)))
}

/// `5 %` or `0.05`.
fn part(text: &str) -> Result<f64, Usage> {
    let (number, factor) = match text.trim().strip_suffix('%') {
        Some(number) => (number.trim(), 0.01),
        None => (text.trim(), 1.0),
    };
    let value = number.parse().map(|value: f64| factor * value);
    value.ok().filter(|v| *v > 0.0 && *v <= 1.0).ok_or_else(|| {
        Usage(format!(
            "--error `{text}` is no part of a whole; give more than 0 and at most 1, \
                 such as \"5 %\" or 0.05"
        ))
    })
}

fn percent(part: f64) -> String {
    format!("{:.2} %", 100.0 * part)
}

/// The largest spacing up to that of the choice that is possible, with its expected error and cost.
fn settle(trials: &[Trial], samples: &[Sample], choice: &Choice) -> Result<Tuned> {
    let base = &trials[choice.sample];
    let scene = file::load(&base.pipeline, &base.sets)?.scene;
    let own = base.sets.iter().any(|set| set.starts_with(SPACING));
    let finest = samples[choice.sample].spacing;
    let suits = |spacing: f64| {
        let sets = with_spacing(&base.sets, spacing);
        file::load(&base.pipeline, &sets).is_ok()
    };
    let wanted = if own { choice.spacing } else { finest };
    let found = candidates(&scene, wanted, finest)
        .into_iter()
        .find(|s| suits(*s));
    let (spacing, sets) = match found {
        Some(spacing) => (spacing, with_spacing(&base.sets, spacing)),
        None => (finest, base.sets.clone()),
    };
    let (error, cost) = predict(samples, choice, spacing);
    let stem = base.name.rsplit_once('-').map_or("study", |(stem, _)| stem);
    let trial = Trial {
        name: format!("{stem}-tuned"),
        title: "tuned".to_string(),
        pipeline: base.pipeline.clone(),
        source: base.source.clone(),
        sets,
        case: None,
        labels: base.labels.clone(),
        repeats: base.repeats.clone(),
        method: base.method,
        spacing,
        count: base.count * (finest / spacing).powi(scene.dimension.count() as i32),
    };
    let group = groups(trials).swap_remove(samples[choice.sample].group);
    Ok(Tuned {
        trial,
        error,
        cost,
        group,
    })
}

fn with_spacing(sets: &[String], spacing: f64) -> Vec<String> {
    let text = legible(spacing, Unit::Length);
    let replace = |set: &String| match set.starts_with(SPACING) {
        true => format!("{SPACING}{text}"),
        false => set.clone(),
    };
    sets.iter().map(replace).collect()
}

/// Spacings between `finest` (itself left out) and `wanted`, the largest first: those that divide
/// the first periodic side, else `wanted` to three digits.
fn candidates(scene: &Scene, wanted: f64, finest: f64) -> Vec<f64> {
    let axes = scene.dimension.axes().iter();
    let mut periodic = axes.filter(|axis| scene.domain.boundary[**axis][0] == Side::Periodic);
    match periodic.next() {
        Some(axis) => {
            let side = scene.domain.size[*axis];
            let range = (side / wanted - 1e-9).ceil() as u64..=(side / finest) as u64;
            let all = range.map(|count| side / count as f64);
            all.filter(|spacing| *spacing > finest * (1.0 + 1e-9))
                .collect()
        }
        None => {
            let unit = 10f64.powf(wanted.log10().floor() - 2.0);
            let spacing = rounded((wanted / unit * (1.0 + 1e-9)).floor() * unit);
            Vec::from_iter((spacing > finest).then_some(spacing))
        }
    }
}

/// Runs the settings and adds them to the points: error and cost.
fn check(
    tuned: &Tuned,
    points: &mut Points,
    target: &Target,
    arguments: &TuneArguments,
    stop: &AtomicBool,
) -> Result<(f64, f64)> {
    let trial = tuned.trial.clone();
    let mut own = run(std::slice::from_ref(&trial), &[], place(arguments), 1, stop)?;
    if let Outcome::Failed { why, .. } = &own[0] {
        bail!("the chosen settings fail: {why}");
    }
    let cost = points.cost.of(&own[0]);
    points.trials.push(trial);
    points.outcomes.append(&mut own);
    let errors = points.errors(target, arguments)?;
    Ok((errors[errors.len() - 1], cost))
}

/// `misses`: spacings that did not meet the error as predicted, with their errors.
fn tell(
    tuned: &Tuned,
    (target, cost): (&Target, Cost),
    checked: Option<(f64, f64)>,
    misses: &[(f64, f64)],
    arguments: &TuneArguments,
) {
    let trial = &tuned.trial;
    let sets = trial
        .sets
        .iter()
        .map(|set| format!(" --set {}", quoted(set)));
    let path = quoted(&trial.pipeline.to_string_lossy());
    let command = format!("coronet run {path}{}", sets.collect::<String>());
    if arguments.store.json {
        let object = json!({
            "column": target.column, "group": tuned.group, "spacing_m": trial.spacing,
            "pipeline": trial.pipeline.to_string_lossy(), "set": trial.sets, "command": command,
            "error": tuned.error, "cost": tuned.cost, "cost_in": cost.unit(),
            "file": arguments.output.as_ref().map(|path| path.to_string_lossy()),
            "checked": checked.map(|(error, cost)| json!({"error": error, "cost": cost})),
            "missed": misses.iter().map(|(spacing, error)| {
                json!({"spacing_m": spacing, "error": error})
            }).collect::<Vec<_>>(),
        });
        out!("{object}");
        return;
    }
    for (spacing, error) in misses {
        let spacing = legible(*spacing, Unit::Length);
        out!("missed   s0 = {spacing}: error {}", percent(*error));
    }
    out!(
        "cheapest {}, s0 = {}: error of {} {}, {}",
        named(&tuned.group),
        legible(trial.spacing, Unit::Length),
        target.column,
        percent(tuned.error),
        cost.long(tuned.cost)
    );
    out!("{command}");
    if let Some(path) = &arguments.output {
        out!("file     {}", path.display());
    }
    if let Some((error, found)) = checked {
        out!("checked  error {}, {}", percent(error), cost.long(found));
    }
}

/// What to do when nothing meets the error.
fn miss(trials: &[Trial], samples: &[Sample], target: &Target, wanted: f64) -> String {
    let known = samples
        .iter()
        .zip(trials)
        .filter(|(s, _)| s.error.is_finite());
    let best = known.min_by(|a, b| a.0.error.total_cmp(&b.0.error));
    let best = best.map_or("no point has a known error".to_string(), |(s, trial)| {
        let error = percent(s.error);
        format!("the best point, {}, has {error}", trial.labels.join(", "))
    });
    format!(
        "no settings of the study have an error of {} in {} at a spacing and at all finer ones: \
         {best}; add finer points, or allow more with --error",
        percent(wanted),
        target.column
    )
}
