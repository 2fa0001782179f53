//! What the liquid gives the walls.

use super::Moving;
use crate::kernel::Kernel;
use crate::space::lane::{Real, dot};
use crate::space::sweep::{Pair, Pass};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

/// Extrapolation of pressure and velocity from the liquid to a wall particle (Adami, Hu & Adams
/// 2012, Eqs. 22-27).
pub struct Extrapolation<K> {
    /// The kernel.
    pub kernel: PhantomData<K>,
}

/// Sums of [`Extrapolation`].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct WallSums {
    /// SUM w.
    pub weight: f32,
    /// SUM P w.
    pub pressure: f32,
    /// SUM d w, d = (r_wall - r_liquid) / h.
    pub lever: [f32; 3],
    /// SUM v w.
    pub velocity: [f32; 3],
    /// SUM slope v . d: the power of its pressure.
    pub closing: f32,
}

impl<K: Kernel> Pass<9> for Extrapolation<K> {
    type Payload = Moving;
    type Out = WallSums;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 9]) {
        let other = &pair.other;
        let [w, slope] = pair.weight;
        sum[0] += w;
        sum[1] = w.mul_add(other.pressure / other.weight.abs(), sum[1]);
        for a in 0..3 {
            sum[2 + a] = w.mul_add(pair.d[a], sum[2 + a]);
            sum[5 + a] = w.mul_add(other.velocity[a], sum[5 + a]);
        }
        sum[8] = slope.mul_add(dot(other.velocity, pair.d), sum[8]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 9], out: &mut WallSums) {
        *out = WallSums {
            weight: s[0],
            pressure: s[1],
            lever: [s[2], s[3], s[4]],
            velocity: [s[5], s[6], s[7]],
            closing: s[8],
        };
    }
}
