//! Area of the surface on a raster of the volume fraction.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::raster::Raster;

impl Raster {
    /// Area of the surface, m^2 (length, m, in 2-D): the integral of |∇G(φ)| with
    /// `G = φ − sin(2πφ)/2π`, which goes from 0 to 1 and is insensitive to ripples at both ends.
    /// Of a section through an axis the area of the body of revolution.
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

    /// Sum over the cells whose low corner is a node of the block. Differences of G along the axes
    /// are exact across a flat surface however few nodes it spans.
    fn block_area(&self, block: usize) -> f64 {
        let mut patch = Patch::new(self, block);
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
                        total += self.cell_area(&mut patch, node, [*along, *across, *up]);
                    }
                }
            }
        });
        total
    }

    /// Of one cell, over that of a whole one.
    fn cell_area(&self, patch: &mut Patch, node: [usize; 3], steps: [Step; 3]) -> f64 {
        let corner = patch.corners(node, &steps);
        // Deep inside or outside all differences vanish.
        let mean = corner.map(|n| patch.value[n]).iter().sum::<f32>() / 8.0;
        if !(0.02..0.98).contains(&mean) {
            return 0.0;
        }
        let corner = corner.map(|n| patch.sharp(n));
        let mut square = 0.0;
        for axis in 0..3 {
            let signed = |(n, value): (usize, &f64)| {
                if n >> axis & 1 == 1 { *value } else { -*value }
            };
            let difference = corner.iter().enumerate().map(signed).sum::<f64>() / 4.0;
            square += (difference / self.spacing[axis]).powi(2);
        }
        let x = self.coordinate(0, node[0]) + steps[0].middle * self.spacing[0];
        let part: f64 = steps.iter().map(|step| step.part).product();
        // Both halves of a ring are in a section.
        let weight = self.axis.map_or(1.0, |axis| PI * (x - axis).abs());
        part * weight * square.sqrt()
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
    /// G of them where it has been asked for, else NaN.
    sharp: Vec<f64>,
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
            sharp: vec![f64::NAN; value.len()],
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

    /// G at a place.
    fn sharp(&mut self, place: usize) -> f64 {
        let known = self.sharp[place];
        if !known.is_nan() {
            return known;
        }
        let phase = 2.0 * PI * f64::from(self.value[place].clamp(0.0, 1.0));
        let sharp = (phase - phase.sin()) / (2.0 * PI);
        self.sharp[place] = sharp;
        sharp
    }
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
