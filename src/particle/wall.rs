//! Fixed wall particles outside the box.
//!
//! They lie on the lattice of the box, the first layer half a spacing outside, and take part in
//! every sum of the method. Corners and edges where walls meet are filled; a wall that ends at an
//! open side continues beyond it by the same depth, so that the last liquid inside has full
//! support. At a mirror plane it ends: images lie behind the plane.

use super::Wall;
use super::lattice::cells;
use super::ring;
use super::shape::axes;
use crate::scene::{Dimension, Domain, Problem, Side};

/// Wall particles deep enough for the largest kernel support of the scene.
pub fn build(problem: &Problem) -> Wall {
    let Problem {
        domain,
        dimension,
        spacing,
        ..
    } = problem;
    let mut wall = build_layers(domain, *dimension, *spacing, layers(problem));
    if domain.is_axial() {
        let rings = wall.position[0].iter_mut();
        wall.weight = rings.map(|r| ring::settle(r, *spacing)).collect();
    }
    wall
}

/// Layers that cover the widest kernel support.
pub fn layers(scene: &Problem) -> usize {
    let support = scene.widest() / scene.spacing;
    (support - 1e-9).ceil().max(1.0) as usize
}

/// Wall particles of `layers` layers at every side that is [`Side::Wall`], z slowest, x fastest.
pub fn build_layers(domain: &Domain, dimension: Dimension, spacing: f64, layers: usize) -> Wall {
    let depth = layers as i64;
    let mut count = [1; 3];
    let mut pitch = [0.0; 3];
    let mut range = [[0, 1]; 3];
    for &k in axes(dimension) {
        (count[k], pitch[k]) = cells(domain.size[k], spacing);
        let extra = |side: Side| match side {
            Side::Periodic | Side::Mirror | Side::Axis => 0,
            Side::Open | Side::Wall => depth,
        };
        range[k] = [
            -extra(domain.boundary[k][0]),
            count[k] + extra(domain.boundary[k][1]),
        ];
    }
    let mut wall = Wall::default();
    for iz in range[2][0]..range[2][1] {
        for iy in range[1][0]..range[1][1] {
            let mut ix = range[0][0];
            while ix < range[0][1] {
                let index = [ix, iy, iz];
                match owner(domain.boundary, index, count) {
                    Some((axis, side)) => {
                        for k in 0..3 {
                            let x = if pitch[k] == 0.0 {
                                0.0
                            } else {
                                index[k] as f64 + 0.5
                            };
                            wall.position[k].push(x * pitch[k]);
                            wall.velocity[k].push(domain.wall_velocity[axis][side][k]);
                        }
                    }
                    // The box itself is empty: continue at the far side.
                    None if ix == 0 => ix = count[0] - 1,
                    None => {}
                }
                ix += 1;
            }
        }
    }
    wall
}

/// Whether the lattice cell `index` lies behind a wall, at any depth.
pub fn is_wall(boundary: [[Side; 2]; 3], index: [i64; 3], count: [i64; 3]) -> bool {
    owner(boundary, index, count).is_some()
}

/// The wall to which the lattice cell `index` belongs: the one with the least depth, in a tie z
/// before x before y; `None` for a cell behind no wall.
fn owner(boundary: [[Side; 2]; 3], index: [i64; 3], count: [i64; 3]) -> Option<(usize, usize)> {
    let mut nearest: Option<(i64, usize, usize)> = None;
    for k in [2, 0, 1] {
        for (side, depth) in [-index[k], index[k] - count[k] + 1].into_iter().enumerate() {
            let behind = depth > 0 && boundary[k][side] == Side::Wall;
            if behind && nearest.is_none_or(|(least, ..)| depth < least) {
                nearest = Some((depth, k, side));
            }
        }
    }
    nearest.map(|(_, axis, side)| (axis, side))
}
