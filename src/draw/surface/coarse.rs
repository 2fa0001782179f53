//! Fields with nodes further apart than particles: the part of each cell that liquid fills.

use super::Field;
use super::smooth::Smoothing;
use crate::particle::Frame;
use crate::scene::{Scene, Side};

/// How much the field of thin liquid is raised, so that a sheet of two particles is seen.
const THIN: f32 = 1.4;

impl Field {
    /// Volumes of particles, shared among the eight nodes around each, over that of a cell; smooth
    /// where liquid is deep. For nodes that are more than a spacing apart.
    ///
    /// `None` without a particle.
    pub fn coarse(scene: &Scene, frame: &Frame, cell: f64) -> Option<Field> {
        let mut field = Field::empty(scene, frame, cell)?;
        let share = scene.spacing.powi(3) as f32 / field.step.product();
        let [x, y, z] = &frame.position;
        for i in 0..x.len() {
            field.share([x[i], y[i], z[i]], share);
        }
        field.mirror(scene);
        field.smooth_by(Smoothing {
            passes: 1,
            reach: 1,
            sharpness: 0.0,
            thin: THIN,
        });
        Some(field)
    }

    fn share(&mut self, at: [f32; 3], share: f32) {
        let (mut node, mut part) = ([0; 3], [0.0; 3]);
        for a in 0..3 {
            let place = (at[a] - self.low[a]) / self.step[a];
            let last = (self.count[a] - 1) as f32;
            if !(0.0..=last).contains(&place) {
                return;
            }
            node[a] = (place as usize).min(self.count[a].saturating_sub(2));
            part[a] = place - node[a] as f32;
        }
        for corner in 0..8 {
            let next = [0, 1, 2].map(|a| corner >> a & 1);
            let weight = |a: usize| [1.0 - part[a], part[a]][next[a]];
            // Across a box of one node the second has no weight.
            let place = self.index([0, 1, 2].map(|a| (node[a] + next[a]).min(self.count[a] - 1)));
            self.values[place] += share * weight(0) * weight(1) * weight(2);
        }
    }

    /// Half the cell of a node on a side that is not open is behind it.
    fn mirror(&mut self, scene: &Scene) {
        for axis in 0..3 {
            let size = scene.domain.size[axis] as f32;
            let (first, last) = (self.low[axis], self.high()[axis]);
            let [low, high] = scene.domain.boundary[axis].map(|side| side != Side::Open);
            let near = 0.01 * self.step[axis];
            let at_low = (low && first.abs() < near).then_some(0);
            let at_high = (high && (last - size).abs() < near).then_some(self.count[axis] - 1);
            for layer in at_low.into_iter().chain(at_high) {
                self.layer(axis, layer, |value| *value *= 2.0);
            }
        }
    }

    fn layer(&mut self, axis: usize, layer: usize, mut change: impl FnMut(&mut f32)) {
        let [nx, ny, nz] = self.count;
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    if [i, j, k][axis] == layer {
                        let place = self.index([i, j, k]);
                        change(&mut self.values[place]);
                    }
                }
            }
        }
    }
}
