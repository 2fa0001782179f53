//! One step, as the algorithm box of Kuri et al. has it.

use super::{MIST, Projection, Scheme, Scratch};
use crate::effect::gravity;
use crate::method::flow::retain;
use crate::method::limit::Limits;
use crate::method::pass::{Extrapolation, Marked};
use crate::method::{Diverged, frame};
use crate::space::parallel::{each_mut, max, sum_mut, three};
use crate::space::sweep;
use std::marker::PhantomData;

/// Halvings of a step whose pressure cannot be found, or that throws a particle.
const HALVINGS: usize = 5;

/// Spacings that sqrt(p / rho) crosses in a step: a third of what is stable on a lattice.
const ELASTIC: f64 = 0.25;

/// Part of the capillary limit over which projections do not shake the layer at a surface whose
/// tension has an energy (water at rest, ISPH, kinetic energy after 40 ms: at 1 3e-5, at 1/2
/// 2e-5, at 1/4 2e-7 J/kg).
const LAYER: f64 = 0.25;

/// Longest step of a liquid that nothing moves, s.
const IDLE: f64 = 1.0;

impl<S: Scheme> Projection<S> {
    pub(super) fn advance_step(&mut self) -> Result<(), Diverged> {
        let expected = self.next_step();
        self.flow.lasting = if self.fastest > 0.0 { expected } else { 0.0 };
        self.rebuild();
        self.hold(0.5 * expected);
        self.connected = self.connected_speed();
        let mut dt = self.next_step().min(expected.max(self.settings.shortest));
        self.remember();
        let (mut done, mut known) = (false, true);
        for attempt in 0..=HALVINGS {
            let ahead = self.settings.theta * dt;
            self.predict(ahead);
            known = !self.flow.stale(|_| 0.0);
            if known {
                self.outcome = self.project(ahead);
                done = self.outcome.converged;
            }
            self.peak = self.peak();
            let stable = self.elastic().max(self.settings.shortest);
            let last = attempt == HALVINGS;
            let short = dt <= 2.0 * stable || last;
            if done && short {
                self.correct(dt);
                if last || self.check(dt).is_ok() {
                    break;
                }
                // Thrown past its neighbours: over half the step it passes fewer.
                self.repeated += 1;
            }
            self.restore();
            dt = if done && !short { stable } else { 0.5 * dt };
            done = false;
        }
        if !done {
            return Err(self.unsolved(dt, known));
        }
        self.check(dt)?;
        self.ledger.step(dt);
        self.ledger.walls += self.ledger.rubbed;
        if self.case.shifts(self.settings.shifting) {
            let before = self.stored();
            self.shift(dt);
            self.ledger.shifting += self.stored() - before;
        }
        self.time += dt;
        self.step += 1;
        self.last_step = dt;
        Ok(())
    }

    fn limits_now(&self) -> Limits {
        Limits {
            h: self.case.h,
            spacing: self.case.spacing,
            density: self.case.density,
            sound_speed: f64::INFINITY,
            viscosity: self.case.effects.mu(),
            tension: self.case.effects.sigma(),
            speed: self.connected,
            acceleration: self.hardest,
        }
    }

    /// Every limit by name, s, least first.
    pub(super) fn step_limits(&self) -> Vec<(&'static str, f64)> {
        let mut all = self.limits_now().all();
        all.retain(|(name, _)| *name != "acoustic");
        all.push(("advective", self.advective()));
        all.push(("pressure", self.elastic()));
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all
    }

    /// Spray may cross a spacing, s.
    fn advective(&self) -> f64 {
        let connected = self.settings.courant * self.case.spacing / self.connected.max(1e-30);
        connected.min(self.case.spacing / self.fastest.max(1e-30))
    }

    /// Where a symmetric gradient stays stable, s.
    fn elastic(&self) -> f64 {
        if !self.scheme.is_symmetric() {
            return f64::INFINITY;
        }
        ELASTIC * self.case.spacing / (self.peak / self.case.density).sqrt().max(1e-30)
    }

    fn next_step(&self) -> f64 {
        let limits = self.limits_now();
        let waves = match self.case.follows_energy() {
            true => LAYER * limits.capillary(),
            false => limits.capillary(),
        };
        let mut least = limits.force().min(limits.viscous()).min(waves);
        if self.scheme.is_symmetric() {
            least = least.min(self.elastic());
        }
        let (shortest, longest) = (self.settings.shortest, self.settings.longest);
        self.advective()
            .min(least)
            .clamp(shortest, longest)
            .min(IDLE)
    }

