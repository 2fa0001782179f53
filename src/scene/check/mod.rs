//! Checks of a resolved scene that involve several values.

mod axis;
mod gradient;
mod method;
mod spacing;
mod stop;
mod tension;

use std::path::Path;

use super::body::SHAPES;
use super::error::{Mistakes, SceneError};
use super::quantity::{Unit, legible};
use super::stage::LONGEST_REFERENCE;
use super::tree::Tree;
use super::{
    AXES, Clock, Dimension, Method, Motion, Projection, Scene, Shape, Side, TimeStepping, Wetting,
    limit, numbers,
};

/// Largest number of bodies: they are numbered by a byte.
const BODIES: usize = 255;
/// Largest number of frames in a log.
const FRAMES: f64 = 1e6;
/// Least time between frames in a log, and its last time, s.
const TICK: f64 = 1e-9;
const LAST: f64 = 1.5e10;
/// Relative difference below which lengths are equal: they come from decimal texts.
const EQUAL: f64 = 1e-9;
/// Least distance of two mirrors, in supports of the widest sum, with room for lists.
const MIRRORED: f64 = 1.5;

/// Checks `scene`; `tree` gives the places of values, `folder` contains the file.
pub fn scene(scene: &Scene, tree: &Tree<'_>, folder: &Path) -> Result<(), SceneError> {
    bodies(scene, tree)?;
    let mut found = Mistakes::default();
    found.take(overlaps(scene, tree));
    found.take(spacing::check(scene, tree));
    found.take(periodic_reach(scene, tree));
    found.take(mirrors(scene, tree));
    found.take(vortices(scene, tree));
    found.take(axis::check(scene, tree));
    found.take(gradient::check(scene, tree));
    found.take(method::check(scene, tree));
    found.take(tension::check(scene, tree));
    found.take(times(scene, tree));
    found.take(stop::check(scene, tree));
    found.take(references(scene, tree, folder));
    found.take(figures(scene, tree));
    found.told()
}

fn bodies(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let count = scene.bodies.len();
    if count == 0 || count > BODIES {
        let remedy = format!("write 1 to {BODIES} tables [body.NAME]");
        return Err(tree.fault("body", &format!("has {count} bodies"), &remedy));
    }
    for body in &scene.bodies {
        let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
        for &axis in scene.dimension.axes() {
            let size = scene.domain.size[axis];
            if low[axis] < -EQUAL * size || high[axis] > size * (1.0 + EQUAL) {
                let problem = format!(
                    "reaches from {} to {} in {}, out of the box [0, {}]",
                    legible(low[axis], Unit::Length),
                    legible(high[axis], Unit::Length),
                    AXES[axis],
                    legible(size, Unit::Length)
                );
                let key = shape_of(&body.name, tree);
                return Err(tree.fault(&key, &problem, "move it or enlarge `box.size`"));
            }
        }
    }
    Ok(())
}

/// The key of the shape of a body.
fn shape_of(body: &str, tree: &Tree<'_>) -> String {
    let key = |shape: &str| format!("body.{body}.{shape}");
    let is_there = |shape: &&str| tree.get(&key(shape)).is_some();
    SHAPES.into_iter().find(is_there).map_or(key(""), key)
}

fn overlaps(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    for (index, first) in scene.bodies.iter().enumerate() {
        for second in &scene.bodies[index + 1..] {
            if overlap(scene, &first.shape, &second.shape) {
                let problem = format!("overlaps body `{}`", first.name);
                let key = shape_of(&second.name, tree);
                return Err(tree.fault(&key, &problem, "move them apart"));
            }
        }
    }
    Ok(())
}

fn overlap(scene: &Scene, first: &Shape, second: &Shape) -> bool {
    if let (
        Shape::Sphere {
            centre: a,
            radius: ra,
        },
        Shape::Sphere {
            centre: b,
            radius: rb,
        },
    ) = (first, second)
    {
        let square: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
        return square.sqrt() < (ra + rb) * (1.0 - EQUAL);
    }
    let (domain, dimension) = (&scene.domain, scene.dimension);
    let (low_a, high_a) = first.bounds(domain, dimension);
    let (low_b, high_b) = second.bounds(domain, dimension);
    let low: [f64; 3] = std::array::from_fn(|axis| low_a[axis].max(low_b[axis]));
    let high: [f64; 3] = std::array::from_fn(|axis| high_a[axis].min(high_b[axis]));
    let thin = |axis: &usize| high[*axis] - low[*axis] <= EQUAL * domain.size[*axis];
    if dimension.axes().iter().any(thin) {
        return false;
    }
    // Exact for axis-parallel shapes; otherwise tested at points of the common box.
    const POINTS: i32 = 40;
    let coordinate = |axis: usize, step: i32| {
        low[axis] + (high[axis] - low[axis]) * (f64::from(step) + 0.5) / f64::from(POINTS)
    };
    let across = if dimension == Dimension::Two {
        1
    } else {
        POINTS
    };
    let mut steps = (0..POINTS).flat_map(|i| (0..across).map(move |j| (i, j)));
    steps.any(|(i, j)| {
        (0..POINTS).any(|k| {
            let point = [coordinate(0, i), coordinate(1, j), coordinate(2, k)];
            let inside = |shape: &Shape| shape.contains(point, domain, dimension);
            inside(first) && inside(second)
        })
    })
}

