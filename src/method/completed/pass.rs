//! The sums of [`super`] over particles. Lengths in units of h, as in [`crate::method::pass`].

use super::Completed;
use crate::effect::tension::energy::look;
use crate::kernel::Kernel;
use crate::method::pass::{self, Sparing, difference};
use crate::method::projection::surface::Share;
use crate::method::projection::transposed::Flowing;
use crate::space::lane::{Real, are_zero, dot};
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// (1), of particles for which it is `wanted`.
pub struct Look<'a, K, W> {
    /// V norm / h^d.
    pub unit: f64,
    /// F.
    pub share: &'a Share,
    /// Whether a surface is near a particle.
    pub wanted: W,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel, W: Fn(usize) -> bool + Sync> Pass<4> for Look<'_, K, W> {
    type Payload = ();
    type Out = Completed;
    #[inline(always)]
    fn skips(&self, target: usize) -> bool {
        !(self.wanted)(target)
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 4]) {
        look(pair.weight, pair.d, sum);
    }
    #[inline(always)]
    fn finish(&self, target: usize, [x, y, z, sum]: [f32; 4], out: &mut Completed) {
        *out = match self.skips(target) {
            true => Completed::default(),
            false => {
                let sum = self.unit * (sum as f64 + K::w(0.0));
                let gradient = [x, y, z].map(|g| self.unit * g as f64);
                Completed::of(self.share, sum, gradient)
            }
        };
    }
}

/// dC/dt and n_g . h d(grad C)/dt of a pair at the velocities `v`, own minus other, from the
/// distance and the slope of the kernel.
#[inline(always)]
fn rates<K: Kernel, F: Real>([q, slope]: [F; 2], d: [F; 3], v: [F; 3], along: [F; 3]) -> [F; 2] {
    let closing = dot(v, d);
    if are_zero(along) {
        return [slope * closing, q.splat(0.0)];
    }
    let turning = K::curve_lanes(q) * (closing * dot(along, d));
    [slope * closing, slope.mul_add(dot(along, v), turning)]
}

/// The rate of density, as [`pass::Spared`] has it, by (2).
pub struct Spared<'a, K> {
    /// What it is of a full support.
    pub plain: pass::Spared<K>,
    /// By particle.
    pub completed: &'a [Completed],
}

impl<K: Kernel> Pass<3> for Spared<'_, K> {
    type Payload = Sparing;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.completed[target].along
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::root_and_slope(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Sparing>, sum: &mut [F; 3]) {
        let v = difference(pair.own.velocity, pair.other.velocity);
        let evened = self.plain.evened(pair);
        let [sums, gradients] = rates::<K, F>(pair.weight, pair.d, v, pair.extra);
        sum[0] += sums;
        sum[1] += gradients;
        sum[2] = pair.weight[1].mul_add(evened, sum[2]);
    }
    #[inline(always)]
    fn finish(&self, target: usize, [sums, gradients, evened]: [f32; 3], out: &mut [f32; 3]) {
        let closing = self.completed[target].slope * sums + gradients;
        *out = [closing + evened, evened, 0.0].map(|s| (self.plain.factor * s as f64) as f32);
    }
}

/// Minus (2), as [`crate::method::projection::transposed::Divergence`] has it.
pub struct Divergence<'a, K> {
    /// V norm / h^(d+1), 1/m.
    pub factor: f64,
    /// By particle.
    pub completed: &'a [Completed],
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<2> for Divergence<'_, K> {
    type Payload = Flowing;
    type Out = f64;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.completed[target].along
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::root_and_slope(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Flowing>, sum: &mut [F; 2]) {
        let v = difference(pair.own.velocity, pair.other.velocity);
        let [sums, gradients] = rates::<K, F>(pair.weight, pair.d, v, pair.extra);
        sum[0] += sums;
        sum[1] += gradients;
    }
    #[inline(always)]
    fn finish(&self, target: usize, [sums, gradients]: [f32; 2], out: &mut f64) {
        *out = -self.factor * (self.completed[target].slope * sums + gradients) as f64;
    }
}
