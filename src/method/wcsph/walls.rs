//! What wall particles carry: density, pressure, and the velocity that viscosity sees.

use super::{SURFACE, Wcsph};
use crate::columns;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::pass::{Extrapolation, Moving, WallSums};
use crate::method::wet;
use crate::particle::column::{Entry, Role};
use crate::particle::{Particles, Wall, weight_of};
use crate::scene::Pressure;
use crate::space::parallel::{each_mut, sum_mut};

columns! {
    /// What is kept of a wall particle, in the order of the flow's wall.
    #[derive(Default)]
    pub struct WallState as this {
        /// kg/m^3.
        pub density: f64 => Role::RolledBack,
        pub sums: WallSums => Role::Scratch,
        /// Kernel sum over the liquid of a wall that is wet; empty unless it matters.
        wet: f32 => Role::Held,
        /// The velocity that viscosity sees, m/s.
        viscous: [f32; 3] => Role::Scratch,
    }
    with {
        /// Power of the pressure of the acoustic step before with the velocities of now, W.
        pub power_since: f64,
    }
}

impl Entry for WallSums {}

impl WallState {
    pub fn resize(&mut self, walls: usize, density: f64) {
        self.density.resize(walls, density);
        self.sums.resize(walls, WallSums::default());
        self.viscous.resize(walls, [0.0; 3]);
    }
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Begins anew, with other walls than before.
    pub(super) fn forget_walls(&mut self) {
        self.walls = WallState::default();
        self.walls
            .resize(self.liquid.flow.walls(), self.model.density);
    }

    fn extrapolate(&mut self) {
        if self.liquid.flow.is_axial() {
            return self.extrapolate_rings();
        }
        let pass = Extrapolation {
            kernel: self.kernel,
        };
        self.liquid.sum_at_walls(&pass, &mut self.walls.sums);
    }

    /// Packs records for a force pass, with `ahead` s of the held acceleration added to the
    /// velocity, and gives the walls their pressure.
    pub(super) fn pack_force(&mut self, ahead: f64) {
        self.write_force(ahead, true);
    }

    /// The same when the records hold the present positions.
    pub(super) fn repack_force(&mut self, ahead: f64) {
        self.write_force(ahead, false);
    }

    fn write_force(&mut self, ahead: f64, moved: bool) {
        self.tear();
        let (model, held) = (&self.model, &self.own.held);
        let controlled = model.settings.pressure == Pressure::Controlled;
        let (around, sums) = (&self.own.around, self.sum_factor());
        let rho0 = model.density;
        let inverse = |rho: f64| 1.0 / (rho * rho);
        let liquid = |p: &Particles, i: usize| {
            let rho = p.density[i];
            let velocity: [f32; 3] = if ahead == 0.0 {
                super::velocity(p, i)
            } else {
                [0, 1, 2].map(|a| (p.velocity[a][i] + ahead * held[i][a] as f64) as f32)
            };
            let inside = controlled && around[i].kernel_sum(sums) >= SURFACE;
            Moving {
                velocity,
                pressure: (model.pressure(rho) * inverse(rho)) as f32,
                weight: inverse(rho) as f32 * if inside { -1.0 } else { 1.0 },
            }
        };
        let wall = |_: &Wall, _: usize| Moving {
            weight: inverse(rho0) as f32,
            ..Moving::default()
        };
        self.liquid.flow.pack_moving(moved, liquid, wall);
        if !self.liquid.flow.has_walls() {
            return;
        }
        if !self.liquid.flow.wall_sees_wall {
            self.extrapolate();
            self.walls.power_since = self.power_of_walls();
            self.wall_density();
        }
        self.set_viscous_velocity();
        let (model, walls) = (&self.model, &self.walls);
        self.liquid.flow.pack_moving_wall(|i| {
            let rho = walls.density[i];
            Moving {
                velocity: walls.viscous[i],
                pressure: (model.pressure(rho) * inverse(rho)) as f32,
                weight: inverse(rho) as f32,
            }
        });
    }

