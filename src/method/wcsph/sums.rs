//! The pair sums of a step, with their factors; equation numbers as in [`super`].

use super::{Wcsph, rings, velocity};
use crate::effect::tension::energy::LOAD;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::pass::{Compressed, Continuity, Force, ForceAndGradient, Moving};
use crate::method::pass::{Neighbourhood, Spared, Sparing, Summation};
use crate::particle::{Particles, Wall};
use crate::scene::Pressure;
use crate::space::sweep;

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// norm s0^d / h^d: turns [`Surroundings::sum`] into the kernel sum (without the particle).
    pub(super) fn sum_factor(&self) -> f32 {
        let d = self.liquid.case.space;
        (K::norm(d) * (self.liquid.case.spacing / self.liquid.case.h).powi(d as i32)) as f32
    }

    /// Kernel sum of particle `i`: 1 inside, 0.77 at a flat surface.
    #[inline(always)]
    pub(super) fn kernel_sum(&self, i: usize) -> f32 {
        self.own.around[i].kernel_sum(self.sum_factor())
    }

    /// Viscosity, kernel sums and their gradients of all particles.
    pub(super) fn look(&mut self) {
        if self.is_dual() {
            self.look_with(self.viscosity);
        } else {
            self.look_with(());
        }
    }

    fn look_with<U: PairViscosity>(&mut self, viscosity: U) {
        if U::PRESENT {
            self.extrapolate_velocity();
        } else {
            let still = Moving::default();
            self.liquid
                .flow
                .pack_moving(true, |_, _| still, |_, _| still);
        }
        if self.liquid.flow.is_axial() {
            self.look_at_rings();
        } else {
            let pass = Neighbourhood {
                factor: self.gradient_factor(),
                viscosity,
                kernel: self.kernel,
            };
            self.liquid.sum(&pass, &mut self.own.around);
        }
        if self.liquid.removes_mist {
            self.own.kernel_sum.clear();
            let factor = self.sum_factor();
            let sums = self
                .own
                .around
                .iter()
                .map(|around| around.kernel_sum(factor));
            self.own.kernel_sum.extend(sums);
        }
    }

    /// (1) for liquid, and for the wall if it carries its own density.
    pub(super) fn sum_density(&mut self) {
        self.liquid.flow.pack(|_, _| (), |_, _| ());
        let d = self.liquid.case.space;
        let factor =
            self.liquid.flow.particles.mass * K::norm(d) / self.liquid.case.h.powi(d as i32);
        let pass = Summation {
            factor,
            own: factor * K::w(0.0),
            kernel: self.kernel,
        };
        let scale = self.liquid.scale();
        let (records, rows) = (&self.liquid.flow.records, &self.liquid.flow.rows);
        sweep::rows(
            records,
            rows,
            scale,
            &pass,
            &mut self.liquid.flow.particles.density,
        );
        if self.liquid.flow.has_walls() && self.liquid.flow.wall_sees_wall {
            self.liquid.sum_at_walls(&pass, &mut self.walls.density);
        }
    }

    /// (2): fills `rate`. The pressure holds what is `held` apart from it, or gravity.
    pub(super) fn density_rate(&mut self, diffusion: f64, apart: bool) {
        if self.books() {
            return self.density_rate_apart(diffusion);
        }
        let (model, rho0) = (&self.model, self.model.density);
        let c = model.sound_speed;
        let lag = (2.0 * diffusion * self.liquid.case.h / c) as f32;
        let gravity = [self.liquid.body_force.total().map(|g| g as f32)];
        let held = match apart {
            true => &self.own.held[..],
            false => &gravity,
        };
        let ahead = |v: [f32; 3], f: [f32; 3]| [0, 1, 2].map(|a| v[a] + 0.5 * lag * f[a]);
        let excess = |rho: f64| (rho / rho0 - 1.0) as f32;
        let density = &self.walls.density;
        self.liquid.flow.pack(
            |p, i| Compressed {
                velocity: ahead(velocity(p, i), held[i.min(held.len() - 1)]),
                excess: excess(p.density[i]),
            },
            |w, i| Compressed {
                velocity: ahead([0, 1, 2].map(|a| w.velocity[a][i] as f32), gravity[0]),
                excess: excess(density[i]),
            },
        );
        let pass = Continuity {
            factor: self.gradient_factor(),
            diffusion: (2.0 * diffusion * c) as f32,
            lag,
            held,
            kernel: self.kernel,
        };
        self.liquid.sum(&pass, &mut self.own.rate);
    }

    /// The same for the budget, sparing what holds the load of a tension that has an energy.
    fn density_rate_apart(&mut self, diffusion: f64) {
        let completes = self.liquid.follows_energy();
        if completes && self.liquid.flow.is_axial() {
            self.complete(true);
        }
        let (rho0, c) = (self.model.density, self.model.sound_speed);
        let gravity = self.liquid.body_force.total();
        let (around, density) = (&self.own.around, &self.walls.density);
        let excess = |rho: f64| (rho / rho0 - 1.0) as f32;
        let tension = self.liquid.effects.tension.as_ref().filter(|_| completes);
        let load = tension.map_or(0.0, |t| t.coefficient / t.length);
        let spared = (2.0 * diffusion * c * LOAD * load / (rho0 * c * c)) as f32;
        let liquid = |p: &Particles, i: usize| {
            let layer = around[i].vector != [0.0; 3];
            Sparing {
                velocity: velocity(p, i),
                excess: excess(p.density[i]),
                spared: if layer { spared } else { 0.0 },
            }
        };
        let wall = |w: &Wall, i: usize| Sparing {
            velocity: [0, 1, 2].map(|a| w.velocity[a][i] as f32),
            excess: excess(density[i]),
            spared: 0.0,
        };
        if self.liquid.flow.is_axial() {
            rings::pack_density(&mut self.liquid.flow, !completes, liquid, wall);
            return self.density_rate_of_rings(diffusion);
        }
        self.liquid.flow.pack(liquid, wall);
        let pass = Spared {
            factor: self.gradient_factor(),
            diffusion: (2.0 * diffusion * c) as f32,
            held: gravity.map(|g| (2.0 * diffusion * self.liquid.case.h / c * g) as f32),
            kernel: self.kernel,
        };
        match completes {
            true => self.completed_rate(pass),
            false => self.liquid.sum(&pass, &mut self.own.force),
        }
    }

    /// (4) without a_s, g and viscosity, and the gradient of the kernel sum, into `driven`.
    pub(super) fn pair_force_and_gradient(&mut self) {
        if self.model.settings.pressure == Pressure::Controlled {
            self.pair_force_and_gradient_with::<true>();
        } else {
            self.pair_force_and_gradient_with::<false>();
        }
    }

    fn pair_force_and_gradient_with<const CONTROL: bool>(&mut self) {
        let pass = ForceAndGradient(Force::<K, (), CONTROL> {
            factor: self.gradient_factor(),
            viscosity: (),
            kernel: self.kernel,
        });
        self.liquid.sum(&pass, &mut self.own.driven);
    }

    /// (4) without a_s and g; viscosity `U` in the same loop. Records must be packed.
    pub(super) fn pair_force<U: PairViscosity>(&mut self, viscosity: U) {
        if self.liquid.follows_energy() {
            return self.completed_force();
        }
        if self.model.settings.pressure == Pressure::Controlled {
            self.pair_force_with::<U, true>(viscosity);
        } else {
            self.pair_force_with::<U, false>(viscosity);
        }
    }

    fn pair_force_with<U: PairViscosity, const CONTROL: bool>(&mut self, viscosity: U) {
        if self.liquid.flow.is_axial() {
            return self.force_on_rings();
        }
        let pass = Force::<K, U, CONTROL> {
            factor: self.gradient_factor(),
            viscosity,
            kernel: self.kernel,
        };
        self.liquid.sum(&pass, &mut self.own.force);
    }
}
