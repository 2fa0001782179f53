//! Gravity, or any uniform body force: a = g.
//!
//! Time step: 0.25 sqrt(h / |g|) (Monaghan 1992). Test: tests/validation/wall.rs (hydrostatic).

use crate::space::parallel::each_mut;

/// Adds `g`, m/s^2, to every acceleration.
pub fn add(g: [f64; 3], into: &mut [[f32; 3]]) {
    let n = into.len();
    each_mut(&mut into[..n], |_, a| {
        (0..3).for_each(|c| a[c] += g[c] as f32);
    });
}
