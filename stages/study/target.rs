//! The reference of the error of a study.

use std::path::{Path, PathBuf};

use anyhow::Result;
use coronet::draw::readable::Readable;
use coronet::measure::lamella::Lamella;
use coronet::measure::norm::{Norm, compare_column};
use coronet::measure::series::{Reference, Series};
use coronet::measure::summary::{mean, period};
use coronet::scene::quantity::{Unit, parse};
use coronet::scene::{Clock, Scene};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::fault::Usage;
use crate::print::note;
use crate::study::trial::{Outcome, Trial};

/// Columns of the table of costs, beside the point and the axes.
pub const COLUMNS: [&str; 8] = [
    "spacing_m",
    "particles",
    "status",
    "error",
    "pareto",
    "cpu_s",
    "wall_s",
    "memory_MB",
];

/// The reference of the error: exactly one of `value`, `theory`, `reference` and `finest`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Target {
    pub column: String,
    /// An exact value, SI.
    value: Option<f64>,
    /// A theory that is applied to the scene of each point.
    theory: Option<Theory>,
    /// Feature of the column that is compared with value or theory.
    #[serde(default)]
    of: Feature,
    /// A table with the column, relative to the study file. A point that has less than nine tenths
    /// of its instants that another point has is without an error.
    reference: Option<PathBuf>,
    /// Zero of its times, also of `from` and `to`; left out: from the name of its column of times.
    clock: Option<Clock>,
    /// The point with the smallest spacing.
    #[serde(default)]
    pub finest: bool,
    from: Option<String>,
    to: Option<String>,
}

/// A theory: gives a value for a scene, or the range of its forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Theory {
    /// The contact angle that is set, degrees.
    Angle,
    /// [`Lamella`], printed and corrected.
    Lamella,
}

impl Theory {
    fn range(self, scene: &Scene) -> Option<[f64; 2]> {
        match self {
            Theory::Angle => scene.effects.wetting.map(|wetting| [wetting.angle; 2]),
            Theory::Lamella => {
                let Lamella { printed, corrected } = Lamella::of(scene)?;
                Some([printed.min(corrected), printed.max(corrected)])
            }
        }
    }
}

/// A number from a column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Feature {
    #[default]
    Largest,
    /// When it is largest, s.
    When,
    Last,
    Mean,
    /// Of the oscillation about the mean, s.
    Period,
}

impl Feature {
    pub fn of(self, measures: &Series, column: &str) -> Option<f64> {
        match self {
            Feature::Largest => measures.maximum(column).map(|(value, _)| value),
            Feature::When => measures.maximum(column).map(|(_, time)| time),
            Feature::Last => measures.column(column)?.last().copied(),
            Feature::Mean => mean(measures, column),
            Feature::Period => period(measures, column),
        }
    }
}

/// The times of a measurement, s; all times by default.
///
/// # Errors
/// If a text is not a time; `part` is its place in the file.
pub fn window(part: &str, from: &Option<String>, to: &Option<String>) -> Result<[f64; 2], Usage> {
    let time = |text: &Option<String>, otherwise: f64| match text {
        None => Ok(otherwise),
        Some(text) => {
            parse(text, Unit::Time).map_err(|error| Usage(format!("{part}: `{text}` {error}")))
        }
    };
    let [from, to] = [time(from, f64::NEG_INFINITY)?, time(to, f64::INFINITY)?];
    if from > to {
        return Err(Usage(format!(
            "{part}: `from` is after `to`; exchange them"
        )));
    }
    Ok([from, to])
}

/// Result of a point.
pub struct Found {
    /// Relative error; NaN if unknown.
    pub error: f64,
    /// Its value, and the range from value or theory; `None` with a reference.
    pub against: Option<[f64; 3]>,
}

impl Target {
    /// What is compared, whose absolute value is at most `most`: `crater depth`, mm.
    pub fn readable(&self, most: f64) -> Readable {
        let column = Readable::of(&self.column, most);
        let time = |words: String| Readable {
            words,
            ..Readable::of("_s", most)
        };
        match self.of {
            Feature::Period => time(format!("period of {}", column.words)),
            Feature::When => time(format!("time of largest {}", column.words)),
            Feature::Largest | Feature::Last | Feature::Mean => column,
        }
    }

