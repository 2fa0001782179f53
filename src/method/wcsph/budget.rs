//! The budget of energy with dual stepping: what is stored, what was given and taken
//! ([`Ledger`](crate::method::ledger::Ledger)).
//!
//! Pressure does the work that the density sees pair by pair, gravity that of the height, a tension
//! that has an energy that of the surface: these are exchanges. What is held over a
//! step is booked with the power that it has then; all else as it happens.

use super::Wcsph;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::scene::WallPressure;
use crate::space::parallel::{sum, sum_in, sum_mut};

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Whether all parts of the budget are known: with dual stepping, a density from its rate,
    /// walls without a density of their own and no tension but one that has an energy.
    pub(super) fn books(&self) -> bool {
        self.is_dual()
            && self.model.diffusion().is_some()
            && (!self.liquid.flow.has_walls()
                || self.model.settings.wall_pressure != WallPressure::Summation)
            && (self.liquid.case.effects.tension.is_none() || self.liquid.follows_energy())
    }

    /// Energy of motion, height and compression, J.
    pub(super) fn stored(&mut self) -> f64 {
        if !self.books() {
            return 0.0;
        }
        let model = &self.model;
        self.liquid.stored(|density| model.compression(density))
    }

    /// Energy of compression, J.
    pub(super) fn compression(&self) -> f64 {
        let (model, p) = (&self.model, &self.liquid.flow.particles);
        let [energy] = sum(self.liquid.flow.span(), |i| {
            [p.weight(i) * model.compression(p.density[i])]
        });
        p.mass * energy
    }

    /// Of the pressure that walls have, W. Extrapolated sums must be those of now.
    pub(super) fn power_of_walls(&mut self) -> f64 {
        if !self.books() {
            return 0.0;
        }
        let (model, walls, wall) = (&self.model, &self.walls, &self.liquid.flow.wall);
        let factor = self.gradient_factor();
        let [power] = sum_in(&mut self.liquid.parts, self.liquid.flow.wall_span(), |j| {
            let rho = walls.density[j];
            let closing = wall.weight(j) * walls.sums[j].closing as f64;
            [model.pressure(rho) / (rho * rho) * closing]
        });
        self.liquid.flow.particles.mass * factor * power
    }

    /// Books the work of walls in a step of `dt` s by the trapezoidal rule: with the velocities at
    /// its beginning now, with those at its end in the next step or by [`Self::close_walls`].
    pub(super) fn book_walls(&mut self, dt: f64, is_first: bool) {
        let since = if is_first {
            0.0
        } else {
            self.walls.power_since
        };
        self.liquid.ledger.walls += 0.5 * dt * (since + self.power_of_walls());
    }

    /// Books the end of the last acoustic step, of `dt` s.
    pub(super) fn close_walls(&mut self, dt: f64) {
        if self.books() && self.liquid.flow.has_walls() {
            self.extrapolate_velocity();
            self.liquid.ledger.walls += 0.5 * dt * self.power_of_walls();
        }
    }

    /// Takes the rates that a pass left in `force`, and the power of diffusion: that in the middle
    /// of the time for which they are held, half a step of `dt` s from now.
    pub(super) fn take_rates(&mut self, dt: f64) {
        let (model, p, found) = (&self.model, &self.liquid.flow.particles, &self.own.force);
        let [power] = sum_mut(
            &mut self.liquid.parts,
            self.liquid.flow.span(),
            &mut self.own.rate[..p.len()],
            |i, rate| {
                let rho = p.density[i] + 0.5 * dt * found[i][0] as f64;
                *rate = found[i][0];
                [p.weight(i) * (model.pressure(rho) / (rho * rho) * found[i][1] as f64)]
            },
        );
        self.liquid.ledger.diffusive = p.mass * power;
    }

    /// Finds the surface at the start of a run, and its energy if it has one.
    pub(super) fn find_surface(&mut self) {
        let hardest = self.liquid.now.max_acceleration;
        self.rebuild();
        if self.liquid.follows_energy() {
            self.hold(0.0);
        }
        self.liquid.now.max_acceleration = hardest;
    }
}
