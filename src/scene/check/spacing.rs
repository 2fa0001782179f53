//! The spacing of particles: divides periodic sides, and makes no more than can be numbered.

use super::super::error::SceneError;
use super::super::quantity::{Unit, legible};
use super::super::tree::Tree;
use super::super::{AXES, Body, Scene, numbers};
use super::{EQUAL, periodic_axes};

/// Largest number of particles: they are numbered by 32 bits.
const PARTICLES: f64 = 4e9;

/// Most spacings along a side of the box: its coordinates have 32 bits, of which two are room
/// beside it, so that a ten-thousandth of a spacing is left.
const ALONG: f64 = 1e5;

/// Bodies have two particles across at least.
pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let spacing = scene.spacing;
    let key = "pack.spacing";
    for body in &scene.bodies {
        let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
        let axes = scene.dimension.axes();
        if axes
            .iter()
            .any(|&axis| high[axis] - low[axis] < 1.9 * spacing)
        {
            let problem = format!("leaves fewer than 2 particles across body `{}`", body.name);
            return Err(tree.fault(key, &problem, "make it smaller"));
        }
    }
    let periodic: Vec<f64> = periodic_axes(scene)
        .map(|axis| scene.domain.size[axis])
        .collect();
    let divides = |spacing: f64| {
        periodic.iter().all(|side| {
            let count = side / spacing;
            (count - count.round()).abs() <= EQUAL * count
        })
    };
    let too_many = |total: f64| {
        let problem = format!("requires {total:.2e} particles");
        let remedy = format!("at most {PARTICLES:.0e} can be numbered");
        Err(tree.fault(key, &problem, &remedy))
    };
    // Before rows of a lattice are counted, and divisors looked for, one by one.
    let cell = spacing.powi(scene.dimension.count() as i32);
    let volume = |body: &Body| body.shape.volume(&scene.domain, scene.dimension);
    let about = scene.bodies.iter().map(volume).sum::<f64>() / cell;
    if about > 2.0 * PARTICLES {
        return too_many(about);
    }
    for &axis in scene.dimension.axes() {
        let count = scene.domain.size[axis] / spacing;
        if count > ALONG {
            let problem = format!("is {count:.2e} spacings long in {}", AXES[axis]);
            let remedy = format!("at most {ALONG:.0e}: make it smaller, or `pack.spacing` larger");
            return Err(tree.fault("box.size", &problem, &remedy));
        }
    }
    if !divides(spacing) {
        let remedy = divisors(spacing, &periodic, divides);
        let problem = "does not divide every periodic side of the box";
        return Err(tree.fault(key, problem, &remedy));
    }
    let total: f64 = (0..scene.bodies.len())
        .map(|body| numbers::count(scene, body) as f64)
        .sum();
    if total > PARTICLES {
        return too_many(total);
    }
    Ok(())
}

/// The nearest spacings below and above that divide all periodic sides.
fn divisors(spacing: f64, sides: &[f64], divides: impl Fn(f64) -> bool) -> String {
    let first = sides[0];
    let count = (first / spacing).floor().max(1.0) as u64;
    let exact = |count: u64| legible(first / count as f64, Unit::Length);
    let above = (1..=count)
        .rev()
        .find(|count| divides(first / *count as f64));
    let below = (count + 1..count * 4 + 1000).find(|count| divides(first / *count as f64));
    match (above, below) {
        (Some(above), Some(below)) => {
            format!(
                "nearest that do: \"{}\" and \"{}\"",
                exact(below),
                exact(above)
            )
        }
        (Some(only), None) | (None, Some(only)) => {
            format!("nearest that does: \"{}\"", exact(only))
        }
        (None, None) => "make the periodic sides multiples of one length".to_string(),
    }
}
