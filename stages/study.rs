//! `coronet study`: a table of runs over one store, and what accuracy costs in time.
//!
//! The points are the product of the axes. Each is an ordinary run, so finished points are never
//! computed again, a killed study goes on, and packed and relaxed bodies are shared.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context as _, Result};
use coronet::measure::gauge::contact_time;
use coronet::measure::series::{Series, compare_column};
use coronet::measure::tradeoff::{front, growth};
use coronet::pipeline::{Store, latest};
use coronet::record::atomic::write_file;
use coronet::scene::file;
use coronet::scene::numbers::count;
use coronet::scene::quantity::{Unit, parse};
use serde::Deserialize;
use serde_json::json;

use crate::arguments::StudyArguments;
use crate::fault::Usage;
use crate::finding::{figure, groups, samples, sentence, table};
use crate::trial::{Outcome, Trial};
use crate::watch::duration;

/// The table, one row a point.
const TABLE: &str = "study.csv";
const FIGURE: &str = "error-against-time.svg";

/// A study file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    pub title: String,
    /// From the study file.
    pipeline: PathBuf,
    /// For every point, as after `--set`.
    #[serde(default)]
    set: Vec<String>,
    pub axis: Vec<Axis>,
    pub error: Target,
}

/// Either `key` with `values`, or `points`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    pub name: String,
    key: Option<String>,
    #[serde(default)]
    values: Vec<toml::Value>,
    #[serde(default)]
    points: Vec<Choice>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    label: String,
    #[serde(default)]
    set: Vec<String>,
}

/// What the error is measured against: exactly one of `value`, `reference` and `finest`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    pub column: String,
    /// An exact value, SI; against the largest value of the column.
    value: Option<f64>,
    /// A table with the column, from the study file.
    reference: Option<PathBuf>,
    /// The point with the smallest spacing.
    #[serde(default)]
    finest: bool,
    from: Option<String>,
    to: Option<String>,
}

pub fn study(arguments: &StudyArguments) -> Result<()> {
    let (study, trials) = load(&arguments.study)?;
    let window = study.error.window()?;
    let outcomes = run(&trials, arguments)?;
    let folder = arguments.study.parent().unwrap_or(Path::new("."));
    let errors = study.error.measure(&trials, &outcomes, folder, window)?;
    let samples = samples(&trials, &outcomes, &errors);
    let on_front = front(&samples);
    let stem = arguments.study.file_stem().unwrap_or_default();
    let store = Store::new(&arguments.store.artifacts);
    let out = latest::folder(&store, &stem.to_string_lossy());
    fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
    let table = table(&study, &trials, &outcomes, &samples, &on_front)?;
    write_file(&out.join(TABLE), &table)?;
    let figure = figure(&study, &trials, &samples, &on_front).svg()?;
    if let Some(figure) = &figure {
        write_file(&out.join(FIGURE), figure.as_bytes())?;
    }
    let groups = groups(&trials);
    if arguments.store.json {
        let rows: Vec<_> = groups
            .iter()
            .enumerate()
            .map(|(g, name)| {
                let growth = growth(&samples, g);
                json!({ "group": name, "order": growth.order, "work": growth.work,
                    "halving": growth.halving })
            })
            .collect();
        println!(
            "{}",
            json!({ "table": out.join(TABLE), "groups": rows,
                               "figure": figure.map(|_| out.join(FIGURE)) })
        );
        return Ok(());
    }
    for (g, name) in groups.iter().enumerate() {
        if let Some(sentence) = sentence(name, &samples, g) {
            println!("{sentence}");
        }
    }
    println!("table    {}", out.join(TABLE).display());
    if figure.is_some() {
        println!("figure   {}", out.join(FIGURE).display());
    }
    Ok(())
}

/// The study and its points, each checked against the format of scenes before anything runs.
fn load(path: &Path) -> Result<(Study, Vec<Trial>)> {
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let wrong = |what: String| Usage(format!("{}: {what}", path.display()));
    let study: Study = toml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    study
        .error
        .check()
        .map_err(|what| wrong(what.to_string()))?;
    let mut points = vec![(Vec::new(), study.set.clone())];
    for axis in &study.axis {
        let choices = axis.choices().map_err(wrong)?;
        let extend = |(labels, sets): &(Vec<String>, Vec<String>)| {
            let (labels, sets) = (labels.clone(), sets.clone());
            choices
                .clone()
                .into_iter()
                .map(move |choice| {
                    let mut point = (labels.clone(), sets.clone());
                    point.0.push(choice.label);
                    point.1.extend(choice.set);
                    point
                })
                .collect::<Vec<_>>()
        };
        points = points.iter().flat_map(extend).collect();
    }
    let pipeline = path
        .parent()
        .unwrap_or(Path::new("."))
        .join(&study.pipeline);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let trials: Result<Vec<Trial>> = points
        .into_iter()
        .enumerate()
        .map(|(k, (labels, sets))| {
            let scene = file::load(&pipeline, &sets)
                .with_context(|| format!("{}, point {}", path.display(), labels.join(", ")))?
                .scene;
            let particles = (0..scene.bodies.len()).map(|body| count(&scene, body) as f64);
            Ok(Trial {
                name: format!("{stem}-{:02}", k + 1),
                pipeline: pipeline.clone(),
                spacing: scene.pack.spacing,
                count: particles.sum(),
                labels,
                sets,
            })
        })
        .collect();
    Ok((study, trials?))
}

