//! The second half of a step: from predicted positions and velocities to the pressure.

use super::pass::{Look, Number, PressureSlope, Weights};
use super::{Mps, Smooth};
use crate::kernel::Kernel;
use crate::method::isph::correction::times;
use crate::method::pass::Extrapolation;
use crate::method::pressure::Outcome;
use crate::method::pressure::multigrid::Domain;
use crate::scene::{MpsClosure, MpsGradient, PoissonSource, Preconditioner, Pressure};
use crate::space::parallel::{Slots, each};
use crate::space::sparse::Layout;
use crate::space::sweep;
use std::marker::PhantomData;

/// How many more iterations a safer preconditioner may take.
const PATIENCE: usize = 4;

impl Mps {
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
        let extrapolation = Extrapolation::<Smooth> {
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
            MpsGradient::Corrected => self.look_with::<true>(),
            _ => self.look_with::<false>(),
        }
        let (rho0, h, closure) = (self.case.density, self.case.h, &self.closure);
        let out = Slots::new(&mut self.flow.particles.density);
        let count = self.local.len();
        let local = Slots::new(&mut self.local);
        each(count, |i| {
            let local = unsafe { local.at(i) };
            let slope = local.slope.map(|s| h * s as f64);
            local.density = closure.density(local.kernel_sum as f64, slope) as f32;
            *unsafe { out.at(i) } = rho0 * local.number as f64;
        });
        if self.flow.wall_sees_wall {
            let pass = Number {
                reach: self.reach(),
                factor: 1.0 / self.lattice.number,
            };
            let (records, rows) = (&self.flow.records, &self.flow.wall_rows);
            sweep::rows(records, rows, scale, &pass, &mut self.walls.density);
        }
        self.flag();
    }

    fn look_with<const CORRECTED: bool>(&mut self) {
        let d = self.case.dimension.count();
        let volume = self.flow.particles.mass / self.case.density;
        let pass = Look::<CORRECTED> {
            reach: self.reach(),
            number: 1.0 / self.lattice.number,
            value: self.gradient_factor(),
            length: self.case.h,
            smooth: volume * Smooth::norm(d) / self.case.h.powi(d as i32),
            active: self.active(),
            marks: &self.marks,
        };
        self.local.resize(self.flow.liquid(), Default::default());
        let scale = self.scale();
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        sweep::rows(records, rows, scale, &pass, &mut self.local);
    }

    /// Unknowns whose p is zero because n < beta n0.
    fn flag(&mut self) {
        let n = self.flow.liquid();
        let threshold = self.settings.closure == MpsClosure::Threshold;
        let (local, walls, beta) = (&self.local, &self.walls, self.settings.beta);
        let inside = |i: usize| {
            let number = match i.checked_sub(n) {
                None => local[i].number as f64,
                Some(g) => walls.density[walls.contact[g] as usize],
            };
            f32::from(!threshold || number >= beta)
        };
        self.inside.clear();
        self.inside.extend((0..n + walls.len()).map(inside));
    }

    /// Axes along which anything varies.
    fn active(&self) -> [bool; 3] {
        self.flow.grid.unit.map(|unit| unit > 0.0)
    }

    /// The weights of (4).
    fn couple(&mut self) {
        let (local, walls, inside) = (&self.local, &self.walls, &self.inside);
        let n = self.flow.liquid();
        self.flow.pack(
            |_, i| [inside[i], 1.0 / local[i].density, 0.0, 0.0, 0.0],
            |_, j| {
                let inside = inside[n + walls.group[j] as usize];
                [inside, 1.0, 0.0, walls.offset[j], 0.0]
            },
        );
        self.walls.number(n);
        let layout = Layout {
            records: &self.flow.records,
            liquid: &self.flow.rows,
            wall: &self.flow.wall_rows,
            start: &self.walls.start,
            member: &self.walls.member,
            unknown: &self.walls.unknown,
            scale: self.flow.grid.scale(self.case.h),
        };
        let reach = self.laplacian_reach();
        let e = &mut self.equation;
        let (sparse, degree, sums) = (&mut e.coupling, &mut e.diagonal, &mut self.sums);
        match self.settings.closure {
            MpsClosure::Threshold => {
                sparse.build(&layout, &Weights::<true> { reach }, degree, sums)
            }
            MpsClosure::Completed => {
                sparse.build(&layout, &Weights::<false> { reach }, degree, sums)
            }
        }
    }

    /// Free surfaces, shares and places; a wall that touches nothing has p = 0.
    fn close(&mut self) {
        let n = self.flow.liquid();
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
        let flagged = self.settings.closure == MpsClosure::Threshold;
        let alone = closure.full();
        each(count, |i| {
            let diagonal = unsafe { diagonal.at(i) };
            let s = if flagged {
                sums[i][6] as f64
            } else if i >= n {
                0.0
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

    /// Right-hand side of (6), positive where the pressure must rise.
    fn set_right(&mut self, dt: f64) {
        let n = self.flow.liquid();
        let (rho0, h) = (self.case.density, self.case.h);
        let unit = self.laplacian_factor() / rho0;
        let (local, marks, sums) = (&self.local, &self.marks, &self.sums);
        let source = self.settings.source;
        let (walls, flow, inside) = (&self.walls, &self.flow, &self.inside);
        let completed = self.settings.closure == MpsClosure::Completed;
        let right = Slots::new(&mut self.equation.right);
        each(self.sums.len(), |i| {
            let right = unsafe { right.at(i) };
            let g = i.wrapping_sub(n);
            *right = match source {
                _ if inside[i] == 0.0 => 0.0,
                PoissonSource::Density => {
                    let dense = match i < n {
                        true => local[i].number as f64,
                        false if walls.wet[g] => walls.density[walls.contact[g] as usize],
                        false => 1.0,
                    };
                    (dense - 1.0) / (dt * dt * unit)
                }
                PoissonSource::Divergence { density } if i < n => {
                    // Rows count as much as their volume, 1 / n. Who lacks neighbours at a surface
                    // is not too thin.
                    let n = if completed { local[i].density } else { 1.0 } as f64;
                    let mut dense = if completed { n } else { local[i].number as f64 } - 1.0;
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
        if self.settings.pressure == Pressure::Clipped {
            self.unknown.iter_mut().for_each(|p| *p = p.max(0.0));
            self.pressure.copy_from_slice(&self.unknown[..n]);
        }
        self.push.resize(n, [0.0; 3]);
        let (scale, reach) = (self.scale(), self.reach());
        self.pack_pressure();
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        if self.settings.gradient == MpsGradient::Symmetric {
            let pass = PressureSlope::<true> { reach };
            sweep::rows(records, rows, scale, &pass, &mut self.push);
        } else {
            let pass = PressureSlope::<false> { reach };
            sweep::rows(records, rows, scale, &pass, &mut self.push);
        }
        // d = r_i - r_j: the sign of (3) and that of the acceleration cancel.
        let factor = self.gradient_factor() / (self.case.h * self.case.density);
        let corrected = self.settings.gradient == MpsGradient::Corrected;
        let (local, push) = (&self.local, Slots::new(&mut self.push));
        each(n, |i| {
            let push = unsafe { push.at(i) };
            let mut sum = push.map(|s| factor * s as f64);
            if corrected {
                sum = times(&local[i].correction, sum);
            }
            *push = sum.map(|a| a as f32);
        });
    }

    /// P and Q of `PressureSlope`: p less the least about it and that (`symmetric`), p and the
    /// least about it (`minimum`), or p and itself, near a surface with its sign turned.
    fn pack_pressure(&mut self) {
        let n = self.flow.liquid();
        let gradient = self.settings.gradient;
        if gradient != MpsGradient::Corrected {
            self.find_least();
        }
        let (x, walls, least, marks) = (&self.unknown, &self.walls, &self.least, &self.marks);
        self.flow.pack(
            |_, i| {
                let [p, q] = match gradient {
                    MpsGradient::Symmetric => [x[i] - least[i], 0.0],
                    MpsGradient::Minimum => [x[i], least[i]],
                    MpsGradient::Corrected if marks[i] > 0.0 => [x[i], -x[i]],
                    MpsGradient::Corrected => [x[i], x[i]],
                };
                [p as f32, q as f32, 0.0, 0.0, 0.0]
            },
            |_, j| {
                let mut p = x[n + walls.group[j] as usize] + walls.offset[j] as f64;
                if gradient == MpsGradient::Symmetric {
                    p -= least[n + j];
                }
                [p as f32, 0.0, 0.0, 0.0, 0.0]
            },
        );
    }

    /// The least pressure within the radius of (3) of every particle, itself included.
    fn find_least(&mut self) {
        let n = self.flow.liquid();
        let (flow, walls, x) = (&self.flow, &self.walls, &self.unknown);
        let pressure = |j: usize| match j.checked_sub(n) {
            None => x[j],
            Some(w) => x[n + walls.group[w] as usize] + walls.offset[w] as f64,
        };
        let square = (self.settings.radius * self.case.spacing).powi(2);
        let unit = flow.grid.unit;
        self.least.resize(n + flow.walls(), 0.0);
        let least = Slots::new(&mut self.least);
        each(n + flow.walls(), |i| {
            let row = match i.checked_sub(n) {
                None => flow.rows.row(i),
                Some(w) => flow.wall_rows.row(w),
            };
            let own = &flow.records[i];
            let mut lowest = pressure(i);
            for &j in row {
                let other = &flow.records[j as usize];
                let away = |a: usize| other.at(a).wrapping_sub(own.at(a)) as f64 * unit[a];
                if (0..3).map(|a| away(a).powi(2)).sum::<f64>() < square {
                    lowest = lowest.min(pressure(j as usize));
                }
            }
            *unsafe { least.at(i) } = lowest;
        });
    }
}
