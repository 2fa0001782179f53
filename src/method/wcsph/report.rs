//! Frames.

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::frame;
use crate::particle::Frame;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, momentum @ ..] = self.liquid.budget();
        let p = &self.liquid.flow.particles;
        let energies = [
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
            ("compression_energy_J", self.compression()),
        ];
        let rejected = ("steps_rejected", self.control.steps.rejected as f64);
        let works = self.books().then(|| self.liquid.ledger.works());
        let named = energies
            .into_iter()
            .chain(self.liquid.progress(momentum))
            .chain([rejected])
            .chain(works.into_iter().flatten());
        let fields = frame::Fields {
            pressure: &|i| self.model.pressure(p.density[i]),
            surface: &|i| self.kernel_sum(i) < SURFACE,
        };
        self.liquid.frame(&fields, named)
    }
}
