//! The second half of a step: from predicted positions and velocities to the pressure.

use super::product::Product;
use super::walls::Halt;
use super::{Projection, SURFACE, Scheme};
use crate::method::pass::Moving;
use crate::method::pressure::multigrid::{Domain, pitch};
use crate::method::pressure::{Outcome, Rows};
use crate::method::shifting::LOOSE;
use crate::scene::{PoissonSource, Preconditioner};
use crate::space::parallel::each_mut;

/// How many more iterations a safer preconditioner may take.
const PATIENCE: usize = 4;

impl<S: Scheme> Projection<S> {
    /// Solves for the pressure at the predicted state; `push` becomes its acceleration.
    pub(super) fn project(&mut self, dt: f64) -> Outcome {
        self.look_ahead(dt);
        S::couple(self);
        self.close();
        if self.settings.preconditioner == Preconditioner::Multigrid {
            let domain = self.domain();
            self.solver.prepare(&self.equation, &domain);
        }
        let is_transposed = self.scheme.is_transposed();
        let outcome = match self.settings.source {
            PoissonSource::Divergence { density } if is_transposed => {
                self.solve_transposed(dt, density)
            }
            _ => {
                self.set_right(dt);
                self.solve(self.settings.tolerance)
            }
        };
        if outcome.converged {
            let n = self.liquid.len();
            self.own.pressure.copy_from_slice(&self.unknown[..n]);
            match is_transposed {
                true => self.press_all(),
                false => {
                    self.equation.fill(&mut self.unknown);
                    S::slope(self);
                }
            }
            if self.scheme.is_corrected() {
                self.keep_momentum();
            }
        }
        outcome
    }

    /// Kernel sums, divergence, corrections, and what walls are to have.
    fn look_ahead(&mut self, dt: f64) {
        let pressure = &self.own.pressure;
        self.liquid.flow.pack_moving(
            true,
            |p, i| Moving {
                velocity: [0, 1, 2].map(|a| p.velocity[a][i] as f32),
                pressure: pressure[i] as f32,
                weight: 1.0,
            },
            |_, _| Moving {
                weight: 1.0,
                ..Moving::default()
            },
        );
        self.extrapolate();
        let factor = self.factor(0);
        self.walls.gather(&self.liquid.flow.wall, factor);
        let still = self.is_printed();
        let halt = self.halt(dt);
        self.walls.set_offsets(&self.liquid.flow.wall, still, &halt);
        let walls = &self.walls;
        self.liquid.flow.pack_moving_wall(|j| Moving {
            velocity: walls.velocity[walls.group[j] as usize],
            pressure: 0.0,
            weight: 1.0,
        });
        self.own.local.resize(self.liquid.len(), Default::default());
        match self.liquid.flow.is_axial() {
            true => self.look_at_rings(),
            false => S::look(self),
        }
        let (rho0, h, closure) = (self.liquid.case.density, self.liquid.case.h, &self.closure);
        let count = self.own.local.len();
        each_mut(
            (
                &mut self.own.local[..count],
                &mut self.liquid.flow.particles.density[..count],
            ),
            |_, (local, out)| {
                let slope = local.slope.map(|s| h * s as f64);
                local.density = closure.density(local.kernel_sum as f64, slope) as f32;
                *out = rho0 * local.number as f64;
            },
        );
        if S::walls_are_dense(self) {
            S::look_at_walls(self);
            let own = self.walls.own.iter();
            let density = self.walls.density.iter_mut();
            density.zip(own).for_each(|(density, own)| *density += own);
        }
    }

