//! What the error of a study is measured against.

use std::path::{Path, PathBuf};

use anyhow::Result;
use coronet::measure::gauge::contact_time;
use coronet::measure::series::{Series, compare_column};
use coronet::measure::summary::{mean, period};
use coronet::scene::file;
use coronet::scene::quantity::{Unit, parse};
use serde::Deserialize;

use crate::fault::Usage;
use crate::trial::{Outcome, Trial};

/// What the error is measured against: exactly one of `value`, `reference` and `finest`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    pub column: String,
    /// An exact value, SI.
    value: Option<f64>,
    /// What of the column is compared with the value.
    #[serde(default)]
    of: Feature,
    /// A table with the column, from the study file.
    reference: Option<PathBuf>,
    /// The point with the smallest spacing.
    #[serde(default)]
    pub finest: bool,
    from: Option<String>,
    to: Option<String>,
}

/// A number that a column comes down to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Feature {
    #[default]
    Largest,
    Last,
    Mean,
    /// Of the oscillation about the mean, s.
    Period,
}

impl Feature {
    fn of(self, measures: &Series, column: &str) -> Option<f64> {
        match self {
            Feature::Largest => measures.maximum(column).map(|(value, _)| value),
            Feature::Last => measures.column(column)?.last().copied(),
            Feature::Mean => mean(measures, column),
            Feature::Period => period(measures, column),
        }
    }
}

impl Target {
    pub fn check(&self) -> Result<(), &'static str> {
        let given = [self.value.is_some(), self.reference.is_some(), self.finest];
        match given.iter().filter(|given| **given).count() {
            1 => Ok(()),
            _ => Err("[error] needs exactly one of value, reference and finest = true"),
        }
    }

    pub fn window(&self) -> Result<[f64; 2], Usage> {
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
    pub fn measure(
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
                    let found = known(k).and_then(|m| self.of.of(&m.window(from, to), column));
                    found.map_or(f64::NAN, |found| (found / value - 1.0).abs())
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
