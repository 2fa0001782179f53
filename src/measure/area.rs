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
        let mut total = 0.0;
        self.for_nodes(block, |node| {
            let [x, y, z] = [0, 1, 2].map(|axis| self.steps(node, axis));
            for along in x.into_iter().flatten() {
                for across in y.into_iter().flatten() {
                    for up in z.into_iter().flatten() {
                        total += self.cell_area(node, [along, across, up]);
                    }
                }
            }
        });
        total
    }

    /// Of one cell, over that of a whole one.
    fn cell_area(&self, node: [usize; 3], steps: [Step; 3]) -> f64 {
        let corner: [f32; 8] = std::array::from_fn(|n| {
            let at = |a: usize| {
                if n >> a & 1 == 1 {
                    steps[a].next
                } else {
                    node[a]
                }
            };
            self.value([at(0), at(1), at(2)])
        });
        // Deep inside or outside all differences vanish.
        let mean = corner.iter().sum::<f32>() / 8.0;
        if !(0.02..0.98).contains(&mean) {
            return 0.0;
        }
        let corner = corner.map(|value| {
            let phase = 2.0 * PI * f64::from(value.clamp(0.0, 1.0));
            (phase - phase.sin()) / (2.0 * PI)
        });
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

    /// The cells that begin at a node along an axis: one to the next node or, half of one, to a
    /// side of the box, behind which the liquid is mirrored.
    fn steps(&self, node: [usize; 3], axis: usize) -> [Option<Step>; 2] {
        let (at, count) = (node[axis], self.count[axis]);
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

/// A cell along an axis from a node on.
#[derive(Clone, Copy)]
struct Step {
    /// The node at its other end.
    next: usize,
    /// Its middle from the node, and how much of it there is, in cells.
    middle: f64,
    part: f64,
}