fn periodic_axes(scene: &Scene) -> impl Iterator<Item = usize> + '_ {
    let axes = scene.dimension.axes().iter().copied();
    axes.filter(|axis| scene.domain.boundary[*axis][0] == Side::Periodic)
}

/// A particle must not interact with itself, nor twice with a neighbour, through periodic sides.
fn periodic_reach(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let reach = scene.widest();
    for axis in periodic_axes(scene) {
        if scene.domain.size[axis] < 2.0 * reach {
            let problem = format!(
                "is periodic in {} over less than twice the kernel{}",
                AXES[axis],
                widened(scene)
            );
            let remedy = at_least(scene, 2.0 * reach);
            return Err(tree.fault("box.size", &problem, &remedy));
        }
    }
    Ok(())
}

/// Names the contact angle where it widens the kernel; else empty.
fn widened(scene: &Scene) -> String {
    let Some(wetting) = scene.effects.wetting.filter(|_| is_stretched(scene)) else {
        return String::new();
    };
    let keys = match wetting.hysteresis {
        Some([advancing, receding]) => format!(
            "effects.wetting.advancing` = {} and `receding` = {}",
            legible(advancing, Unit::Angle),
            legible(receding, Unit::Angle)
        ),
        None => {
            let angle = legible(wetting.angle, Unit::Angle);
            format!("effects.wetting.angle` = {angle}")
        }
    };
    let stretch = wetting.stretch();
    format!(", which `{keys} widens by a factor of {stretch:.2}")
}

/// Whether a contact angle widens the kernel: the surface is continued into the wall at it.
fn is_stretched(scene: &Scene) -> bool {
    let mut plain = scene.clone();
    plain.effects.wetting = scene.effects.wetting.map(|_| Wetting::of(90.0));
    scene.widest() > plain.widest() * (1.0 + EQUAL)
}

fn at_least(scene: &Scene, length: f64) -> String {
    let least = legible(length, Unit::Length);
    let angle = match is_stretched(scene) {
        true => ", or take an angle nearer 90 deg",
        false => "",
    };
    format!("make it at least {least}{angle}, or lower `pack.spacing`")
}

/// Requires that images stay away from the next plane, and that nothing breaks the symmetry.
fn mirrors(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let reach = scene.widest();
    for &axis in scene.dimension.axes() {
        if scene.domain.fold(axis).is_none() {
            continue;
        }
        let name = AXES[axis];
        if let Some((what, remedy)) = super::symmetry::crosswise(scene, axis) {
            let problem = format!("has a mirror, but {what}");
            return Err(tree.fault(&format!("box.{name}"), &problem, &remedy));
        }
        if scene.domain.size[axis] < MIRRORED * reach {
            let widened = widened(scene);
            let has = match scene.domain.is_axial() {
                true => "has a radius of".to_string(),
                false => format!("has mirrors in {name}, over"),
            };
            let problem = format!("{has} less than {MIRRORED} kernels{widened}");
            // A symmetry cuts half of what the file says.
            let parts = match tree.get("box.symmetry") {
                Some(_) => 2.0,
                None => 1.0,
            };
            let remedy = at_least(scene, parts * MIRRORED * reach);
            return Err(tree.fault("box.size", &problem, &remedy));
        }
    }
    Ok(())
}

fn vortices(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    for body in &scene.bodies {
        let Motion::TaylorGreen { .. } = body.motion else {
            continue;
        };
        let key = format!("body.{}.taylor_green", body.name);
        let size = scene.domain.size;
        let sides = [0, 2].map(|axis| scene.domain.boundary[axis][0]);
        if sides != [Side::Periodic; 2] || size[0] != size[2] {
            let remedy = "make the box periodic in x and z, and as high as wide";
            return Err(tree.fault(&key, "needs a periodic square in x and z", remedy));
        }
    }
    Ok(())
}

