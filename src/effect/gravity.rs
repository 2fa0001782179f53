//! Gravity: a = g, with the energy of height -m g . x.
//!
//! Time step: 0.25 sqrt(h / |a|) (Monaghan 1992), that of every acceleration. Test:
//! tests/validation/wall.rs (hydrostatic).

use super::{Effect, Uniform};

/// g, m/s^2.
pub struct Gravity(pub [f64; 3]);

impl Effect for Gravity {
    fn uniform(&self, _: f64) -> Option<Uniform> {
        Some(Uniform::Constant(self.0))
    }
}
