//! What makes the figures of a run doubtful: liquid that left the box, liquid detached from the
//! main body, which most measures do not include, a crater that ends at the floor, figures that
//! still grow, energy that nothing explains, and pressure that does work.
//!
//! Test: tests/engine/measure_loss.rs.

use super::conservation;
use super::kind::Kind;
use super::series::Series;
use super::summary::digits;
use crate::scene::quantity::{Unit, legible};
use crate::scene::sanity::Warning;
use crate::scene::{Body, Scene, Shape, Side};

/// Part of the liquid that may leave the box without a word at the end of a run.
const LOST: f64 = 1e-3;

/// Part of the liquid from which a loss is reported at once. A length goes with the cube root of a
/// volume: 1 % is a third of a per cent of a length, below the accuracy of any measure here
/// (docs/results/validation.md).
const WORTH: f64 = 0.01;

/// Last part of a run in which a figure that still grows gains more than [`WORTH`] of its value.
const LATE: f64 = 0.1;

/// Part of the energy at the start that may be unexplained at the end without a word: more than the
/// hard cases promise (3 %), with room for coarse spacings.
const MISSING: f64 = 0.1;

/// How many times the energy of a flow its pressure may turn over without a word: beside a sliding
/// lid it is a few times in the corners, in a run that burst hundreds of times.
const PRESSED: f64 = 30.0;

/// Part of that energy that pressure may give without a word. The hard cases promise to gain no
/// more than half a per cent in all; settings that boil gave several times the energy.
const GIVEN: f64 = 0.2;

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
            "{} of the liquid has left the box by t = {:.3} ms, through open sides or as mist at \
             periodic ones; if that is not meant, stop, and enlarge `box.size` on that side or \
             make it a wall",
            percent(part),
            1e3 * time
        ))
    }
}

/// Warnings about the measures of a run; `contact`: when the drop meets pool or wall, s from the
/// start.
pub fn warnings(scene: &Scene, series: &Series, contact: Option<f64>) -> Vec<Warning> {
    let mut all: Vec<Warning> = floor(scene, series, contact).into_iter().collect();
    all.extend(sides(scene, series));
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
        && removed > LOST * mass
    {
        let part = exact(removed / mass);
        let rest = "energies and measures are those of the rest";
        let axes = scene.dimension.axes().iter();
        let has = |side: Side| {
            axes.clone()
                .any(|&axis| scene.domain.boundary[axis].contains(&side))
        };
        let has_layer = |body: &Body| matches!(body.shape, Shape::Layer { .. });
        // Where there is a pool, single particles end at periodic sides.
        let has_mist = has(Side::Periodic) && scene.bodies.iter().any(has_layer);
        let (how, remedy) = match (has(Side::Open), has_mist) {
            (true, false) => (
                "left the box through open sides",
                "enlarge `box.size` on that side, make it a wall, or end the run before",
            ),
            (true, true) => (
                "left the box through open sides, or as single particles at periodic sides",
                "enlarge `box.size`, or end the run before; mist is less with a finer \
                 `pack.spacing`",
            ),
            (false, true) => (
                "left the box as single particles at periodic sides",
                "make the box wider; mist is less with a finer `pack.spacing`",
            ),
            (false, false) => (
                "passed through the walls",
                "check accelerations and speeds, or use a finer `pack.spacing`",
            ),
        };
        let why = format!("{part} of the liquid {how}: {rest}");
        let value = format!("{} kg", digits(removed));
        all.push(Warning::new("mass_removed_kg", value, &why, remedy));
    }
    let has_met = contact.is_none_or(|contact| series.time().last() > Some(&contact));
    if let Some(part) = end("detached_part").filter(|part| has_met && *part > WORTH) {
        let why = "so much of the liquid is off the main body at the end: crater, crown, jet and \
                   spread are those of the main body";
        let remedy = "check in the panels whether these are drops or mist; mist is reduced by a \
                      finer `pack.spacing`";
        all.push(Warning::new("detached_part", percent(part), why, remedy));
    }
    if has_met {
        all.extend(growing(scene, series));
    }
    all.extend(unexplained(scene, series));
    all.extend(pressed(scene, series));
    all
}