    pub fn check(&self) -> Result<(), &'static str> {
        let given = [
            self.value.is_some(),
            self.theory.is_some(),
            self.reference.is_some(),
            self.finest,
        ];
        if self.value.is_some_and(|value| !value.is_normal()) {
            return Err(
                "[error] value must be a finite number other than zero: errors are relative",
            );
        }
        if self.of != Feature::default() && (self.reference.is_some() || self.finest) {
            return Err("[error] of goes with value or theory; a reference is compared as a curve");
        }
        if self.clock.is_some() && self.reference.is_none() {
            return Err("[error] clock goes with reference");
        }
        match given.iter().filter(|given| **given).count() {
            1 => Ok(()),
            _ => Err("[error] needs exactly one of value, theory, reference and finest = true"),
        }
    }

    /// The reference, with the column that it must have.
    pub fn table(&self) -> Option<(&Path, &str)> {
        Some((self.reference.as_deref()?, self.column.as_str()))
    }

    pub fn window(&self) -> Result<[f64; 2], Usage> {
        window("[error]", &self.from, &self.to)
    }

    /// The value of each point, and the range from value or theory.
    fn against_theory(
        &self,
        trials: &[Trial],
        outcomes: &[Outcome],
        [from, to]: [f64; 2],
    ) -> Result<Vec<Option<[f64; 3]>>> {
        let points = trials.iter().zip(outcomes);
        points
            .map(|(trial, outcome)| {
                let range = match self.theory {
                    None => self.value.map(|value| [value; 2]),
                    Some(theory) => theory.range(&trial.scene()?),
                };
                let found = outcome.measures().and_then(|m| {
                    let measures = m.window(from, to);
                    self.of.of(&measures, &self.column)
                });
                Ok(found.zip(range).map(|(f, [low, high])| [f, low, high]))
            })
            .collect()
    }

    /// Whether theory differs between points.
    pub fn varies(&self) -> bool {
        self.theory.is_some()
    }

    /// The error of each point.
    pub fn measure(
        &self,
        trials: &[Trial],
        outcomes: &[Outcome],
        folder: &Path,
        [from, to]: [f64; 2],
    ) -> Result<Vec<Found>> {
        let column = &self.column;
        if self.value.is_some() || self.theory.is_some() {
            let error = |[found, low, high]: [f64; 3]| (found / found.clamp(low, high) - 1.0).abs();
            let found = |against: Option<[f64; 3]>| Found {
                error: against.map_or(f64::NAN, error),
                against,
            };
            let all = self.against_theory(trials, outcomes, [from, to])?;
            return Ok(all.into_iter().map(found).collect());
        }
        let known = |k: usize| outcomes[k].measures();
        let finest = (0..trials.len())
            .filter(|k| known(*k).is_some())
            .min_by(|a, b| trials[*a].spacing.total_cmp(&trials[*b].spacing));
        if let Some(finest) = finest.filter(|_| self.finest) {
            warn_of_others(trials, &trials[finest]);
        }
        let mut reference = match &self.reference {
            Some(path) => Reference::read(&folder.join(path), self.clock)?,
            None => Reference {
                table: finest.and_then(known).cloned().unwrap_or_default(),
                clock: Clock::Start,
            },
        };
        reference.table = reference.table.window(from, to);
        let norms: Vec<Option<Norm>> = (0..trials.len())
            .map(|k| {
                let Some(measures) = known(k).filter(|_| !self.finest || Some(k) != finest) else {
                    return Ok(None);
                };
                let shift = reference.shift(trials[k].contact()?);
                Ok(compare_column(
                    measures,
                    &reference.table,
                    "",
                    column,
                    shift,
                ))
            })
            .collect::<Result<_>>()?;
        // An error over a part of the instants is none of the whole.
        let most = norms.iter().flatten().map(|norm| norm.points).max();
        let whole = |norm: &Norm| most.is_some_and(|most| norm.points >= most - most / 10);
        let points = norms.into_iter().zip(trials);
        let found = points.map(|(norm, trial)| {
            let counted = norm.as_ref().filter(|norm| whole(norm));
            if let (Some(norm), None) = (&norm, counted) {
                note!(
                    "warning: {} has no error: it has {} of the {} instants of the reference that \
                     other points have; let it run as long",
                    trial.title,
                    norm.points,
                    most.unwrap_or_default()
                );
            }
            Found {
                error: counted.map_or(f64::NAN, |norm| norm.l2),
                against: None,
            }
        });
        Ok(found.collect())
    }
}

/// Tells that other points are as fine as the one against which all are compared.
fn warn_of_others(trials: &[Trial], finest: &Trial) {
    let as_fine = trials
        .iter()
        .filter(|trial| trial.spacing == finest.spacing);
    let (count, title) = (as_fine.count(), &finest.title);
    if count > 1 {
        note!("warning: {count} points are the finest; all errors are against the first, {title}");
    }
}
