//! Kernels of rings: Wendland C2 in three dimensions, averaged over the angle between the points of
//! two circles about the axis.
//!
//! Points of rings a and b that are f apart in angle have d^2 = D^2 + 2 P (1 - cos f), with
//! D^2 = (r_a - r_b)^2 + (z_a - z_b)^2 and P = r_a r_b. In units of h, y = D^2 / h^2, p = P / h^2:
//! (1) W = norm / h^3 F(y, p),  F = 1/pi INT_0^pi w(sqrt(y + 2 p (1 - cos f))) df
//! (2) dW/dr_a = norm / h^4 (2 d_r F_y + r_b F_p),  dW/dr_b = norm / h^4 (-2 d_r F_y + r_a F_p),
//!     dW/dz_a = -dW/dz_b = norm / h^4 2 d_z F_y,  d = (r_a - r_b, z_a - z_b) / h, r in h
//! F is symmetric, its integral over rings is 1 everywhere, on the axis too, and a ring is its own
//! neighbour: that is what the curvature about the axis is seen by. No 1 / r appears.
//! Far from the axis (the target beyond [`FAR`]) the circles are almost straight lines:
//! (3) F = (M_0 + M_1 / (8 p)) / (2 pi sqrt(p)),  M_k(y) = INT w(sqrt(y + t^2)) t^2k dt;
//!     what is left out is below 1e-5 of F and F_y, 1e-4 of the rest, as what a table leaves out.
//!     M_k is u^(4.5 + k) times a polynomial in q, u = 1 - q^2 / 4, fitted by least squares to it
//!     and to its derivative.
//! Elsewhere, and for other functions of the distance, (1) is interpolated in a table of q and
//! 1 / (1 + sqrt(p)), times powers of s = 1 / sqrt(1 + p).
//! Tests: tests/engine/ring.rs.

mod table;

pub use table::mean;

use crate::space::lane::Real;
use crate::space::sweep::{Pair, Payload};
use table::{Table, WENDLAND, interpolated};

/// Radius in h beyond which (3) holds: the partner of a ring is at most 2 nearer to the axis.
pub const FAR: f32 = 6.0;

/// Coefficients of 1, q^2, q^3 ... of the polynomials of M_0 and M_1 in (3).
const M0: [f32; 10] = [
    1.333_335,
    -1.009_096_7,
    0.304_886_98,
    2.063_587_2,
    -4.984_62,
    6.444_17,
    -5.248_798_2,
    2.654_988_5,
    -0.758_578_5,
    0.093_300_94,
];
const M1: [f32; 7] = [
    0.380_952_67,
    -0.143_220_06,
    0.002_679_727_4,
    0.138_793_7,
    -0.139_451_16,
    0.062_567_63,
    -0.011_205_646,
];

/// Least q where second derivatives are divided by it.
const TINY: f32 = 1e-3;

