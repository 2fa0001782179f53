//! Settings that are probably not intended: warnings before a run.
//!
//! [`super::check`] rejects what cannot be computed; these settings can be, and some are intended.
//! Test: tests/engine/scene_sanity.rs, with the warnings of each shipped scene.

mod course;
mod full;
mod instants;
mod method;
mod values;

use std::fmt;

use serde::Serialize;

use super::lamella::{Thickness, spreads_in};
use super::numbers;
use super::quantity::{Unit, legible};
use super::{AXES, Body, Dimension, Motion, Scene, Shape, Side, TensionForm, symmetry};
use course::Course;

/// Spacings across a sheet below which it has surfaces but no interior.
const THIN: f64 = 3.0;
/// Reynolds number below which viscosity slows a drop before it touches: with 0.36 one of six
/// spacings loses a fifth of its speed.
const CREEPING: f64 = 1.0;
/// Contact angle of a wall without one, degrees.
const NEUTRAL: f64 = 90.0;

/// A setting that is probably not intended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Warning {
    /// Dotted, as in the scene file.
    pub key: String,
    /// With its unit.
    pub value: String,
    /// Why it is doubtful.
    pub why: String,
    /// What to write instead.
    pub remedy: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Warning {
            key,
            value,
            why,
            remedy,
        } = self;
        write!(out, "`{key}` = {value}: {why}; {remedy}")
    }
}

impl Warning {
    /// A warning about the setting at `key`.
    pub fn new(key: &str, value: String, why: &str, remedy: &str) -> Warning {
        Warning {
            key: key.to_string(),
            value,
            why: why.to_string(),
            remedy: remedy.to_string(),
        }
    }
}

/// All warnings about a scene; empty if it is plausible.
pub fn warnings(scene: &Scene) -> Vec<Warning> {
    let mut all = values::all(scene);
    all.extend(gravity(scene));
    all.extend(method::all(scene));
    all.extend(full::alternating(scene));
    all.extend(floor(scene));
    all.extend(flows_out(scene));
    all.extend(motions(scene));
    all.extend(instants::frames(scene));
    all.extend(instants::pictures(scene));
    all.extend(fields(scene));
    all.extend(thin(scene));
    all.extend(lamella(scene));
    all.extend(brakes(scene));
    all.extend(dry_walls(scene));
    all.extend(mirrors(scene));
    all
}

fn is_layer(body: &Body) -> bool {
    matches!(body.shape, Shape::Layer { .. })
}

fn has_layer(scene: &Scene) -> bool {
    scene.bodies.iter().any(is_layer)
}

/// Whether the liquid fills the box, so that it has no surface.
fn is_full(scene: &Scene) -> bool {
    let axes = scene.dimension.axes();
    let box_volume: f64 = axes.iter().map(|axis| scene.domain.size[*axis]).product();
    let volumes = scene.bodies.iter();
    let liquid: f64 = volumes
        .map(|body| body.shape.volume(&scene.domain, scene.dimension))
        .sum();
    liquid > 0.999 * box_volume
}

fn vector(scene: &Scene, vector: [f64; 3], unit: Unit) -> String {
    let axes = scene.dimension.axes().iter();
    let parts: Vec<String> = axes.map(|axis| legible(vector[*axis], unit)).collect();
    format!("[{}]", parts.join(", "))
}

/// Gravity that lifts the liquid, or pulls a pool along.
fn gravity(scene: &Scene) -> Option<Warning> {
    let gravity = scene.effects.gravity?;
    let lid = scene.domain.boundary[2][1] == Side::Wall;
    let sides = scene.domain.boundary[0]
        .iter()
        .chain(&scene.domain.boundary[1]);
    let is_walled = |axis: usize| scene.domain.boundary[axis] == [Side::Wall; 2];
    let drifts = (0..2).any(|axis| gravity[axis] != 0.0 && !is_walled(axis));
    let why = if gravity[2] > 0.0 && has_layer(scene) {
        "it points up, away from the floor on which the layer lies"
    } else if gravity[2] > 0.0 && !lid {
        "it points up, where no wall holds the liquid"
    } else if is_full(scene) {
        return None;
    } else if gravity[2] == 0.0 && has_layer(scene) {
        "it points sideways, and nothing holds the layer on the floor"
    } else if drifts && has_layer(scene) {
        "it pulls the layer along the floor, where no walls hold it"
    } else if gravity[2] == 0.0 && drifts && !sides.into_iter().any(|side| *side == Side::Wall) {
        "it points sideways, where no wall holds the liquid"
    } else {
        return None;
    };
    let value = vector(scene, gravity, Unit::Acceleration);
    // A section through an axis is written in three dimensions.
    let is_plane = scene.dimension == Dimension::Two && !scene.domain.is_axial();
    let down = if is_plane { "[0, -1]" } else { "[0, 0, -1]" };
    let remedy = format!("z is up: write {down}, or leave the direction out");
    Some(Warning::new(
        "effects.gravity.direction",
        value,
        why,
        &remedy,
    ))
}

