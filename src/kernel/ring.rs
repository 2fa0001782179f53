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
//! Far from the axis (p > [`FAR`]^2) the circles are almost straight lines:
//! (3) F = (M_0 + M_1 / (8 p)) / (2 pi sqrt(p)),  M_k(y) = INT w(sqrt(y + t^2)) t^2k dt;
//!     what is left out is below 1e-6 of it. M_k is u^(4.5 + k) times a polynomial in q,
//!     u = 1 - q^2 / 4, fitted by least squares to it and to its derivative.
//! Elsewhere (1) is interpolated in a table of q and 1 / (1 + sqrt(p)), times powers of
//! s = 1 / sqrt(1 + p).
//! Tests: tests/engine/ring.rs.

use super::{Kernel, WendlandC2};
use crate::space::lane::{Real, WIDTH};
use crate::space::sweep::{Pair, Payload};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Radius in h beyond which (3) holds: the partner of a ring is at most 2 nearer to the axis.
pub const FAR: f32 = 12.0;

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

/// Nodes of the table, in q and in 1 / (1 + sqrt(p)), and of that for a ring and itself.
const ACROSS: usize = 160;
const ALONG: usize = 128;
const OWN: usize = 1024;

/// Least q where second derivatives are divided by it.
const TINY: f32 = 1e-3;

/// Points of the mean over the angle.
const POINTS: usize = 400;

/// F and its derivatives by y and p, each times what makes it smooth in the table.
struct Table {
    /// F / s, F_y / s, F_p / s^3.
    first: Vec<[f32; 4]>,
    /// F_yy q / s, F_yp z / s^2, F_pp z / s^4, z = sqrt(y + p).
    second: Vec<[f32; 4]>,
    /// F / s, F_p / s^3, F_pp / s^5 at y = 0.
    own: Vec<[f64; 3]>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

/// F, F_y, F_p, F_yy, F_yp, F_pp of (1) by the midpoint rule, which ends with the support.
pub fn mean(q: f64, p: f64) -> [f64; 6] {
    let y = q * q;
    let reach = (4.0 - y).max(0.0) / (4.0 * p.max(1e-30));
    let end = match reach < 1.0 {
        true => 2.0 * reach.sqrt().asin(),
        false => PI,
    };
    let mut sums = [0.0; 6];
    for k in 0..POINTS {
        // Points crowd at f = 0, where a ring that is near itself needs them.
        let x = (k as f64 + 0.5) / POINTS as f64;
        let (f, part) = (end * x * x, end * 2.0 * x / POINTS as f64 / PI);
        let chord = 4.0 * (0.5 * f).sin().powi(2);
        let apart = (y + p * chord).sqrt().max(1e-9);
        let t = (1.0 - 0.5 * apart).max(0.0);
        let (slope, curve) = (-2.5 * t * t * t, 1.875 * t * t / apart);
        let of = [
            WendlandC2::w(apart),
            slope,
            slope * chord,
            curve,
            curve * chord,
            curve * chord * chord,
        ];
        for (sum, of) in sums.iter_mut().zip(of) {
            *sum += of * part;
        }
    }
    sums
}

impl Table {
    fn new() -> Self {
        let p_of = |place: f64| (1.0 / place.max(1e-3) - 1.0).powi(2);
        let scale = |p: f64| 1.0 / (1.0 + p).sqrt();
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for j in 0..=ALONG {
            let p = p_of(j as f64 / ALONG as f64);
            let s = scale(p);
            for i in 0..=ACROSS {
                let q = (2.0 * i as f64 / ACROSS as f64).max(1e-6);
                let [f, fy, fp, fyy, fyp, fpp] = mean(q, p);
                let z = (q * q + p).sqrt();
                first.push([f / s, fy / s, fp / s.powi(3), 0.0].map(|x| x as f32));
                let second_of = [fyy * q / s, fyp * z / (s * s), fpp * z / s.powi(4), 0.0];
                second.push(second_of.map(|x| x as f32));
            }
        }
        let own = (0..=OWN).map(|j| {
            let p = p_of(j as f64 / OWN as f64).max(1e-9);
            let s = scale(p);
            let [f, _, fp, _, _, fpp] = mean(1e-9, p);
            [f / s, fp / s.powi(3), fpp / s.powi(5)]
        });
        Table {
            first,
            second,
            own: own.collect(),
        }
    }
}

/// The kernel of rings, ready to be evaluated.
#[derive(Clone, Copy)]
pub struct Rings(&'static Table);

impl Default for Rings {
    fn default() -> Self {
        Rings(&TABLE)
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
    /// F, F_y and F_p of (1) for eight pairs; `far`: whether (3) holds; zero for q >= 2.
    #[inline(always)]
    pub fn first<F: Real>(self, far: bool, q2: F, p: F) -> [F; 3] {
        let q = q2.sqrt().min(q2.splat(2.0));
        if far {
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

    /// F, F_p and F_pp of a ring and itself; `radius` in h.
    #[inline(always)]
    pub fn own(self, radius: f64) -> [f64; 3] {
        let s = 1.0 / (1.0 + radius * radius).sqrt();
        let place = OWN as f64 / (1.0 + radius);
        let j = (place as usize).min(OWN - 1);
        let part = place - j as f64;
        let (low, high) = (&self.0.own[j], &self.0.own[j + 1]);
        let at = |k: usize| low[k] + part * (high[k] - low[k]);
        [at(0) * s, at(1) * s.powi(3), at(2) * s.powi(5)]
    }
}

/// What a ring adds to its own sums.
#[derive(Clone, Copy)]
pub struct Own {
    /// F.
    pub value: f64,
    /// g_r of a pair of rings at the same place: r F_p.
    pub gradient: f64,
    /// F_p.
    pub turn: f64,
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
        let [value, turn, _] = self.rings.own(radius);
        Own {
            value,
            gradient: radius * turn,
            turn,
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

/// The first three columns of a table at q and p, bilinear.
#[inline(always)]
fn interpolated<F: Real>(table: &[[f32; 4]], q: F, p: F) -> [F; 3] {
    let across = q * (0.5 * ACROSS as f32);
    let along = q.splat(ALONG as f32) / (p.sqrt() + 1.0);
    let (across, along) = (across.to_array(), along.to_array());
    let mut found = [[0.0; WIDTH]; 3];
    for k in 0..WIDTH {
        let (i, j) = (
            (across[k] as usize).min(ACROSS - 1),
            (along[k] as usize).min(ALONG - 1),
        );
        let (u, v) = (across[k] - i as f32, along[k] - j as f32);
        let at = j * (ACROSS + 1) + i;
        let (low, high) = (&table[at..at + 2], &table[at + ACROSS + 1..at + ACROSS + 3]);
        for (c, found) in found.iter_mut().enumerate() {
            let below = low[0][c] + u * (low[1][c] - low[0][c]);
            let above = high[0][c] + u * (high[1][c] - high[0][c]);
            found[k] = below + v * (above - below);
        }
    }
    [
        q.of_array(found[0]),
        q.of_array(found[1]),
        q.of_array(found[2]),
    ]
}