/// The kernel of rings, ready to be evaluated.
#[derive(Clone, Copy)]
pub struct Rings(&'static Table);

impl Default for Rings {
    fn default() -> Self {
        Rings(&WENDLAND)
    }
}

/// a_0 + a_1 q^2 + a_2 q^3 + ..., and its first and second derivatives by y = q^2.
#[inline(always)]
fn polynomial<F: Real, const N: usize, const SECOND: bool>(a: &[f32; N], q: F, y: F) -> [F; 3] {
    let zero = q.splat(0.0);
    let (mut value, mut slope, mut curve) = (zero, zero, zero);
    let mut k = N - 1;
    while k >= 1 {
        let power = k as f32 + 1.0;
        value = value.mul_add(q, q.splat(a[k]));
        slope = slope.mul_add(q, q.splat(0.5 * power * a[k]));
        if SECOND && k >= 3 {
            curve = curve.mul_add(q, q.splat(0.25 * power * (power - 2.0) * a[k]));
        }
        k -= 1;
    }
    if SECOND {
        curve += q.splat(0.75 * a[2]) / q.at_least(TINY);
    }
    [value.mul_add(y, q.splat(a[0])), slope, curve]
}

/// M_k of (3) and its derivatives by y; `power`: 4.5 + k, `lower`: u^(power - 2).
#[inline(always)]
fn moment<F: Real, const SECOND: bool>(
    [value, slope, curve]: [F; 3],
    power: f32,
    u: F,
    lower: F,
) -> [F; 3] {
    let mid = lower * u;
    let first = u.mul_add(slope, value * (-0.25 * power));
    let second = match SECOND {
        true => {
            let of_value = value * (0.0625 * power * (power - 1.0));
            let rest = u.mul_add(curve, slope * (-0.5 * power));
            lower * u.mul_add(rest, of_value)
        }
        false => lower,
    };
    [mid * u * value, mid * first, second]
}

/// M_0 and M_1 / 8 of (3), with their derivatives by y.
#[inline(always)]
fn moments<F: Real, const SECOND: bool>(q: F, q2: F) -> [[F; 3]; 2] {
    let u = q2.mul_add(q.splat(-0.25), q.splat(1.0)).at_least(0.0);
    let lower = u * u * u.sqrt();
    let zeroth = moment::<F, SECOND>(polynomial::<F, 10, SECOND>(&M0, q, q2), 4.5, u, lower);
    let first = polynomial::<F, 7, SECOND>(&M1, q, q2);
    let first = moment::<F, SECOND>(first, 5.5, u, lower * u);
    [zeroth, first.map(|m| m * 0.125)]
}

impl Rings {
    /// Such that -2 F_y is the mean of a `weight` of the distance in h, that of points `apart` h
    /// from each other along a ring: it sees none of itself that is nearer than half of that. F and
    /// second derivatives are not found. What is made is kept to the end of the program.
    pub fn of_weight(weight: impl Fn(f64) -> f64, apart: f64) -> Self {
        let function = |distance: f64| [0.0, -0.5 * weight(distance), 0.0];
        Rings(Box::leak(Box::new(Table::of(&function, 0.5 * apart))))
    }

    /// F, F_y and F_p of (1) for eight pairs; `far`: whether (3) holds; zero for q >= 2.
    #[inline(always)]
    pub fn first<F: Real>(self, far: bool, q2: F, p: F) -> [F; 3] {
        let q = q2.sqrt().min(q2.splat(2.0));
        if far && self.0.is_fitted {
            let [m, n] = moments::<F, false>(q, q * q);
            // Lanes without a pair may have any p.
            let p = p.at_least(1.0);
            let (root, inverse) = (p.sqrt(), p.splat(1.0) / p);
            let scale = root * inverse * (0.5 / std::f32::consts::PI);
            let f = n[0].mul_add(inverse, m[0]);
            let fy = n[1].mul_add(inverse, m[1]);
            let fp = (n[0] * 1.5).mul_add(inverse, m[0] * 0.5);
            return [scale * f, scale * fy, q.splat(0.0) - scale * inverse * fp];
        }
        let s = p.splat(1.0) / (p + 1.0).sqrt();
        let [f, fy, fp] = interpolated(&self.0.first, q, p);
        [f * s, fy * s, fp * s * s * s]
    }

    /// F_yy, F_yp and F_pp, likewise.
    #[inline(always)]
    pub fn second<F: Real>(self, far: bool, q2: F, p: F) -> [F; 3] {
        let q = q2.sqrt().min(q2.splat(2.0));
        if far {
            let [m, n] = moments::<F, true>(q, q * q);
            // Lanes without a pair may have any p.
            let p = p.at_least(1.0);
            let (root, inverse) = (p.sqrt(), p.splat(1.0) / p);
            let scale = root * inverse * (0.5 / std::f32::consts::PI);
            let yy = n[2].mul_add(inverse, m[2]);
            let yp = (n[1] * 1.5).mul_add(inverse, m[1] * 0.5);
            let pp = (n[0] * 3.75).mul_add(inverse, m[0] * 0.75);
            let by_p = scale * inverse;
            return [scale * yy, q.splat(0.0) - by_p * yp, by_p * inverse * pp];
        }
        let s = p.splat(1.0) / (p + 1.0).sqrt();
        let [yy, yp, pp] = interpolated(&self.0.second, q, p);
        let z = q.mul_add(q, p).sqrt().at_least(TINY);
        let (s2, q) = (s * s, q.at_least(TINY));
        [yy * s / q, yp * s2 / z, pp * s2 * s2 / z]
    }

    /// F, F_p, F_pp and F_y of a ring and itself; `radius` in h.
    #[inline(always)]
    pub fn own(self, radius: f64) -> [f64; 4] {
        let ([f, fp, fpp, fy], s) = self.0.alone(radius);
        let s2 = s * s;
        [f * s, fp * (s * s2), fpp * (s * (s2 * s2)), fy * s]
    }
}

/// What a ring adds to its own sums.
#[derive(Clone, Copy)]
pub struct Own {
    /// F.
    pub value: f64,
    /// g_r of a pair of rings at the same place: r F_p.
    pub gradient: f64,
    /// r^2 F_pp.
    pub hoop: f64,
    /// F_y.
    pub slope: f64,
}

/// Distances of points from the axis: of liquid, then of walls, m.
#[derive(Clone, Copy)]
pub struct Radii<'a> {
    /// Of the liquid, m.
    pub liquid: &'a [f64],
    /// Of wall particles, m.
    pub wall: &'a [f64],
    /// Smoothing length, m.
    pub length: f64,
    /// The kernel.
    pub rings: Rings,
}

