//! Pair sums of MPS. Lengths in units of h, half the largest radius.
//!
//! Beside the weight of Eq. 3 stands the kernel [`Smooth`]: where a weight that is infinite at
//! r = 0 and has a kink at r_e would show noise, at the free surface and in the shifting.

use super::Smooth;
use crate::kernel::Kernel;
use crate::method::pass::{Moving, difference};
use crate::method::projection::correction::{AXES, IDENTITY, inverse};
use crate::method::projection::look::{Local, Sums, complete, divergence};
use crate::method::projection::transposed::Weight;
use crate::payload;
use crate::space::lane::{Real, dot};
use crate::space::sparse::Couple;
use crate::space::sweep::{Pair, Pass};

/// Nearer than this, some quarter of a spacing, the weight is that at it, and what it makes of a
/// separation fades with that: two particles at one place are an error that must not throw either.
pub(super) const NEAREST: f32 = 0.15;

/// w = r_e / r - 1 (Eq. 3) from the squared distance; zero for r = 0 and beyond `reach`, r_e / h.
/// Below `core` it stays as it is there.
#[inline(always)]
fn weight<F: Real>(q2: F, reach: f32, core: f32) -> F {
    let (zero, one) = (q2.splat(0.0), q2.splat(1.0));
    let q = q2.sqrt().max(q2.splat(core));
    let w = q2.splat(reach) / q - one;
    w.max(zero).if_less(zero, q2)
}

/// w / q^2, the weight of gradients (Eq. 5).
#[inline(always)]
fn steep<F: Real>(q2: F, reach: f32, core: f32) -> F {
    let near = q2.splat(core * core);
    weight(q2, reach, core) / q2.max(near)
}

/// [`steep`] as the weight of gradients.
#[derive(Clone, Copy)]
pub struct Steep {
    /// r_e / h.
    pub reach: f32,
    /// Where the weight stops growing, in h.
    pub core: f32,
}

impl Weight for Steep {
    #[inline(always)]
    fn at<F: Real>(&self, q2: F) -> F {
        steep(q2, self.reach, self.core)
    }
}

/// What a pass over gradients knows of free surfaces.
#[derive(Clone, Copy)]
pub struct Surface<'a> {
    /// Above 0 for particles with a surface in the support.
    pub marks: &'a [f32],
    /// V norm / h^d of the smooth kernel over d / n0.
    pub even: f64,
}

impl Surface<'_> {
    /// Whether a surface is near `target`, 0 or 1.
    #[inline(always)]
    fn near(&self, target: usize) -> [f32; 3] {
        [f32::from(self.marks[target] > 0.0), 0.0, 0.0]
    }

    /// The weight of gradients, `f` inside and -W' / q near a surface; `slope`: W' / q.
    #[inline(always)]
    fn blend<F: Real>(&self, near: F, f: F, slope: F) -> F {
        let smooth = slope * -self.even as f32;
        near.mul_add(smooth - f, f)
    }
}

payload! {
    /// What [`Weights`] read.
    pub struct Coupled<F> {
        /// 1 inside, 0 where p = 0 is given.
        inside: F,
        /// 1 / n with the density n of `surface::Share`.
        volume: F,
        /// c of a wall particle, Pa.
        offset: F,
    }
}

/// Weights of the Laplacian (Eq. 6).
///
/// `FLAGGED`: an unknown with p = 0 given is coupled to nothing and goes to the diagonal; else the
/// weights are divided by both n.
///
/// Sums: w q^2; w c of the neighbours; w d (3); w c of the target; w of neighbours with p = 0.
pub struct Weights<const FLAGGED: bool> {
    /// r_e / h.
    pub reach: f32,
}

impl<const FLAGGED: bool> Couple<7> for Weights<FLAGGED> {
    type Payload = Coupled;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let w = weight(q2, self.reach, NEAREST);
        [w, w]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Coupled>, sum: &mut [F; 7]) -> F {
        let mut w = pair.weight[0];
        if FLAGGED {
            let whole = w * pair.own.inside;
            w = whole * pair.other.inside;
            sum[6] += whole - w;
        } else {
            w = w * (pair.own.volume * pair.other.volume);
        }
        sum[0] = w.mul_add(pair.q2, sum[0]);
        sum[1] = w.mul_add(pair.other.offset, sum[1]);
        for a in 0..3 {
            sum[2 + a] = w.mul_add(pair.d[a], sum[2 + a]);
        }
        sum[5] = w.mul_add(pair.own.offset, sum[5]);
        w
    }
}

/// Fills [`Local`].
/// `CORRECTED`: divergence and gradients are exact for linear fields but near a surface, else as in
/// Eq. 5. `BLENDED`: near a surface they have the weight of the smooth kernel.
pub struct Look<'a, const CORRECTED: bool, const BLENDED: bool> {
    /// r_e / h, where the weight of gradients ends to grow, in h, 1 / n0 and d / n0.
    pub reach: f32,
    /// Where the weight of gradients stops growing, in h.
    pub core: f32,
    /// 1 / n0.
    pub number: f64,
    /// d / n0, what turns a sum into a gradient.
    pub value: f64,
    /// h, m.
    pub length: f64,
    /// V norm / h^d of the smooth kernel.
    pub smooth: f64,
    /// Axes along which anything varies.
    pub active: [bool; 3],
    /// Where gradients are blended near a surface.
    pub surface: Surface<'a>,
}

