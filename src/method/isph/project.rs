//! The second half of a step: from predicted positions and velocities to the pressure.

use super::pass::{Look, PressureSlope, Weights};
use super::{Isph, surface};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::isph::correction::times;
use crate::method::pass::{Extrapolation, Summation};
use crate::method::pressure::Outcome;
use crate::method::pressure::multigrid::Domain;
use crate::scene::{Closure, Gradient, PoissonSource, Preconditioner};
use crate::space::parallel::{Slots, each};
use crate::space::sparse::Layout;
use crate::space::sweep;
use std::marker::PhantomData;

/// How many more iterations a safer preconditioner may take.
const PATIENCE: usize = 4;

impl<K: Kernel, V: PairViscosity> Isph<K, V> {
    /// Solves for the pressure at the predicted state; `push` becomes its acceleration.
    pub(super) fn project(&mut self, dt: f64) -> Outcome {
        self.look_ahead(dt);
        self.couple();
        self.close();
        self.set_right(dt);
        self.guess();
        let outcome = self.solve();
        if outcome.converged {
            let n = self.flow.liquid();
            self.pressure.copy_from_slice(&self.unknown[..n]);
            self.slope();
        }
        outcome
    }

    /// Kernel sums, divergence, corrections, and what walls are to have.
    fn look_ahead(&mut self, dt: f64) {
        let pressure = &self.pressure;
        self.flow.pack(
            |p, i| {
                let [x, y, z] = [0, 1, 2].map(|a| p.velocity[a][i] as f32);
                [x, y, z, pressure[i] as f32, 1.0]
            },
            |_, _| [0.0, 0.0, 0.0, 0.0, 1.0],
        );
        let scale = self.scale();
        let extrapolation = Extrapolation::<K> {
            kernel: PhantomData,
        };
        let (records, rows) = (&self.flow.records, &self.flow.wall_rows);
        sweep::rows(records, rows, scale, &extrapolation, &mut self.walls.sums);
        self.walls.gather(&self.flow.wall);
        let still = self.is_printed();
        let (wall, density) = (&self.flow.wall, self.case.density);
        self.walls.set_offsets(wall, still, density, dt);
        let walls = &self.walls;
        self.flow.pack_wall(|j| {
            let [x, y, z] = walls.velocity[walls.group[j] as usize];
            [x, y, z, 0.0, 1.0]
        });
        match self.settings.gradient {
            Gradient::Corrected => self.look_with::<true>(),
            Gradient::Symmetric => self.look_with::<false>(),
        }
        let (rho0, h, closure) = (self.case.density, self.case.h, &self.closure);
        let out = Slots::new(&mut self.flow.particles.density);
        let count = self.local.len();
        let local = Slots::new(&mut self.local);
        each(count, |i| {
            let local = unsafe { local.at(i) };
            let sum = local.kernel_sum as f64;
            let slope = local.slope.map(|s| h * s as f64);
            local.density = closure.density(sum, slope) as f32;
            *unsafe { out.at(i) } = rho0 * sum;
        });
        if self.flow.wall_sees_wall {
            let value = self.factor(0);
            let pass = Summation::<K> {
                factor: value,
                own: value * K::w(0.0),
                kernel: PhantomData,
            };
            let (records, rows) = (&self.flow.records, &self.flow.wall_rows);
            sweep::rows(records, rows, scale, &pass, &mut self.walls.density);
        }
    }

    fn look_with<const CORRECTED: bool>(&mut self) {
        let pass = Look::<K, CORRECTED> {
            value: self.factor(0),
            gradient: self.factor(1),
            active: self.active(),
            marks: &self.marks,
            kernel: PhantomData,
        };
        self.local.resize(self.flow.liquid(), Default::default());
        let scale = self.scale();
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        sweep::rows(records, rows, scale, &pass, &mut self.local);
    }

    /// Axes along which anything varies.
    fn active(&self) -> [bool; 3] {
        self.flow.grid.unit.map(|unit| unit > 0.0)
    }

