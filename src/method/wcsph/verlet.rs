//! Single-rate velocity Verlet (kick, drift, kick), as Nishio et al. use it; velocity-dependent
//! forces see the velocity predicted to the end of the step.

use super::Wcsph;
use crate::effect::gravity;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::{Diverged, Solver};
use crate::scene::TimeStepping;
use crate::space::parallel::{each_mut, three};

/// Most steps on one set of neighbour rows, so that restart points come often enough.
const LONGEST: usize = 20;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Forces at the start of a run.
    pub(super) fn prime(&mut self) {
        self.rebuild();
        self.evaluate(0.0, 0.0);
    }

    /// From one rebuild of the rows to the next.
    pub(super) fn verlet_steps(
        &mut self,
        on_step: &mut dyn FnMut(&dyn Solver),
    ) -> Result<(), Diverged> {
        self.flow.lasting = LONGEST as f64 * self.next_step();
        self.rebuild();
        // Rates of density see the walls of the step before, which no state keeps.
        if self.model.diffusion().is_some() {
            self.pack_force(0.0);
        }
        for k in 0..LONGEST {
            let dt = self.next_step();
            let push = self.hardest * dt;
            if k > 0
                && self
                    .flow
                    .stale(|i| (self.flow.particles.speed(i) + push) * dt)
            {
                break;
            }
            match self.model.settings.time_stepping {
                TimeStepping::Fixed { .. } => {
                    self.verlet_step(dt);
                    self.check()?;
                }
                _ => self.controlled(|s, part| s.bounded_step(part * dt))?,
            }
            on_step(self);
        }
        Ok(())
    }

    /// A step that leaves the accelerations of before if it is bad.
    fn bounded_step(&mut self, dt: f64) -> Result<(), Diverged> {
        self.bound(dt);
        self.verlet_step(dt);
        let outcome = self.check().and_then(|()| self.check_energy());
        if outcome.is_err() {
            std::mem::swap(&mut self.held, &mut self.force);
            self.tension_age = f64::INFINITY;
        }
        outcome
    }

    fn next_step(&self) -> f64 {
        match self.model.settings.time_stepping {
            TimeStepping::Fixed { step } => step,
            TimeStepping::Adaptive { safety, .. } => safety * self.limits_now().least(),
            TimeStepping::Dual { .. } => unreachable!("dual stepping has its own loop"),
        }
    }

    fn verlet_step(&mut self, dt: f64) {
        let n = self.flow.liquid();
        {
            let p = &mut self.flow.particles;
            let held = &self.held;
            each_mut(
                (three(&mut p.velocity, n), three(&mut p.position, n)),
                |i, (v, x)| {
                    for a in 0..3 {
                        let v = &mut *v[a];
                        *v += 0.5 * dt * held[i][a] as f64;
                        *x[a] += dt * *v;
                    }
                },
            );
        }
        self.evaluate(0.5 * dt, dt);
        let damp = 1.0 / (1.0 + self.model.damping * dt);
        {
            let p = &mut self.flow.particles;
            let held = &self.held;
            each_mut(three(&mut p.velocity, n), |i, v| {
                for a in 0..3 {
                    let v = &mut *v[a];
                    *v = damp * (*v + 0.5 * dt * held[i][a] as f64);
                }
            });
        }
        self.rub(dt);
        self.fastest = self.speed();
        self.connected = self.fastest;
        self.time += dt;
        self.step += 1;
        self.last_step = dt;
    }

    /// Density and all accelerations at the current positions, into `held`.
    /// `ahead`: seconds by which the stored velocity lags.
    fn evaluate(&mut self, ahead: f64, dt: f64) {
        match self.model.diffusion() {
            None => self.sum_density(),
            Some(diffusion) => {
                self.density_rate(diffusion, false);
                let rate = &self.rate;
                each_mut(
                    &mut self.flow.particles.density[..rate.len()],
                    |i, density| *density += dt * rate[i] as f64,
                );
            }
        }
        self.repack_force(ahead);
        self.pair_force(self.viscosity);
        if let Some(g) = self.model.effects.gravity {
            gravity::add(g, &mut self.force);
        }
        self.add_tension_of_step(dt);
        std::mem::swap(&mut self.held, &mut self.force);
        self.hardest = self.acceleration();
    }
}
