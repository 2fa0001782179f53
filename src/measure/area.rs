//! Area of the surface on a raster of the volume fraction.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::raster::{LEVEL, Raster};

/// The orders in which a way along the edges of a cell from its low to its high corner takes the
/// axes. The corners of each way are those of one of six equal tetrahedra.
const WAYS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

impl Raster {
    /// Area of the surface, m^2 (length, m, in 2-D): of the level φ = 1/2, as φ is linear in each
    /// of the tetrahedra of a cell. What φ is behind the surface, where layers of particles are
    /// denser or apart, has no part in it, as it would have in an integral of |∇φ|. Of a section
    /// through an axis the area of the body of revolution.
    pub fn surface_area(&self) -> f64 {
        let cell: f64 = (0..3)
            .filter(|&a| self.edge[a] > 1)
            .map(|a| self.spacing[a])
            .product();
        let per_block: Vec<f64> = (0..self.code.len())
            .into_par_iter()
            .map(|block| {
                if self.is_summed(block) {
                    self.block_area(block)
                } else {
                    0.0
                }
            })
            .collect();
        per_block.iter().fold(0.0, |total, area| total + area) * cell
    }

    /// Sum over the cells whose low corner is a node of the block.
    fn block_area(&self, block: usize) -> f64 {
        let patch = Patch::new(self, block);
        let steps = [0, 1, 2].map(|axis| {
            let end = patch.low[axis] + self.edge[axis];
            let all = patch.low[axis]..end.min(self.count[axis]);
            let steps = all.map(|at| self.steps(at, axis));
            steps.collect::<Vec<[Option<Step>; 2]>>()
        });
        let mut total = 0.0;
        self.for_nodes(block, |node| {
            let [x, y, z] = [0, 1, 2].map(|axis| &steps[axis][node[axis] - patch.low[axis]]);
            for along in x.iter().flatten() {
                for across in y.iter().flatten() {
                    for up in z.iter().flatten() {
                        total += self.cell_area(&patch, node, [*along, *across, *up]);
                    }
                }
            }
        });
        total
    }

    /// Of one cell, over that of a whole one.
    fn cell_area(&self, patch: &Patch, node: [usize; 3], steps: [Step; 3]) -> f64 {
        let value = patch.corners(node, &steps).map(|n| patch.value[n]);
        let inside = value.iter().filter(|value| **value >= LEVEL).count();
        if inside == 0 || inside == value.len() {
            return 0.0;
        }
        let value = value.map(f64::from);
        let tetrahedron = |way: &[usize; 3]| {
            let (mut place, mut square) = (0, 0.0);
            let mut along = [value[0]; 4];
            for (n, axis) in way.iter().enumerate() {
                place |= 1 << axis;
                along[n + 1] = value[place];
                square += ((along[n + 1] - along[n]) / self.spacing[*axis]).powi(2);
            }
            square.sqrt() * density(along) / WAYS.len() as f64
        };
        let area: f64 = WAYS.iter().map(tetrahedron).sum();
        let x = self.coordinate(0, node[0]) + steps[0].middle * self.spacing[0];
        let part: f64 = steps.iter().map(|step| step.part).product();
        // Both halves of a ring are in a section.
        let weight = self.axis.map_or(1.0, |axis| PI * (x - axis).abs());
        part * weight * area
    }

    /// The cells that begin at node `at` along an axis: one to the next node or, half of one, to a
    /// side of the box, behind which the liquid is mirrored.
    fn steps(&self, at: usize, axis: usize) -> [Option<Step>; 2] {
        let count = self.count[axis];
        let step = |next, middle, part| Some(Step { next, middle, part });
        if count == 1 {
            return [step(at, 0.0, 1.0), None];
        }
        let ends = !self.periodic[axis];
        let up = match at + 1 == count {
            true if ends => step(at, 0.25, 0.5),
            true => step(0, 0.5, 1.0),
            false => step(at + 1, 0.5, 1.0),
        };
        let down = step(0, -0.25, 0.5).filter(|_| at == 0 && ends);
        [up, down]
    }
}

/// The values of a block and of the nodes behind it.
struct Patch {
    /// The first node, and nodes along each axis.
    low: [usize; 3],
    count: [usize; 3],
    value: Vec<f32>,
}

impl Patch {
    fn new(raster: &Raster, block: usize) -> Patch {
        let low = raster.block_at(block);
        let low = [0, 1, 2].map(|a| low[a] * raster.edge[a]);
        // Of each axis the nodes of the block, and the one to which the last of its cells goes.
        let nodes: [Vec<usize>; 3] = [0, 1, 2].map(|a| {
            let end = (low[a] + raster.edge[a]).min(raster.count[a]);
            let [up, _] = raster.steps(end - 1, a);
            (low[a]..end).chain(up.map(|step| step.next)).collect()
        });
        let mut value = Vec::with_capacity(nodes.iter().map(Vec::len).product());
        for &k in &nodes[2] {
            for &j in &nodes[1] {
                value.extend(nodes[0].iter().map(|&i| raster.value([i, j, k])));
            }
        }
        Patch {
            low,
            count: nodes.map(|nodes| nodes.len()),
            value,
        }
    }

    /// Places of the corners of a cell.
    fn corners(&self, node: [usize; 3], steps: &[Step; 3]) -> [usize; 8] {
        let stride = [1, self.count[0], self.count[0] * self.count[1]];
        let ends = [0, 1, 2].map(|a| {
            let own = node[a] - self.low[a];
            // A step down, to a side, stays at its node.
            let next = if steps[a].middle > 0.0 { own + 1 } else { own };
            [own * stride[a], next * stride[a]]
        });
        std::array::from_fn(|n| ends[0][n & 1] + ends[1][n >> 1 & 1] + ends[2][n >> 2 & 1])
    }
}

/// The volume of a tetrahedron in which a linear function is within a unit around the level, over
/// its own, of the values of the function at the corners: their quadratic B-spline (Curry &
/// Schoenberg 1966). Times the slope of the function it is the area of the level over the volume.
fn density(mut corner: [f64; 4]) -> f64 {
    corner.sort_by(f64::total_cmp);
    let [a, b, c, d] = corner;
    let level = f64::from(LEVEL);
    if !(a..d).contains(&level) {
        return 0.0;
    }
    let (up, down) = (level - a, d - level);
    let spline = if level < b {
        up * up / ((b - a) * (c - a))
    } else if level < c {
        (up * (c - level) / (c - a) + down * (level - b) / (d - b)) / (c - b)
    } else {
        down * down / ((d - b) * (d - c))
    };
    3.0 * spline / (d - a)
}

/// A cell along an axis from a node on.
#[derive(Clone, Copy)]
struct Step {
    /// The node at its other end.
    next: usize,
    /// Its middle from the node, and how much of it there is, in cells.
    middle: f64,
    part: f64,
}