    /// Wraps, removes, sorts along cells, finds neighbours.
    pub(super) fn rebuild(&mut self) {
        let (before, gone) = (self.stored(), self.flow.removed.1);
        let (around, sums) = (&self.around, self.sum_factor());
        let mist = &mut self.scratch.mist;
        mist.clear();
        if self.pool && self.step > 0 {
            let is = |i: usize| self.flow.crosses(i) && sums * around[i].kernel < MIST;
            mist.extend((0..around.len()).map(is));
        }
        // All vectors that are held are made anew before they are used.
        let doomed = |i: usize| !mist.is_empty() && mist[i];
        if let Some(keep) = self.flow.confine(doomed, &mut []) {
            retain(&mut self.pressure, &keep);
            retain(&mut self.around, &keep);
        }
        self.ledger.removal += self.stored() - before;
        self.ledger.removes = self.flow.removed.1 > gone;
        self.flow.sort();
        let cells = &self.flow.liquid_cells;
        cells.permute(&mut self.pressure, &mut self.scratch.f64s);
        cells.permute(&mut self.around, &mut self.scratch.around);
        if self.walls.own.is_empty() && S::walls_are_dense(self) {
            self.look_along_walls();
        }
        self.flow.find();
    }

    /// Density of wall particles by each other, once: walls stand still.
    fn look_along_walls(&mut self) {
        self.flow.wall_sees_wall = true;
        self.flow.find();
        self.flow.wall_sees_wall = false;
        let (n, unit) = (self.flow.liquid(), self.flow.grid.unit);
        let (at, rows) = (&self.flow.at, &self.flow.wall_rows);
        let add = |j: usize, k: usize| {
            let away = |a: usize| at[a][k].wrapping_sub(at[a][j]) as f64 * unit[a];
            let r = (0..3).map(|a| away(a).powi(2)).sum::<f64>().sqrt();
            S::wall_to_wall(self, r / self.case.h)
        };
        // In the order of the walls: that of rows changes with the liquid.
        let own = |j: usize| {
            let others = rows.row(j).iter().map(|k| *k as usize);
            let is_wall = |k: &usize| self.flow.original(*k) >= n && *k != n + j;
            let mut others: Vec<usize> = others.filter(is_wall).collect();
            others.sort_unstable();
            add(n + j, n + j) + others.into_iter().map(|k| add(n + j, k)).sum::<f64>()
        };
        self.walls.own = (0..self.flow.walls()).map(own).collect();
    }

    /// (1) without the step: viscosity, gravity, tension at r^n.
    pub(super) fn hold(&mut self, ahead: f64) {
        self.held.resize(self.flow.liquid(), [0.0; 3]);
        S::look_around(self);
        let (p, parts) = (&self.flow.particles, &mut self.scratch.pairs);
        self.ledger.viscous = frame::power(p, &self.held, parts);
        self.mark();
        if let Some(g) = self.case.effects.gravity {
            gravity::add(g, &mut self.held);
        }
        if self.case.follows_energy() {
            self.add_tension_ahead(ahead);
        } else {
            self.add_tension();
        }
        let held = &self.held;
        let square = |i: usize| held[i].iter().map(|a| (*a as f64).powi(2)).sum();
        self.hardest = max(held.len(), square).max(0.0).sqrt();
    }

    /// Records for viscosity: velocity, unused, `weight`.
    pub(in crate::method) fn pack_velocity(&mut self, weight: f32) {
        self.flow.pack(
            |p, i| {
                let [x, y, z] = [0, 1, 2].map(|a| p.velocity[a][i] as f32);
                [x, y, z, 0.0, weight]
            },
            |w, j| {
                let [x, y, z] = [0, 1, 2].map(|a| w.velocity[a][j] as f32);
                [x, y, z, 0.0, weight]
            },
        );
    }

    /// Gives walls in these records the velocity of no slip, unless Eq. 8 stands as printed.
    pub(in crate::method) fn pack_no_slip(&mut self, weight: f32) {
        if self.is_printed() || self.walls.len() == 0 {
            return;
        }
        let scale = self.scale();
        let pass = Extrapolation::<S::Kernel> {
            kernel: PhantomData,
        };
        let (records, rows) = (&self.flow.records, &self.flow.wall_rows);
        sweep::rows(records, rows, scale, &pass, &mut self.walls.sums);
        let sums = &self.walls.sums;
        let still = self.flow.wall.velocity.each_ref();
        let viscous = |j: usize| {
            let s = &sums[j];
            [0, 1, 2].map(|a| {
                let u = still[a][j] as f32;
                if s.weight > 0.0 {
                    2.0 * u - s.velocity[a] / s.weight
                } else {
                    u
                }
            })
        };
        let seen = &mut self.scratch.viscous;
        seen.clear();
        seen.extend((0..sums.len()).map(viscous));
        let seen = &*seen;
        self.flow
            .pack_wall(|j| [seen[j][0], seen[j][1], seen[j][2], 0.0, weight]);
    }

