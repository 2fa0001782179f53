//! What a run tells of itself: divergence, budgets, frames.

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::Diverged;
use crate::particle::Frame;
use crate::space::parallel::sum;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// An error if anything is not a number or ran away.
    pub(super) fn check(&self) -> Result<(), Diverged> {
        let bad = !self.fastest.is_finite() || self.fastest > self.model.sound_speeds[1];
        if !bad {
            return Ok(());
        }
        let v = &self.flow.particles.velocity;
        let square = |i: usize| v[0][i] * v[0][i] + v[1][i] * v[1][i] + v[2][i] * v[2][i];
        let key = |i: usize| {
            if square(i).is_nan() {
                f64::INFINITY
            } else {
                square(i)
            }
        };
        let worst = (0..self.flow.liquid()).max_by(|a, b| key(*a).total_cmp(&key(*b)));
        let i = worst.unwrap_or(0);
        let [x, y, z] = self.flow.position(i);
        Err(Diverged {
            time: self.time,
            step: self.step,
            particle: self.flow.particles.id[i],
            x,
            y,
            z,
            what: format!(
                "speed {:.4e} m/s above the sound speed {:.4e} m/s",
                key(i).sqrt(),
                self.model.sound_speeds[1]
            ),
            remedy: "a larger method.wcsph.sound_speed_factor or a smaller time step".into(),
        })
    }

    /// Kinetic and potential energy, J, momentum, kg m/s.
    pub(super) fn budget(&self) -> [f64; 6] {
        let (p, m) = (&self.flow.particles, self.flow.particles.mass);
        let g = self.model.effects.gravity.unwrap_or([0.0; 3]);
        let c2 = self.model.sound_speed * self.model.sound_speed;
        let rho0 = self.model.density;
        sum(p.len(), |i| {
            let v = [p.velocity[0][i], p.velocity[1][i], p.velocity[2][i]];
            let x = self.flow.position(i);
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let e = p.density[i] / rho0 - 1.0;
            let compression = 0.5 * m * c2 * e * e;
            [
                0.5 * m * dot(v, v),
                -m * dot(g, x),
                compression,
                m * v[0],
                m * v[1],
                m * v[2],
            ]
        })
    }

    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, compression, x, y, z] = self.budget();
        let p = &self.flow.particles;
        let named = [
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
            ("compression_energy_J", compression),
            ("mass_kg", p.mass * p.len() as f64),
            ("mass_removed_kg", self.flow.removed.0),
            ("momentum_x_kg_m_s", x),
            ("momentum_y_kg_m_s", y),
            ("momentum_z_kg_m_s", z),
            ("speed_max_m_s", self.fastest),
            ("time_step_s", self.last_step),
            ("steps", self.step as f64),
        ];
        let scalars = named
            .map(|(name, value)| (name.to_string(), value))
            .to_vec();
        let fields = crate::method::frame::Fields {
            pressure: &|i| self.model.pressure(p.density[i]),
            surface: &|i| self.kernel_sum(i) < SURFACE,
        };
        crate::method::frame::of(self.time, p, &fields, scalars)
    }
}
