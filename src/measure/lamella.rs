//! Theory of the spread of a drop on a dry wall at t = D0 / U0: the diameter of the lamella of
//! [`crate::scene::lamella`], which contains the equations.
//!
//! Test: tests/engine/measure_lamella.rs.

use super::kind::strikes_wall;
use crate::scene::lamella::{Thickness, spreads_in};
use crate::scene::{Dimension, Scene, numbers};

/// d1: diameter over that of the drop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamella {
    /// (1) or (2).
    pub printed: f64,
    /// With (3).
    pub corrected: f64,
}

impl Lamella {
    /// For a single drop that falls on a dry wall with a contact angle; `None` if there is none.
    /// With hysteresis the advancing angle is used.
    pub fn of(scene: &Scene) -> Option<Lamella> {
        if !strikes_wall(scene) {
            return None;
        }
        let angle = scene.effects.wetting?.advancing();
        let numbers = numbers::of(scene);
        let (weber, reynolds) = (numbers.get("We")?, numbers.get("Re")?);
        Some(Lamella::new(spreads_in(scene), weber, reynolds, angle))
    }

    /// We and Re of the drop's diameter; `angle`: contact angle, degrees.
    pub fn new(dimension: Dimension, weber: f64, reynolds: f64, angle: f64) -> Lamella {
        let thickness = Thickness::new(dimension, weber, reynolds, angle);
        let diameter = |h: f64| match dimension {
            Dimension::Three => (2.0 / (3.0 * h)).sqrt(),
            Dimension::Two => std::f64::consts::PI / (4.0 * h),
        };
        Lamella {
            printed: diameter(thickness.printed),
            corrected: diameter(thickness.corrected),
        }
    }
}
