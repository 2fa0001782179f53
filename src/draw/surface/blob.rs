//! What a particle adds to the field: an ellipsoid that is flat along a surface, long along a
//! ligament, round elsewhere (Yu & Turk 2013, "Reconstructing surfaces of particle-based fluids
//! using anisotropic kernels").
//!
//! (1) `C = sum w (x_j - m)(x_j - m)^T / sum w`, `m = sum w x_j / sum w`, `w = 1 - (r/R)^3`
//! (2) `V(x) = s0^3 W(|G (x - x_i)|) det G`, `G = Q diag(1 / (h s_k)) Q^T`, `C = Q diag(l_k) Q^T`
//!
//! with s_k proportional to sqrt(l_k), at least a quarter of the largest, `s_1 s_2 s_3 = 1`, so
//! that each particle adds its volume whatever its form. Particles with few neighbours have
//! narrower and stronger kernels, so that a single one has a surface, about that of its volume.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use rayon::prelude::*;

use super::near::Near;
use super::points::Points;
use crate::draw::smooth_step;
use crate::scene::{Domain, Side};

/// Smoothing length of a particle inside, spacings.
const SMOOTHING: f32 = 1.3;
/// R of (1), spacings.
pub(super) const REACH: f32 = 2.5;
/// Part of the particles of a full cell, REACH wide, that each cell about a particle deep inside
/// has: a surface is then two spacings away at least, beyond which no ellipsoid is flat.
const CROWDED: f32 = 0.8;
/// Largest ratio of two axes of an ellipsoid.
const RATIO: f32 = 4.0;
/// Largest extent of an ellipsoid, spacings: 2 h times the longest axis, `RATIO^(2/3)`.
pub(super) const EXTENT: f32 = 6.6;
/// Sum of w of (1) inside: `2 pi R^3 / 3`, in particles.
const FULL: f32 = 2.0 * std::f32::consts::PI * REACH * REACH * REACH / 3.0;

/// (2): `strength * (1 - q/2)^4 (1 + 2 q)`, `q = |inverse (x - centre)| < 2`.
pub(super) struct Blob {
    pub centre: Vector3<f32>,
    pub inverse: Matrix3<f32>,
    pub strength: f32,
    /// Half of the sides of its bounding box, m.
    pub extent: Vector3<f32>,
    /// Of a ring: the number of its turned kernels in half a turn; else 0.
    pub turns: usize,
}

/// The blobs of all points, in their order: an image has that of its particle, mirrored.
/// `position`: of the particles, m.
pub(super) fn blobs(
    points: &Points,
    domain: &Domain,
    position: &[Vec<f32>; 3],
    spacing: f32,
    is_flat: bool,
) -> Vec<Blob> {
    let all = points.at.par_iter().zip(&points.source);
    if is_flat {
        let round = |p: &Vector3<f32>| Blob::round(*p, SMOOTHING * spacing, flat_strength());
        return all.map(|(p, _)| round(p)).collect();
    }
    // Far from surfaces nothing is to be looked for.
    let crowded = points.crowded(CROWDED * REACH.powi(3));
    let mut is_there = vec![false; position[0].len()];
    for source in &points.source {
        is_there[*source as usize] = true;
    }
    let own: Vec<Blob> = (0..position[0].len())
        .into_par_iter()
        .map_init(Near::default, |near, i| {
            let p = Vector3::from([0, 1, 2].map(|a| position[a][i]));
            match !is_there[i] || crowded[points.place(&p)] {
                true => Blob::round(p, SMOOTHING * spacing, strength(SMOOTHING)),
                false => Blob::new(near, points, p, spacing, |_| 1.0),
            }
        })
        .collect();
    all.map(|(p, source)| own[*source as usize].at(domain, *p))
        .collect()
}

/// Of a kernel in the plane: `7 / (4 pi h^2)`.
fn flat_strength() -> f32 {
    7.0 / (4.0 * std::f32::consts::PI * SMOOTHING.powi(2))
}

/// Of a kernel in space: `21 / (16 pi h^3)`.
fn strength(smoothing: f32) -> f32 {
    21.0 / (16.0 * std::f32::consts::PI * smoothing.powi(3))
}

impl Blob {
    fn round(centre: Vector3<f32>, h: f32, strength: f32) -> Blob {
        Blob {
            centre,
            inverse: Matrix3::from_diagonal_element(1.0 / h),
            strength,
            extent: Vector3::repeat(2.0 * h),
            turns: 0,
        }
    }

    /// That of the image at `p`: mirrored in each wall that is between.
    fn at(&self, domain: &Domain, p: Vector3<f32>) -> Blob {
        let sign = [0, 1, 2].map(|a| {
            let side = domain.boundary[a][usize::from(p[a] > self.centre[a])];
            match p[a] != self.centre[a] && side != Side::Periodic {
                true => -1.0,
                false => 1.0,
            }
        });
        Blob {
            centre: p,
            inverse: Matrix3::from_fn(|i, j| sign[i] * sign[j] * self.inverse[(i, j)]),
            ..*self
        }
    }

    /// `volume`: of a point, by its source, in cubes of the spacing.
    pub fn new(
        near: &mut Near,
        points: &Points,
        own: Vector3<f32>,
        spacing: f32,
        volume: impl Fn(u32) -> f32,
    ) -> Blob {
        let reach = REACH * spacing;
        let (mut weight, mut first) = (0.0, Vector3::zeros());
        near.find(points, &own, reach, volume);
        for (d, w) in &near.found {
            weight += w;
            first += *w * d;
        }
        let mean = first / weight;
        let fullness = weight / FULL;
        if fullness > 0.85 && mean.norm() < 0.03 {
            return Blob::round(own, SMOOTHING * spacing, strength(SMOOTHING));
        }
        let mut second = Matrix3::zeros();
        for (d, w) in &near.found {
            second += *w * d * d.transpose();
        }
        let part = smooth_step(0.03, 0.30, fullness);
        let smoothing = SMOOTHING * (0.62 + 0.38 * part);
        let boost = 1.0 + 1.6 * (1.0 - smooth_step(0.03, 0.12, fullness));
        let eigen = SymmetricEigen::new(second / weight - mean * mean.transpose());
        let axes = eigen.eigenvalues.map(|l| l.max(0.0).sqrt());
        // Too few neighbours have no shape.
        let round = 0.6 * (1.0 - smooth_step(0.03, 0.10, fullness)) + 1e-3;
        let longest = axes.max() + round;
        let axes = axes.map(|a| ((a + round) / longest).max(1.0 / RATIO));
        let axes = axes / axes.product().cbrt();
        let h = smoothing * spacing;
        let turn = eigen.eigenvectors;
        let inverse =
            turn * Matrix3::from_diagonal(&axes.map(|a| 1.0 / (h * a))) * turn.transpose();
        let extent = [0, 1, 2].map(|a| {
            let row = turn.row(a).transpose().component_mul(&axes);
            2.0 * h * row.norm()
        });
        Blob {
            centre: own,
            inverse,
            strength: boost * strength(smoothing),
            extent: extent.into(),
            turns: 0,
        }
    }
}