    /// Keeps the density of the free surface from falling below that of a torn one,
    /// [`crate::method::model::Model::torn`]: a sheet of one or two particles cannot get
    /// thinner, so that stretching it would look like expansion, and the pressure against that
    /// would take its energy.
    fn tear(&mut self) {
        let Some(least) = self.model.torn(&self.liquid.case) else {
            return;
        };
        let (around, sums) = (&self.own.around, self.sum_factor());
        // Pressure works by the mean of its values now and in the step before, and goes on to do so
        // where density no longer follows.
        let (model, rate, dt) = (&self.model, &self.own.rate, self.liquid.now.last_step);
        let span = self.liquid.flow.span();
        let p = &mut self.liquid.flow.particles;
        let (torn, mass, weights) = (model.pressure(least), p.mass, &p.weight);
        let [given] = sum_mut(
            &mut self.liquid.parts,
            span,
            &mut p.density[..around.len()],
            |i, rho| {
                if around[i].kernel_sum(sums) >= SURFACE || *rho >= least {
                    return [0.0];
                }
                let now = std::mem::replace(rho, least);
                let before = rate.get(i).map_or(now, |rate| now - dt * *rate as f64);
                let mean = 0.5 * (torn + model.pressure(before));
                [weight_of(weights, i) * (mean * (least - now) / (least * least))]
            },
        );
        self.liquid.ledger.diffusion += mass * given;
    }

    /// Pressure of the liquid carried to the wall against gravity (Adami et al. Eq. 27), as
    /// density.
    fn wall_density(&mut self) {
        let walls = self.liquid.flow.walls();
        if self.liquid.follows_energy() && self.walls.wet.len() != walls {
            self.walls.wet = wet::full(&self.liquid.case, &self.liquid.flow.wall);
        }
        let (model, unit, whole) = (&self.model, self.sum_factor(), &self.walls.wet);
        let (g, h) = (self.liquid.body_force.total(), self.liquid.case.h);
        let sums = &self.walls.sums;
        each_mut(&mut self.walls.density[..sums.len()], |i, density| {
            let s = &sums[i];
            let lever: f64 = (0..3).map(|a| g[a] * s.lever[a] as f64).sum();
            let p = if s.weight > 0.0 {
                (s.pressure as f64 + model.density * h * lever) / s.weight as f64
            } else {
                0.0
            };
            let part = match whole.get(i) {
                Some(whole) if s.weight > 0.0 => wet::part(unit * s.weight, *whole),
                _ => 1.0,
            };
            *density = model.density_at(part as f64 * p);
        });
    }

    /// 2 u_wall - <v> (Adami et al. Eq. 23): no slip. A wall with its own density keeps u_wall.
    fn set_viscous_velocity(&mut self) {
        let (sums, wall) = (&self.walls.sums, &self.liquid.flow.wall);
        let own = self.liquid.flow.wall_sees_wall;
        each_mut(&mut self.walls.viscous[..sums.len()], |i, viscous| {
            let s = &sums[i];
            let out = viscous;
            for a in 0..3 {
                let u = wall.velocity[a][i] as f32;
                out[a] = if s.weight > 0.0 && !own {
                    2.0 * u - s.velocity[a] / s.weight
                } else {
                    u
                };
            }
        });
    }

    /// Packs records for the advective pass, the walls with the velocity that makes no slip.
    pub(super) fn extrapolate_velocity(&mut self) {
        let w0 = (1.0 / (self.model.density * self.model.density)) as f32;
        let flow = &mut self.liquid.flow;
        flow.pack_moving(
            true,
            |p, i| Moving {
                velocity: super::velocity(p, i),
                pressure: 0.0,
                weight: (1.0 / (p.density[i] * p.density[i])) as f32,
            },
            |_, _| Moving {
                weight: w0,
                ..Moving::default()
            },
        );
        if !self.liquid.flow.has_walls() {
            return;
        }
        if !self.liquid.flow.wall_sees_wall {
            self.extrapolate();
        }
        self.set_viscous_velocity();
        let viscous = &self.walls.viscous;
        self.liquid.flow.pack_moving_wall(|i| Moving {
            velocity: viscous[i],
            pressure: 0.0,
            weight: w0,
        });
    }
}
