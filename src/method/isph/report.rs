//! What a run tells of itself: divergence, budgets, frames.

use super::Isph;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::Diverged;
use crate::particle::Frame;
use crate::space::parallel::sum;

/// Spacings that no particle crosses in one step: its neighbours would be others.
const STRIDE: f64 = 2.0;

impl<K: Kernel, V: PairViscosity> Isph<K, V> {
    /// The particle that is fastest, or the first that is not a number.
    fn worst(&self) -> usize {
        let p = &self.flow.particles;
        let key = |i: &usize| {
            let v = p.speed(*i);
            if v.is_nan() { f64::INFINITY } else { v }
        };
        let all = 0..p.len();
        all.max_by(|a, b| key(a).total_cmp(&key(b))).unwrap_or(0)
    }

    fn fault(&self, what: String, remedy: &str) -> Diverged {
        let i = self.worst();
        let [x, y, z] = self.flow.position(i);
        Diverged {
            time: self.time,
            step: self.step,
            particle: self.flow.particles.id[i],
            x,
            y,
            z,
            what,
            remedy: remedy.into(),
        }
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
        Err(self.fault(what, "a smaller method.isph.courant or shortest step"))
    }

    /// No pressure, for no step down to `dt` s.
    pub(super) fn unsolved(&self, dt: f64) -> Diverged {
        let what = format!(
            "no pressure after {} iterations down to steps of {:.4e} s: residual {:.4e} above \
             {:.4e}",
            self.outcome.iterations,
            2.0 * dt,
            self.outcome.residual,
            self.settings.tolerance
        );
        self.fault(what, "more method.isph.iterations or a larger tolerance")
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
        let (p, m) = (&self.flow.particles, self.flow.particles.mass);
        let g = self.case.effects.gravity.unwrap_or([0.0; 3]);
        sum(p.len(), |i| {
            let v = [p.velocity[0][i], p.velocity[1][i], p.velocity[2][i]];
            let x = self.flow.position(i);
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            [
                0.5 * m * dot(v, v),
                -m * dot(g, x),
                m * v[0],
                m * v[1],
                m * v[2],
            ]
        })
    }

    /// What the log shows.
    pub(super) fn make_frame(&self) -> Frame {
        let [kinetic, potential, x, y, z] = self.budget();
        let p = &self.flow.particles;
        let mut named = vec![
            ("kinetic_energy_J", kinetic),
            ("potential_energy_J", potential),
            ("mass_kg", p.mass * p.len() as f64),
            ("mass_removed_kg", self.flow.removed.0),
            ("momentum_x_kg_m_s", x),
            ("momentum_y_kg_m_s", y),
            ("momentum_z_kg_m_s", z),
            ("speed_max_m_s", self.fastest),
            ("time_step_s", self.last_step),
            ("steps", self.step as f64),
        ];
        named.extend(self.solution_scalars());
        let scalars = named
            .into_iter()
            .map(|(name, value)| (name.to_string(), value));
        let fields = crate::method::frame::Fields {
            pressure: &|i| self.pressure[i],
            surface: &|i| self.is_surface(i),
        };
        crate::method::frame::of(self.time, p, &fields, scalars.collect())
    }
}
