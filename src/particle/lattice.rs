//! Cubic lattices: the arrangement of Nishio et al. (2010).
//!
//! A block or layer is filled cell by cell, a particle in the middle of each cell; the number of
//! cells along an axis is the nearest whole one, and the cells are stretched to fit, so that
//! periodic sides match. A sphere or ellipsoid is cut out of a lattice centred ON a particle: d =
//! 3.75 mm at s0 = 0.25 mm then holds the published 1791 particles, which are the lattice points
//! with r <= 7.5 s0. Along an axis on which a mirror plane cuts it, the lattice starts half a
//! spacing from that plane.

use super::shape::{Form, Region, axes};
use crate::scene::Dimension;

/// Round-off allowance when a lattice point lies on the surface, relative.
const ON_SURFACE: f64 = 1e-9;

/// Positions of the lattice that fills `region`, m, x fastest, then y, then z.
pub fn fill(region: &Region, spacing: f64) -> [Vec<f64>; 3] {
    match &region.form {
        Form::Ellipsoid { semi_axes } => ellipsoid(region, *semi_axes, spacing),
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

fn ellipsoid(region: &Region, semi_axes: [f64; 3], spacing: f64) -> [Vec<f64>; 3] {
    let mut range = [[0, 0]; 3];
    for &k in axes(region.dimension) {
        let reach = semi_axes[k] / spacing * (1.0 + ON_SURFACE);
        range[k] = match region.cut[k] {
            None => [-(reach.floor() as i64), reach.floor() as i64],
            Some(0) => [0, (reach - 0.5).floor() as i64],
            Some(_) => [-((reach - 0.5).floor() as i64) - 1, -1],
        };
    }
    let at = |k: usize, i: i64| match region.cut[k] {
        None => i as f64 * spacing,
        Some(_) => (i as f64 + 0.5) * spacing,
    };
    let term = |k: usize, i: i64| match range[k] {
        [0, 0] if region.cut[k].is_none() => 0.0,
        _ => (at(k, i) / semi_axes[k]).powi(2),
    };
    let mut position = [const { Vec::new() }; 3];
    for iz in range[2][0]..=range[2][1] {
        for iy in range[1][0]..=range[1][1] {
            for ix in range[0][0]..=range[0][1] {
                if term(0, ix) + term(1, iy) + term(2, iz) <= 1.0 + ON_SURFACE {
                    push(&mut position, [at(0, ix), at(1, iy), at(2, iz)]);
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