impl<const CORRECTED: bool, const BLENDED: bool> Pass<21> for Look<'_, CORRECTED, BLENDED> {
    type Payload = Moving;
    type Out = Local;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        match BLENDED {
            true => self.surface.near(target),
            false => [0.0; 3],
        }
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        Smooth::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 21]) {
        sum[0] += weight(pair.q2, self.reach, NEAREST);
        let [smooth, slope] = pair.weight;
        sum[1] += smooth;
        let mut f = steep(pair.q2, self.reach, self.core);
        if BLENDED {
            f = self.surface.blend(pair.extra[0], f, slope);
        }
        let (mut g, mut v) = (pair.d, pair.d);
        for a in 0..3 {
            sum[2 + a] = slope.mul_add(pair.d[a], sum[2 + a]);
            g[a] = f * pair.d[a];
            v[a] = pair.own.velocity[a] - pair.other.velocity[a];
        }
        sum[20] = smooth.mul_add(dot(v, v), sum[20]);
        for (k, [a, b]) in AXES.into_iter().enumerate() {
            sum[5 + k] = g[a].mul_add(pair.d[b], sum[5 + k]);
        }
        for a in 0..3 {
            for b in 0..3 {
                sum[11 + 3 * a + b] = v[a].mul_add(g[b], sum[11 + 3 * a + b]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, s: [f32; 21], out: &mut Local) {
        out.number = (self.number * s[0] as f64) as f32;
        out.kernel_sum = (self.smooth * (s[1] as f64 + Smooth::w(0.0))) as f32;
        out.stir = (s[20] / s[1].max(f32::MIN_POSITIVE)).sqrt();
        out.slope = [s[2], s[3], s[4]].map(|s| (self.smooth / self.length * s as f64) as f32);
        out.moment = std::array::from_fn(|k| (self.value * s[5 + k] as f64) as f32);
        complete(&mut out.moment, self.active);
        out.correction = if CORRECTED && self.surface.marks[target] == 0.0 {
            inverse(&out.moment)
        } else {
            IDENTITY
        };
        let divergence = divergence(&out.correction, &s[11..20]);
        out.divergence = (self.value / self.length * divergence) as f32;
    }
}

/// n / n0 (Eq. 4).
pub struct Number {
    /// r_e / h and 1 / n0.
    pub reach: f32,
    /// What turns a sum into an acceleration.
    pub factor: f64,
}

impl Pass<1> for Number {
    type Payload = ();
    type Out = f64;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let w = weight(q2, self.reach, NEAREST);
        [w, w]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += pair.weight[0]
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f64) {
        *out = self.factor * sum[0] as f64;
    }
}

payload! {
    /// What [`PressureSlope`] reads.
    pub struct Pressed<F> {
        /// P, Pa.
        pressure: F,
        /// Q, what is subtracted from the pressures about, Pa.
        level: F,
    }
}

/// SUM (P_b + P_a) d w / q^2 with `SYMMETRIC`, else SUM (P_b - Q_a) d w / q^2.
/// `BLENDED`: as in [`Look`].
pub struct PressureSlope<'a, const SYMMETRIC: bool, const BLENDED: bool> {
    /// r_e / h, and where the weight ends to grow, in h.
    pub reach: f32,
    /// Where the weight of gradients stops growing, in h.
    pub core: f32,
    /// Where gradients are blended near a surface.
    pub surface: Surface<'a>,
}

impl<const SYMMETRIC: bool, const BLENDED: bool> Pass<3> for PressureSlope<'_, SYMMETRIC, BLENDED> {
    type Payload = Pressed;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        match BLENDED {
            true => self.surface.near(target),
            false => [0.0; 3],
        }
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let f = steep(q2, self.reach, self.core);
        match BLENDED {
            true => [f, Smooth::slope_lanes(q2.sqrt())],
            false => [f, f],
        }
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Pressed>, sum: &mut [F; 3]) {
        let p = if SYMMETRIC {
            pair.other.pressure + pair.own.pressure
        } else {
            pair.other.pressure - pair.own.level
        };
        let [mut f, slope] = pair.weight;
        if BLENDED {
            f = self.surface.blend(pair.extra[0], f, slope);
        }
        f = f * p;
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum;
    }
}

/// SUM (u_b - u_a) w, the viscous Laplacian (Eq. 9), or (d + 2) SUM (u_b - u_a) . e e w with e
/// along the line of the pair (Kondo 2021): see [`crate::effect::viscosity`].
pub struct Viscous {
    /// r_e / h.
    pub reach: f32,
    /// Whether it is the second.
    pub is_central: bool,
    /// nu 2 d / (n0 lambda), 1/s, times d + 2 in the second.
    pub factor: f64,
}

impl Pass<3> for Viscous {
    type Payload = Moving;
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let w = weight(q2, self.reach, NEAREST);
        [w, w]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 3]) {
        let w = pair.weight[0];
        let v = difference(pair.other.velocity, pair.own.velocity);
        let (w, along) = match self.is_central {
            true => (
                w * dot(v, pair.d) / pair.q2.at_least(NEAREST * NEAREST),
                pair.d,
            ),
            false => (w, v),
        };
        for a in 0..3 {
            sum[a] = w.mul_add(along[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}

/// What shows the free surface at r^n, and n / n0.
pub struct Around {
    /// r_e / h and 1 / n0.
    pub reach: f32,
    /// 1 / n0.
    pub number: f64,
}

impl Pass<5> for Around {
    type Payload = ();
    type Out = Sums<f32>;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        Smooth::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 5]) {
        sum[0] += weight(pair.q2, self.reach, NEAREST);
        let [w, slope] = pair.weight;
        sum[1] += w;
        for a in 0..3 {
            sum[2 + a] = slope.mul_add(pair.d[a], sum[2 + a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 5], out: &mut Sums<f32>) {
        *out = Sums {
            own: (self.number * s[0] as f64) as f32,
            kernel: s[1] + Smooth::w(0.0) as f32,
            slope: [s[2], s[3], s[4]],
        };
    }
}
