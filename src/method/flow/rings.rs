//! Records of rings about an axis.

use super::Flow;
use crate::kernel::ring::{Radii, Rings};
use crate::method::pass::Moving;
use crate::method::ring::Ring;
use crate::particle::{Particles, Wall};

impl Flow {
    /// Where the rings are; `length`: h, m.
    pub fn radii(&self, length: f64) -> Radii<'_> {
        self.radii_of(Rings::default(), length)
    }

    /// The same for another kernel.
    pub fn radii_of(&self, rings: Rings, length: f64) -> Radii<'_> {
        Radii {
            liquid: &self.particles.position[0],
            wall: &self.wall.position[0],
            length,
            rings,
        }
    }

    /// Packs what moves for a pass, as rings where particles are rings; `has_moved`: since the last
    /// time.
    pub fn pack_moving(
        &mut self,
        has_moved: bool,
        liquid: impl Fn(&Particles, usize) -> Moving + Sync,
        wall: impl Fn(&Wall, usize) -> Moving + Sync,
    ) {
        let of_liquid = |p: &Particles, i: usize| Ring::of(liquid(p, i), p.weight(i));
        let of_wall = |w: &Wall, j: usize| Ring::of(wall(w, j), w.weight(j));
        match (self.is_axial(), has_moved) {
            (false, true) => self.pack(liquid, wall),
            (false, false) => self.repack(liquid, wall),
            (true, true) => self.pack(of_liquid, of_wall),
            (true, false) => self.repack(of_liquid, of_wall),
        }
    }

    /// The same for the walls alone.
    pub fn pack_moving_wall(&mut self, wall: impl Fn(usize) -> Moving + Sync) {
        if !self.is_axial() {
            return self.pack_wall(wall);
        }
        let weights = std::mem::take(&mut self.wall.weight);
        self.pack_wall(|j| Ring::of(wall(j), weights[j]));
        self.wall.weight = weights;
    }
}