/// A side without a floor.
fn floor(scene: &Scene) -> Option<Warning> {
    let low = scene.domain.boundary[2][0];
    let falls = scene.effects.gravity.is_some_and(|g| g[2] < 0.0);
    let (value, why) = match low {
        Side::Open if falls => (
            "open",
            "nothing holds the liquid, which falls out of the box",
        ),
        Side::Open if has_layer(scene) => ("open", "the layer has no floor to lie on"),
        Side::Periodic if falls => (
            "periodic",
            "the liquid falls through the box again and again",
        ),
        _ => return None,
    };
    let value = format!("{value:?} at its low side");
    let remedy = "write `box.z = [\"wall\", \"open\"]`, or leave gravity out";
    Some(Warning::new("box.z", value, why, remedy))
}

/// Layers beside open sides.
fn flows_out(scene: &Scene) -> Vec<Warning> {
    let axes = scene.dimension.axes().iter().filter(|axis| **axis < 2);
    let open = axes.filter(|axis| scene.domain.boundary[**axis].contains(&Side::Open));
    let key = |axis: &usize| format!("box.{}", AXES[*axis]);
    let warning = |axis| {
        let why = "the layer flows out of the box there";
        let remedy = "write \"periodic\" or \"wall\"";
        Warning::new(&key(axis), "\"open\"".to_string(), why, remedy)
    };
    match has_layer(scene) {
        true => open.map(warning).collect(),
        false => Vec::new(),
    }
}

/// Bodies that leave the box or meet nothing.
fn motions(scene: &Scene) -> Vec<Warning> {
    let has_walls = scene
        .domain
        .boundary
        .iter()
        .flatten()
        .any(|side| *side == Side::Wall);
    let lonely = scene.bodies.len() == 1 && !has_walls;
    let bodies = scene.bodies.iter().enumerate();
    let moving = bodies.filter_map(|(index, body)| match body.motion {
        Motion::Uniform(velocity) if velocity != [0.0; 3] => Some((index, body, velocity)),
        _ => None,
    });
    let doubtful = moving.filter_map(|(index, body, velocity)| {
        let why = match Course::of(scene, index) {
            Course::Meets => return None,
            Course::Leaves(time) => {
                let time = numbers::short(time, Unit::Time);
                format!(
                    "`{}` leaves the box after {time} and meets nothing",
                    body.name
                )
            }
            Course::Alone if lonely => return None,
            Course::Alone => {
                let end = legible(scene.impact.end, Unit::Time);
                format!("`{}` meets nothing before `impact.end` = {end}", body.name)
            }
        };
        let key = format!("body.{}.velocity", body.name);
        let value = vector(scene, velocity, Unit::Speed);
        let remedy = "turn it towards a body or a wall (a single speed is downward), or make \
                      `impact.end` later";
        Some(Warning::new(&key, value, &why, remedy))
    });
    doubtful.collect()
}

/// Bodies that are thinner than a few particles.
fn thin(scene: &Scene) -> Vec<Warning> {
    let spacing = scene.spacing;
    let across = |body: &Body| {
        let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
        let axes = scene.dimension.axes().iter();
        let cuts = body.shape.cuts(&scene.domain);
        let extent = |axis: &usize| {
            let parts = if cuts[*axis].is_some() { 2.0 } else { 1.0 };
            parts * (high[*axis] - low[*axis])
        };
        axes.map(extent).fold(f64::INFINITY, f64::min)
    };
    let thin = scene.bodies.iter().filter_map(|body| {
        let thickness = across(body);
        (thickness < THIN * (1.0 - 1e-9) * spacing).then(|| {
            let name = &body.name;
            let count = thickness / spacing;
            let thickness = numbers::short(thickness, Unit::Length);
            let why = format!(
                "body `{name}`, {thickness} thick, is {count:.1} particles across: less than \
                 {THIN} have no inside"
            );
            finer(scene, &why, across(body))
        })
    });
    thin.collect()
}

/// Advice for liquid that is `thickness` m thick.
fn finer(scene: &Scene, why: &str, thickness: f64) -> Warning {
    let value = legible(scene.spacing, Unit::Length);
    let enough = numbers::short(thickness / THIN, Unit::Length);
    let remedy = format!("make it {enough} or less");
    Warning::new("pack.spacing", value, why, &remedy)
}

/// The lamella of a drop on a dry wall, by Roisman's estimate, too thin for the particles.
fn lamella(scene: &Scene) -> Option<Warning> {
    let floor = scene.domain.boundary[2][0] == Side::Wall;
    let down = |body: &Body| matches!(body.motion, Motion::Uniform(v) if v[2] < 0.0);
    let strikes = |(index, body): (usize, &Body)| {
        body.shape.is_free() && down(body) && Course::of(scene, index) == Course::Meets
    };
    if !floor || has_layer(scene) || !scene.bodies.iter().enumerate().any(strikes) {
        return None;
    }
    let numbers = numbers::of(scene);
    let diameter = numbers::drop_diameter(scene)?;
    let reynolds = numbers.get("Re")?;
    let weber = numbers.get("We").unwrap_or(f64::INFINITY);
    let angle = scene
        .effects
        .wetting
        .map_or(NEUTRAL, |wetting| wetting.advancing());
    let thickness = Thickness::new(spreads_in(scene), weber, reynolds, angle).corrected * diameter;
    let count = thickness / scene.spacing;
    (count < THIN).then(|| {
        let why = format!(
            "by the estimate of Roisman et al. (2002) the drop spreads to a lamella of {}, \
             {count:.1} particles: less than {THIN} have no inside",
            numbers::short(thickness, Unit::Length)
        );
        finer(scene, &why, thickness)
    })
}

