//! The same sums where particles are rings about an axis: those of [`crate::method::ring`] over
//! pairs, and what each ring adds to its own.

use super::Wcsph;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::completed::ring as completed;
use crate::method::flow::Flow;
use crate::method::pass::{Sparing, Surroundings};
use crate::method::ring::{Compressed, Continuity, Extrapolation, Force, Surrounded};
use crate::particle::{Particles, Wall};
use crate::space::parallel::each_mut;

/// Packs what the rate of density is found from; `has_moved` as in [`Liquid::sum_rings`].
///
/// [`Liquid::sum_rings`]: crate::method::liquid::Liquid::sum_rings
pub(super) fn pack_density(
    flow: &mut Flow,
    has_moved: bool,
    liquid: impl Fn(&Particles, usize) -> Sparing + Sync,
    wall: impl Fn(&Wall, usize) -> Sparing + Sync,
) {
    let liquid = |p: &Particles, i: usize| Compressed::of(liquid(p, i), p.weight(i));
    let wall = |w: &Wall, j: usize| Compressed::of(wall(w, j), w.weight(j));
    match has_moved {
        true => flow.pack(liquid, wall),
        false => flow.repack(liquid, wall),
    }
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Viscosity and kernel sums of all rings.
    pub(super) fn look_at_rings(&mut self) {
        let h = self.liquid.case.h;
        let factor = self.gradient_factor();
        let dynamic = self.liquid.case.effects.mu().unwrap_or(0.0);
        let mut sums = std::mem::take(&mut self.own.force);
        let radii = self.liquid.flow.radii(h);
        let pass = Surrounded {
            radii,
            viscosity: (-4.0 * dynamic / h) as f32,
        };
        self.liquid.sum(&pass, &mut sums);
        let p = &self.liquid.flow.particles;
        each_mut(&mut self.own.around[..p.len()], |i, around| {
            let own = radii.own(i);
            let mass = p.weight(i);
            let [r, z, sum] = sums[i].map(f64::from);
            let r = r + pass.alone(i, mass, p.velocity[0][i]) / (p.density[i] * p.density[i]);
            *around = Surroundings {
                vector: [(factor * r) as f32, 0.0, (factor * z) as f32],
                sum: (sum + mass * own.value - 1.0) as f32,
                stir: 0.0,
            };
        });
        self.own.force = sums;
    }

    /// Fills `force` with the rate of density of all rings and its part from diffusion.
    /// Records must be packed.
    pub(super) fn density_rate_of_rings(&mut self, diffusion: f64) {
        let (h, c) = (self.liquid.case.h, self.model.sound_speed);
        let factor = self.gradient_factor();
        let gravity = self.liquid.body_force.total()[2];
        let radii = self.liquid.flow.radii(h);
        let pass = Continuity {
            radii,
            diffusion: (2.0 * diffusion * c) as f32,
            held: (2.0 * diffusion * h / c * gravity) as f32,
        };
        let p = &self.liquid.flow.particles;
        if self.liquid.follows_energy() {
            let pass = completed::Continuity {
                plain: pass,
                completed: &self.own.completed,
            };
            self.liquid.sum(&pass, &mut self.own.force);
            each_mut(&mut self.own.force[..p.len()], |i, out| {
                let evened = out[2] as f64;
                let rate = evened + pass.closing(i, *out, p.weight(i) * p.velocity[0][i]);
                *out = [rate, evened, 0.0].map(|s| (factor * s) as f32);
            });
            return;
        }
        self.liquid.sum(&pass, &mut self.own.force);
        each_mut(&mut self.own.force[..p.len()], |i, out| {
            let closing = 2.0 * p.weight(i) * radii.own(i).gradient * p.velocity[0][i];
            let rate = out[0] as f64 + closing;
            *out = [rate, out[1] as f64, 0.0].map(|s| (factor * s) as f32);
        });
    }

    /// Fills `force` with the acceleration by pressure. Records must be packed.
    pub(super) fn force_on_rings(&mut self) {
        let factor = self.gradient_factor();
        let radii = self.liquid.flow.radii(self.liquid.case.h);
        self.liquid.sum(&Force { radii }, &mut self.own.force);
        let (p, model) = (&self.liquid.flow.particles, &self.model);
        each_mut(&mut self.own.force[..p.len()], |i, out| {
            let rho = p.density[i];
            let pressure = model.pressure(rho) / (rho * rho);
            let own = -2.0 * p.weight(i) * pressure * radii.own(i).gradient;
            *out = [out[0] as f64 + own, 0.0, out[2] as f64].map(|s| (factor * s) as f32);
        });
    }

    /// Fills the sums of the walls. Records must be packed.
    pub(super) fn extrapolate_rings(&mut self) {
        let radii = self.liquid.flow.radii(self.liquid.case.h);
        self.liquid
            .sum_at_walls(&Extrapolation { radii }, &mut self.walls.sums);
    }

    /// Puts what has crossed the axis back: no force acts there, so that it may cross in a step.
    pub(super) fn fold_axis(&mut self) {
        if !self.liquid.flow.is_axial() {
            return;
        }
        let n = self.liquid.len();
        let p = &mut self.liquid.flow.particles;
        let (x, v) = (&mut p.position[0][..n], &mut p.velocity[0][..n]);
        each_mut((x, v, &mut self.own.held[..n]), |_, (x, v, held)| {
            if *x < 0.0 {
                (*x, *v, held[0]) = (-*x, -*v, -held[0]);
            }
        });
    }
}
