//! Vibration of the box: seen from it, all particles have the acceleration
//!
//! (1) a = A omega^2 sin(omega t),  omega = 2 pi f,
//!
//! that of a box at A sin(omega t). Its work is that of the walls, which move.
//!
//! Time step: 1 / (20 f): the acceleration in the middle of a step is within (omega dt)^2 / 24,
//! 0.4 %, of its mean. Test: tests/validation/vibration.rs (frequencies of a standing wave).

use super::{Effect, Uniform};
use std::f64::consts::TAU;

/// Steps of a period.
const STEPS: f64 = 20.0;

/// A and f of (1).
pub struct Vibration {
    /// m.
    pub amplitude: [f64; 3],
    /// 1/s.
    pub frequency: f64,
}

impl Effect for Vibration {
    fn uniform(&self, time: f64) -> Option<Uniform> {
        let omega = TAU * self.frequency;
        let factor = omega * omega * (omega * time).sin(); // (1)
        Some(Uniform::Driven(self.amplitude.map(|a| factor * a)))
    }

    fn limit(&self, _: f64, _: f64) -> Option<(&'static str, f64)> {
        Some(("vibration", 1.0 / (STEPS * self.frequency)))
    }
}
