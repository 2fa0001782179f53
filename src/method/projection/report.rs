//! Reports of a run: divergence, budgets, frames.

use super::{Projection, Scheme};
use crate::method::{Diverged, frame};
use crate::particle::Frame;
use crate::space::parallel::max;

/// Spacings that no particle crosses in one step: its neighbours would be others.
const STRIDE: f64 = 2.0;

impl<S: Scheme> Projection<S> {
    fn fault(&self, what: String, remedy: &str) -> Diverged {
        let now = (self.liquid.now.time, self.liquid.now.step);
        frame::fault(frame::fastest(&self.liquid.flow), now, what, remedy)
    }

    /// An error if anything is not a number or ran away in a step of `dt` s.
    pub(super) fn check(&self, dt: f64) -> Result<(), Diverged> {
        let far = STRIDE * self.liquid.case.spacing;
        if self.liquid.now.max_speed.is_finite() && self.liquid.now.max_speed * dt <= far {
            return Ok(());
        }
        let what = format!(
            "{:.4e} m in a step of {dt:.4e} s, above {STRIDE} spacings, {far:.4e} m",
            self.liquid.now.max_speed * dt
        );
        let remedy = format!("a smaller method.{}.courant or shortest step", S::NAME);
        Err(self.fault(what, &remedy))
    }

    /// No pressure, for no step down to `dt` s; `known`: whether all neighbours were.
    pub(super) fn unsolved(&self, dt: f64, known: bool) -> Diverged {
        if !known {
            let what = format!(
                "it passes its neighbours without pressure, {:.4e} m/s and {:.4e} m/s^2, even in \
                 steps of {:.4e} s",
                self.liquid.now.max_speed,
                self.liquid.now.max_acceleration,
                2.0 * dt
            );
            let remedy = format!("a smaller method.{}.courant", S::NAME);
            return self.fault(what, &remedy);
        }
        let what = format!(
            "no pressure after {} iterations down to steps of {:.4e} s: residual {:.4e} above \
             {:.4e}",
            self.solution.outcome.iterations,
            2.0 * dt,
            self.solution.outcome.residual,
            self.settings.tolerance
        );
        let remedy = format!("more method.{}.iterations or a larger tolerance", S::NAME);
        self.fault(what, &remedy)
    }

    /// Largest pressure now, Pa, or zero.
    pub(super) fn peak(&self) -> f64 {
        max(self.liquid.flow.span(), |i| self.own.pressure[i]).max(0.0)
    }

    /// Energy of motion and height, J.
    pub(super) fn stored(&mut self) -> f64 {
        self.liquid.stored(|_| 0.0)
    }

    /// Largest speed of what is not spray, m/s.
    pub(super) fn max_connected_speed(&self) -> f64 {
        self.liquid.max_connected_speed(|i| self.kernel_sum(i))
    }

    /// Finds the surface at the start of a run, and its energy if it has one.
    pub(super) fn find_surface(&mut self) {
        if !self.liquid.lacks_surface() {
            return;
        }
        let before = self.liquid.now.max_acceleration;
        self.rebuild();
        self.hold(0.0);
        self.liquid.now.max_acceleration = before;
    }

    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, momentum @ ..] = self.liquid.budget();
        let energies = [
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
        ];
        let outcome = &self.solution.outcome;
        let solution = [
            ("pressure_iterations", outcome.iterations as f64),
            ("pressure_residual", outcome.residual),
            ("pressure_repeated", self.solution.repeated as f64),
        ];
        let named = energies
            .into_iter()
            .chain(self.liquid.progress(momentum))
            .chain(solution)
            .chain(self.liquid.ledger.works());
        let fields = frame::Fields {
            pressure: &|i| self.own.pressure[i],
            surface: &|i| self.is_surface(i),
        };
        self.liquid.frame(&fields, named)
    }
}
