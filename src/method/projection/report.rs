//! What a run tells of itself: divergence, budgets, frames.

use super::{Projection, Scheme};
use crate::method::shifting::LOOSE;
use crate::method::{Diverged, frame};
use crate::particle::Frame;
use crate::space::parallel::max;

/// Spacings that no particle crosses in one step: its neighbours would be others.
const STRIDE: f64 = 2.0;

impl<S: Scheme> Projection<S> {
    fn fault(&self, what: String, remedy: &str) -> Diverged {
        let (i, _) = frame::fastest(&self.flow);
        frame::fault(&self.flow, (self.time, self.step), i, what, remedy)
    }

    /// An error if anything is not a number or ran away in a step of `dt` s.
    pub(super) fn check(&self, dt: f64) -> Result<(), Diverged> {
        let far = STRIDE * self.case.spacing;
        if self.fastest.is_finite() && self.fastest * dt <= far {
            return Ok(());
        }
        let what = format!(
            "{:.4e} m in a step of {dt:.4e} s, above {STRIDE} spacings, {far:.4e} m",
            self.fastest * dt
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
                self.fastest,
                self.hardest,
                2.0 * dt
            );
            let remedy = format!("a smaller method.{}.courant", S::NAME);
            return self.fault(what, &remedy);
        }
        let what = format!(
            "no pressure after {} iterations down to steps of {:.4e} s: residual {:.4e} above \
             {:.4e}",
            self.outcome.iterations,
            2.0 * dt,
            self.outcome.residual,
            self.settings.tolerance
        );
        let remedy = format!("more method.{}.iterations or a larger tolerance", S::NAME);
        self.fault(what, &remedy)
    }

    /// What the solver of the pressure did, for states and frames.
    pub(super) fn solution_scalars(&self) -> [(&'static str, f64); 3] {
        [
            ("pressure_iterations", self.outcome.iterations as f64),
            ("pressure_residual", self.outcome.residual),
            ("pressure_repeated", self.repeated as f64),
        ]
    }

    /// Kinetic and potential energy, J, momentum, kg m/s.
    pub(super) fn budget(&self) -> [f64; 5] {
        frame::budget(&self.flow, self.case.effects.gravity)
    }

    /// Largest speed now, m/s.
    pub(super) fn speed(&self) -> f64 {
        let p = &self.flow.particles;
        max(p.len(), |i| p.speed(i)).max(0.0)
    }

    /// Largest speed of what is not spray, m/s: spray meets nothing that could be pressed.
    pub(super) fn connected_speed(&self) -> f64 {
        let p = &self.flow.particles;
        let speed = |i: usize| match self.kernel_sum(i) < LOOSE {
            true => 0.0,
            false => p.speed(i),
        };
        max(p.len(), speed).max(0.0)
    }

    /// Largest pressure now, Pa, or zero.
    pub(super) fn peak(&self) -> f64 {
        max(self.pressure.len(), |i| self.pressure[i]).max(0.0)
    }

    /// Energy of motion and height, J.
    pub(super) fn stored(&mut self) -> f64 {
        let (p, g) = (&self.flow.particles, self.case.effects.gravity);
        frame::stored(p, g, |_| 0.0, &mut self.scratch.parts)
    }

    /// Finds the energy of the surface at the start of a run, if there is one.
    pub(super) fn find_surface_energy(&mut self) {
        if self.ledger.surface.is_some() || !self.case.follows_energy() {
            return;
        }
        let hardest = self.hardest;
        self.rebuild();
        self.hold(0.0);
        self.hardest = hardest;
    }

    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, x, y, z] = self.budget();
        let p = &self.flow.particles;
        let moved = (self.fastest, self.last_step, self.step);
        let mut named = vec![
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
        ];
        named.extend(frame::progress(&self.flow, [x, y, z], moved));
        named.extend(self.solution_scalars());
        named.extend(self.ledger.scalars());
        let scalars = named
            .into_iter()
            .map(|(name, value)| (name.to_string(), value));
        let fields = frame::Fields {
            pressure: &|i| self.pressure[i],
            surface: &|i| self.is_surface(i),
        };
        frame::of(self.time, p, &fields, scalars.collect())
    }
}
