//! Crater, crown and jet of a drop that falls into a pool.
//!
//! On the raster of the volume fraction (see `raster`), with z from the initial level and r from
//! the axis of the drop:
//!
//! * `axis_level`: the lowest exterior gas within r ≤ 1.5 s0; below the level it is the crater's
//!   floor and `crater_depth = −axis_level`. `crater_depth_mean`: the depth, averaged over azimuth
//!   (all columns within r ≤ 1.5 s0).
//! * `crater_diameter`: 2 √(A/π), A the area at z = 0 inside the outer edge of the gas that
//!   encloses the axis (2-D: the width).
//! * `crown_height`: the highest point of the largest connected liquid at r > d, without mist; with
//!   several drops, beyond d of each. `jet_height`: the highest point at r ≤ d. `highest_particle`:
//!   of all particles, mist included.
//! * `far_level`: mean level of the outermost tenth of the box; a crater in a small box raises it.

use super::layer::{self, crossing};
use super::raster::{LEVEL, Raster};
use super::region::{Class, Region};
use super::series::Series;
use crate::scene::Dimension;

/// Axis of the measures of a pool.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Lateral position of the axis, m.
    pub at: [f64; 2],
    /// Drop diameter d, m.
    pub diameter: f64,
}

/// Measures of one frame; m, z from the initial level. `None`: not present in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pool {
    /// Lowest exterior gas at the axis.
    pub axis_level: Option<f64>,
    /// Its mean over the azimuth.
    pub axis_level_mean: Option<f64>,
    /// Diameter of the crater at z = 0.
    pub crater_diameter: Option<f64>,
    /// Highest point of the largest liquid at r > d.
    pub crown_height: Option<f64>,
    /// Highest point of the largest liquid at r <= d.
    pub jet_height: Option<f64>,
    /// Mean level of the outermost tenth of the box.
    pub far_level: Option<f64>,
}

/// Lateral offset of a column from the axis, nearest image where periodic, m.
fn offset(region: &Region, axis: &Axis, i: usize, j: usize) -> [f64; 2] {
    let raster = region.raster;
    let node = [i, j];
    [0, 1].map(|a| {
        if raster.count[a] == 1 {
            return 0.0;
        }
        let mut d = raster.coordinate(a, node[a]) - axis.at[a];
        if raster.periodic[a] {
            let length = raster.spacing[a] * raster.count[a] as f64;
            d -= length * (d / length).round();
        }
        d
    })
}

/// Mean level of the outermost tenth of the box, m above the floor.
pub fn far_level(region: &Region, axis: &Axis) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for_columns(region, |i, j| {
        if is_far(region, axis, i, j)
            && let Some(z) = region.column_low(i, j)
        {
            sum += z;
            count += 1;
        }
    });
    (count > 0).then(|| sum / count as f64)
}

fn is_far(region: &Region, axis: &Axis, i: usize, j: usize) -> bool {
    let raster = region.raster;
    let d = offset(region, axis, i, j);
    (0..2).any(|a| {
        let half = 0.5 * raster.spacing[a] * raster.count[a] as f64;
        raster.count[a] > 1 && d[a].abs() > 0.9 * half
    })
}

fn for_columns(region: &Region, mut visit: impl FnMut(usize, usize)) {
    for j in 0..region.raster.count[1] {
        for i in 0..region.raster.count[0] {
            visit(i, j);
        }
    }
}

impl Pool {
    /// Measures with the initial level at `level`, m above the floor; `others`: the axes of the
    /// other drops.
    pub fn beside(
        region: &Region,
        axis: &Axis,
        others: &[Axis],
        dimension: Dimension,
        level: f64,
    ) -> Pool {
        let reach = 1.5 * region.raster.particle_spacing;
        let mut pool = Pool {
            far_level: far_level(region, axis),
            ..Pool::default()
        };
        let (mut sum, mut count) = (0.0, 0usize);
        for_columns(region, |i, j| {
            let d = offset(region, axis, i, j);
            let r = d[0].hypot(d[1]);
            if r <= reach
                && let Some(z) = region.column_low(i, j)
            {
                lower(&mut pool.axis_level, z - level);
                sum += z - level;
                count += 1;
            }
            let is_near = |axis: &Axis| {
                let [x, y] = offset(region, axis, i, j);
                x.hypot(y) <= axis.diameter
            };
            if let Some(z) = region.column_high(i, j) {
                if is_near(axis) {
                    raise(&mut pool.jet_height, z - level);
                } else if !others.iter().any(is_near) {
                    raise(&mut pool.crown_height, z - level);
                }
            }
        });
        pool.axis_level_mean = (count > 0).then(|| sum / count as f64);
        pool.far_level = pool.far_level.map(|z| z - level);
        // Where the surroundings lie just at the level there is no edge: search below it.
        let diameter = |part: f64| {
            let below = part * region.raster.particle_spacing;
            crater_diameter(region, axis, dimension, level - below)
        };
        pool.crater_diameter = [0.0, 0.5, 1.0].into_iter().find_map(diameter);
        pool
    }
}

fn lower(value: &mut Option<f64>, z: f64) {
    *value = Some(value.map_or(z, |old| old.min(z)));
}

fn raise(value: &mut Option<f64>, z: f64) {
    *value = Some(value.map_or(z, |old| old.max(z)));
}

/// One column at the initial level.
#[derive(Clone, Copy, PartialEq)]
enum Cell {
    Liquid,
    /// Exterior gas, not yet assigned to a patch.
    Gas,
    /// Belongs to the patch of this number.
    Patch(u32),
}

