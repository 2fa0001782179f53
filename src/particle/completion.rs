//! Kernel mass outside a free surface: the missing part of a particle's density.
//!
//! Model. A particle at depth delta under a free surface sums rho_i = SUM m W_ij over the liquid
//! only. If the liquid continued beyond the surface, it would add rho0 gamma,
//!
//! gamma(delta) = INT W(s) S(s) f(s) ds,                                                  (1)
//!
//! S(s) the area (length in 2-D) of the sphere of radius s about the particle and f(s) the part of
//! it that lies outside. For a surface of mean curvature kappa (a sphere of radius 1 / kappa) that
//! sphere cuts off
//!
//! mu = (delta - kappa (delta^2 + s^2) / 2) / ((1 - kappa delta) s),                      (2)
//! f = (1 - mu) / 2 in 3-D,  f = acos(mu) / pi in 2-D,                                    (3)
//!
//! exact for a plane (kappa = 0), sphere and disc, first order in the curvatures elsewhere. Free
//! faces of a block that meet combine as gamma = 1 - PROD (1 - gamma_k), exact in the corner and
//! far from it.
//!
//! Lengths are in units of the particle spacing. Tests: tests/engine/pack_completion.rs.

use super::ellipsoid;
use super::shape::{Face, Form, Region};
use crate::kernel::Kernel;
use crate::scene::input::PackInput;

/// Depths tabulated between -support and support.
const DEPTHS: usize = 512;
/// Curvatures tabulated between the least and the largest of an ellipsoid.
const CURVATURES: usize = 17;
/// Largest curvature, 1 / spacing: (2) is of first order in it, and no spacing resolves a sharper
/// rim. Flat ellipsoids with rims above about 1 could not be packed.
pub const SHARPEST: f64 = 0.8;
/// Intervals of the quadrature (1) over s.
const INTERVALS: usize = 400;

/// gamma and its gradient everywhere in a region.
#[derive(Clone, Debug)]
pub struct Completion {
    region: Region,
    support: f64,
    /// Least curvature and the step to the next.
    curvature: [f64; 2],
    /// `table[curvature][depth] = [gamma, d gamma / d delta]`.
    table: Vec<Vec<[f64; 2]>>,
}

/// Whether a body has rims that are sharper than [`SHARPEST`].
pub fn is_sharp(input: &PackInput) -> bool {
    match Region::new(input).form {
        Form::Block { .. } => false,
        Form::Ellipsoid { semi_axes } => {
            let (_, most) = ellipsoid::curvatures(input.dimension, semi_axes);
            most * input.spacing > SHARPEST
        }
    }
}

impl Completion {
    /// For kernel `K` of smoothing length `h`; `region` and `h` in units of the spacing.
    pub fn new<K: Kernel>(region: &Region, h: f64) -> Self {
        let (least, most) = match &region.form {
            Form::Block { .. } => (0.0, 0.0),
            Form::Ellipsoid { semi_axes } => ellipsoid::curvatures(region.dimension, *semi_axes),
        };
        let [least, most] = [least, most].map(|kappa: f64| kappa.min(SHARPEST));
        let rows = if most - least > 1e-9 { CURVATURES } else { 1 };
        let step = (most - least) / (CURVATURES - 1) as f64;
        let dimension = region.dimension.count();
        let table = (0..rows)
            .map(|k| tabulate::<K>(dimension, h, least + k as f64 * step))
            .collect();
        Completion {
            region: region.clone(),
            support: 2.0 * h,
            curvature: [least, step],
            table,
        }
    }

    /// gamma at `x` and its gradient, 1 / spacing.
    pub fn at(&self, x: [f64; 3]) -> (f64, [f64; 3]) {
        match &self.region.form {
            Form::Ellipsoid { semi_axes } => {
                let found = ellipsoid::nearest(self.region.dimension, *semi_axes, x, self.support);
                match found {
                    None => (0.0, [0.0; 3]),
                    Some(surface) => {
                        let [gamma, slope] = self.look_up(surface.depth, surface.curvature);
                        (gamma, surface.normal.map(|n| -slope * n))
                    }
                }
            }
            Form::Block { low, high, face } => {
                let mut kept = 1.0;
                let mut log_slope = [0.0; 3];
                for &k in self.region.axes() {
                    for (side, depth, outward) in
                        [(0, x[k] - low[k], -1.0), (1, high[k] - x[k], 1.0)]
                    {
                        if face[k][side] == Face::Free && depth < self.support {
                            let [gamma, slope] = self.look_up(depth, 0.0);
                            let inside = (1.0 - gamma).max(1e-9);
                            kept *= inside;
                            log_slope[k] -= slope * outward / inside;
                        }
                    }
                }
                (1.0 - kept, log_slope.map(|l| l * kept))
            }
        }
    }

    /// Linear interpolation in both directions.
    fn look_up(&self, depth: f64, curvature: f64) -> [f64; 2] {
        let at = (depth / self.support + 1.0) * 0.5 * (DEPTHS - 1) as f64;
        let at = at.clamp(0.0, (DEPTHS - 1) as f64 - 1e-9);
        let (i, u) = (at as usize, at.fract());
        let row = |k: usize| {
            let [a, b] = [self.table[k][i], self.table[k][i + 1]];
            [0, 1].map(|c| a[c] + u * (b[c] - a[c]))
        };
        if self.table.len() == 1 {
            return row(0);
        }
        let at = (curvature - self.curvature[0]) / self.curvature[1];
        let at = at.clamp(0.0, (CURVATURES - 1) as f64 - 1e-9);
        let (k, u) = (at as usize, at.fract());
        let [a, b] = [row(k), row(k + 1)];
        [0, 1].map(|c| a[c] + u * (b[c] - a[c]))
    }
}

/// One curvature's table over depths.
fn tabulate<K: Kernel>(dimension: usize, h: f64, curvature: f64) -> Vec<[f64; 2]> {
    let step = 4.0 * h / (DEPTHS - 1) as f64;
    let depth = |i: usize| -2.0 * h + i as f64 * step;
    let gamma = |depth: f64| outside::<K>(dimension, h, depth, curvature);
    (0..DEPTHS)
        .map(|i| {
            let d = depth(i);
            let slope = (gamma(d + 0.5 * step) - gamma(d - 0.5 * step)) / step;
            [gamma(d), slope]
        })
        .collect()
}

/// Kernel mass outside the surface, by midpoints.
fn outside<K: Kernel>(dimension: usize, h: f64, depth: f64, curvature: f64) -> f64 {
    let ds = 2.0 * h / INTERVALS as f64;
    let mut sum = 0.0;
    let mut whole = 0.0;
    for i in 0..INTERVALS {
        let s = (i as f64 + 0.5) * ds;
        let weight = K::w(s / h) * s.powi(dimension as i32 - 1);
        // (2); beyond the centre of a small sphere the denominator vanishes
        let scale = ((1.0 - curvature * depth) * s).max(1e-12);
        let mu = (depth - 0.5 * curvature * (depth * depth + s * s)) / scale;
        let mu = mu.clamp(-1.0, 1.0);
        let fraction = match dimension {
            2 => mu.acos() / std::f64::consts::PI,
            _ => 0.5 * (1.0 - mu),
        };
        sum += weight * fraction;
        whole += weight;
    }
    sum / whole
}