    /// Counts the particles of the surface in every support.
    fn mark(&mut self) {
        let n = self.flow.liquid();
        let mut marks = std::mem::take(&mut self.marks);
        marks.resize(n, 0.0);
        each_mut(&mut marks[..n], |i, out| {
            *out = f32::from(self.is_surface(i))
        });
        self.flow
            .pack_scalars(|_, i| [marks[i], 0.0, 0.0, 0.0, 0.0], |_, _| [0.0; 5]);
        let (cells, support) = (&self.flow.liquid_cells, 2.0 * self.case.h);
        let Scratch { band, near, .. } = &mut self.scratch;
        band.mark(cells, |i| marks[i] > 0.0);
        band.grow(&self.flow.grid, support);
        band.flags(cells, near);
        self.marks = marks;
        let (records, rows, scale) = (&self.flow.records, &self.flow.rows, self.scale());
        let pass = Marked {
            near: &self.scratch.near,
        };
        sweep::rows(records, rows, scale, &pass, &mut self.marks);
    }

    fn add_tension(&mut self) {
        let Some(mut tension) = self.tension.take() else {
            return;
        };
        let sources = self.flow.sources();
        let flow = crate::method::surface_of(&self.flow, &sources);
        tension.update(&flow, |i| self.is_surface(i));
        let velocity = &self.flow.particles.velocity;
        tension.friction(&flow, velocity, &mut self.scratch.friction);
        if self.case.follows_energy() {
            self.ledger.see(tension.account(&self.flow.particles));
        }
        tension.add(&mut self.held);
        self.tension = Some(tension);
    }

    /// The same with the tension of where particles are `ahead` s later.
    fn add_tension_ahead(&mut self, ahead: f64) {
        self.flow.look_ahead(ahead, &mut self.before[0]);
        self.add_tension();
        self.flow.look_back(&mut self.before[0]);
    }

    fn remember(&mut self) {
        let p = &self.flow.particles;
        for a in 0..3 {
            self.before[0][a].clone_from(&p.position[a]);
            self.before[1][a].clone_from(&p.velocity[a]);
        }
    }

    fn restore(&mut self) {
        let p = &mut self.flow.particles;
        for a in 0..3 {
            p.position[a].copy_from_slice(&self.before[0][a]);
            p.velocity[a].copy_from_slice(&self.before[1][a]);
        }
    }

    /// (1): v* and r*.
    fn predict(&mut self, dt: f64) {
        let n = self.flow.liquid();
        let held = &self.held;
        let p = &mut self.flow.particles;
        each_mut(
            (three(&mut p.position, n), three(&mut p.velocity, n)),
            |i, (x, v)| {
                for a in 0..3 {
                    let v = &mut *v[a];
                    *v += dt * held[i][a] as f64;
                    *x[a] += dt * *v;
                }
            },
        );
    }

    /// Rate of damping, 1/s. A relaxation whose source is density puts it right by displacements at
    /// once (the top layer's lacks a quarter); carried on, the speed of that would overshoot, so
    /// that at least half of it goes in every step.
    fn damping(&self, dt: f64) -> f64 {
        let damping = self.case.damping;
        if damping > 0.0 && self.is_printed() {
            damping.max(1.0 / dt)
        } else {
            damping
        }
    }

    /// (3) and (4), from a part theta of the step to all of it, damped.
    fn correct(&mut self, dt: f64) {
        let theta = self.settings.theta;
        let n = self.flow.liquid();
        let damp = 1.0 / (1.0 + self.damping(dt) * dt);
        let trapezoidal = S::TRAPEZOIDAL || theta < 1.0;
        let (push, before, friction) = (&self.push, &self.before, &self.scratch.friction);
        let p = &mut self.flow.particles;
        let [work] = sum_mut(
            &mut self.scratch.parts,
            (three(&mut p.position, n), three(&mut p.velocity, n)),
            |i, (x, mut v)| {
                for a in 0..3 {
                    let v = &mut *v[a];
                    let old = before[1][a][i];
                    let ahead = *v + theta * dt * push[i][a] as f64;
                    *v = damp * (old + (ahead - old) / theta);
                }
                let mut work = 0.0;
                if !friction.is_empty() {
                    let [x, y, z] = v.each_mut().map(|v| &mut **v);
                    let free = [*x, *y, *z];
                    [*x, *y, *z] = friction[i].slowed(free, dt);
                    work = frame::gained(free, [*x, *y, *z]);
                }
                for a in 0..3 {
                    let v = &mut *v[a];
                    let old = before[1][a][i];
                    let mean = match trapezoidal {
                        true => 0.5 * (old + *v),
                        false => *v,
                    };
                    *x[a] = before[0][a][i] + dt * mean;
                }
                [work]
            },
        );
        self.ledger.rubbed = p.mass * work;
        self.fastest = self.speed();
    }
}