/// Diameter of the crater at the initial level, m; `None` if no gas there encloses the axis.
///
/// Gas patches of the plane that touch the far field are troughs of waves, and those under which
/// the surface lies less than s0 deep are ripples: neither is a crater. The crater is the largest
/// other patch (in 2-D, where a jet divides a crater, all others), with all that it encloses.
fn crater_diameter(region: &Region, axis: &Axis, dimension: Dimension, level: f64) -> Option<f64> {
    let raster = region.raster;
    let [nx, ny, _] = raster.count;
    let (mut plane, values) = plane(region, level);
    let patches = patches(region, axis, &mut plane, level);
    let deep = patches.iter().filter(|p| p.crater);
    let largest = deep
        .max_by_key(|p| (p.size, std::cmp::Reverse(p.number)))?
        .number;
    let wall = |cell: Cell| match cell {
        Cell::Patch(n) if dimension == Dimension::Two => patches[n as usize].crater,
        Cell::Patch(n) => n == largest,
        _ => false,
    };
    // Cells that are not connected with the far field are inside.
    let mut outside = vec![false; nx * ny];
    let mut stack = Vec::new();
    for_columns(region, |i, j| {
        if is_far(region, axis, i, j) {
            outside[j * nx + i] = true;
            stack.push((i, j));
        }
    });
    while let Some((i, j)) = stack.pop() {
        for (a, b) in beside(raster, i, j) {
            if !outside[b * nx + a] && !wall(plane[b * nx + a]) {
                outside[b * nx + a] = true;
                stack.push((a, b));
            }
        }
    }
    let inside: Vec<bool> = outside.iter().map(|outside| !outside).collect();
    let mut encloses = false;
    for_columns(region, |i, j| {
        let d = offset(region, axis, i, j);
        encloses |= inside[j * nx + i] && d[0].hypot(d[1]) <= raster.particle_spacing;
    });
    let edge = |from: [usize; 2], to: [usize; 2]| {
        let [from, to] = [from, to].map(|[i, j]| values[j * nx + i]);
        crossing(from, to)
    };
    encloses.then(|| layer::diameter(raster, dimension, &inside, edge))
}

/// Gas or liquid of every column at height `level`, and φ there, interpolated between two layers.
fn plane(region: &Region, level: f64) -> (Vec<Cell>, Vec<f32>) {
    let raster = region.raster;
    let [nx, ny, nz] = raster.count;
    let place = level / raster.spacing[2] - 0.5;
    let low = (place.floor().max(0.0) as usize).min(nz - 1);
    let high = (low + 1).min(nz - 1);
    let part = (place - low as f64).clamp(0.0, 1.0) as f32;
    let (mut plane, mut values) = (Vec::new(), Vec::with_capacity(nx * ny));
    for_columns(region, |i, j| {
        let (below, above) = (raster.value([i, j, low]), raster.value([i, j, high]));
        let exterior = region.class([i, j, low]) == Class::Exterior
            || region.class([i, j, high]) == Class::Exterior;
        let value = (1.0 - part) * below + part * above;
        values.push(value);
        plane.push(if value < LEVEL && exterior {
            Cell::Gas
        } else {
            Cell::Liquid
        });
    });
    (plane, values)
}

struct Patch {
    number: u32,
    size: usize,
    crater: bool,
}

/// Connected patches of gas; the plane's cells get their numbers.
fn patches(region: &Region, axis: &Axis, plane: &mut [Cell], level: f64) -> Vec<Patch> {
    let raster = region.raster;
    let nx = raster.count[0];
    let deep = level - raster.particle_spacing;
    let mut all = Vec::new();
    for start in 0..plane.len() {
        if plane[start] != Cell::Gas {
            continue;
        }
        let number = all.len() as u32;
        plane[start] = Cell::Patch(number);
        let mut stack = vec![(start % nx, start / nx)];
        let (mut size, mut far, mut below) = (0, false, false);
        while let Some((i, j)) = stack.pop() {
            size += 1;
            far |= is_far(region, axis, i, j);
            below = below || region.column_low(i, j).is_some_and(|z| z < deep);
            for (a, b) in beside(raster, i, j) {
                if plane[b * nx + a] == Cell::Gas {
                    plane[b * nx + a] = Cell::Patch(number);
                    stack.push((a, b));
                }
            }
        }
        all.push(Patch {
            number,
            size,
            crater: below && !far,
        });
    }
    all
}

/// Columns that share a face with this one, also across periodic sides.
fn beside(raster: &Raster, i: usize, j: usize) -> impl Iterator<Item = (usize, usize)> {
    let [nx, ny, _] = raster.count;
    let next = move |at: usize, count: usize, periodic: bool| match at + 1 < count {
        true => Some(at + 1),
        false => periodic.then_some(0),
    };
    let last = move |at: usize, count: usize, periodic: bool| match at > 0 {
        true => Some(at - 1),
        false => periodic.then_some(count - 1),
    };
    let [px, py, _] = raster.periodic;
    let along = [last(i, nx, px), next(i, nx, px)].map(|place| place.map(|a| (a, j)));
    let across = [last(j, ny, py), next(j, ny, py)].map(|place| place.map(|b| (i, b)));
    along.into_iter().chain(across).flatten()
}

/// Blanks the jet until the crater is deepest: till then the liquid at the axis is the drop.
/// `contact`: time of contact, s.
pub fn blank_early_jet(series: &mut Series, contact: f64) {
    let after = series.window(contact, f64::INFINITY);
    let deepest = after.maximum("crater_depth_m").map(|(_, t)| t);
    let times = series.time().to_vec();
    if let Some(jet) = series.column_mut("jet_height_m") {
        for (height, time) in jet.iter_mut().zip(times) {
            if deepest.is_none_or(|t| time <= t) {
                *height = f64::NAN;
            }
        }
    }
}
