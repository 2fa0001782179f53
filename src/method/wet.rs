//! Which part of a wall is wet. A wall particle takes its pressure from the liquid that it sees.
//! Beyond the edge of a drop it sees liquid on one side only, and would push the edge back: the
//! layer at the surface has pressures of some sigma / H, so that contact angles were too large by
//! the same at two spacings, whether lines advanced or receded (90 degrees: 94 with WCSPH and ISPH,
//! 93 with MPS). What a wall has of its pressure is
//! (1) f = (S / S_wet - 1/4) / (1/2), between 0 and 1,  S = SUM V W over the liquid
//! Test: tests/engine/projection_wall.rs.

use super::model::Case;
use crate::kernel;
use crate::particle::Wall;
use std::collections::HashMap;

/// A wall is dry up to this part of S_wet, and wet from all but this part on.
const DAMP: f32 = 0.25;

/// Strips of an integral over a half-space, and depths in h that are the same.
const STRIPS: usize = 64;
const LIKE: f64 = 1e-6;

/// f of (1) from S and S_wet.
pub fn part(seen: f32, whole: f32) -> f32 {
    ((seen / whole - DAMP) / (1.0 - 2.0 * DAMP)).clamp(0.0, 1.0)
}

/// S_wet of every wall particle: over a half-space, in a corner the product of those over two or
/// three.
pub fn full(case: &Case, wall: &Wall) -> Vec<f32> {
    let (wall, size) = (&wall.position, case.domain.size);
    let (kernel, dimension) = (case.sph.kernel, case.space);
    let half = |depth: f64| {
        let step = (2.0 - depth).max(0.0) / STRIPS as f64;
        let at = |k: usize| kernel::plane(kernel, dimension, depth + (k as f64 + 0.5) * step);
        step * (0..STRIPS).map(at).sum::<f64>()
    };
    // Layers are few and their depths the same everywhere.
    let mut known = HashMap::new();
    let mut seen = |depth: f64| {
        let layer = (depth / LIKE).round() as i64;
        *known.entry(layer).or_insert_with(|| half(depth))
    };
    let of = |j: usize| {
        let behind = |a: usize| (-wall[a][j]).max(wall[a][j] - size[a]) / case.h;
        let depths = (0..3).map(behind).filter(|depth| *depth > 0.0);
        depths.map(&mut seen).product::<f64>().max(LIKE) as f32
    };
    (0..wall[0].len()).map(of).collect()
}
