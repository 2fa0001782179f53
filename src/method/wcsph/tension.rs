//! Effects near a surface in a step: tension and contact lines.
//!
//! Waves of tension are some 30 times slower than sound at d/15, so that the force of tension may
//! be held over steps (multiple time steps: Tuckerman, Berne & Martyna 1992; over a whole advective
//! step: Zhang, Rezavand & Hu 2020).

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Adds to `held` what effects do where particles are `ahead` s later.
    pub(super) fn add_effects_ahead(&mut self, ahead: f64) {
        let (around, scale) = (&self.own.around, self.sum_factor());
        let is_surface = |i: usize| around[i].kernel_sum(scale) < SURFACE;
        self.liquid
            .add_effects(ahead, &is_surface, &mut self.own.held);
    }

    /// The same to `force` for the end of a single-rate step of `dt` s: found on new rows, after a
    /// rejected step, and in each step unless it is held; then where it would be older than the
    /// capillary limit of a step.
    pub(super) fn add_effects_of_step(&mut self, dt: f64) {
        let holds = self.model.settings.time_stepping.holds();
        self.tension_age += dt;
        if holds && self.tension_age <= self.limits_now().capillary() {
            return self.liquid.effects.add(&mut self.own.force);
        }
        self.tension_age = 0.0;
        let (around, scale) = (&self.own.around, self.sum_factor());
        let is_surface = |i: usize| around[i].kernel_sum(scale) < SURFACE;
        self.liquid
            .add_effects(0.0, &is_surface, &mut self.own.force);
    }
}
