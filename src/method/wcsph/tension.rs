//! Tension and contact lines in a step.
//!
//! Waves of tension are some 30 times slower than sound at d/15, so that the force of tension may
//! be held over steps (multiple time steps: Tuckerman, Berne & Martyna 1992; over a whole advective
//! step: Zhang, Rezavand & Hu 2020).

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::frame::gained;
use crate::method::surface_of;
use crate::space::parallel::{sum_mut, three};

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Adds a_s, found now, to `held` or `force`, whichever is given.
    pub(super) fn add_tension(&mut self, into: fn(&mut Self) -> &mut Vec<[f32; 3]>) {
        let Some(mut tension) = self.tension.take() else {
            return;
        };
        self.tension_age = 0.0;
        if self.flow.has_moved() {
            self.flow.place();
        }
        let scale = self.sum_factor();
        let around = &self.around;
        let sources = self.flow.sources();
        let flow = surface_of(&self.flow, &sources);
        tension.update(&flow, |i| around[i].kernel_sum(scale) < SURFACE);
        let velocity = &self.flow.particles.velocity;
        tension.friction(&flow, velocity, &mut self.friction);
        if self.model.follows_energy() {
            self.ledger.see(tension.account(&self.flow.particles));
        }
        tension.add(into(self));
        self.tension = Some(tension);
    }

    /// Whether the tension is the derivative of an energy.
    pub(super) fn follows_energy(&self) -> bool {
        self.tension.is_some() && self.model.follows_energy()
    }

    /// Adds to `held` the a_s of where particles are `ahead` s later.
    pub(super) fn add_tension_ahead(&mut self, ahead: f64) {
        if ahead == 0.0 {
            return self.add_tension(|s| &mut s.held);
        }
        let mut now = std::mem::take(&mut self.scratch.position);
        self.flow.look_ahead(ahead, &mut now);
        self.add_tension(|s| &mut s.held);
        self.flow.look_back(&mut now);
        self.scratch.position = now;
    }

    /// The same for the end of a single-rate step of `dt` s: found on new rows, after a rejected
    /// step, and in each step unless it is held; then where it would be older than the capillary
    /// limit of a step.
    pub(super) fn add_tension_of_step(&mut self, dt: f64) {
        let holds = self.model.settings.time_stepping.holds();
        self.tension_age += dt;
        if !holds || self.tension_age > self.limits_now().capillary() {
            self.add_tension(|s| &mut s.force);
        } else if let Some(tension) = &self.tension {
            tension.add(&mut self.force);
        }
    }

    /// Lets friction act on contact lines for `dt` s.
    pub(super) fn rub(&mut self, dt: f64) {
        let friction = &self.friction;
        let mass = self.flow.particles.mass;
        let [work] = sum_mut(
            &mut self.control.parts,
            three(&mut self.flow.particles.velocity, friction.len()),
            |i, v| {
                let [x, y, z] = v;
                let before = [*x, *y, *z];
                [*x, *y, *z] = friction[i].slowed(before, dt);
                [gained(before, [*x, *y, *z])]
            },
        );
        self.ledger.walls += mass * work;
    }
}
