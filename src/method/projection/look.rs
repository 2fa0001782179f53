//! What a particle knows of its neighbourhood, whatever the method.

use super::correction::Tensor;
use serde::{Deserialize, Serialize};

/// Sums at r^n. `T`: the method's own.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Sums<T> {
    /// What the method sums beside the kernel.
    pub own: T,
    /// SUM w with the particle itself, and SUM slope d, of the kernel.
    pub kernel: f32,
    /// SUM slope d of the kernel.
    pub slope: [f32; 3],
}

/// The neighbourhood at r*.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Local {
    /// Density as the method sums it, over rho0.
    pub number: f32,
    /// C = SUM V W: 1 inside, and its gradient, 1/m.
    pub kernel_sum: f32,
    /// Gradient of C, 1/m.
    pub slope: [f32; 3],
    /// n of `surface::Share`.
    pub density: f32,
    /// Divergence of v*, 1/s.
    pub divergence: f32,
    /// Root mean square of |v*_ab| over the neighbours, by W, m/s.
    pub stir: f32,
    /// What a gradient makes of r, and the matrix that corrects gradients.
    pub moment: Tensor,
    /// The matrix that corrects gradients.
    pub correction: Tensor,
}

/// trace(L G) of a gradient G of velocity, `g[3 a + b]`: the divergence that L corrects.
#[inline(always)]
pub fn divergence(correction: &Tensor, g: &[f32]) -> f64 {
    let mut sum = 0.0;
    for (k, [a, b]) in super::correction::AXES.into_iter().enumerate() {
        let part = if a == b {
            g[4 * a]
        } else {
            g[3 * a + b] + g[3 * b + a]
        };
        sum += correction[k] as f64 * part as f64;
    }
    sum
}

/// A moment with 1 for the axes along which nothing varies.
#[inline(always)]
pub fn complete(moment: &mut Tensor, active: [bool; 3]) {
    for (k, [a, b]) in super::correction::AXES.into_iter().enumerate() {
        if a == b && !active[a] {
            moment[k] = 1.0;
        }
    }
}
