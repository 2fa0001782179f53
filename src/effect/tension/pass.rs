//! Pair sums of the surface tension; numbers as in [`super`].

use crate::kernel::Kernel;
use crate::space::lane::Lanes;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// SUM w: (1).
pub struct Volume<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<1> for Volume<K> {
    type Out = f32;
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 1]) {
        unsafe {
            sum[0] = L::add(sum[0], K::w_lanes::<L>(L::sqrt(pair.q2)));
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// SUM V_b w: (2). Payload 0: V.
pub struct Colour<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<1> for Colour<K> {
    type Out = f32;
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 1]) {
        unsafe {
            let w = K::w_lanes::<L>(L::sqrt(pair.q2));
            sum[0] = L::fma(pair.other[0], w, sum[0]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// SUM (c_b - c_a) slope d: (3), then SUM slope d. Payload 0: c.
pub struct Difference<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<6> for Difference<K> {
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 6]) {
        unsafe {
            let slope = K::slope_lanes::<L>(L::sqrt(pair.q2));
            let f = L::mul(slope, L::sub(pair.other[0], pair.own[0]));
            for a in 0..3 {
                sum[a] = L::fma(f, pair.d[a], sum[a]);
                sum[3 + a] = L::fma(slope, pair.d[a], sum[3 + a]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 6], out: &mut Self::Out) {
        *out = ([s[0], s[1], s[2]], [s[3], s[4], s[5]]);
    }
}

/// What the neighbours' stress adds to the acceleration, (5) without the own stress:
/// T_b / rho^2 = |u|^2 I - u u. Payload: u.
#[derive(Clone, Copy)]
pub struct Summed<K> {
    pub factor: f64,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<3> for Summed<K> {
    type Out = [f32; 3];
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 3]) {
        unsafe {
            let slope = K::slope_lanes::<L>(L::sqrt(pair.q2));
            let u = [pair.other[0], pair.other[1], pair.other[2]];
            let along = L::mul(L::sub(L::splat(0.0), slope), L::dot(u, pair.d));
            let size = L::mul(slope, L::dot(u, u));
            for c in 0..3 {
                sum[c] = L::fma(size, pair.d[c], L::fma(along, u[c], sum[c]));
            }
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}

/// The same for stresses of any shape. Payload: T / rho^2 as in [`super::stressed`].
pub struct Tensor<K>(pub Summed<K>);

impl<K: Kernel> Pass<3> for Tensor<K> {
    type Out = [f32; 3];
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 3]) {
        unsafe {
            let slope = K::slope_lanes::<L>(L::sqrt(pair.q2));
            let [xx, yy, zz, yz, xz, xy] = pair.other;
            for (c, row) in [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
                .iter()
                .enumerate()
            {
                sum[c] = L::fma(slope, L::dot(*row, pair.d), sum[c]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        self.0.finish(target, sum, out);
    }
}

/// The whole pair force (5) before its factor.
#[inline(always)]
unsafe fn stress<K: Kernel, L: Lanes>(pair: &Pair<L>) -> [L::F; 3] {
    unsafe {
        let slope = K::slope_lanes::<L>(L::sqrt(pair.q2));
        let d = pair.d;
        let a = [pair.own[0], pair.own[1], pair.own[2]];
        let b = [pair.other[0], pair.other[1], pair.other[2]];
        let s = L::add(L::dot(a, a), L::dot(b, b));
        let (ad, bd) = (L::dot(a, d), L::dot(b, d));
        let mut force = d;
        for c in 0..3 {
            let stress = L::sub(L::mul(s, d[c]), L::fma(b[c], bd, L::mul(a[c], ad)));
            force[c] = L::mul(slope, stress);
        }
        force
    }
}

/// The whole pair force as an acceleration. Payload: u.
pub struct Whole<K>(pub Summed<K>);

impl<K: Kernel> Pass<3> for Whole<K> {
    type Out = [f32; 3];
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 3]) {
        unsafe {
            let force = stress::<K, L>(pair);
            for c in 0..3 {
                sum[c] = L::add(sum[c], force[c]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        self.0.finish(target, sum, out);
    }
}

/// Tangential over (d-1) minus normal virial, about the normal of the surface at the target: that
/// of the colour is noisy, and takes some per cent of the one for the other. Own: u, normal.
pub struct Virial<K> {
    /// 1 / (d-1).
    pub scale: f32,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<1> for Virial<K> {
    type Out = f64;
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 1]) {
        unsafe {
            let force = stress::<K, L>(pair);
            let n = [pair.own[3], pair.own[4], pair.own[5]];
            let normal = L::mul(L::dot(n, pair.d), L::dot(n, force));
            let tangential = L::sub(L::dot(pair.d, force), normal);
            let part = L::sub(L::mul(tangential, L::splat(self.scale)), normal);
            sum[0] = L::add(sum[0], part);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f64) {
        *out = sum[0] as f64;
    }
}

/// (2) of [`super::energy`]. Payload: e', then g / H.
pub(super) struct Pull<K> {
    pub factor: f64,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<3> for Pull<K> {
    type Out = [f32; 3];
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 3]) {
        unsafe {
            let q = L::sqrt(pair.q2);
            let (slope, curve) = (K::slope_lanes::<L>(q), K::curve_lanes::<L>(q));
            let g = [1, 2, 3].map(|k| L::sub(pair.own[k], pair.other[k]));
            let along = L::mul(curve, L::dot(g, pair.d));
            let central = L::fma(slope, L::add(pair.own[0], pair.other[0]), along);
            for a in 0..3 {
                sum[a] = L::fma(central, pair.d[a], L::fma(slope, g[a], sum[a]));
            }
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}
