//! Connected regions on the grid: the gas that is open above, and the largest body of liquid.

use super::forest::{Forest, identity};
use super::raster::{LEVEL, Raster};
use crate::particle::Frame;

/// Region of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Gas connected with the topmost layer of the grid.
    Exterior,
    /// The largest connected liquid.
    Main,
    /// Mist, bubbles.
    Other,
}

/// Connected regions (across faces) of a raster.
pub struct Region<'a> {
    /// The raster that is divided.
    pub raster: &'a Raster,
    /// Class of each summed node, then of each uniform block.
    class: Vec<Class>,
}

impl<'a> Region<'a> {
    /// Finds the connected regions of a raster.
    pub fn new(raster: &'a Raster) -> Region<'a> {
        let mut forest = Forest::new(raster);
        forest.join_all();
        let class = forest.classes();
        Region { raster, class }
    }

    /// Class of a node.
    pub fn class(&self, node: [usize; 3]) -> Class {
        self.class[identity(self.raster, node)]
    }

    /// Level of the lowest exterior gas in a column, m above the floor, interpolated to φ = 1/2;
    /// 0 where the gas touches the floor, `None` if the column has none.
    pub fn column_low(&self, i: usize, j: usize) -> Option<f64> {
        let raster = self.raster;
        let mut k = 0;
        while k < raster.count[2] {
            let class = self.class([i, j, k]);
            if class == Class::Exterior {
                return Some(self.interface(i, j, k, false));
            }
            k = self.skip_up(i, j, k);
        }
        None
    }

    /// Level of the highest liquid of the main body in a column, m, interpolated; `None` if none.
    pub fn column_high(&self, i: usize, j: usize) -> Option<f64> {
        let raster = self.raster;
        let mut k = raster.count[2];
        while k > 0 {
            let (block, _) = raster.locate([i, j, k - 1]);
            if self.class([i, j, k - 1]) == Class::Main {
                return Some(self.interface(i, j, k - 1, true));
            }
            k = if raster.is_summed(block) {
                k - 1
            } else {
                (k - 1) / raster.edge[2] * raster.edge[2]
            };
        }
        None
    }

    /// Part of the mass that is detached from the main body: farther than a spacing from its
    /// inside. Particles at its surface belong to it, although φ < 1/2 there.
    pub fn detached(&self, frame: &Frame) -> f64 {
        let (mut all, mut off) = (0.0, 0.0);
        for i in 0..frame.id.len() {
            let mass = frame.mass.get(i).map_or(1.0, |mass| f64::from(*mass));
            all += mass;
            if !self.is_beside_main([0, 1, 2].map(|a| frame.position[a][i])) {
                off += mass;
            }
        }
        if all > 0.0 { off / all } else { 0.0 }
    }

    /// Whether a node within a spacing of a point, m, is in the main body.
    fn is_beside_main(&self, point: [f32; 3]) -> bool {
        let raster = self.raster;
        let near = |a: usize| {
            let (size, reach) = (raster.count[a] as i64, raster.particle_spacing);
            let place = |x: f64| (x / raster.spacing[a]).floor() as i64;
            let x = f64::from(point[a]);
            let (low, high) = (place(x - reach), place(x + reach));
            let inside = move |k: i64| match raster.periodic[a] {
                true => k.rem_euclid(size),
                false => k.clamp(0, size - 1),
            };
            (low..=high.min(low.saturating_add(size))).map(move |k| inside(k) as usize)
        };
        let at = [0, 1, 2].map(|a| {
            let place = (f64::from(point[a]) / raster.spacing[a]).max(0.0) as usize;
            place.min(raster.count[a] - 1)
        });
        let is_main = |node: [usize; 3]| self.class(node) == Class::Main;
        is_main(at) || near(2).any(|k| near(1).any(|j| near(0).any(|i| is_main([i, j, k]))))
    }

    fn skip_up(&self, i: usize, j: usize, k: usize) -> usize {
        let (block, _) = self.raster.locate([i, j, k]);
        if self.raster.is_summed(block) {
            k + 1
        } else {
            (k / self.raster.edge[2] + 1) * self.raster.edge[2]
        }
    }

    /// Crossing of φ = 1/2 between node k and the one below (or above).
    fn interface(&self, i: usize, j: usize, k: usize, above: bool) -> f64 {
        let raster = self.raster;
        let z = raster.coordinate(2, k);
        if above && k + 1 == raster.count[2] {
            return z + 0.5 * raster.spacing[2];
        }
        if !above && k == 0 {
            return 0.0;
        }
        let here = raster.value([i, j, k]);
        let next = raster.value([i, j, if above { k + 1 } else { k - 1 }]);
        let part = f64::from(((LEVEL - here) / (next - here)).clamp(0.0, 1.0));
        let step = part * raster.spacing[2];
        if above { z + step } else { z - step }
    }
}
