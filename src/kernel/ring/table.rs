//! Tables of a function of distance, averaged over the angle between the points of two circles.

use super::super::{Kernel, WendlandC2};
use crate::space::lane::Real;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Nodes of the table, in q and in 1 / (1 + sqrt(p)), and of that for a ring and itself.
const ACROSS: usize = 160;
const ALONG: usize = 128;
const OWN: usize = 1024;

/// Points of the mean over the angle.
const POINTS: usize = 400;

/// F and its derivatives by y and p, each times what makes it smooth in the table.
pub struct Table {
    /// F / s, F_y / s, F_p / s^3.
    pub first: Vec<[f32; 4]>,
    /// F_yy q / s, F_yp z / s^2, F_pp z / s^4, z = sqrt(y + p).
    pub second: Vec<[f32; 4]>,
    /// F / s, F_p / s^3, F_pp / s^5, F_y / s at y = 0.
    pub own: Vec<[f64; 4]>,
    /// Whether it is that of Wendland's kernel, which far circles need not look up.
    pub is_fitted: bool,
}

/// That of Wendland C2.
pub static WENDLAND: LazyLock<Table> = LazyLock::new(Table::of_wendland);

/// A function of the distance in h, and its first and second derivatives by the square of that.
fn wendland(apart: f64) -> [f64; 3] {
    let t = (1.0 - 0.5 * apart).max(0.0);
    let [slope, curve] = [-2.5 * t * t * t, 1.875 * t * t / apart];
    [WendlandC2::w(apart), slope, curve]
}

/// F, F_y, F_p, F_yy, F_yp, F_pp of (1) for Wendland's kernel.
pub fn mean(q: f64, p: f64) -> [f64; 6] {
    mean_of(&wendland, q, p)
}

/// The same of any function, by the midpoint rule, which ends with the support.
fn mean_of(function: &impl Fn(f64) -> [f64; 3], q: f64, p: f64) -> [f64; 6] {
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
        let [value, slope, curve] = function(apart);
        let of = [
            value,
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

/// p at a node, and s.
fn node(place: f64) -> [f64; 2] {
    let p = (1.0 / place.max(1e-3) - 1.0).powi(2);
    [p, 1.0 / (1.0 + p).sqrt()]
}

impl Table {
    fn of_wendland() -> Self {
        Table {
            is_fitted: true,
            ..Table::of(&wendland, 0.0)
        }
    }

    /// Of any function. Of a ring itself, what is nearer than `apart` h is left out.
    pub fn of(function: &impl Fn(f64) -> [f64; 3], apart: f64) -> Self {
        let (mut first, mut second) = (Vec::new(), Vec::new());
        for j in 0..=ALONG {
            let [p, s] = node(j as f64 / ALONG as f64);
            for i in 0..=ACROSS {
                let q = (2.0 * i as f64 / ACROSS as f64).max(1e-6);
                let [f, fy, fp, fyy, fyp, fpp] = mean_of(function, q, p);
                let z = (q * q + p).sqrt();
                first.push([f / s, fy / s, fp / s.powi(3), 0.0].map(|x| x as f32));
                let second_of = [fyy * q / s, fyp * z / (s * s), fpp * z / s.powi(4), 0.0];
                second.push(second_of.map(|x| x as f32));
            }
        }
        let others = |distance: f64| match distance < apart {
            true => [0.0; 3],
            false => function(distance),
        };
        let own = (0..=OWN).map(|j| {
            let [p, s] = node(j as f64 / OWN as f64);
            let [f, fy, fp, _, _, fpp] = mean_of(&others, 1e-9, p.max(1e-9));
            [f / s, fp / s.powi(3), fpp / s.powi(5), fy / s]
        });
        Table {
            first,
            second,
            own: own.collect(),
            is_fitted: false,
        }
    }

    /// The entries of a ring and itself at a `radius` in h, and s.
    #[inline(always)]
    pub fn alone(&self, radius: f64) -> ([f64; 4], f64) {
        let s = 1.0 / (1.0 + radius * radius).sqrt();
        let place = OWN as f64 / (1.0 + radius);
        let j = (place as usize).min(OWN - 1);
        let part = place - j as f64;
        let (low, high) = (&self.own[j], &self.own[j + 1]);
        let mut found = *low;
        for (found, high) in found.iter_mut().zip(high) {
            *found += part * (high - *found);
        }
        (found, s)
    }
}

/// The first three words of a table at q and p, bilinear.
#[inline(always)]
pub fn interpolated<F: Real>(table: &[[f32; 4]], q: F, p: F) -> [F; 3] {
    let across = q * (0.5 * ACROSS as f32);
    let along = q.splat(ALONG as f32) / (p.sqrt() + 1.0);
    across.look_up(along, table, ACROSS + 1)
}
