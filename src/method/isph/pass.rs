//! Pair sums of ISPH. Lengths in units of h, as in `method::pass`.

use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::pass::Moving;
use crate::method::projection::correction::{AXES, IDENTITY, inverse};
use crate::method::projection::look::{Local, Sums, complete, divergence};
use crate::payload;
use crate::space::lane::{Real, dot};
use crate::space::sparse::Couple;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

payload! {
    /// What [`Weights`] read.
    pub struct Coupled<F> {
        /// n, or rho / rho0.
        density: F,
        /// 1 / n.
        volume: F,
        /// c of a wall particle, Pa.
        offset: F,
    }
}

/// Weights of Eq. 8 in units of 2 m norm / (rho0^2 h^(d+2)): -W'/q / (n_a n_b) with the densities
/// n of `surface::Share`, and as printed -W'/q q^2 / (q^2 + 0.01) 4 rho0^2 / (rho_a + rho_b)^2
/// (eta = 0.1 h). Where the liquid is thin, its volumes are larger: weights that do not know make
/// the pressure too steep there, and a thin surface thinner.
///
/// Sums: w q^2; w c of the neighbours; w d (3); w c of the target.
pub struct Weights<K, const PRINTED: bool>(pub PhantomData<K>);

impl<K: Kernel, const PRINTED: bool> Couple<6> for Weights<K, PRINTED> {
    type Payload = Coupled;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Coupled>, sum: &mut [F; 6]) -> F {
        let slope = pair.weight[0];
        let zero = pair.q2.splat(0.0);
        let mut w = zero - slope;
        if PRINTED {
            let rho = pair.own.density + pair.other.density;
            let below = (pair.q2 + 0.01) * (rho * rho);
            w = w * pair.q2 * 4.0 / below;
        } else {
            w = w * (pair.own.volume * pair.other.volume);
        }
        w = w.if_less(zero, pair.q2);
        sum[0] = w.mul_add(pair.q2, sum[0]);
        sum[1] = w.mul_add(pair.other.offset, sum[1]);
        for a in 0..3 {
            sum[2 + a] = w.mul_add(pair.d[a], sum[2 + a]);
        }
        sum[5] = w.mul_add(pair.own.offset, sum[5]);
        w
    }
}

/// Fills [`Local`], its number with the kernel sum.
/// `CORRECTED`: divergence and L are those of corrected gradients, else L is the identity.
pub struct Look<'a, K, const CORRECTED: bool> {
    /// V norm / h^d and that over h.
    pub value: f64,
    /// What turns a sum of `slope d` into a gradient.
    pub gradient: f64,
    /// Kernel sum at rho0.
    pub full: f32,
    /// Axes along which anything varies.
    pub active: [bool; 3],
    /// Above 0 for particles near a surface, whose L is the identity.
    pub marks: &'a [f32],
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel, const CORRECTED: bool> Pass<20> for Look<'_, K, CORRECTED> {
    type Payload = Moving;
    type Out = Local;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 20]) {
        let [w, slope] = pair.weight;
        sum[0] += w;
        let (mut g, mut v) = (pair.d, pair.d);
        for a in 0..3 {
            g[a] = slope * pair.d[a];
            sum[1 + a] += g[a];
            v[a] = pair.other.velocity[a] - pair.own.velocity[a];
        }
        sum[19] = w.mul_add(dot(v, v), sum[19]);
        for (k, [a, b]) in AXES.into_iter().enumerate() {
            sum[4 + k] = g[a].mul_add(pair.d[b], sum[4 + k]);
        }
        for a in 0..3 {
            for b in 0..3 {
                sum[10 + 3 * a + b] = v[a].mul_add(g[b], sum[10 + 3 * a + b]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, s: [f32; 20], out: &mut Local) {
        out.kernel_sum = (self.value * (s[0] as f64 + K::w(0.0))) as f32;
        out.number = out.kernel_sum / self.full;
        out.stir = (s[19] / s[0].max(f32::MIN_POSITIVE)).sqrt();
        out.slope = [s[1], s[2], s[3]].map(|s| (self.gradient * s as f64) as f32);
        out.moment = std::array::from_fn(|k| (-self.value * s[4 + k] as f64) as f32);
        complete(&mut out.moment, self.active);
        out.correction = if CORRECTED && self.marks[target] == 0.0 {
            inverse(&out.moment)
        } else {
            IDENTITY
        };
        let divergence = divergence(&out.correction, &s[10..19]);
        out.divergence = (self.gradient * divergence) as f32;
    }
}

payload! {
    /// What [`PressureSlope`] reads.
    pub struct Pressed<F> {
        /// P, or P / rho^2 where Eq. 9 stands as printed.
        pressure: F,
    }
}

/// SUM slope (P_b +- P_a) d. `SYMMETRIC`: the sum, else the difference.
pub struct PressureSlope<K, const SYMMETRIC: bool>(pub PhantomData<K>);

impl<K: Kernel, const SYMMETRIC: bool> Pass<3> for PressureSlope<K, SYMMETRIC> {
    type Payload = Pressed;
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Pressed>, sum: &mut [F; 3]) {
        let slope = pair.weight[0];
        let p = if SYMMETRIC {
            pair.other.pressure + pair.own.pressure
        } else {
            pair.other.pressure - pair.own.pressure
        };
        let f = slope * p;
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum;
    }
}

/// What the explicit half of a step needs at r^n, and the viscous acceleration, m/s^2.
pub struct Around<K, V> {
    /// m norm / h^(d+1).
    pub factor: f64,
    /// The viscous part of a pair.
    pub viscosity: V,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel, V: PairViscosity> Pass<7> for Around<K, V> {
    type Payload = Moving;
    type Out = Sums<[f32; 3]>;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 7]) {
        let [w, slope] = pair.weight;
        sum[3] += w;
        let mut v = pair.d;
        for a in 0..3 {
            sum[4 + a] = slope.mul_add(pair.d[a], sum[4 + a]);
            v[a] = pair.own.velocity[a] - pair.other.velocity[a];
        }
        if V::PRESENT {
            let mut s = [sum[0], sum[1], sum[2]];
            let weight = pair.own.weight + pair.other.weight;
            self.viscosity
                .add(slope, pair.q2, pair.d, v, weight, &mut s);
            [sum[0], sum[1], sum[2]] = s;
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 7], out: &mut Sums<[f32; 3]>) {
        *out = Sums {
            own: [s[0], s[1], s[2]].map(|s| (self.factor * s as f64) as f32),
            kernel: s[3] + K::w(0.0) as f32,
            slope: [s[4], s[5], s[6]],
        };
    }
}