    /// The weights of Eq. 8 in units of 2 m norm / (rho0^2 h^(d+2)).
    fn couple(&mut self) {
        let (local, walls) = (&self.local, &self.walls);
        self.flow.pack(
            |_, i| [local[i].kernel_sum, 1.0 / local[i].density, 0.0, 0.0, 0.0],
            |_, j| [walls.density[j] as f32, 1.0, 0.0, walls.offset[j], 0.0],
        );
        self.walls.number(self.flow.liquid());
        let layout = Layout {
            records: &self.flow.records,
            liquid: &self.flow.rows,
            wall: &self.flow.wall_rows,
            start: &self.walls.start,
            member: &self.walls.member,
            unknown: &self.walls.unknown,
            scale: self.flow.grid.scale(self.case.h),
        };
        let e = &mut self.equation;
        let (sparse, degree, sums) = (&mut e.coupling, &mut e.diagonal, &mut self.sums);
        match self.settings.source {
            PoissonSource::Density => {
                sparse.build(&layout, &Weights::<K, true>(PhantomData), degree, sums)
            }
            PoissonSource::Divergence { .. } => {
                sparse.build(&layout, &Weights::<K, false>(PhantomData), degree, sums)
            }
        }
    }

    /// Free surfaces, shares and places; a wall that touches nothing has p = 0.
    fn close(&mut self) {
        let n = self.flow.liquid();
        if self.settings.closure == Closure::Mirrored {
            self.detect();
        }
        let (h, d) = (self.case.h, self.case.dimension.count() as f64);
        let e = &mut self.equation;
        let count = e.diagonal.len();
        e.surface.resize(count, 0.0);
        e.share.resize(count, 0.0);
        e.right.resize(count, 0.0);
        e.place.iter_mut().for_each(|x| x.resize(count, 0.0));
        let (surface, diagonal) = (Slots::new(&mut e.surface), Slots::new(&mut e.diagonal));
        let (share, sums) = (Slots::new(&mut e.share), &self.sums);
        let (local, closure) = (&self.local, &self.closure);
        let mirrored = &self.scratch.mirrored;
        let flagged = self.settings.closure == Closure::Mirrored;
        let alone = closure.full();
        each(count, |i| {
            let diagonal = unsafe { diagonal.at(i) };
            let s = if i >= n {
                0.0
            } else if flagged {
                if mirrored[i] { *diagonal } else { 0.0 }
            } else {
                let slope = local[i].slope.map(|s| h * s as f64);
                let moment = [2, 3, 4].map(|k| sums[i][k] as f64);
                closure.surface(local[i].kernel_sum as f64, slope, *diagonal, moment)
            };
            // Who has no neighbours has no pressure.
            let s = if *diagonal + s > 0.0 { s } else { alone };
            *diagonal += s;
            *unsafe { surface.at(i) } = s;
            *unsafe { share.at(i) } = sums[i][0] as f64 * h * h / (2.0 * d);
        });
        for a in 0..3 {
            let (liquid, wall) = (
                &self.flow.particles.position[a],
                &self.flow.wall.position[a],
            );
            e.place[a][..n].copy_from_slice(liquid);
            for (g, x) in e.place[a][n..].iter_mut().enumerate() {
                *x = wall[self.walls.contact[g] as usize];
            }
        }
    }

    /// Flags of the first closure.
    fn detect(&mut self) {
        let n = self.flow.liquid();
        self.scratch.mirrored.resize(n, false);
        let planar = self.case.dimension.count() == 2;
        let scene = (&self.flow.grid, self.case.h, planar);
        let (local, records, rows) = (&self.local, &self.flow.records, &self.flow.rows);
        let out = Slots::new(&mut self.scratch.mirrored);
        each(n, |i| {
            *unsafe { out.at(i) } = surface::is_surface(&local[i], i, rows.row(i), records, scene)
        });
    }

