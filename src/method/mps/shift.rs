//! Particle shifting as in [`super::super::shifting`], C at r* by the smooth kernel. Near a surface
//! only tension sets the speed, v_c (1 - (v / v_c)^2) with the largest speed v: what stirs the
//! neighbours is not summed. Velocity stays with the particle.

use super::{LOOSE, Mps};
use crate::method::shifting::Shifting;
use crate::space::parallel::{each, slots3};

impl Mps {
    pub(super) fn shift(&mut self, dt: f64) {
        let (case, fastest) = (&self.case, self.fastest);
        let shifting = Shifting {
            strength: self.settings.shifting,
            h: case.h,
            dt,
            fastest,
            capillary: Shifting::capillary(case.effects.tension, case.density, case.h),
            unit: 1.0,
        };
        let (local, marks, tension) = (&self.local, &self.marks, &self.tension);
        let x = slots3(&mut self.flow.particles.position);
        each(local.len(), |i| {
            if local[i].kernel_sum < LOOSE {
                return;
            }
            let slope = local[i].slope.map(f64::from);
            let normal = match tension {
                Some(tension) => tension.root_of(i).map(f64::from),
                None => [marks[i] as f64; 3],
            };
            let dr = match normal.iter().any(|n| *n != 0.0) {
                true => shifting.near(slope, normal, LOOSE, fastest as f32),
                false => shifting.inside(slope),
            };
            (0..3).for_each(|a| *unsafe { x[a].at(i) } += dr[a]);
        });
    }
}
