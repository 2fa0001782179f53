//! Losses of a run: liquid that left the box, and liquid detached from the main body, which most
//! measures do not include.
//!
//! Test: tests/engine/measure_loss.rs.

use super::series::Series;
use super::summary::digits;
use crate::scene::sanity::Warning;

/// Part of the liquid from which a loss is reported. A length goes with the cube root of a volume:
/// 1 % is a third of a per cent of a length, below the accuracy of any measure here
/// (docs/results/validation.md).
const WORTH: f64 = 0.01;

/// Reports losses during a run: from [`WORTH`] on, and again whenever they have doubled.
#[derive(Debug, Default)]
pub struct Watch {
    told: f64,
}

impl Watch {
    /// A sentence about the scalars of a frame at `time` s, if there is something new to report.
    pub fn look(&mut self, time: f64, scalars: &[(String, f64)]) -> Option<String> {
        let named = |name: &str| scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        let (mass, removed) = (named("mass_kg")?, named("mass_removed_kg")?);
        let part = removed / (mass + removed);
        if part.is_nan() || part <= WORTH.max(2.0 * self.told) {
            return None;
        }
        self.told = part;
        Some(format!(
            "{} of the liquid has left the box through open sides by t = {:.3} ms; if that is not \
             meant, stop, and enlarge `box.size` on that side or make it a wall",
            percent(part),
            1e3 * time
        ))
    }
}

/// Warnings about the liquid that is missing at the end of a run.
pub fn warnings(series: &Series) -> Vec<Warning> {
    let mut all = Vec::new();
    let end = |name: &str| {
        series
            .column(name)
            .and_then(|values| values.last().copied())
    };
    let first = |name: &str| {
        series
            .column(name)
            .and_then(|values| values.first().copied())
    };
    if let (Some(removed), Some(mass)) = (end("mass_removed_kg"), first("mass_kg"))
        && removed > WORTH * mass
    {
        let why = format!(
            "{} of the liquid left the box through open sides: energies and measures are those of \
             the rest",
            percent(removed / mass)
        );
        let remedy = "enlarge `box.size` on that side, make it a wall, or end the run before";
        let value = format!("{} kg", digits(removed));
        all.push(Warning::new("mass_removed_kg", value, &why, remedy));
    }
    if let Some(part) = end("detached_part").filter(|part| *part > WORTH) {
        let why = "so much of the liquid is off the main body at the end: crater, crown, jet and \
                   spread are those of the main body";
        let remedy = "check in the panels whether these are drops or mist; mist is reduced by a \
                      finer `pack.spacing`";
        all.push(Warning::new("detached_part", percent(part), why, remedy));
    }
    all
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}
