//! Liquid that body forces drive along periodic axes.

use super::{Problem, Side};
use std::f64::consts::TAU;

/// Speeds, m/s, that body forces along periodic axes, which have no downhill end, give: 2 omega A
/// of a vibration, which starts at rest; of gravity g L^2 / (8 nu), that of a steady flow between
/// walls L apart, but in the first no more than sqrt(2 g T), of one way through the box of T.
pub fn speeds(scene: &Problem) -> [f64; 2] {
    let (domain, axes) = (&scene.domain, scene.dimension.axes());
    let is_periodic = |axis: &&usize| domain.boundary[**axis][0] == Side::Periodic;
    let between = |axis: &&usize| domain.boundary[**axis] == [Side::Wall; 2];
    let gap = axes.iter().filter(between).map(|axis| domain.size[*axis]);
    let gap = gap.fold(f64::INFINITY, f64::min);
    let mut speeds: [f64; 2] = [0.0; 2];
    for &axis in axes.iter().filter(is_periodic) {
        let shaken = scene.effects.vibration.map_or(0.0, |vibration| {
            2.0 * TAU * vibration.frequency * vibration.amplitude[axis].abs()
        });
        let force = scene.effects.gravity.map_or(0.0, |g| g[axis].abs());
        let once = (2.0 * force * domain.size[axis]).sqrt();
        let steady = match scene.effects.mu() {
            Some(mu) if gap.is_finite() && force > 0.0 => {
                force * gap * gap * scene.density / (8.0 * mu)
            }
            _ => once,
        };
        let both = [steady.min(once), steady].map(|speed| speed.max(shaken));
        speeds = [0, 1].map(|k| speeds[k].max(both[k]));
    }
    speeds
}

/// Whether a body force acts along a periodic axis.
pub fn is_driven(scene: &Problem) -> bool {
    speeds(scene)[0] > 0.0
}
