//! Single-rate velocity Verlet (kick, drift, kick), as Nishio et al. use it; velocity-dependent
//! forces see the velocity predicted to the end of the step.

use super::Wcsph;
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
        self.liquid.flow.lasting = LONGEST as f64 * self.next_step();
        self.rebuild();
        // Rates of density see the walls of the step before, which no state keeps.
        if self.model.diffusion().is_some() {
            self.pack_force(0.0);
        }
        for k in 0..LONGEST {
            let dt = self.next_step();
            let push = self.liquid.now.max_acceleration * dt;
            if k > 0
                && self
                    .liquid
                    .flow
                    .stale(|i| (self.liquid.flow.particles.speed(i) + push) * dt)
            {
                break;
            }
            match self.model.settings.time_stepping {
                TimeStepping::Fixed { .. } => {
                    self.verlet_step(dt);
                    self.check()?;
                }
                _ => self.controlled(|s, part| {
                    s.bounded_step(s.liquid.fit(part * s.liquid.longest(dt)))
                })?,
            }
            on_step(self);
        }
        Ok(())
    }

    fn bounded_step(&mut self, dt: f64) -> Result<(), Diverged> {
        self.bound(dt);
        self.verlet_step(dt);
        self.check().and_then(|()| self.check_energy(1.0))
    }

    fn next_step(&self) -> f64 {
        match self.model.settings.time_stepping {
            TimeStepping::Fixed { step } => step,
            TimeStepping::Adaptive { safety, .. } => safety * self.limits_now().least(),
            TimeStepping::Dual { .. } => unreachable!("dual stepping has its own loop"),
        }
    }

    fn verlet_step(&mut self, dt: f64) {
        let n = self.liquid.len();
        {
            let p = &mut self.liquid.flow.particles;
            let held = &self.own.held;
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
        let damp = 1.0 / (1.0 + self.liquid.case.damping * dt);
        {
            let p = &mut self.liquid.flow.particles;
            let held = &self.own.held;
            each_mut(three(&mut p.velocity, n), |i, v| {
                for a in 0..3 {
                    let v = &mut *v[a];
                    *v = damp * (*v + 0.5 * dt * held[i][a] as f64);
                }
            });
        }
        // Positions have moved by the velocity between the two kicks.
        self.liquid.rub(dt, |_| [0.0; 3]);
        self.liquid.now.max_speed = self.liquid.max_speed();
        self.liquid.now.connected_speed = self.liquid.now.max_speed;
        self.liquid.now.time = self.liquid.beat.exact(self.liquid.now.time + dt);
        self.liquid.now.step += 1;
        self.liquid.now.last_step = dt;
    }

    /// Density and all accelerations at the current positions, into `held`.
    /// `ahead`: seconds by which the stored velocity lags.
    fn evaluate(&mut self, ahead: f64, dt: f64) {
        self.liquid.set_body_force(dt);
        match self.model.diffusion() {
            None => self.sum_density(),
            Some(diffusion) => {
                self.density_rate(diffusion, false);
                let rate = &self.own.rate;
                each_mut(
                    &mut self.liquid.flow.particles.density[..rate.len()],
                    |i, density| *density += dt * rate[i] as f64,
                );
            }
        }
        self.repack_force(ahead);
        self.pair_force(self.viscosity);
        self.liquid.body_force.add(&mut self.own.force);
        self.add_effects_of_step(dt);
        std::mem::swap(&mut self.own.held, &mut self.own.force);
        self.liquid.now.max_acceleration = self.acceleration();
    }
}
