//! The force of walls, from the balance of momentum.
//!
//! (1) F = (P_1 - P_0 - M INT g dt) / (t_1 - t_0), P the momentum of the liquid, M its mass, g the
//!     acceleration by gravity and vibration: what the walls do to the liquid, on average from one
//!     frame to the next, whatever the method and the geometry. The liquid pushes the walls with
//!     the opposite force. It includes what a method's own forces lack of conserving momentum.

use super::series::Row;
use crate::particle::Frame;
use crate::scene::{Effects, Scene, Side};
use std::f64::consts::TAU;

const NAMES: [&str; 3] = ["wall_force_x_N", "wall_force_y_N", "wall_force_z_N"];

/// Momentum at an instant.
#[derive(Clone, Copy, Debug)]
pub struct Impulse {
    /// s.
    time: f64,
    /// kg m/s.
    momentum: [f64; 3],
    /// kg.
    mass: f64,
    /// Mass of what has been removed so far, kg: it takes an unknown momentum along.
    removed: f64,
}

impl Impulse {
    /// Of a frame whose method gives its momentum.
    pub(super) fn of(frame: &Frame) -> Option<Impulse> {
        let named = |name: &str| frame.scalars.iter().find(|(n, _)| n == name);
        let momentum = |axis: &str| Some(named(&format!("momentum_{axis}_kg_m_s"))?.1);
        Some(Impulse {
            time: frame.time,
            momentum: [momentum("x")?, momentum("y")?, momentum("z")?],
            mass: named("mass_kg")?.1,
            removed: named("mass_removed_kg").map_or(0.0, |(_, removed)| *removed),
        })
    }
}

/// Adds (1) since `last`, N (N/m in two dimensions), blank where it is not known, and returns what
/// the next frame needs. A scene without walls has no columns.
pub(super) fn put(
    scene: &Scene,
    frame: &Frame,
    last: Option<Impulse>,
    row: &mut Row,
) -> Option<Impulse> {
    let mut sides = scene.domain.boundary.iter().flatten();
    if !sides.any(|side| *side == Side::Wall) {
        return None;
    }
    let now = Impulse::of(frame)?;
    let span = |last: &Impulse| now.time - last.time;
    let last = last.filter(|last| span(last) > 0.0 && last.removed == now.removed);
    for a in (0..3).filter(|a| scene.domain.size[*a] > 0.0) {
        let force = last.map_or(f64::NAN, |last| {
            let body = now.mass * body_force(&scene.effects, a, last.time, now.time);
            (now.momentum[a] - last.momentum[a] - body) / span(&last)
        });
        row.push((NAMES[a].to_owned(), force));
    }
    Some(now)
}

/// INT g dt of (1) along an axis, m/s.
fn body_force(effects: &Effects, axis: usize, from: f64, to: f64) -> f64 {
    let gravity = effects.gravity.map_or(0.0, |g| g[axis] * (to - from));
    let shaken = effects.vibration.map_or(0.0, |vibration| {
        let omega = TAU * vibration.frequency;
        let turned = (omega * from).cos() - (omega * to).cos();
        vibration.amplitude[axis] * omega * turned
    });
    gravity + shaken
}
