//! Cases of a study and their promises: hard cases that must stay stable.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use coronet::measure::conservation::{ALWAYS, Conservation, FIGURES};
use coronet::measure::summary::digits;
use coronet::record::log::read_frames;
use coronet::scene::file;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::fault;
use crate::study::trial::{Outcome, Trial};

/// Columns of the table of promises, beside the point, the case and the axes.
pub const COLUMNS: [&str; 5] = ["promise", "bound", "found", "kept", "known"];

/// A named case; with axes, it runs at each of their points.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Case {
    pub name: String,
    /// Pipeline file, relative to the study file.
    pub pipeline: Option<PathBuf>,
    #[serde(default)]
    pub set: Vec<String>,
    /// Points of the axes at which the case runs; all if left out.
    only: Option<Vec<String>>,
    #[serde(default)]
    pub ends: Ending,
    /// Words of the message, unless it ends `done`.
    #[serde(default)]
    says: Vec<String>,
    /// Upper bounds of figures, besides those of every run.
    #[serde(default)]
    promise: BTreeMap<String, f64>,
    /// Why a point does not keep its promises: a known failure. If it keeps them, that is a
    /// failure, too.
    #[serde(default)]
    known: BTreeMap<String, String>,
}

/// How a case must end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Ending {
    /// At the end of its time.
    #[default]
    Done,
    /// Stopped as diverged, with the cause; frames and checkpoints are kept.
    Diverged,
    /// Rejected before the run, as a mistake in the scene.
    Refused,
}

/// One promise and its result.
pub struct Promise {
    pub name: String,
    pub bound: String,
    pub found: String,
    pub kept: bool,
}

/// The results of all promises of a point.
pub struct Verdict {
    pub promises: Vec<Promise>,
    /// Reason of a known failure.
    pub known: Option<String>,
}

impl Verdict {
    pub fn kept(&self) -> bool {
        self.promises.iter().all(|promise| promise.kept)
    }

    /// Whether the result is the expected one.
    pub fn as_told(&self) -> bool {
        self.kept() == self.known.is_none()
    }

    /// `kept`, `known` (a known failure), `BROKEN`, or `KEPT` (a known failure that is kept).
    pub fn word(&self) -> &'static str {
        match (self.kept(), self.known.is_some()) {
            (true, false) => "kept",
            (false, true) => "known",
            (false, false) => "BROKEN",
            (true, true) => "KEPT",
        }
    }

    /// The broken promises.
    pub fn broken(&self) -> String {
        let broken = self.promises.iter().filter(|promise| !promise.kept);
        let texts: Vec<String> = broken
            .map(|p| format!("{} {} (promised {})", p.name, p.found, p.bound))
            .collect();
        texts.join("; ")
    }
}

impl Case {
    pub fn covers(&self, label: &str) -> bool {
        let only = self.only.as_ref();
        only.is_none_or(|only| only.iter().any(|own| own == label))
    }

    /// `labels`: of the points of the axes.
    pub fn check(&self, labels: &[String], has_pipeline: bool) -> Result<(), String> {
        let wrong = |what: String| Err(format!("case `{}`: {what}", self.name));
        if self.pipeline.is_none() && !has_pipeline {
            return wrong("it needs `pipeline`, because the study has none".to_string());
        }
        if self.ends != Ending::Done && !self.promise.is_empty() {
            return wrong("promises of figures need a run that ends `done`".to_string());
        }
        for name in self.promise.keys() {
            if !FIGURES.iter().any(|(known, _)| known == name) {
                let known: Vec<&str> = FIGURES.iter().map(|(name, _)| *name).collect();
                return wrong(format!(
                    "`promise.{name}` is not known; known are {}",
                    known.join(", ")
                ));
            }
        }
        let named = self.only.iter().flatten().chain(self.known.keys());
        for label in named {
            if !labels.contains(label) {
                return wrong(format!(
                    "`{label}` is not a point; points are {}",
                    labels.join("; ")
                ));
            }
        }
        Ok(())
    }

    /// Compares the result of a point with its promises.
    ///
    /// # Errors
    /// If the frames of a finished point cannot be read.
    pub fn judge(&self, trial: &Trial, outcome: &Outcome) -> Result<Verdict> {
        let mut promises = vec![self.ending(outcome)];
        if let (Ending::Done, Outcome::Done { .. }) = (self.ends, outcome) {
            promises.extend(self.bounds(trial, outcome)?);
        }
        Ok(Verdict {
            promises,
            known: self.known.get(&trial.labels.join(", ")).cloned(),
        })
    }

    fn ending(&self, outcome: &Outcome) -> Promise {
        let (found, matches) = match outcome {
            Outcome::Done { .. } => ("done".to_string(), self.ends == Ending::Done),
            Outcome::Failed { why, code, work } => {
                let kept = work.as_ref().is_some_and(|folder| folder.is_dir());
                let told = self.says.iter().all(|word| why.contains(word));
                let matches = match *code {
                    fault::USAGE => self.ends == Ending::Refused && told,
                    fault::DIVERGED => self.ends == Ending::Diverged && told && kept,
                    _ => false,
                };
                (why.clone(), matches)
            }
        };
        let mut bound = format!("{:?}", self.ends).to_lowercase();
        if !self.says.is_empty() {
            bound = format!("{bound}: \"{}\"", self.says.join("\", \""));
        }
        Promise {
            name: "ends".to_string(),
            bound,
            found,
            kept: matches,
        }
    }

    fn bounds(&self, trial: &Trial, outcome: &Outcome) -> Result<Vec<Promise>> {
        let Outcome::Done {
            measures, frames, ..
        } = outcome
        else {
            return Ok(Vec::new());
        };
        let scene = file::load(&trial.pipeline, &trial.sets)?.scene;
        let mut conservation = Conservation::new(&scene);
        let log = || format!("cannot read the frames of point {}", trial.name);
        for frame in read_frames(frames).with_context(log)? {
            conservation.take(&frame.with_context(log)?);
        }
        let figures = conservation.figures(measures);
        // A figure that a run does not have, as an energy budget, cannot break a promise.
        let bound = |name: &str, found: f64| {
            let always = ALWAYS.iter().find(|(always, _)| *always == name);
            let own = self.promise.get(name).copied();
            match always {
                Some(_) if found.is_nan() => None,
                Some((_, bound)) => own.or(Some(*bound)),
                None => own,
            }
        };
        let judged = figures.into_iter().filter_map(|(name, found)| {
            let bound = bound(name, found)?;
            Some(Promise {
                name: name.to_string(),
                bound: format!("<= {bound}"),
                found: digits(found),
                kept: found <= bound,
            })
        });
        Ok(judged.collect())
    }
}
