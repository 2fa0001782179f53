//! Particle shifting against the gradient of concentration.
//!
//! (1) dr = -2 A h v dt grad C,  C = SUM V W at r*  (Lind, Xu, Stansby & Rogers 2012; Sun et al.
//! 2019), with v the largest speed, |dr| <= v dt / 2 and 2 A h v dt <= h^2 / 2, beyond which the
//! explicit diffusion of particles is unstable. The rules at a free surface are those of WCSPH:
//! spray stays; near a surface particles move along it, at the capillary speed of the smoothing
//! length v_c (1 - (v_max / v_c)^2), v_c^2 = sigma / (rho h), and not at all beyond it or without
//! tension. Velocity stays with the particle.

use super::{LOOSE, Mps};
use crate::space::parallel::{each, slots3};

/// Largest part of v dt.
const CAP: f64 = 0.5;

/// Largest 2 A h v dt in h^2 (Lind et al. 2012).
const LIMIT: f64 = 0.5;

impl Mps {
    pub(super) fn shift(&mut self, dt: f64) {
        let (case, fastest, strength) = (&self.case, self.fastest, self.settings.shifting);
        let factor = |speed: f64| {
            let wanted = 2.0 * strength * case.h * speed * dt;
            wanted.min(LIMIT * case.h * case.h)
        };
        let square = case.effects.tension.unwrap_or(0.0) / (case.density * case.h);
        let surface = (square - fastest * fastest).max(0.0) / square.sqrt().max(1e-30);
        let (inside, skin) = (factor(fastest), factor(surface));
        let cap = CAP * fastest.max(surface) * dt;
        let (local, marks, tension) = (&self.local, &self.marks, &self.tension);
        let x = slots3(&mut self.flow.particles.position);
        each(local.len(), |i| {
            let normal = match tension {
                Some(tension) => tension.root_of(i).map(f64::from),
                None => [marks[i] as f64; 3],
            };
            let n2: f64 = normal.iter().map(|n| n * n).sum();
            let spray = local[i].kernel_sum < LOOSE;
            if spray || (n2 > 0.0 && skin == 0.0) {
                return;
            }
            let amount = if n2 > 0.0 { skin } else { inside };
            let mut dr = local[i].slope.map(|g| -amount * g as f64);
            if n2 > 0.0 {
                let along = (0..3).map(|a| dr[a] * normal[a]).sum::<f64>() / n2;
                (0..3).for_each(|a| dr[a] -= along * normal[a]);
            }
            let length = dr.iter().map(|d| d * d).sum::<f64>().sqrt();
            let limit = if length > cap { cap / length } else { 1.0 };
            (0..3).for_each(|a| *unsafe { x[a].at(i) } += limit * dr[a]);
        });
    }
}