/// Liquid so viscous that pairs of particles stop a drop before it touches.
fn brakes(scene: &Scene) -> Option<Warning> {
    let reynolds = numbers::of(scene).get("Re")?;
    let viscosity = scene.effects.viscosity?.dynamic;
    let is_free = |body: &Body| body.shape.is_free() && body.motion != Motion::Uniform([0.0; 3]);
    if reynolds >= CREEPING || !scene.bodies.iter().any(is_free) {
        return None;
    }
    let reach = 2.0 * numbers::smoothing_length(scene);
    let why = format!(
        "at Re = {reynolds:.2} it slows a drop before it touches: particles see each other over {}",
        numbers::short(reach, Unit::Length)
    );
    let remedy = "let it start in contact (a `gap` of 0), or see whether a smaller `pack.spacing` \
                  gives the same";
    let value = legible(viscosity, Unit::Viscosity);
    Some(Warning::new(
        "effects.viscosity.dynamic",
        value,
        &why,
        remedy,
    ))
}

/// Fields of a scene without an axis, which are not drawn: they are means over what is as far from
/// it.
pub fn fields(scene: &Scene) -> Option<Warning> {
    if scene.post.fields.is_empty() || scene.domain.is_part() {
        return None;
    }
    let free = scene.bodies.iter().filter(|body| !is_layer(body)).count();
    let is_anywhere = free == 1 && scene.domain.boundary[0] == [Side::Periodic; 2];
    let (what, _) = match is_anywhere {
        true => symmetry::crosswise(scene, 0)?,
        false => symmetry::lopsided(scene, 0)?,
    };
    let why = format!("fields are means over both sides of the axis of the drop, but {what}");
    let value = format!("{} instants", scene.post.fields.len());
    let remedy = "none is drawn: leave them out";
    Some(Warning::new("post.fields", value, &why, remedy))
}

/// Walls that meet a free surface with tension, and no contact angle.
fn dry_walls(scene: &Scene) -> Option<Warning> {
    let tension = scene.effects.sigma()?;
    if scene.effects.wetting.is_some() || is_full(scene) {
        return None;
    }
    let falls = scene.effects.gravity.is_some_and(|g| g[2] < 0.0);
    let meets = |axis: usize, end: usize| {
        let size = scene.domain.size[axis];
        let near = scene.spacing;
        scene.bodies.iter().any(|body| {
            let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
            let sinks = matches!(body.motion, Motion::Uniform(v) if v[2] < 0.0) || falls;
            match (axis, end) {
                (2, 0) => low[2] < near || sinks,
                (_, 0) => low[axis] < near,
                _ => high[axis] > size - near,
            }
        })
    };
    let is_line = |axis: usize, end: usize| {
        let covered = axis == 2 && end == 0 && has_layer(scene);
        scene.domain.boundary[axis][end] == Side::Wall && !covered && meets(axis, end)
    };
    let mut axes = scene.dimension.axes().iter();
    let axis = axes.find(|axis| (0..2).any(|end| is_line(**axis, end)))?;
    let value = legible(tension, Unit::Tension);
    let axis = AXES[*axis];
    let neutral = scene.effects.has_tension(TensionForm::SurfaceEnergy);
    let why = match neutral {
        true => {
            format!("the surface meets walls in {axis}, no contact angle is set: it takes 90 deg")
        }
        false => format!(
            "the surface meets walls in {axis} at no contact angle: it is not held there, and \
             breaks up"
        ),
    };
    let remedy = "add `effects.wetting.angle` (\"90 deg\" is neutral)";
    Some(Warning::new(
        "effects.tension.coefficient",
        value,
        &why,
        remedy,
    ))
}

/// Mirrors on both sides of a body that neither cuts.
fn mirrors(scene: &Scene) -> Vec<Warning> {
    let whole = |axis: &&usize| {
        scene.domain.boundary[**axis] == [Side::Mirror; 2] && scene.unfolds(**axis).is_none()
    };
    if scene.bodies.iter().all(is_layer) {
        return Vec::new();
    }
    let axes = scene.dimension.axes().iter().filter(whole);
    let warning = |axis: &usize| {
        let key = format!("box.{}", AXES[*axis]);
        let why = "no mirror plane cuts a body: the box is a cell of an endless row, and its sides \
                   are walls without friction";
        let remedy = "write \"periodic\" or \"wall\"; for a part of a symmetric scene leave the \
                      sides and set `box.symmetry`";
        Warning::new(&key, "\"mirror\"".to_string(), why, remedy)
    };
    axes.map(warning).collect()
}
