//! Area of the surface on a raster of the volume fraction.

use rayon::prelude::*;

use super::raster::Raster;

impl Raster {
    /// Area of the surface, m^2 (length, m, in 2-D): the integral of |∇G(φ)| with
    /// `G = φ − sin(2πφ)/2π`, which goes from 0 to 1 and is insensitive to ripples at both ends.
    ///
    /// `weight`: of what lies at x, m; 1, or pi times the distance from the axis through which the
    /// raster is a section.
    pub fn surface_area(&self, weight: impl Fn(f64) -> f64 + Sync) -> f64 {
        let cell: f64 = (0..3)
            .filter(|&a| self.edge[a] > 1)
            .map(|a| self.spacing[a])
            .product();
        let per_block: Vec<f64> = (0..self.code.len())
            .into_par_iter()
            .map(|block| {
                if self.is_summed(block) {
                    self.block_area(block, &weight)
                } else {
                    0.0
                }
            })
            .collect();
        per_block.iter().fold(0.0, |total, area| total + area) * cell
    }

    /// Sum over the cells whose low corner is a node of the block. Differences of G along the axes
    /// are exact across a flat surface however few nodes it spans.
    fn block_area(&self, block: usize, weight: &impl Fn(f64) -> f64) -> f64 {
        let mut total = 0.0;
        self.for_nodes(block, |node| {
            let Some(corner) = self.corners(node) else {
                return;
            };
            // Deep inside or outside all differences vanish.
            let mean = corner.iter().sum::<f32>() / 8.0;
            if !(0.02..0.98).contains(&mean) {
                return;
            }
            let corner = corner.map(|value| {
                let phase = 2.0 * std::f64::consts::PI * f64::from(value.clamp(0.0, 1.0));
                (phase - phase.sin()) / (2.0 * std::f64::consts::PI)
            });
            let mut square = 0.0;
            for axis in 0..3 {
                let signed = |(n, value): (usize, &f64)| {
                    if n >> axis & 1 == 1 { *value } else { -*value }
                };
                let difference = corner.iter().enumerate().map(signed).sum::<f64>() / 4.0;
                square += (difference / self.spacing[axis]).powi(2);
            }
            // A cell begins at its node.
            let x = self.coordinate(0, node[0]) + 0.5 * self.spacing[0];
            total += weight(x) * square.sqrt();
        });
        total
    }

    /// φ at a node and the next ones along the axes, x fastest; `None` at the grid's end.
    fn corners(&self, node: [usize; 3]) -> Option<[f32; 8]> {
        let mut next = node;
        for axis in (0..3).filter(|&a| self.count[a] > 1) {
            next[axis] = match node[axis] + 1 {
                end if end == self.count[axis] && self.periodic[axis] => 0,
                end if end == self.count[axis] => return None,
                inside => inside,
            };
        }
        Some(std::array::from_fn(|n| {
            let pick = |axis: usize| {
                if n >> axis & 1 == 1 {
                    next[axis]
                } else {
                    node[axis]
                }
            };
            self.value([pick(0), pick(1), pick(2)])
        }))
    }
}