/// Figures that are still growing when the run ends.
fn growing(scene: &Scene, series: &Series) -> Option<Warning> {
    let (start, end) = (*series.time().first()?, *series.time().last()?);
    let grows = |(column, least): (&str, f64)| {
        let (value, time) = series.maximum(column)?;
        let before = series.at(column, end - LATE * (end - start)).unwrap_or(0.0);
        (time == end && value > least && value - before > WORTH * value).then_some(())
    };
    let spacing = scene.spacing;
    let figures = [
        ("crater depth", ("crater_depth_m", spacing)),
        ("crown height", ("crown_height_m", spacing)),
        ("spread factor", ("spread_factor", 0.0)),
    ];
    let names: Vec<&str> = figures
        .into_iter()
        .filter_map(|(name, column)| grows(column).map(|()| name))
        .collect();
    if names.is_empty() {
        return None;
    }
    let why = match names[..] {
        [name] => format!("the largest {name} is that of the last frame: it still grows"),
        _ => {
            let names = names.join(" and ");
            format!("the largest {names} are those of the last frame: they still grow")
        }
    };
    let (stop, set_end) = (&scene.impact.stop_when, scene.impact.end);
    if !stop.is_empty() && end + scene.frames.interval < set_end {
        let value = format!("met at {}", legible(end, Unit::Time));
        let remedy = "leave out the condition that ended the run; it continues from there";
        return Some(Warning::new("impact.stop_when", value, &why, remedy));
    }
    let remedy = "set a later end; the run continues from where it ended";
    let value = legible(set_end, Unit::Time);
    Some(Warning::new("impact.end", value, &why, remedy))
}

/// Energy that came from nowhere or is missing at the end.
fn unexplained(scene: &Scene, series: &Series) -> Option<Warning> {
    let mass = *series.column("mass_kg")?.first()?;
    let [_, part] = conservation::unexplained_part(scene, series, mass);
    if !part.is_finite() || part <= MISSING {
        return None;
    }
    let value = series.column("energy_unexplained_J")?.last()?;
    let why = format!(
        "{} of the energy that the run starts with or that drives it, which neither forces nor \
         losses explain: energies are that uncertain",
        percent(part)
    );
    let remedy = "compare with a finer `pack.spacing`, or with another method";
    let value = format!("{} J", digits(*value));
    Some(Warning::new("energy_unexplained_J", value, &why, remedy))
}

/// Pressure that did many times the work of the flow, or gave a part of its energy: the budget
/// closes all the same.
fn pressed(scene: &Scene, series: &Series) -> Option<Warning> {
    let mass = *series.column("mass_kg")?.first()?;
    let [most, given] = conservation::pressed_parts(scene, series, mass)?;
    let why = match (most > PRESSED, given > GIVEN) {
        (true, _) => format!(
            "it was {most:.0} times the energy that the run starts with or that drives it, and \
             pressure should do no work: particles are pressed into walls"
        ),
        (_, true) => format!(
            "it gave {} of the energy that the run starts with or that drives it, and pressure \
             should give none: speeds and energies are those of a scheme that is unstable",
            percent(given)
        ),
        _ => return None,
    };
    let remedy = "take the settings of preset `modern`, or compare with WCSPH, or with a finer \
                  `pack.spacing`";
    let work = series.column("pressure_work_J")?.iter();
    let value = work.fold(0.0_f64, |most, work| match work.abs() > most.abs() {
        true => *work,
        false => most,
    });
    let value = format!("{} J", digits(value));
    Some(Warning::new("pressure_work_J", value, &why, remedy))
}

/// A crater down to the floor of a pool.
fn floor(scene: &Scene, series: &Series, contact: Option<f64>) -> Option<Warning> {
    let layer = |body: &Body| match body.shape {
        Shape::Layer { depth } => Some((body.name.clone(), depth)),
        _ => None,
    };
    let (name, depth) = scene.bodies.iter().find_map(layer)?;
    let from = contact.unwrap_or(f64::NEG_INFINITY);
    let (deepest, _) = series
        .window(from, f64::INFINITY)
        .maximum("crater_depth_m")?;
    if deepest < depth - 1.5 * scene.spacing {
        return None;
    }
    let key = format!("body.{name}.layer.depth");
    let why = format!(
        "the crater, {} mm deep, comes within 1.5 spacings of the floor, which limits its depth",
        digits(1e3 * deepest)
    );
    let remedy = "for the depth of a crater in deep liquid make the pool, and the box, deeper";
    let value = format!("{} mm", digits(1e3 * depth));
    Some(Warning::new(&key, value, &why, remedy))
}

/// Liquid on a wall that reaches the sides of the box.
fn sides(scene: &Scene, series: &Series) -> Option<Warning> {
    let (spread, _) = series.maximum("max_diameter_factor")?;
    let Kind::Wall(axis) = Kind::new(scene) else {
        return None;
    };
    let widest = spread * axis.diameter;
    let axes = scene.dimension.axes().iter().filter(|axis| **axis < 2);
    let width = axes
        .map(|&axis| scene.domain.size[axis])
        .fold(f64::INFINITY, f64::min);
    if widest < width - 2.0 * scene.spacing {
        return None;
    }
    let why = format!(
        "the liquid, {} mm wide, reaches the sides, which limit its spread and its angle",
        digits(1e3 * widest)
    );
    let value = format!("{} mm", digits(1e3 * width));
    let remedy = "make the box wider for the spread of a drop on a wide wall";
    Some(Warning::new("box.size", value, &why, remedy))
}

fn exact(part: f64) -> String {
    match part < WORTH {
        true => format!("{:.2} %", 100.0 * part),
        false => percent(part),
    }
}

fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}
