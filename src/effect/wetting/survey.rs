//! What is fixed of every wall particle: the wall it belongs to, and integrals of the kernel.

use super::Setting;
use crate::kernel;
use crate::scene::Side;

/// A wall particle.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Axis across which its wall lies; `None` behind two walls and in layers without liquid in
    /// reach.
    pub axis: Option<usize>,
    /// 1 at the low side of the box, -1 at the high one.
    pub side: f64,
    /// C: the kernel sum over liquid without end.
    pub full: f64,
    /// e, 1/m.
    pub edge: f64,
    /// Gradient that wall below the last layer would add, 1/m.
    pub missing: f64,
    /// Whether no liquid is in reach.
    pub is_deep: bool,
}

/// Below this C the few particles in reach say nothing about the surface.
const LEAST: f64 = 5e-4;

/// Cells of the tables over depth.
const CELLS: usize = 400;

/// Surveys wall particles at `wall`, m.
pub fn survey(setting: &Setting, wall: &[Vec<f64>; 3]) -> Vec<Place> {
    let step = 2.0 / CELLS as f64;
    let [planes, uprights] = tables(setting);
    let below = |table: &[f64], depth: f64| {
        let from = depth / setting.length / step;
        let whole = from as usize;
        let rest = table.iter().skip(whole + 1).sum::<f64>();
        rest + table
            .get(whole)
            .map_or(0.0, |cell| cell * (1.0 - from.fract()))
    };
    let domain = &setting.domain;
    let behind = |axis: usize, x: f64| {
        let [low, high] = domain.boundary[axis];
        let depth = |side, depth: f64| {
            if side == Side::Wall {
                depth.max(0.0)
            } else {
                0.0
            }
        };
        [depth(low, -x), depth(high, x - domain.size[axis])]
    };
    let mut places = Vec::with_capacity(wall[0].len());
    let mut last: f64 = 0.0;
    for i in 0..wall[0].len() {
        let sides = (0..3).flat_map(|a| behind(a, wall[a][i]).map(|depth| (a, depth)));
        let deep: Vec<(usize, f64)> = sides.filter(|(_, depth)| *depth > 0.0).collect();
        let (axis, depth) = deep.first().copied().unwrap_or((0, 0.0));
        let full = below(&planes, depth);
        let is_deep = full < LEAST;
        if deep.len() == 1 && !is_deep {
            last = last.max(depth);
        }
        places.push(Place {
            axis: (deep.len() == 1 && !is_deep).then_some(axis),
            side: if wall[axis][i] < 0.0 { 1.0 } else { -1.0 },
            full,
            edge: below(&uprights, depth) / setting.length / full.max(LEAST),
            // The depth, until the last layer is known.
            missing: depth,
            is_deep,
        });
    }
    for place in &mut places {
        let left = (last + 0.5 * setting.spacing - place.missing) / setting.length;
        let slope = kernel::plane(setting.kernel, setting.dimension, left.max(0.0));
        place.missing = slope / setting.length;
    }
    places
}

/// Over cells of depth, in units of H: the kernel summed over planes along the wall, and over lines
/// (2-D: points) of the upright plane through the particle.
fn tables(setting: &Setting) -> [Vec<f64>; 2] {
    let step = 2.0 / CELLS as f64;
    let middle = |k: usize| (k as f64 + 0.5) * step;
    let value = |r: f64| kernel::value(setting.kernel, setting.dimension, r, 1.0);
    let line = |z: f64| match setting.dimension {
        2 => value(z),
        _ => (0..CELLS)
            .map(|k| 2.0 * step * value(middle(k).hypot(z)))
            .sum(),
    };
    let plane = |z: f64| kernel::plane(setting.kernel, setting.dimension, z);
    [
        (0..CELLS).map(|k| step * plane(middle(k))).collect(),
        (0..CELLS).map(|k| step * line(middle(k))).collect(),
    ]
}
