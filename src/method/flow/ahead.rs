//! A look at where particles will be.

use super::Flow;
use crate::space::parallel::{each_mut, three};

impl Flow {
    /// Moves particles by `ahead` s with their velocities, for a look at what is there then; what
    /// is so fast that it would pass its neighbours goes a quarter of a spacing. `now` gets where
    /// they are.
    pub fn look_ahead(&mut self, ahead: f64, now: &mut [Vec<f64>; 3]) {
        for (now, x) in now.iter_mut().zip(&self.particles.position) {
            now.clone_from(x);
        }
        let is_axial = self.is_axial();
        let farthest = 0.25 * self.lengths.spacing;
        let p = &mut self.particles;
        let v = &p.velocity;
        each_mut(three(&mut p.position, now[0].len()), |i, x| {
            let v = [0, 1, 2].map(|a| v[a][i]);
            let speed = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            let time = ahead.min(farthest / speed.max(f64::MIN_POSITIVE));
            (0..3).for_each(|a| *x[a] += time * v[a]);
            if is_axial {
                *x[0] = x[0].abs();
            }
        });
        self.place();
    }

    /// Moves particles to where they were `now`.
    pub fn look_back(&mut self, now: &mut [Vec<f64>; 3]) {
        std::mem::swap(now, &mut self.particles.position);
        self.place();
    }
}