    /// Free surfaces, shares and places; a wall that touches nothing has p = 0.
    fn close(&mut self) {
        let n = self.liquid.len();
        let (h, d) = (
            self.liquid.case.h,
            self.liquid.case.dimension.count() as f64,
        );
        let mut e = std::mem::take(&mut self.equation);
        let count = e.diagonal.len();
        e.surface.resize(count, 0.0);
        e.share.resize(count, 0.0);
        e.right.resize(count, 0.0);
        e.place.iter_mut().for_each(|x| x.resize(count, 0.0));
        let (this, closure) = (&*self, &self.closure);
        each_mut(
            (
                &mut e.diagonal[..count],
                &mut e.surface[..count],
                &mut e.share[..count],
            ),
            |i, (diagonal, surface, share)| {
                let sums = &this.sums[i];
                let mass = this.mass(i);
                let s = match S::flagged(this, i, *diagonal) {
                    Some(s) => s,
                    None if i >= n => 0.0,
                    None => {
                        let local = &this.own.local[i];
                        let slope = local.slope.map(|s| h * s as f64);
                        let moment = [2, 3, 4].map(|k| sums[k] as f64 / mass);
                        let degree = *diagonal / mass + this.coupled_alone(i);
                        mass * closure.surface(local.kernel_sum as f64, slope, degree, moment)
                    }
                };
                // Who has no neighbours has no pressure.
                let s = if *diagonal + s > 0.0 {
                    s
                } else {
                    mass * closure.full()
                };
                *diagonal += s;
                *surface = s;
                *share = sums[0] as f64 * h * h / (2.0 * d);
            },
        );
        for a in 0..3 {
            let (liquid, wall) = (
                &self.liquid.flow.particles.position[a],
                &self.liquid.flow.wall.position[a],
            );
            e.place[a][..n].copy_from_slice(liquid);
            for (g, x) in e.place[a][n..].iter_mut().enumerate() {
                *x = wall[self.walls.contact[g] as usize];
            }
        }
        self.join_ranks(&mut e);
        self.equation = e;
    }

    /// By which the row of unknown `i` is multiplied: the mass of a ring over the nominal one.
    pub(super) fn mass(&self, i: usize) -> f64 {
        match i < self.liquid.len() {
            true => self.liquid.flow.particles.weight(i),
            false => 1.0,
        }
    }

    /// Right-hand side of (2), positive where the pressure must rise.
    fn set_right(&mut self, dt: f64) {
        let mut values = std::mem::take(&mut self.equation.right);
        let this = &*self;
        let unit = S::unit(this);
        let (n, span, held) = (this.liquid.len(), this.span(dt), this.cohesion());
        each_mut(&mut values[..this.sums.len()], |i, right| {
            *right = match this.settings.source {
                _ if S::given(this, i) => 0.0,
                PoissonSource::Density => {
                    let walls = &this.walls;
                    let dense = match i.checked_sub(n) {
                        None => this.own.local[i].number as f64,
                        Some(g) if walls.wet[g] => walls.density[walls.contact[g] as usize],
                        Some(_) => 1.0,
                    };
                    (dense - 1.0) / (dt * dt * unit)
                }
                PoissonSource::Divergence { density } if i < n => {
                    // Rows count as much as their volume, 1 / n.
                    let [n, _] = S::dense(this, i);
                    let rate =
                        density * this.excess(i) / span - this.own.local[i].divergence as f64;
                    let right = rate / (n * dt * unit) + this.sums[i][1] as f64;
                    // What is stretched at a surface tears: a sheet of one or two particles cannot
                    // get thinner, and to hold it together would take its energy.
                    if (this.own.local[i].kernel_sum as f64) < SURFACE {
                        right.max(0.0 - held * this.equation.diagonal[i])
                    } else {
                        right
                    }
                }
                PoissonSource::Divergence { .. } => this.wall_flux(i, dt),
            };
        });
        self.equation.right = values;
    }

    /// How much too dense particle `i` is, over rho0. Spray is not too thin.
    pub(super) fn excess(&self, i: usize) -> f64 {
        let [_, seen] = S::dense(self, i);
        match self.own.local[i].kernel_sum < LOOSE {
            true => (seen - 1.0).max(0.0),
            false => seen - 1.0,
        }
    }

