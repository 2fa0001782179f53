//! Fixed wall particles outside the box.
//!
//! They lie on the lattice of the box and take part in every sum of the method. A box that is no
//! whole number of spacings has stretched cells; layers behind its sides are so much thinner or
//! thicker that a cell of a wall has the volume of a particle ([`Lattice`]). Corners and edges
//! where walls meet are filled; a wall that ends at an open side continues beyond it by the same
//! depth, so that the last liquid inside has full support. At a mirror plane it ends: images lie
//! behind the plane.

use super::Wall;
use super::lattice::cells;
use super::ring;
use super::shape::axes;
use crate::scene::{Dimension, Domain, Problem, Side};

/// Cells are whole if they differ from a spacing by less than this part of it.
const WHOLE: f64 = 1e-9;

/// Wall particles deep enough for the largest kernel support of the scene.
pub fn build(problem: &Problem) -> Wall {
    build_where(problem, &|_| true)
}

/// Those of them at certain x, m.
pub fn build_where(problem: &Problem, is_wanted: &dyn Fn(f64) -> bool) -> Wall {
    let Problem {
        domain,
        dimension,
        spacing,
        ..
    } = problem;
    let lattice = Lattice::new(domain, *dimension, *spacing);
    let mut wall = layers_of(domain, &lattice, layers(problem), is_wanted);
    if domain.is_axial() {
        let rings = wall.position[0].iter_mut();
        wall.weight = rings
            .map(|r| ring::settle(r, lattice.pitch[0], *spacing))
            .collect();
    }
    wall
}

/// Layers that cover the widest kernel support.
pub fn layers(scene: &Problem) -> usize {
    let support = scene.widest() / scene.spacing;
    (support - 1e-9).ceil().max(1.0) as usize
}

/// Cells of a box, and of the layers behind its sides.
#[derive(Clone, Debug)]
pub struct Lattice {
    size: [f64; 3],
    /// Number of cells inside; 1 along an axis that the scene has not.
    pub count: [i64; 3],
    /// Their length, m; 0 along an axis that the scene has not.
    pub pitch: [f64; 3],
    /// Thickness of a layer, m.
    pub layer: [f64; 3],
}

impl Lattice {
    /// Cells of about `spacing` m.
    pub fn new(domain: &Domain, dimension: Dimension, spacing: f64) -> Self {
        let (mut count, mut pitch) = ([1; 3], [0.0; 3]);
        for &a in axes(dimension) {
            (count[a], pitch[a]) = cells(domain.size[a], spacing);
        }
        let stretch: f64 = axes(dimension)
            .iter()
            .map(|&a| pitch[a] / spacing)
            .product();
        let is_whole = axes(dimension)
            .iter()
            .all(|&a| (pitch[a] / spacing - 1.0).abs() < WHOLE);
        Lattice {
            size: domain.size,
            count,
            pitch,
            layer: if is_whole {
                pitch
            } else {
                pitch.map(|pitch| pitch / stretch)
            },
        }
    }

    /// Whether the sides of the box are no whole numbers of spacings.
    pub fn is_stretched(&self) -> bool {
        self.layer != self.pitch
    }

    /// Middle of a cell along an axis, m.
    pub fn middle(&self, axis: usize, index: i64) -> f64 {
        let (count, layer) = (self.count[axis], self.layer[axis]);
        match self.pitch[axis] {
            0.0 => 0.0,
            pitch if pitch == layer || (0..count).contains(&index) => (index as f64 + 0.5) * pitch,
            _ if index < 0 => (index as f64 + 0.5) * layer,
            _ => self.size[axis] + ((index - count) as f64 + 0.5) * layer,
        }
    }

    /// The cell along an axis that is at `x` m.
    pub fn index(&self, axis: usize, x: f64) -> i64 {
        let (count, layer) = (self.count[axis], self.layer[axis]);
        match self.pitch[axis] {
            0.0 => 0,
            pitch if pitch == layer || (0.0..self.size[axis]).contains(&x) => {
                (x / pitch).floor() as i64
            }
            _ if x < 0.0 => (x / layer).floor() as i64,
            _ => count + ((x - self.size[axis]) / layer).floor() as i64,
        }
    }

    /// How far one cell is beyond another along an axis, m.
    pub fn apart(&self, axis: usize, index: i64, other: i64) -> f64 {
        match self.pitch[axis] == self.layer[axis] {
            true => (index - other) as f64 * self.pitch[axis],
            false => self.middle(axis, index) - self.middle(axis, other),
        }
    }

    /// How many cells are within `reach` m along an axis, at most.
    pub fn within(&self, axis: usize, reach: f64) -> i64 {
        match self.pitch[axis] {
            0.0 => 0,
            pitch => (reach / pitch.min(self.layer[axis])).floor() as i64,
        }
    }
}

/// Wall particles of `layers` layers at every side that is [`Side::Wall`], z slowest, x fastest.
pub fn build_layers(domain: &Domain, dimension: Dimension, spacing: f64, layers: usize) -> Wall {
    let lattice = Lattice::new(domain, dimension, spacing);
    layers_of(domain, &lattice, layers, &|_| true)
}

fn layers_of(
    domain: &Domain,
    lattice: &Lattice,
    layers: usize,
    is_wanted: &dyn Fn(f64) -> bool,
) -> Wall {
    let depth = layers as i64;
    let count = lattice.count;
    let mut range = [[0, 1]; 3];
    for k in (0..3).filter(|&k| lattice.pitch[k] > 0.0) {
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
                match owners(domain.boundary, index, count) {
                    [None, ..] if ix == 0 => {
                        // The box itself is empty: continue at the far side.
                        ix = count[0] - 1;
                    }
                    [None, ..] => {}
                    _ if !is_wanted(lattice.middle(0, ix)) => {}
                    owners => {
                        for k in 0..3 {
                            wall.position[k].push(lattice.middle(k, index[k]));
                            wall.velocity[k].push(velocity(domain, owners, k));
                        }
                    }
                }
                ix += 1;
            }
        }
    }
    wall
}

/// Whether the lattice cell `index` lies behind a wall, at any depth.
pub fn is_wall(boundary: [[Side; 2]; 3], index: [i64; 3], count: [i64; 3]) -> bool {
    owners(boundary, index, count)[0].is_some()
}

/// The walls, axis and side, behind which the lattice cell `index` lies: the one with the least
/// depth first, in a tie z before x before y.
fn owners(
    boundary: [[Side; 2]; 3],
    index: [i64; 3],
    count: [i64; 3],
) -> [Option<(usize, usize)>; 3] {
    let mut owners = [2, 0, 1].map(|k| {
        let depths = [-index[k], index[k] - count[k] + 1];
        let side = (0..2).find(|&side| depths[side] > 0 && boundary[k][side] == Side::Wall);
        side.map(|side| (depths[side], k, side))
    });
    owners.sort_by_key(|owner| owner.map_or(i64::MAX, |(depth, ..)| depth));
    owners.map(|owner| owner.map(|(_, axis, side)| (axis, side)))
}

/// Velocity of a cell behind these walls along an axis, m/s: of the first that can slide along it.
/// So a wall that slides goes on into the corners at its ends, and nothing there is pressed.
fn velocity(domain: &Domain, owners: [Option<(usize, usize)>; 3], along: usize) -> f64 {
    let mut sliding = owners.into_iter().flatten();
    let first = sliding.find(|(axis, _)| *axis != along);
    first.map_or(0.0, |(axis, side)| domain.wall_velocity[axis][side][along])
}
