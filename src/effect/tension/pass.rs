//! Pair sums of the surface tension; numbers as in [`super`].

use crate::effect::normal::{Coloured, Root};
use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::{Real, are_zero, dot};
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// SUM w: (1).
pub struct Volume<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<1> for Volume<K> {
    type Payload = ();
    type Out = f32;
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += K::w_lanes(pair.q2.sqrt());
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

payload! {
    /// V of (2).
    pub struct Filled<F> {
        /// m^d.
        volume: F,
    }
}

/// SUM V_b w: (2).
pub struct Colour<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<1> for Colour<K> {
    type Payload = Filled;
    type Out = f32;
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Filled>, sum: &mut [F; 1]) {
        let w = K::w_lanes(pair.q2.sqrt());
        sum[0] = pair.other.volume.mul_add(w, sum[0]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// SUM (c_b - c_a) slope d: (3), then SUM slope d.
pub struct Difference<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<6> for Difference<K> {
    type Payload = Coloured;
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Coloured>, sum: &mut [F; 6]) {
        let slope = K::slope_lanes(pair.q2.sqrt());
        let f = slope * (pair.other.colour - pair.own.colour);
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
            sum[3 + a] = slope.mul_add(pair.d[a], sum[3 + a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 6], out: &mut Self::Out) {
        *out = ([s[0], s[1], s[2]], [s[3], s[4], s[5]]);
    }
}

/// What the neighbours' stress adds to the acceleration, (5) without the own stress:
/// T_b / rho^2 = |u|^2 I - u u.
#[derive(Clone, Copy)]
pub(super) struct Summed<K> {
    pub factor: f64,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<3> for Summed<K> {
    type Payload = Root;
    type Out = [f32; 3];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Root>, sum: &mut [F; 3]) {
        let slope = K::slope_lanes(pair.q2.sqrt());
        let u = pair.other.u;
        let along = (pair.q2.splat(0.0) - slope) * dot(u, pair.d);
        let size = slope * dot(u, u);
        for c in 0..3 {
            sum[c] = size.mul_add(pair.d[c], along.mul_add(u[c], sum[c]));
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}

payload! {
    /// T / rho^2.
    pub(super) struct Stress<F> { xx: F, yy: F, zz: F, yz: F, xz: F, xy: F }
}

/// The same for stresses of any shape.
pub(super) struct Tensor<K>(pub Summed<K>);

impl<K: Kernel> Pass<3> for Tensor<K> {
    type Payload = Stress;
    type Out = [f32; 3];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Stress>, sum: &mut [F; 3]) {
        let slope = K::slope_lanes(pair.q2.sqrt());
        let t = &pair.other;
        let rows = [[t.xx, t.xy, t.xz], [t.xy, t.yy, t.yz], [t.xz, t.yz, t.zz]];
        for c in 0..3 {
            sum[c] = slope.mul_add(dot(rows[c], pair.d), sum[c]);
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        self.0.finish(target, sum, out);
    }
}

/// The whole pair force (5) before its factor.
#[inline(always)]
fn stress<K: Kernel, F: Real>(pair: &Pair<F, Root>) -> [F; 3] {
    let slope = K::slope_lanes(pair.q2.sqrt());
    let (d, a, b) = (pair.d, pair.own.u, pair.other.u);
    let s = dot(a, a) + dot(b, b);
    let (ad, bd) = (dot(a, d), dot(b, d));
    let mut force = d;
    for c in 0..3 {
        let stress = s * d[c] - b[c].mul_add(bd, a[c] * ad);
        force[c] = slope * stress;
    }
    force
}

/// The whole pair force as an acceleration.
pub(super) struct Whole<K>(pub Summed<K>);

impl<K: Kernel> Pass<3> for Whole<K> {
    type Payload = Root;
    type Out = [f32; 3];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Root>, sum: &mut [F; 3]) {
        let force = stress::<K, F>(pair);
        for c in 0..3 {
            sum[c] += force[c];
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        self.0.finish(target, sum, out);
    }
}

/// Tangential over (d-1) minus normal virial, about the normal of the surface at the target: that
/// of the colour is noisy, and takes some per cent of the one for the other.
pub(super) struct Virial<'a, K> {
    /// Of each target.
    pub normals: &'a [[f32; 3]],
    /// 1 / (d-1).
    pub scale: f32,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<1> for Virial<'_, K> {
    type Payload = Root;
    type Out = f64;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.normals[target]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Root>, sum: &mut [F; 1]) {
        let force = stress::<K, F>(pair);
        let n = pair.extra;
        let normal = dot(n, pair.d) * dot(n, force);
        let tangential = dot(pair.d, force) - normal;
        let part = tangential * self.scale - normal;
        sum[0] += part;
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f64) {
        *out = sum[0] as f64;
    }
}

payload! {
    /// What [`Pull`] reads.
    pub struct Energetic<F> {
        /// e'.
        slope: F,
        /// g / H.
        gradient: [F; 3],
    }
}

/// (2) of [`super::energy`].
pub struct Pull<K> {
    /// What the sum is multiplied by.
    pub factor: f64,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<3> for Pull<K> {
    type Payload = Energetic;
    type Out = [f32; 3];
    const SKIPS_ZEROS: bool = true;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::root_and_slope(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Energetic>, sum: &mut [F; 3]) {
        let [q, slope] = pair.weight;
        let (own, other) = (&pair.own, &pair.other);
        let mut g = own.gradient;
        for a in 0..3 {
            g[a] = own.gradient[a] - other.gradient[a];
        }
        if are_zero(g) {
            let both = slope * (own.slope + other.slope);
            for a in 0..3 {
                sum[a] = both.mul_add(pair.d[a], sum[a]);
            }
            return;
        }
        let along = K::curve_lanes(q) * dot(g, pair.d);
        let central = slope.mul_add(own.slope + other.slope, along);
        for a in 0..3 {
            sum[a] = central.mul_add(pair.d[a], slope.mul_add(g[a], sum[a]));
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}
