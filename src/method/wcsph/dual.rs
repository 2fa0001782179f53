//! Dual-criteria stepping (Zhang, Rezavand & Hu 2020): viscosity, tension, shifting and neighbour
//! rows once per advective step; pressure and density in acoustic sub-steps by position Verlet.

use super::{SURFACE, Wcsph};
use crate::effect::gravity;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::Diverged;
use crate::space::parallel::{Slots, each, slots3};

/// Most acoustic steps in one advective step.
const MOST: f64 = 20.0;

/// Shifting never moves a particle by more than this, in spacings, in one advective step.
const SHIFT_CAP: f64 = 0.1;

/// Least factor of the shifting under tension, in h^2 a step (Lind et al. 2012).
const LIND: f64 = 0.5;

/// Below this kernel sum a particle is spray and is not shifted (Sun et al. 2017 use 0.55 of the
/// eigenvalue of the renormalisation matrix, which a surface lowers like the kernel sum).
const LOOSE: f32 = 0.55;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// One advective step.
    pub(super) fn dual_step(&mut self, advective: f64, acoustic: f64) -> Result<(), Diverged> {
        self.rebuild();
        self.hold();
        let inner = acoustic * self.model.h / (self.model.sound_speed + self.fastest);
        let outer = self.limits_now().advective(advective).min(MOST * inner);
        let count = (outer / inner).ceil();
        let dt = outer / count;
        if self.model.settings.shifting > 0.0 {
            self.shift(dt * count);
        }
        for _ in 0..count as usize {
            self.acoustic_step(dt)?;
        }
        self.last_step = dt;
        Ok(())
    }

    /// What is held over the advective step: viscosity (from `look`), gravity, tension.
    fn hold(&mut self) {
        let (around, held) = (&self.around, Slots::new(&mut self.held));
        each(around.len(), |i| *unsafe { held.at(i) } = around[i].viscous);
        if let Some(g) = self.model.effects.gravity {
            gravity::add(g, &mut self.held);
        }
        self.add_tension(|s| &mut s.held);
        // Pressure acceleration belongs to the acoustic criterion.
        self.hardest = self.acceleration();
    }

    fn acoustic_step(&mut self, dt: f64) -> Result<(), Diverged> {
        self.drift(0.5 * dt);
        self.pack_force(0.0);
        self.pair_force(());
        let damp = 1.0 / (1.0 + self.model.damping * dt);
        {
            let n = self.flow.liquid();
            let v = slots3(&mut self.flow.particles.velocity);
            let (held, force) = (&self.held, &self.force);
            each(n, |i| {
                for a in 0..3 {
                    let v = unsafe { v[a].at(i) };
                    *v = damp * (*v + dt * (held[i][a] + force[i][a]) as f64);
                }
            });
        }
        self.fastest = self.speed();
        self.check()?;
        self.drift_position(0.5 * dt);
        match self.model.diffusion() {
            None => self.sum_density(),
            Some(diffusion) => {
                self.density_rate(diffusion);
                self.drift_density(0.5 * dt);
            }
        }
        self.time += dt;
        self.step += 1;
        Ok(())
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
        let rate = &self.rate;
        let density = Slots::new(&mut self.flow.particles.density);
        each(rate.len(), |i| {
            *unsafe { density.at(i) } += dt * rate[i] as f64
        });
    }

    /// Moves everything by `dt` s; makes rows anew first if that would let a pair be missed.
    fn drift_position(&mut self, dt: f64) {
        let step = self.fastest * dt;
        if self.flow.stale(step) {
            self.sort();
        }
        let n = self.flow.liquid();
        let p = &mut self.flow.particles;
        let (x, v) = (slots3(&mut p.position), &p.velocity);
        each(n, |i| {
            for a in 0..3 {
                *unsafe { x[a].at(i) } += dt * v[a][i];
            }
        });
        self.flow.moved += step;
    }

    /// Particle shifting against the gradient of concentration (Lind et al. 2012; Skillen et al.
    /// 2013): dr = -A h v_max dt grad C, A = 2 times the setting; near a surface only along it, by
    /// the tension's normal, and not at all where there is none. The largest speed, not the local
    /// one: voids open at stagnation points. Tension pulls particles together along the surface
    /// even where nothing flows: there the factor of grad C is at least Lind's 0.5 h^2.
    fn shift(&mut self, dt: f64) {
        let model = &self.model;
        let d = model.dimension.count();
        let gradient = K::norm(d) * (model.spacing / model.h).powi(d as i32) / model.h;
        let flow = 2.0 * model.settings.shifting * model.h * self.fastest * dt;
        let skin = flow.max(LIND * model.h * model.h) * gradient;
        let flow = flow * gradient;
        let (cap, scale) = (SHIFT_CAP * model.spacing, self.sum_factor());
        let (around, records) = (&self.around, &self.flow.records);
        let tension = self.tension.is_some();
        let p = &mut self.flow.particles;
        let x = slots3(&mut p.position);
        each(around.len(), |i| {
            let s = &around[i];
            let support = scale * (s.sum + 1.0);
            if support < LOOSE || (support < SURFACE && !tension) {
                return;
            }
            let mut dr = s.gradient.map(|g| -flow * g as f64);
            if tension {
                // The tension left its normals in the records.
                let u = [0, 1, 2].map(|a| records[i].payload(a) as f64);
                let u2 = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
                if u2 == 0.0 && support < SURFACE {
                    return;
                }
                if u2 > 0.0 {
                    dr = s.gradient.map(|g| -skin * g as f64);
                    let along = (0..3).map(|a| dr[a] * u[a]).sum::<f64>() / u2;
                    (0..3).for_each(|a| dr[a] -= along * u[a]);
                }
            }
            let length = dr.iter().map(|d| d * d).sum::<f64>().sqrt();
            let limit = if length > cap { cap / length } else { 1.0 };
            (0..3).for_each(|a| *unsafe { x[a].at(i) } += limit * dr[a]);
        });
        self.flow.moved += cap;
    }
}
