//! Dual-criteria stepping (Zhang, Rezavand & Hu 2020): viscosity, tension, shifting and neighbour
//! rows once per advective step; pressure and density in acoustic sub-steps by position Verlet.

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::Diverged;
use crate::method::shifting::Shifting;
use crate::space::parallel::{each_mut, sum_mut, three};
use crate::space::room::resize;

/// Most acoustic steps in one advective step.
const MOST: f64 = 20.0;

/// Least ratio of one speed of sound to the one an advective step before.
const SLOWING: f64 = 0.98;

/// Room for what a step adds to a speed, and for shifting.
const HASTE: f64 = 1.5;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// One advective step, `part` as long as it may be.
    pub(super) fn dual_step(
        &mut self,
        advective: f64,
        acoustic: f64,
        part: f64,
    ) -> Result<(), Diverged> {
        let acoustic = part * acoustic;
        let crossing = advective * self.liquid.case.h / self.liquid.now.connected_speed.max(1e-30);
        self.liquid.flow.lasting = crossing.min(MOST * self.inner(acoustic));
        self.rebuild();
        let (around, scale) = (&self.own.around, self.sum_factor());
        let kernel_sum = |i: usize| around[i].kernel_sum(scale);
        self.liquid.now.connected_speed = self.liquid.max_connected_speed(kernel_sum);
        self.follow();
        let inner = self.inner(acoustic);
        let longest = |s: &Self| {
            let slow = part * s.liquid.longest(s.limits_now().advective(advective));
            s.liquid.fit(slow.min(MOST * inner))
        };
        // The derivative of an energy is taken in the middle of the step (position Verlet); then
        // the step follows the accelerations of the one before.
        let expected = longest(self);
        let follows_energy = self.liquid.follows_energy();
        self.liquid.set_body_force(0.5 * expected);
        self.hold(if follows_energy { 0.5 * expected } else { 0.0 });
        let outer = if follows_energy {
            expected
        } else {
            longest(self)
        };
        self.liquid.ledger.step(outer);
        self.liquid.begin_step();
        self.bound(outer);
        let count = (outer / inner).ceil();
        let dt = outer / count;
        self.liquid.now.last_step = dt;
        for k in 0..count as usize {
            self.acoustic_step(dt, k == 0)?;
        }
        self.liquid.now.time = self.liquid.beat.exact(self.liquid.now.time);
        self.close_walls(dt);
        self.liquid
            .end_step(outer, &self.own.held, &self.own.steady);
        self.check_energy(count)
    }

    /// The longest acoustic step, s.
    fn inner(&self, acoustic: f64) -> f64 {
        acoustic * self.liquid.case.h / (self.model.sound_speed + self.liquid.now.connected_speed)
    }

    /// Lets the speed of sound follow the largest speed of the moment: up at once, down slowly.
    /// Pressures stay what they are; densities change to what these mean under the new speed.
    fn follow(&mut self) {
        let (old, [least, most]) = (self.model.sound_speed, self.model.sound_speeds);
        let wanted = self.model.settings.sound_speed_factor * self.liquid.now.connected_speed;
        let new = wanted.max(SLOWING * old).clamp(least, most);
        if new == old {
            return;
        }
        let before = self.stored();
        self.model.sound_speed = new;
        let (model, ratio) = (&self.model, (old / new).powi(2));
        each_mut(
            &mut self.liquid.flow.particles.density[..self.own.around.len()],
            |_, rho| {
                *rho = model.density_at(ratio * model.pressure(*rho));
            },
        );
        self.liquid.ledger.diffusion += self.stored() - before;
    }

    /// What is held over the advective step: viscosity (from `look`), body forces, effects of where
    /// particles are `ahead` s later.
    pub(super) fn hold(&mut self, ahead: f64) {
        let around = &self.own.around;
        each_mut(&mut self.own.held[..around.len()], |i, held| {
            *held = around[i].vector
        });
        self.liquid.see_viscosity(&self.own.held);
        self.liquid.body_force.add(&mut self.own.held);
        if self.liquid.follows_energy() {
            self.own.steady.clone_from(&self.own.held);
        }
        self.add_effects_ahead(ahead);
        if let Some(tension) = &self.liquid.effects.tension {
            let around = &mut self.own.around[..self.own.held.len()];
            each_mut(around, |i, around| around.vector = tension.root_of(i));
        }
        self.see_dry_walls();
        // Pressure acceleration belongs to the acoustic criterion.
        self.liquid.now.max_acceleration = self.acceleration();
    }

    /// Keeps what dry walls add to the sums by which particles are shifted.
    fn see_dry_walls(&mut self) {
        self.own.dry.clear();
        if !self.liquid.case.shifts(self.model.settings.shifting) {
            return;
        }
        let n = self.liquid.len();
        for (i, dry) in self.liquid.effects.tension.iter().flat_map(|t| t.dry()) {
            resize(&mut self.own.dry, n, [0.0; 3]);
            self.own.dry[i] = dry;
        }
    }

    /// Rows are found again first if this step could let a pair be missed.
    fn acoustic_step(&mut self, dt: f64, is_first: bool) -> Result<(), Diverged> {
        if self
            .liquid
            .flow
            .stale(|i| HASTE * self.liquid.flow.particles.speed(i) * dt)
        {
            self.sort();
        }
        let shifts = self.liquid.case.shifts(self.model.settings.shifting);
        self.drift(0.5 * dt);
        self.pack_force(0.0);
        self.book_walls(dt, is_first);
        if shifts {
            resize(&mut self.own.driven, self.liquid.len(), Default::default());
            self.pair_force_and_gradient();
        } else {
            self.pair_force(());
        }
        self.kick(dt, shifts);
        let (held, force, driven) = (&self.own.held, &self.own.force, &self.own.driven);
        self.liquid.rub(dt, |i| {
            let force = if shifts { driven[i].0 } else { force[i] };
            [0, 1, 2].map(|a| dt * (held[i][a] + force[a]) as f64)
        });
        self.liquid.now.max_speed = self.liquid.max_speed();
        self.check()?;
        self.drift_position(0.5 * dt);
        if shifts {
            self.shift(dt);
        }
        match self.model.diffusion() {
            None => self.sum_density(),
            Some(diffusion) => {
                self.density_rate(diffusion, true);
                if self.books() {
                    self.take_rates(dt);
                }
                self.drift_density(0.5 * dt);
            }
        }
        self.liquid.now.time += dt;
        self.liquid.now.step += 1;
        Ok(())
    }

    /// v += dt (held + pressure acceleration), damped.
    fn kick(&mut self, dt: f64, shifts: bool) {
        let damp = 1.0 / (1.0 + self.liquid.case.damping * dt);
        let (held, force, driven) = (&self.own.held, &self.own.force, &self.own.driven);
        let push = |i: usize, force: [f32; 3], v: [&mut f64; 3]| {
            for (a, v) in v.into_iter().enumerate() {
                *v = damp * (*v + dt * (held[i][a] + force[a]) as f64);
            }
        };
        let v = three(&mut self.liquid.flow.particles.velocity, held.len());
        if shifts {
            each_mut(v, |i, v| push(i, driven[i].0, v));
        } else {
            each_mut(v, |i, v| push(i, force[i], v));
        }
    }

    fn drift(&mut self, dt: f64) {
        if self.model.diffusion().is_some() {
            self.drift_density(dt);
        }
        self.drift_position(dt);
        if self.model.diffusion().is_none() {
            self.sum_density();
        }
    }

    fn drift_density(&mut self, dt: f64) {
        let rate = &self.own.rate;
        each_mut(
            &mut self.liquid.flow.particles.density[..rate.len()],
            |i, density| *density += dt * rate[i] as f64,
        );
        self.liquid.ledger.diffusion += dt * self.liquid.ledger.diffusive;
    }

    /// Moves everything by `dt` s.
    pub(super) fn drift_position(&mut self, dt: f64) {
        let n = self.liquid.len();
        let p = &mut self.liquid.flow.particles;
        let v = &p.velocity;
        each_mut(three(&mut p.position, n), |i, x| {
            for a in 0..3 {
                *x[a] += dt * v[a][i];
            }
        });
        self.fold_axis();
    }

    /// [`Shifting`]. Inside density goes along: 2 rho dr . grad C is what the transport by dr
    /// leaves of the divergence at constant density (Sun et al. 2019, Eq. 5), and without it the
    /// mean density drifts, for particles are moved apart where the flow moved them together. Near
    /// a surface grad C is the shape of the surface too: there it would suck a crown back into the
    /// pool.
    fn shift(&mut self, dt: f64) {
        let (model, case) = (&self.model, &self.liquid.case);
        let d = case.space;
        let gradient = K::norm(d) * (case.spacing / case.h).powi(d as i32) / case.h;
        let shifting = Shifting {
            strength: model.settings.shifting,
            h: case.h,
            dt,
            fastest: self.liquid.now.connected_speed,
            capillary: Shifting::capillary(case.effects.sigma(), case.density, case.h),
            unit: gradient,
        };
        let scale = self.sum_factor();
        for ((_, slope), dry) in self.own.driven.iter_mut().zip(&self.own.dry) {
            (0..3).for_each(|a| slope[a] -= dry[a]);
        }
        let (around, driven) = (&self.own.around, &self.own.driven);
        let span = self.liquid.flow.span();
        let p = &mut self.liquid.flow.particles;
        let twice = 2.0 * model.density * gradient;
        let g = self.liquid.body_force.constant.unwrap_or_default();
        let [work] = sum_mut(
            &mut self.liquid.parts,
            span,
            (
                &mut p.density[..around.len()],
                three(&mut p.position, around.len()),
            ),
            |i, (density, x)| {
                let support = around[i].kernel_sum(scale);
                let (slope, normal) = (driven[i].1.map(f64::from), around[i].vector.map(f64::from));
                let near = normal.iter().any(|n| *n != 0.0);
                if !near && support < SURFACE {
                    return [0.0];
                }
                let dr = match near {
                    true => shifting.near(slope, normal, support, around[i].relative_speed()),
                    false => shifting.inside(slope),
                };
                (0..3).for_each(|a| *x[a] += dr[a]);
                let mut work = -(0..3).map(|a| g[a] * dr[a]).sum::<f64>();
                if !near {
                    let spread = (0..3).map(|a| dr[a] * slope[a]).sum::<f64>();
                    let rho = density;
                    work -= model.compression(*rho);
                    *rho += twice * spread;
                    work += model.compression(*rho);
                }
                [work]
            },
        );
        self.liquid.ledger.shifting += p.mass * work;
    }
}
