//! Particle shifting as in [`super::super::shifting`], C at r*. Velocity stays with the particle.

use super::{Projection, Scheme};
use crate::method::shifting::{LOOSE, Shifting};
use crate::space::parallel::{each_mut, three};

impl<S: Scheme> Projection<S> {
    pub(super) fn shift(&mut self, dt: f64) {
        let case = &self.liquid.case;
        let shifting = Shifting {
            strength: self.settings.shifting,
            h: case.h,
            dt,
            fastest: self.liquid.now.connected_speed,
            capillary: Shifting::capillary(case.effects.sigma(), case.density, case.h),
            unit: 1.0,
        };
        let factor = self.sum_factor() / self.liquid.case.h as f32;
        for (i, dry) in self.liquid.effects.tension.iter().flat_map(|t| t.dry()) {
            (0..3).for_each(|a| self.own.local[i].slope[a] -= factor * dry[a]);
        }
        let (local, tension) = (&self.own.local, &self.liquid.effects.tension);
        each_mut(
            three(&mut self.liquid.flow.particles.position, local.len()),
            |i, x| {
                let seen = &local[i];
                if seen.kernel_sum < LOOSE {
                    return;
                }
                let slope = seen.slope.map(f64::from);
                let normal = tension
                    .as_ref()
                    .map_or([0.0; 3], |t| t.root_of(i))
                    .map(f64::from);
                let dr = if normal.iter().any(|n| *n != 0.0) {
                    shifting.near(slope, normal, seen.kernel_sum, seen.stir)
                } else {
                    shifting.inside(slope)
                };
                (0..3).for_each(|a| *x[a] += dr[a]);
            },
        );
    }
}