fn times(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    if scene.impact.end / scene.frames.interval > FRAMES {
        let problem = format!("makes more than {FRAMES:.0e} frames until `impact.end`");
        return Err(tree.fault("frames.interval", &problem, "make it longer"));
    }
    let scale = scene.frames.time_scale;
    let [least, most] = [scene.frames.interval, scene.impact.end].map(|time| time * scale);
    if least < TICK || most > LAST {
        let problem = format!("makes log times from {least:.1e} to {most:.1e} s");
        return Err(tree.fault("frames.time_scale", &problem, "set it nearer to 1"));
    }
    if let Some(settings) = scene.method.projection() {
        return steps(scene.method.name(), settings, tree);
    }
    let Method::Wcsph(settings) = &scene.method else {
        return Ok(());
    };
    let TimeStepping::Fixed { step } = settings.time_stepping else {
        return Ok(());
    };
    let (name, limit) = unstable_step(scene);
    if step > limit {
        let key = "method.wcsph.time_stepping.fixed.step";
        let problem = format!(
            "takes fixed steps of {}, above the {name} limit of {}",
            legible(step, Unit::Time),
            legible(limit, Unit::Time)
        );
        let remedy = format!("set `{key}` lower, or `adaptive` in place of `fixed`");
        return Err(tree.fault(key, &problem, &remedy));
    }
    Ok(())
}

/// The least limit of a fixed step by name, s: the acoustic one with the largest published
/// constant, 0.6 h / (c + V), or the viscous one.
fn unstable_step(scene: &Scene) -> (&'static str, f64) {
    let h = numbers::smoothing_length(scene);
    let acoustic = 0.6 * h / (numbers::sound_speed(scene) + numbers::reference_speed(scene));
    match scene
        .stiff_viscosity()
        .map(|stiff| limit::viscous(h, scene.density, stiff))
    {
        Some(viscous) if viscous < acoustic => ("viscous", viscous),
        _ => ("acoustic", acoustic),
    }
}

fn steps(method: &str, settings: &Projection, tree: &Tree<'_>) -> Result<(), SceneError> {
    if settings.shortest <= settings.longest {
        return Ok(());
    }
    let longest = legible(settings.longest, Unit::Time);
    let problem = format!("is above the longest step of {longest}");
    let key = format!("method.{method}.shortest");
    Err(tree.fault(&key, &problem, "make it shorter"))
}

/// Pixels and letters of figures fit into memory and onto paper.
fn figures(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let style = &scene.post.figures;
    for (key, length) in [("width", style.width), ("height", style.height)] {
        if !(0.03..=0.5).contains(&length) {
            let key = format!("post.figures.{key}");
            let problem = "is no size of a figure on paper";
            return Err(tree.fault(&key, problem, "give 30 mm to 500 mm"));
        }
    }
    // Titles of axes and legends need so many ems.
    let most = (style.width / 24.0).min(style.height / 18.5) * 72.0 / 0.0254;
    if style.font_size <= most {
        return Ok(());
    }
    let [width, height] = [style.width, style.height].map(|length| legible(length, Unit::Length));
    let problem = format!("leaves no room for curves in a plot of {width} by {height}");
    let remedy = match most - 0.05 {
        most if most >= 4.0 => format!("give at most {most:.1}, or larger figures"),
        _ => "make the figures larger".to_string(),
    };
    Err(tree.fault("post.figures.font_size", &problem, &remedy))
}

fn references(scene: &Scene, tree: &Tree<'_>, folder: &Path) -> Result<(), SceneError> {
    for (index, reference) in scene.post.references.iter().enumerate() {
        let key = format!("post.references[{index}].path");
        let path = folder.join(&reference.path);
        let remedy = "give a CSV file, relative to the scene file";
        let content = crate::file::read(&path, LONGEST_REFERENCE).map_err(|error| {
            match error.is_not_found() {
                true => tree.fault(&key, &error.to_string(), remedy),
                false => error.into(),
            }
        })?;
        let mut table = crate::file::table(&content);
        let clocks = Clock::COLUMNS.map(|(name, _)| name);
        let has_time = |head: &csv::StringRecord| head.iter().any(|name| clocks.contains(&name));
        if !table.headers().is_ok_and(has_time) {
            let path = path.display();
            let problem = format!("{path} has no column `{}`", clocks.join("` or `"));
            return Err(tree.fault(&key, &problem, "name its columns as in measures.csv"));
        }
    }
    Ok(())
}
