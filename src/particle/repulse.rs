//! Repulsion: makes a Poisson-disk sample uniform, but disordered (a glass).
//!
//! Particles go down the gradient of the pair energy SUM W(r_ij) (Colagrossi, Bouscasse, Antuono &
//! Marrone 2012):
//!
//! dx_i = -beta (SUM_j grad W_ij + grad gamma_i),                                         (1)
//!
//! j over liquid and wall, gamma the kernel mass outside the free surface. All particles repel each
//! other, so that pairs cannot form; the missing liquid outside also repels, so that the surface
//! stays in place. The kernel is Wendland's C2 with a short support: nearest neighbours dominate.
//! Lengths are in units of the spacing.

use super::completion::Completion;
use super::crowd::Crowd;
use crate::kernel::{Kernel, WendlandC2};
use crate::space::lane::Real;
use crate::space::parallel::{self, each_mut};
use crate::space::sweep::{Pair, Pass};

/// Smoothing length of the repulsion.
pub const SMOOTHING: f64 = 1.3;
/// beta of (1).
const STRENGTH: f32 = 0.12;
/// Longest step.
const CAP: f32 = 0.1;
/// Part of the last step that is added to the next (heavy ball).
const MOMENTUM: f32 = 0.7;

struct Push {
    dimension: usize,
}

impl Pass<3> for Push {
    type Payload = ();
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        WendlandC2::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 3]) {
        let slope = pair.weight[0];
        for k in 0..3 {
            sum[k] = slope.mul_add(pair.d[k], sum[k]);
        }
    }
    fn finish(&self, _target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        let scale = WendlandC2::norm(self.dimension) / SMOOTHING.powi(self.dimension as i32 + 1);
        *out = sum.map(|s| s * scale as f32);
    }
}

/// One step of (1) with momentum of the last; returns the root mean square displacement.
pub fn step(
    crowd: &mut Crowd,
    completion: &Completion,
    dimension: usize,
    last: &mut Vec<[f32; 3]>,
) -> f64 {
    let n = crowd.len();
    let mut next = vec![[0.0f32; 3]; n];
    crowd.sum(SMOOTHING, &Push { dimension }, &mut next);
    last.resize(n, [0.0; 3]);
    let now = &*crowd;
    each_mut(&mut next[..n], |i, step| {
        let (_, slope) = completion.at(now.at(i));
        let dx = [0, 1, 2].map(|k| {
            // (1)
            MOMENTUM * last[i][k] - STRENGTH * (step[k] + slope[k] as f32)
        });
        let shorten = (CAP / square(dx).sqrt().max(f32::MIN_POSITIVE)).min(1.0);
        *step = dx.map(|d| d * shorten);
    });
    let span = crowd.span();
    let [sum] = parallel::sum(span.clone(), |i| [square(next[i]) as f64]);
    let longest = parallel::max(span.clone(), |i| square(next[i]) as f64).sqrt();
    *last = next;
    crowd.advance(longest, |i| last[i].map(f64::from));
    crowd.settle(last);
    (sum / span.total() as f64).sqrt()
}

fn square(x: [f32; 3]) -> f32 {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}
