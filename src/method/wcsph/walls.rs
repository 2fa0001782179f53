//! What wall particles carry: density, pressure, and the velocity that viscosity sees.

use super::{SURFACE, Wcsph};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::pass::{Extrapolation, WallSums};
use crate::particle::{Particles, Wall};
use crate::scene::Pressure;
use crate::space::parallel::{Slots, each};
use crate::space::sweep;

/// One entry per wall particle, in the order of the flow's wall.
#[derive(Default)]
pub struct WallState {
    /// kg/m^3.
    pub density: Vec<f64>,
    sums: Vec<WallSums>,
    /// The velocity that viscosity sees, m/s.
    viscous: Vec<[f32; 3]>,
}

impl WallState {
    pub fn resize(&mut self, walls: usize, density: f64) {
        self.density.resize(walls, density);
        self.sums.resize(walls, WallSums::default());
        self.viscous.resize(walls, [0.0; 3]);
    }
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    fn extrapolate(&mut self) {
        let scale = self.scale();
        let pass = Extrapolation {
            kernel: self.kernel,
        };
        let (records, rows) = (&self.flow.records, &self.flow.wall_rows);
        sweep::rows(records, rows, scale, &pass, &mut self.walls.sums);
    }

    /// Packs records for a force pass: velocity, P/rho^2, 1/rho^2, with `ahead` s of the held
    /// acceleration added to the velocity, and gives the walls their pressure.
    pub(super) fn pack_force(&mut self, ahead: f64) {
        self.write_force(ahead, true);
    }

    /// The same when the records hold the present positions.
    pub(super) fn repack_force(&mut self, ahead: f64) {
        self.write_force(ahead, false);
    }

    fn write_force(&mut self, ahead: f64, moved: bool) {
        self.tear();
        let (model, held) = (&self.model, &self.held);
        let controlled = model.settings.pressure == Pressure::Controlled;
        let (around, sums) = (&self.around, self.sum_factor());
        let rho0 = model.density;
        let inverse = |rho: f64| 1.0 / (rho * rho);
        let liquid = |p: &Particles, i: usize| {
            let rho = p.density[i];
            let v: [f32; 3] = if ahead == 0.0 {
                super::velocity(p, i)
            } else {
                [0, 1, 2].map(|a| (p.velocity[a][i] + ahead * held[i][a] as f64) as f32)
            };
            let pressure = (model.pressure(rho) * inverse(rho)) as f32;
            let inside = controlled && around[i].kernel_sum(sums) >= SURFACE;
            let weight = inverse(rho) as f32 * if inside { -1.0 } else { 1.0 };
            [v[0], v[1], v[2], pressure, weight]
        };
        let wall = |_: &Wall, _: usize| [0.0, 0.0, 0.0, 0.0, inverse(rho0) as f32];
        if moved {
            self.flow.pack(liquid, wall);
        } else {
            self.flow.repack(liquid, wall);
        }
        if self.flow.walls() == 0 {
            return;
        }
        if !self.flow.wall_sees_wall {
            self.extrapolate();
            self.wall_density();
        }
        self.set_viscous_velocity();
        let (model, walls) = (&self.model, &self.walls);
        self.flow.pack_wall(|i| {
            let (rho, v) = (walls.density[i], walls.viscous[i]);
            let pressure = (model.pressure(rho) * inverse(rho)) as f32;
            [v[0], v[1], v[2], pressure, inverse(rho) as f32]
        });
    }

    /// Keeps the density of the free surface from falling below that of a torn one,
    /// [`crate::method::model::Model::torn`]: a sheet of one or two particles cannot get
    /// thinner, so that stretching it would look like expansion, and the pressure against that
    /// would take its energy.
    fn tear(&mut self) {
        let Some(least) = self.model.torn() else {
            return;
        };
        let (around, sums) = (&self.around, self.sum_factor());
        let density = Slots::new(&mut self.flow.particles.density);
        each(around.len(), |i| {
            if around[i].kernel_sum(sums) < SURFACE {
                let rho = unsafe { density.at(i) };
                *rho = rho.max(least);
            }
        });
    }

    /// Pressure of the liquid carried to the wall against gravity (Adami et al. Eq. 27), as
    /// density.
    fn wall_density(&mut self) {
        let model = &self.model;
        let g = model.effects.gravity.unwrap_or([0.0; 3]);
        let (sums, density) = (&self.walls.sums, Slots::new(&mut self.walls.density));
        each(sums.len(), |i| {
            let s = &sums[i];
            let lever: f64 = (0..3).map(|a| g[a] * s.lever[a] as f64).sum();
            let p = if s.weight > 0.0 {
                (s.pressure as f64 + model.density * model.h * lever) / s.weight as f64
            } else {
                0.0
            };
            *unsafe { density.at(i) } = model.density_at(p);
        });
    }

    /// 2 u_wall - <v> (Adami et al. Eq. 23): no slip. A wall with its own density keeps u_wall.
    fn set_viscous_velocity(&mut self) {
        let (sums, wall) = (&self.walls.sums, &self.flow.wall);
        let own = self.flow.wall_sees_wall;
        let viscous = Slots::new(&mut self.walls.viscous);
        each(sums.len(), |i| {
            let s = &sums[i];
            let out = unsafe { viscous.at(i) };
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
        self.flow.pack(
            |p, i| {
                let v = super::velocity(p, i);
                [
                    v[0],
                    v[1],
                    v[2],
                    0.0,
                    (1.0 / (p.density[i] * p.density[i])) as f32,
                ]
            },
            |_, _| [0.0, 0.0, 0.0, 0.0, w0],
        );
        if self.flow.walls() == 0 {
            return;
        }
        if !self.flow.wall_sees_wall {
            self.extrapolate();
        }
        self.set_viscous_velocity();
        let viscous = &self.walls.viscous;
        self.flow
            .pack_wall(|i| [viscous[i][0], viscous[i][1], viscous[i][2], 0.0, w0]);
    }
}