impl Radii<'_> {
    /// Of a record, in smoothing lengths.
    #[inline(always)]
    pub fn of(&self, target: usize) -> [f32; 3] {
        let radius = match target.checked_sub(self.liquid.len()) {
            None => self.liquid[target],
            Some(j) => self.wall[j],
        };
        [(radius / self.length) as f32, 0.0, 0.0]
    }

    /// Of a liquid ring and itself.
    pub fn own(&self, i: usize) -> Own {
        let radius = self.liquid[i] / self.length;
        let [value, turn, second, slope] = self.rings.own(radius);
        Own {
            value,
            gradient: radius * turn,
            hoop: radius * radius * second,
            slope,
        }
    }
}

/// The kernel of eight pairs and its derivatives, in units of norm / h^3.
pub struct Between<F> {
    /// F.
    pub value: F,
    /// F_y.
    pub slope: F,
    /// F_p.
    pub turn: F,
    /// g_r of the target and of the other; g_z of the target is that of the other turned round.
    pub radial: [F; 2],
    /// g_z of the target.
    pub axial: F,
}

/// Radii of a pair whose target has its own in `extra`, and whether it is far from the axis.
#[inline(always)]
pub fn places<F: Real, P: Payload>(pair: &Pair<F, P>) -> ([F; 2], bool) {
    let own = pair.extra[0];
    let other = (own - pair.d[0]).at_least(0.0);
    ([own, other], own.less_mask(own.splat(FAR)) == 0)
}

/// The mass of the other ring; none for padding, which is at the place of the target.
#[inline(always)]
pub fn mass_apart<F: Real>(mass: F, q2: F) -> F {
    mass.if_less(q2.splat(0.0), q2)
}

/// Of a pair whose target has its radius in `extra`.
#[inline(always)]
pub fn between<F: Real, P: Payload>(rings: Rings, pair: &Pair<F, P>) -> Between<F> {
    let ([own, other], is_far) = places(pair);
    let [value, slope, turn] = rings.first(is_far, pair.q2, own * other);
    let twice = slope * 2.0;
    let along = twice * pair.d[0];
    Between {
        value,
        slope,
        turn,
        radial: [
            other.mul_add(turn, along),
            own.mul_add(turn, own.splat(0.0) - along),
        ],
        axial: twice * pair.d[2],
    }
}
