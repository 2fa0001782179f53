//! Liquid that body forces drive along periodic axes, which have no downhill end.

use super::{Problem, Side};
use std::f64::consts::TAU;

/// How many times as fast as [`speed`] the liquid may become before its speed of sound no longer
/// follows: without walls or viscosity nothing but the end of the run limits it.
const ROOM: f64 = 10.0;

/// The speed, m/s, that the scene suggests: 2 omega A of a vibration, which starts at rest, and
/// of gravity g H^2 / (2 nu), that of a steady film of height H, or of a channel that is 2 H wide,
/// but no more than sqrt(2 g T), of one way through the box of length T.
pub fn speed(scene: &Problem) -> f64 {
    shaken(scene) + once(scene).min(steady(scene))
}

/// The most, m/s, that the speed of sound is made for.
pub fn most(scene: &Problem) -> f64 {
    shaken(scene) + (ROOM * once(scene)).min(steady(scene))
}

fn periodic(scene: &Problem) -> impl Iterator<Item = usize> {
    let axes = scene.dimension.axes().iter().copied();
    axes.filter(|axis| scene.domain.boundary[*axis][0] == Side::Periodic)
}

/// Length of the parts of a vector along periodic axes.
fn along(scene: &Problem, vector: [f64; 3]) -> f64 {
    let parts = periodic(scene).map(|axis| vector[axis].powi(2));
    parts.sum::<f64>().sqrt()
}

fn shaken(scene: &Problem) -> f64 {
    scene.effects.vibration.map_or(0.0, |vibration| {
        2.0 * TAU * vibration.frequency * along(scene, vibration.amplitude)
    })
}

/// sqrt(2 g T).
fn once(scene: &Problem) -> f64 {
    let gravity = scene.effects.gravity.unwrap_or_default();
    let energy = periodic(scene).map(|axis| 2.0 * gravity[axis].abs() * scene.domain.size[axis]);
    energy.sum::<f64>().sqrt()
}

/// g H^2 / (2 nu); infinite without walls or viscosity.
fn steady(scene: &Problem) -> f64 {
    let gravity = scene.effects.gravity.unwrap_or_default();
    let force = along(scene, gravity);
    let height = |axis: usize| {
        let walls = scene.domain.boundary[axis].map(|side| side == Side::Wall);
        let shapes = scene.bodies.iter().map(|body| &body.shape);
        let bounds = shapes.map(|shape| shape.bounds(&scene.domain, scene.dimension));
        let (low, high) = bounds.fold((f64::INFINITY, 0.0f64), |(low, high), (from, to)| {
            (low.min(from[axis]), high.max(to[axis]))
        });
        let is_full = high - low > 0.99 * scene.domain.size[axis];
        match walls {
            [false, false] => f64::INFINITY,
            [true, true] if is_full => 0.5 * (high - low),
            _ => high - low,
        }
    };
    let heights = scene.dimension.axes().iter().map(|axis| height(*axis));
    let height = heights.fold(f64::INFINITY, f64::min);
    match scene.effects.mu() {
        _ if force == 0.0 => 0.0,
        Some(mu) => force * height * height * scene.density / (2.0 * mu),
        None => f64::INFINITY,
    }
}