    /// In which time a part of the deviation of density goes, s: a step of the scene's own speed at
    /// least, else the steps that a few fast particles shorten would ask for ever more pressure.
    pub(super) fn span(&self, dt: f64) -> f64 {
        let usual = self.settings.courant * self.liquid.case.spacing / self.liquid.case.speed;
        if usual.is_finite() { dt.max(usual) } else { dt }
    }

    /// What a surface holds before it tears, Pa: the tension of a particle of radius h.
    pub(super) fn cohesion(&self) -> f64 {
        let case = &self.liquid.case;
        let sides = case.space as f64 - 1.0;
        let sigma = case.effects.sigma().unwrap_or(0.0);
        self.settings.cohesion * sides * sigma / case.h
    }

    /// What walls take in a step of which `dt` is the part theta. With the transposed gradient they
    /// hold gravity only (Adami, Hu & Adams 2012, Eq. 27): the divergence sees what moves through a
    /// wall. To take it away twice would cost the energy of all that moves before a wall, and the
    /// more the shorter the steps are.
    fn halt(&self, dt: f64) -> Halt {
        let theta = self.settings.theta;
        let g = self.liquid.body_force.total();
        if self.scheme.is_transposed() {
            return Halt {
                density: self.liquid.case.density,
                dt: f64::INFINITY,
                late: g,
            };
        }
        Halt {
            density: self.liquid.case.density,
            dt: dt / theta,
            late: g.map(|g| (1.0 - theta) * g),
        }
    }

    /// The right-hand side of the group of wall particles `i`: what its offsets move.
    pub(super) fn wall_flux(&self, i: usize, dt: f64) -> f64 {
        let (h, sums) = (self.liquid.case.h, &self.sums[i]);
        let group = i - self.liquid.len();
        let slope = self
            .walls
            .slope(group, &self.liquid.flow.wall, &self.halt(dt));
        let lever = |a: usize| slope[a] * h * sums[2 + a] as f64;
        self.walls.share[group] * (0..3).map(lever).sum::<f64>() - sums[5] as f64
    }

    /// First guess: the last pressure, and before walls that of the liquid.
    pub(super) fn guess(&mut self) {
        let n = self.liquid.len();
        let count = self.equation.len();
        self.unknown.resize(self.equation.columns(), 0.0);
        self.unknown[..n].copy_from_slice(&self.own.pressure);
        self.unknown[n..count].copy_from_slice(&self.walls.guess);
    }

    /// Where multigrid lays its grids.
    pub(super) fn domain(&self) -> Domain {
        Domain {
            active: self.active(),
            periodic: self.liquid.flow.grid.periodic,
            size: self.liquid.case.domain.size,
            pitch: pitch(&self.liquid.case),
        }
    }

    /// From a first guess, with the preconditioner of the settings, then with the safest.
    fn solve(&mut self, tolerance: f64) -> Outcome {
        self.guess();
        self.go_on(tolerance)
    }

    /// The same from the pressure that `unknown` has.
    pub(super) fn go_on(&mut self, tolerance: f64) -> Outcome {
        let wanted = (tolerance, self.settings.iterations);
        let outcome = self.solve_with(self.settings.preconditioner, wanted);
        if outcome.converged {
            return outcome;
        }
        self.solution.repeated += 1;
        self.guess();
        let again = self.solve_with(Preconditioner::Diagonal, (wanted.0, PATIENCE * wanted.1));
        Outcome {
            iterations: outcome.iterations + again.iterations,
            ..again
        }
    }

    fn solve_with(&mut self, by: Preconditioner, wanted: (f64, usize)) -> Outcome {
        let mut solver = std::mem::take(&mut self.solver);
        let mut equation = std::mem::take(&mut self.equation);
        let mut x = std::mem::take(&mut self.unknown);
        let outcome = match self.scheme.is_transposed() {
            true => {
                self.hold_given(&mut x);
                solver.solve(&mut equation, &mut Product(self), by, wanted, &mut x)
            }
            false => solver.solve(&mut equation, &mut Rows, by, wanted, &mut x),
        };
        (self.solver, self.equation, self.unknown) = (solver, equation, x);
        outcome
    }
}
