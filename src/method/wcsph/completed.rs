//! The density of [`crate::method::completed`] at a surface whose tension has an energy. Its
//! derivatives are found anew for every force and rate: held over an advective step they feed
//! energy in.

use super::{Completed, Wcsph};
use crate::effect::tension::pass::Pull;
use crate::effect::tension::ringed;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::completed::pass;
use crate::method::completed::ring::alone_of;
use crate::method::pass::Spared;
use crate::space::parallel::each_mut;
use crate::space::room::resize;
use std::marker::PhantomData;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Finds n and its derivatives of all particles near a surface: where the tension has seen one.
    /// Records must hold the present positions; those of rings are packed, `has_moved` as in
    /// [`crate::method::flow::Flow::pack_moving`].
    pub(super) fn complete(&mut self, has_moved: bool) {
        let mut completed = std::mem::take(&mut self.own.completed);
        resize(&mut completed, self.liquid.len(), Completed::default());
        self.look_completed(has_moved, &mut completed);
        self.own.completed = completed;
    }

    fn look_completed(&mut self, has_moved: bool, completed: &mut [Completed]) {
        let (around, share) = (&self.own.around, &self.share);
        let wanted = |i: usize| around[i].vector != [0.0; 3];
        let unit = self.sum_factor() as f64;
        if !self.liquid.flow.is_axial() {
            let pass = pass::Look {
                unit,
                share,
                wanted,
                kernel: self.kernel,
            };
            return self.liquid.sum(&pass, completed);
        }
        self.liquid.sum_rings(has_moved, wanted, &mut self.sums);
        let sums = &self.sums;
        each_mut(completed, |i, completed| {
            *completed = match wanted(i) {
                false => Completed::default(),
                true => {
                    let [r, _, z, sum] = sums[i].map(|s| unit * s as f64);
                    Completed::of(share, sum, [r, 0.0, z])
                }
            };
        });
    }

    /// The rate of density, as `plain` has it, and its part from diffusion, into `force`.
    /// What it reads must be packed.
    pub(super) fn completed_rate(&mut self, plain: Spared<K>) {
        self.complete(false);
        let pass = pass::Spared {
            plain,
            completed: &self.own.completed,
        };
        self.liquid.sum(&pass, &mut self.own.force);
    }

    /// The acceleration by pressure, into `force`. What moves must be packed.
    pub(super) fn completed_force(&mut self) {
        self.complete(false);
        let (model, factor) = (&self.model, self.gradient_factor());
        let (completed, walls) = (&self.own.completed, &self.walls);
        let of = |rho: f64| (model.pressure(rho) / (rho * rho)) as f32;
        let flow = &mut self.liquid.flow;
        let wall = |j: usize| Completed::default().press(of(walls.density[j]));
        if !flow.is_axial() {
            flow.repack(|p, i| completed[i].press(of(p.density[i])), |_, j| wall(j));
            let pass = Pull::<K> {
                factor: -factor,
                kernel: PhantomData,
            };
            return self.liquid.sum(&pass, &mut self.own.force);
        }
        flow.repack(
            |p, i| ringed::Energetic::of(completed[i].press(of(p.density[i])), p.weight(i)),
            |w, j| ringed::Energetic::of(wall(j), w.weight(j)),
        );
        let radii = self.liquid.flow.radii(self.liquid.case.h);
        self.liquid
            .sum(&ringed::Pull { radii }, &mut self.own.force);
        let p = &self.liquid.flow.particles;
        each_mut(&mut self.own.force[..p.len()], |i, out| {
            let pressed = of(p.density[i]) as f64 * p.weight(i);
            let r = out[0] as f64 + pressed * alone_of(radii, i, &completed[i]);
            *out = [r, 0.0, out[2] as f64].map(|s| (-factor * s) as f32);
        });
    }
}