    /// Right-hand side of (3), positive where the pressure must rise.
    fn set_right(&mut self, dt: f64) {
        let n = self.flow.liquid();
        let (rho0, h) = (self.case.density, self.case.h);
        let unit = 2.0 * self.factor(2) / rho0;
        let (local, marks, sums) = (&self.local, &self.marks, &self.sums);
        let source = self.settings.source;
        let walls = &self.walls;
        let flow = &self.flow;
        let right = Slots::new(&mut self.equation.right);
        each(self.sums.len(), |i| {
            let right = unsafe { right.at(i) };
            let g = i.wrapping_sub(n);
            *right = match source {
                PoissonSource::Density => {
                    let dense = match i < n {
                        true => local[i].kernel_sum as f64,
                        false if walls.wet[g] => walls.density[walls.contact[g] as usize],
                        false => 1.0,
                    };
                    (dense - 1.0) / (dt * dt * unit)
                }
                PoissonSource::Divergence { density } if i < n => {
                    // Rows count as much as their volume, 1 / n. Who lacks neighbours at a surface
                    // is not too thin.
                    let n = local[i].density as f64;
                    let mut dense = n - 1.0;
                    if marks[i] > 0.0 {
                        dense = dense.max(0.0);
                    }
                    let rate = density * dense / dt - local[i].divergence as f64;
                    rate / (n * dt * unit) + sums[i][1] as f64
                }
                PoissonSource::Divergence { .. } => {
                    let slope = walls.slope(g, &flow.wall, rho0, dt);
                    let lever = |a: usize| slope[a] * h * sums[i][2 + a] as f64;
                    (0..3).map(lever).sum::<f64>() - sums[i][5] as f64
                }
            };
        });
    }

    /// First guess: the last pressure, and before walls that of the liquid.
    fn guess(&mut self) {
        let n = self.flow.liquid();
        self.unknown.resize(self.equation.len(), 0.0);
        self.unknown[..n].copy_from_slice(&self.pressure);
        self.unknown[n..].copy_from_slice(&self.walls.guess);
    }

    /// With the preconditioner of the settings, then with the safest.
    fn solve(&mut self) -> Outcome {
        let domain = Domain {
            active: self.active(),
            periodic: self.flow.grid.periodic,
            size: self.case.domain.size,
            pitch: 2.0 * self.case.h,
        };
        let wanted = (self.settings.tolerance, self.settings.iterations);
        let (equation, x) = (&mut self.equation, &mut self.unknown);
        let first = self.settings.preconditioner;
        let outcome = self.solver.solve(equation, &domain, first, wanted, x);
        if outcome.converged {
            return outcome;
        }
        self.repeated += 1;
        self.guess();
        let (equation, x) = (&mut self.equation, &mut self.unknown);
        let wanted = (wanted.0, PATIENCE * wanted.1);
        let second = Preconditioner::Diagonal;
        let again = self.solver.solve(equation, &domain, second, wanted, x);
        Outcome {
            iterations: outcome.iterations + again.iterations,
            ..again
        }
    }

    /// -grad p / rho.
    fn slope(&mut self) {
        let n = self.flow.liquid();
        let printed = self.is_printed();
        let (x, walls, local) = (&self.unknown, &self.walls, &self.local);
        let thin = |dense: f64| if printed { 1.0 / (dense * dense) } else { 1.0 };
        self.flow.pack(
            |_, i| {
                let p = x[i] * thin(local[i].kernel_sum as f64);
                [p as f32, 0.0, 0.0, 0.0, 0.0]
            },
            |_, j| {
                let p = x[n + walls.group[j] as usize] + walls.offset[j] as f64;
                [(p * thin(walls.density[j])) as f32, 0.0, 0.0, 0.0, 0.0]
            },
        );
        self.push.resize(n, [0.0; 3]);
        let scale = self.scale();
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        let symmetric = self.settings.gradient == Gradient::Symmetric;
        if symmetric {
            let pass = PressureSlope::<K, true>(PhantomData);
            sweep::rows(records, rows, scale, &pass, &mut self.push);
        } else {
            let pass = PressureSlope::<K, false>(PhantomData);
            sweep::rows(records, rows, scale, &pass, &mut self.push);
        }
        let (factor, rho0) = (-self.factor(1) / self.case.density, self.case.density);
        let (local, marks, push) = (&self.local, &self.marks, Slots::new(&mut self.push));
        let x = &self.unknown;
        each(n, |i| {
            let push = unsafe { push.at(i) };
            let sum = push.map(|s| factor * s as f64);
            let corrected = if symmetric {
                sum
            } else if marks[i] > 0.0 {
                // The sum of pressures from their difference: 2 p_a SUM V grad W more.
                [0, 1, 2].map(|a| sum[a] - 2.0 * x[i] / rho0 * local[i].slope[a] as f64)
            } else {
                times(&local[i].correction, sum)
            };
            *push = corrected.map(|a| a as f32);
        });
    }
}
