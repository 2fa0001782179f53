//! Particle shifting as in [`super::super::shifting`], C at r*. Velocity stays with the particle.

use super::Isph;
use super::pass::Local;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::shifting::{LOOSE, Shifting};
use crate::space::parallel::{each, slots3};

impl<K: Kernel, V: PairViscosity> Isph<K, V> {
    pub(super) fn shift(&mut self, dt: f64) {
        let case = &self.case;
        let shifting = Shifting {
            strength: self.settings.shifting,
            h: case.h,
            dt,
            fastest: self.fastest,
            capillary: Shifting::capillary(case.effects.tension, case.density, case.h),
            unit: 1.0,
        };
        let (local, marks, tension) = (&self.local, &self.marks, &self.tension);
        let x = slots3(&mut self.flow.particles.position);
        each(local.len(), |i| {
            let Local {
                slope,
                kernel_sum,
                stir,
                ..
            } = local[i];
            let slope = slope.map(f64::from);
            let normal = match tension {
                Some(tension) => tension.root_of(i).map(f64::from),
                None => [marks[i] as f64; 3],
            };
            let dr = if normal.iter().any(|n| *n != 0.0) {
                shifting.near(slope, normal, kernel_sum, stir)
            } else if kernel_sum < LOOSE {
                return;
            } else {
                shifting.inside(slope)
            };
            (0..3).for_each(|a| *unsafe { x[a].at(i) } += dr[a]);
        });
    }
}
