//! What a run tells of itself: budgets, frames.

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::frame;
use crate::particle::Frame;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Kinetic and potential energy, J, momentum, kg m/s.
    pub(super) fn budget(&self) -> [f64; 5] {
        frame::budget(&self.flow, self.model.effects.gravity)
    }

    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, x, y, z] = self.budget();
        let p = &self.flow.particles;
        let moved = (self.fastest, self.last_step, self.step);
        let mut named = vec![
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
            ("compression_energy_J", self.compression()),
        ];
        named.extend(frame::progress(&self.flow, [x, y, z], moved));
        named.push(("steps_rejected", self.control.rejected as f64));
        named.extend(self.budget_scalars());
        let scalars = named
            .into_iter()
            .map(|(name, value)| (name.to_string(), value));
        let fields = frame::Fields {
            pressure: &|i| self.model.pressure(p.density[i]),
            surface: &|i| self.kernel_sum(i) < SURFACE,
        };
        frame::of(self.time, p, &fields, scalars.collect())
    }
}