impl Axis {
    fn choices(&self) -> Result<Vec<Choice>, String> {
        let name = &self.name;
        match (&self.key, self.values.is_empty(), self.points.is_empty()) {
            (Some(key), false, true) => Ok(self
                .values
                .iter()
                .map(|value| {
                    let text = value.as_str().map_or(value.to_string(), str::to_string);
                    let set = vec![format!("{key}={text}")];
                    Choice { label: text, set }
                })
                .collect()),
            (None, true, false) => Ok(self.points.clone()),
            _ => Err(format!(
                "axis {name} needs either key and values, or points"
            )),
        }
    }
}

impl Target {
    fn check(&self) -> Result<(), &'static str> {
        let given = [self.value.is_some(), self.reference.is_some(), self.finest];
        match given.iter().filter(|given| **given).count() {
            1 => Ok(()),
            _ => Err("[error] needs exactly one of value, reference and finest = true"),
        }
    }

    fn window(&self) -> Result<[f64; 2], Usage> {
        let time = |text: &Option<String>, otherwise: f64| match text {
            None => Ok(otherwise),
            Some(text) => {
                parse(text, Unit::Time).map_err(|error| Usage(format!("[error]: `{text}` {error}")))
            }
        };
        Ok([
            time(&self.from, f64::NEG_INFINITY)?,
            time(&self.to, f64::INFINITY)?,
        ])
    }

    /// Relative error of each point; `NaN` where there is none.
    fn measure(
        &self,
        trials: &[Trial],
        outcomes: &[Outcome],
        folder: &Path,
        [from, to]: [f64; 2],
    ) -> Result<Vec<f64>> {
        let column = &self.column;
        let known = |k: usize| match &outcomes[k] {
            Outcome::Done { measures, .. } => Some(measures),
            Outcome::Failed { .. } => None,
        };
        if let Some(value) = self.value {
            return Ok((0..trials.len())
                .map(|k| {
                    let most = known(k).and_then(|m| m.window(from, to).maximum(column));
                    most.map_or(f64::NAN, |(found, _)| (found / value - 1.0).abs())
                })
                .collect());
        }
        let finest = (0..trials.len())
            .filter(|k| known(*k).is_some())
            .min_by(|a, b| trials[*a].spacing.total_cmp(&trials[*b].spacing));
        let table = match &self.reference {
            Some(path) => Series::read(&folder.join(path))?,
            None => finest.and_then(known).cloned().unwrap_or_default(),
        };
        let table = table.window(from, to);
        (0..trials.len())
            .map(|k| {
                let Some(measures) = known(k).filter(|_| !self.finest || Some(k) != finest) else {
                    return Ok(f64::NAN);
                };
                let shift = match self.finest {
                    true => 0.0,
                    false => contact_time(&file::load(&trials[k].pipeline, &trials[k].sets)?.scene),
                };
                let norm = compare_column(measures, &table, "", column, shift);
                Ok(norm.map_or(f64::NAN, |norm| norm.l2))
            })
            .collect()
    }
}

/// Runs all points, `jobs` at a time; says what became of each.
fn run(trials: &[Trial], arguments: &StudyArguments) -> Result<Vec<Outcome>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = usize::from(arguments.jobs).min(trials.len().max(1));
    let threads = (cores / jobs).max(1);
    let (next, ended) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let slots: Vec<_> = trials.iter().map(|_| Mutex::new(None)).collect();
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(trial) = trials.get(k) else { break };
                    let outcome = trial.run(&arguments.store.artifacts, threads);
                    let done = ended.fetch_add(1, Ordering::Relaxed) + 1;
                    eprintln!(
                        "{done}/{}  {}  {}",
                        trials.len(),
                        trial.labels.join(", "),
                        told(&outcome)
                    );
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
    let mut all = Vec::new();
    for outcome in outcomes.flatten() {
        all.push(outcome?);
    }
    Ok(all)
}

fn told(outcome: &Result<Outcome>) -> String {
    match outcome {
        Ok(Outcome::Done {
            cpu_seconds, fresh, ..
        }) => {
            let word = if *fresh { "fresh" } else { "ran" };
            format!("{word}, {} of CPU", duration(*cpu_seconds))
        }
        Ok(Outcome::Failed { why, .. }) => format!("failed: {why}"),
        Err(error) => format!("{error:#}"),
    }
}
