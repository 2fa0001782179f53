//! The tension as an effect: what it limits, keeps and holds.

use super::{Tension, Wetting};
use crate::effect::surface::Surface;
use crate::effect::wetting::friction::Hold;
use crate::effect::{Account, Effect};
use crate::particle::Particles;
use crate::scene::{TensionForm, limit};

impl Effect for Tension {
    fn limit(&self, h: f64, density: f64) -> Option<(&'static str, f64)> {
        let limit = || limit::capillary(h, density, self.coefficient);
        self.pulls().then(|| ("capillary", limit()))
    }

    fn update(&mut self, liquid: &Surface, is_surface: &(dyn Fn(usize) -> bool + Sync)) {
        Tension::update(self, liquid, is_surface);
    }

    fn add(&self, into: &mut [[f32; 3]]) {
        Tension::add(self, into);
    }

    fn friction(&mut self, liquid: &Surface, velocity: &[Vec<f64>; 3], into: &mut Vec<Hold>) {
        Tension::friction(self, liquid, velocity, into);
    }

    fn account(&mut self, particles: &Particles) -> Option<Account> {
        let has_energy = self.form == TensionForm::SurfaceEnergy;
        has_energy.then(|| Tension::account(self, particles))
    }

    fn lines(&mut self, particles: &Particles) -> f64 {
        self.power_of_lines(particles)
    }

    fn kept(&self) -> Option<(&'static str, f64)> {
        self.pulls().then_some(("tension_strength", self.strength))
    }

    fn memory(&self) -> usize {
        let lines = [&self.lines, &self.feet];
        let indices = [&self.near, &self.reached];
        let indices = indices.iter().chain(&lines);
        4 * indices.map(|list| list.capacity()).sum::<usize>()
            + std::mem::size_of::<super::level::Bend>() * self.bends.capacity()
            + 24 * self.stressed.stress[0].capacity()
            + 12 * self.force.capacity()
            + 24 * self.normals.capacity()
            + 12 * self.payload[0].capacity()
            + 24 * self.stressed.u[0].capacity()
            + 4 * (self.stressed.index.capacity()
                + self.scalars.capacity()
                + self.stressed.start.capacity())
            + self.stressed.images.memory()
            + self.counted.memory()
            + self.energy.memory()
            + self.kept.memory()
            + 8 * self.typed.as_ref().map_or(0, |typed| typed.here.capacity())
            + self.band.memory()
            + self.wetting.as_ref().map_or(0, Wetting::memory)
    }
}
