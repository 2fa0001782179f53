//! Cubic lattices: the plain arrangement of Nishio et al. (2010).
//!
//! A block or layer is filled cell by cell, a particle in the middle of each cell; the number of
//! cells along an axis is the nearest whole one, and the cells are stretched to fit, so that
//! periodic sides match. A sphere or ellipsoid is cut out of a lattice centred ON a particle: d =
//! 3.75 mm at s0 = 0.25 mm then holds the published 1791 particles, which are the lattice points
//! with r <= 7.5 s0.

use super::shape::{Form, Region, axes};
use crate::scene::Dimension;

/// Round-off allowance when a lattice point lies on the surface, relative.
const ON_SURFACE: f64 = 1e-9;

/// Positions of the lattice that fills `region`, m, x fastest, then y, then z.
pub fn fill(region: &Region, spacing: f64) -> [Vec<f64>; 3] {
    match &region.form {
        Form::Ellipsoid { semi_axes } => ellipsoid(region.dimension, *semi_axes, spacing),
        Form::Block { low, high, .. } => block(region.dimension, *low, *high, spacing),
    }
}

/// Number of lattice cells along an extent and their length: the extent is filled exactly.
pub fn cells(extent: f64, spacing: f64) -> (i64, f64) {
    let count = (extent / spacing).round().max(1.0);
    (count as i64, extent / count)
}

fn block(dimension: Dimension, low: [f64; 3], high: [f64; 3], spacing: f64) -> [Vec<f64>; 3] {
    let mut count = [1; 3];
    let mut pitch = [0.0; 3];
    for &k in axes(dimension) {
        (count[k], pitch[k]) = cells(high[k] - low[k], spacing);
    }
    let at = |k: usize, i: i64| match pitch[k] {
        0.0 => 0.0,
        pitch => low[k] + (i as f64 + 0.5) * pitch,
    };
    let mut position = [const { Vec::new() }; 3];
    for iz in 0..count[2] {
        for iy in 0..count[1] {
            for ix in 0..count[0] {
                push(&mut position, [at(0, ix), at(1, iy), at(2, iz)]);
            }
        }
    }
    position
}

fn ellipsoid(dimension: Dimension, semi_axes: [f64; 3], spacing: f64) -> [Vec<f64>; 3] {
    let mut reach = [0; 3];
    for &k in axes(dimension) {
        reach[k] = (semi_axes[k] / spacing * (1.0 + ON_SURFACE)).floor() as i64;
    }
    let term = |k: usize, i: i64| match reach[k] {
        0 => 0.0,
        _ => (i as f64 * spacing / semi_axes[k]).powi(2),
    };
    let mut position = [const { Vec::new() }; 3];
    for iz in -reach[2]..=reach[2] {
        for iy in -reach[1]..=reach[1] {
            for ix in -reach[0]..=reach[0] {
                if term(0, ix) + term(1, iy) + term(2, iz) <= 1.0 + ON_SURFACE {
                    push(&mut position, [ix, iy, iz].map(|i| i as f64 * spacing));
                }
            }
        }
    }
    position
}

fn push(position: &mut [Vec<f64>; 3], x: [f64; 3]) {
    for (column, value) in position.iter_mut().zip(x) {
        column.push(value);
    }
}
