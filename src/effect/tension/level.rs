//! The tension at the surface itself, although the stress acts below it.
//!
//! A stress in a layer at the mean depth z_s pulls on a surface that is smaller, and the liquid
//! above it feels no pressure; and |n|^2 grows where the liquid is convex. Together the pressure in
//! a drop comes out as
//! (1) p = sigma tr B (1 + e / R),  e = z_s + (d - 1) b,
//! B the curvature tensor of the surface (1/R in the tangent plane for a sphere), 17 % too high at
//! R = 20 s0 in 3-D with H = 2.6 s0. The stress that a surface with sigma, carried down along its
//! normals, leaves at z_s, over what |n|^2 adds, mends it:
//! (2) T = |T| (P + b tr(B_s) P + z_s B_s)^-1 in the tangent plane,  P = I - nn,
//! B_s the curvature where the stress acts. To first order the normal force is then sigma tr B, the
//! pressure of R, and the tangential div T = -sigma z_s grad tr B (Codazzi) what the gradient of
//! the pressure would do to a layer of depth z_s: both are needed for the period of a drop. The
//! inverse stays positive in the thinnest jet. What is left of (1) is below 1.5 % from R = 8 s0 on.
//! (3) B_a = (d - 1) SUM w sym(t d_t) / (H SUM w |d_t|^2),  w = -slope max(0, u_a . u_b),
//! u the unit normals, d_t and t the parts of d and of u_b - u_a in the tangent plane: the
//! least-squares slope of the normals along the surface. Normals that point apart belong to another
//! surface, that across a sheet.
//! Walls with a contact angle keep the stress where it acts; where a contact line is curved,
//! b tr(B) is taken from theirs too (`super::walled`).
//! Fails where the surface bends within z_s inwards (a cusp): the bracket in (2) is at least 1/2.
//! Tests: tests/engine/effect_level.rs, tests/validation/drop.rs.

use super::Tension;
use super::stressed::Stressed;
use crate::effect::depth::depths;
use crate::effect::normal::Root;
use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::space::lane::{Real, dot};
use crate::space::mirror::PAIRS;
use crate::space::parallel::each_mut;
use crate::space::sweep::{self, Pair, Pass};
use std::marker::PhantomData;

/// Sums of (3): t d_t as xx, yy, zz, yz, xz, xy, and |d_t|^2; in units of the weights.
pub type Bend = [f32; 7];

impl Tension {
    /// The stress (2) of every stressed particle, in place of that of its root.
    pub(super) fn lift<K: Kernel>(&mut self, flow: &Surface) {
        let mut bends = std::mem::take(&mut self.bends);
        let targets = &self.stressed.index;
        bends.resize(targets.len(), Bend::default());
        let sources = self.stressed.sources();
        let field = self.field(flow, self.length);
        let field = self.stressed.field(field, &sources, &self.stressed.u);
        sweep::runs(field, targets, &Curvature::<K>(PhantomData), &mut bends);
        let Stressed { u, stress, .. } = &mut self.stressed;
        stress.iter_mut().for_each(|s| s.resize(u[0].len(), 0.0));
        let [xx, yy, zz, yz, xz, xy] = stress.each_mut().map(|s| &mut s[..bends.len()]);
        let depths = depths(self.kernel, self.dimension);
        each_mut((xx, yy, zz, yz, xz, xy), |k, (xx, yy, zz, yz, xz, xy)| {
            let root = [0, 1, 2].map(|a| u[a][k] as f64);
            let lifted = lifted(root, &bends[k], depths, self.dimension);
            [*xx, *yy, *zz, *yz, *xz, *xy] = lifted.map(|c| c as f32);
        });
        self.stressed.turn_stress();
        self.bends = bends;
    }
}

/// H B from the sums of (3): xx, yy, zz, yz, xz, xy.
pub(super) fn curvature(bend: &Bend, dimension: usize) -> [f64; 6] {
    let scale = (dimension as f64 - 1.0) / (bend[6] as f64).max(f64::MIN_POSITIVE);
    std::array::from_fn(|c| scale * bend[c] as f64)
}

/// (2) over rho^2, from the root of |T| / rho^2 and the sums of (3).
fn lifted(root: [f64; 3], bend: &Bend, [z, b]: [f64; 2], dimension: usize) -> [f64; 6] {
    let squared: f64 = root.iter().map(|u| u * u).sum();
    let n = root.map(|u| u / squared.sqrt().max(f64::MIN_POSITIVE));
    let unit = PAIRS.map(|(a, b)| f64::from(u8::from(a == b)));
    let tangent: [f64; 6] = std::array::from_fn(|c| unit[c] - n[PAIRS[c].0] * n[PAIRS[c].1]);
    let planar = dimension == 2;
    let bend = curvature(bend, dimension);
    let trace = bend[0] + bend[1] + bend[2];
    if planar {
        // Across the plane there is no stress.
        let size = squared / (1.0 + ((z + b) * trace).max(LEAST));
        return std::array::from_fn(|c| size * (tangent[c] - f64::from(u8::from(c == 1))));
    }
    // z B = mean P + rest, the eigenvalues of rest +- spread.
    let mean = 0.5 * z * trace;
    let rest: [f64; 6] = std::array::from_fn(|c| z * bend[c] - mean * tangent[c]);
    let square = (0..6).map(|c| rest[c] * rest[c] * [1.0, 2.0][c / 3]);
    let spread = (0.5 * square.sum::<f64>()).sqrt();
    let mean = mean + b * trace;
    let [high, low] = [mean - spread, mean + spread].map(|b| 1.0 / (1.0 + b.max(LEAST)));
    let slope = (low - high) / (2.0 * spread).max(f64::MIN_POSITIVE);
    std::array::from_fn(|c| squared * (0.5 * (high + low) * tangent[c] + slope * rest[c]))
}

/// The least curvature that counts, as a part of the bracket in (2).
pub(super) const LEAST: f64 = -0.5;

/// Sums of (3).
pub(super) struct Curvature<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<7> for Curvature<K> {
    type Payload = Root;
    type Out = Bend;
    #[inline(always)]
    fn own(&self, _: usize, own: Root) -> Root {
        own.unit()
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Root>, sum: &mut [F; 7]) {
        let zero = pair.q2.splat(0.0);
        let (a, b, d) = (pair.own.u, pair.other.u, pair.d);
        let size = dot(b, b).sqrt().max(pair.q2.splat(f32::MIN_POSITIVE));
        let along = dot(a, b) / size;
        let slope = K::slope_lanes(pair.q2.sqrt());
        let w = zero - slope * along.max(zero);
        let height = dot(a, d);
        let (mut t, mut across) = (d, d);
        for c in 0..3 {
            t[c] = w * (b[c] / size - along * a[c]);
            across[c] = d[c] - height * a[c];
        }
        for (c, (i, j)) in PAIRS.into_iter().enumerate() {
            let product = if i == j {
                t[i] * across[i]
            } else {
                let both = t[i].mul_add(across[j], t[j] * across[i]);
                both * 0.5
            };
            sum[c] += product;
        }
        sum[6] = w.mul_add(dot(across, across), sum[6]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 7], out: &mut Bend) {
        *out = sum;
    }
}
