//! One step, as the algorithm box of Kuri et al. has it.

use super::{Projection, Scheme};
use crate::method::pass::{Mark, Marked, Moving};
use crate::method::{Diverged, frame};
use crate::particle::weight_of;
use crate::scene::PoissonSource;
use crate::space::parallel::{each_mut, max, sum_mut, three};
use crate::space::room::resize;

/// Halvings of a step whose pressure cannot be found, or that throws a particle.
const HALVINGS: usize = 5;

/// Spacings that sqrt(p / rho) crosses in a step: a third of what is stable on a lattice.
const ELASTIC: f64 = 0.25;

/// Longest step of a liquid that nothing moves, s.
const IDLE: f64 = 1.0;

impl<S: Scheme> Projection<S> {
    pub(super) fn advance_step(&mut self) -> Result<(), Diverged> {
        let expected = self.liquid.fit(self.next_step());
        self.liquid.flow.lasting = if self.liquid.now.max_speed > 0.0 {
            expected
        } else {
            0.0
        };
        self.rebuild();
        self.hold(0.5 * expected);
        self.liquid.now.connected_speed = self.max_connected_speed();
        let longest = expected.max(self.settings.shortest);
        let mut dt = self.liquid.fit(self.next_step().min(longest));
        self.remember();
        self.liquid.begin_step();
        let (mut done, mut known) = (false, true);
        for attempt in 0..=HALVINGS {
            let ahead = self.settings.theta * dt;
            self.predict(ahead);
            known = !self.liquid.flow.stale(|_| 0.0);
            if known {
                self.solution.outcome = self.project(ahead);
                done = self.solution.outcome.converged;
            }
            self.peak = self.peak();
            let stable = self.elastic();
            let last = attempt == HALVINGS;
            let short = dt <= 2.0 * stable || last;
            if done && short {
                self.correct(dt);
                if last || self.check(dt).is_ok() {
                    break;
                }
                // Thrown past its neighbours: over half the step it passes fewer.
                self.solution.repeated += 1;
            }
            self.restore();
            dt = if done && !short { stable } else { 0.5 * dt };
            done = false;
        }
        if !done {
            return Err(self.unsolved(dt, known));
        }
        self.check(dt)?;
        self.liquid.ledger.step(dt);
        self.liquid.end_step(dt, &self.own.held, &self.own.steady);
        self.liquid.ledger.correct();
        if self.liquid.case.shifts(self.settings.shifting) {
            let before = self.stored();
            self.shift(dt);
            self.liquid.ledger.shifting += self.stored() - before;
        }
        self.liquid.now.time = self.liquid.beat.exact(self.liquid.now.time + dt);
        self.liquid.now.step += 1;
        self.liquid.now.last_step = dt;
        Ok(())
    }

    /// Every limit by name, s, least first.
    pub(super) fn step_limits(&self) -> Vec<(&'static str, f64)> {
        let mut all = self.liquid.limits(f64::INFINITY).all();
        all.retain(|(name, _)| *name != "acoustic");
        all.push(("advective", self.advective()));
        all.push(("pressure", self.elastic()));
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all
    }

    /// Spray may cross a spacing, s.
    fn advective(&self) -> f64 {
        let connected = self.settings.courant * self.liquid.case.spacing
            / self.liquid.now.connected_speed.max(1e-30);
        connected.min(self.liquid.case.spacing / self.liquid.now.max_speed.max(1e-30))
    }

    /// Where a symmetric gradient stays stable, s. A pressure that brings back density at once
    /// grows as steps become shorter, so that there they have a least length.
    fn elastic(&self) -> f64 {
        if !self.scheme.is_symmetric() {
            return f64::INFINITY;
        }
        let speed = (self.peak / self.liquid.case.density).sqrt();
        let stable = ELASTIC * self.liquid.case.spacing / speed.max(1e-30);
        match self.settings.source {
            PoissonSource::Density => stable.max(self.settings.shortest),
            PoissonSource::Divergence { .. } => stable,
        }
    }

    fn next_step(&self) -> f64 {
        let limits = self.liquid.limits(f64::INFINITY);
        let mut least = limits.least_of_effects();
        if self.scheme.is_symmetric() {
            least = least.min(self.elastic());
        }
        // What effects allow has no least length. That for a force has.
        let (shortest, longest) = (self.settings.shortest, self.settings.longest);
        self.advective()
            .min(limits.force())
            .clamp(shortest, longest)
            .min(least)
            .min(IDLE)
    }

    /// Wraps, removes, sorts along cells, finds neighbours.
    pub(super) fn rebuild(&mut self) {
        let before = self.stored();
        self.liquid.find_mist(&self.own.kernel_sum);
        // All vectors that are held are found again before they are used.
        self.liquid.confine(&mut self.own);
        self.liquid.ledger.removal += self.stored() - before;
        if self.liquid.flow.balance(false) {
            self.walls = self.walls.of(&self.liquid);
        }
        self.liquid.sort(&mut self.own);
        if !self.walls.is_seen && S::walls_are_dense(self) {
            self.look_along_walls();
        }
        self.liquid.flow.find();
        if self.adapt() {
            self.liquid.sort(&mut self.own);
            self.liquid.flow.find();
        }
    }

    /// Density of wall particles by each other, once: walls stand still.
    fn look_along_walls(&mut self) {
        self.liquid.flow.wall_sees_wall = true;
        self.liquid.flow.find();
        self.liquid.flow.wall_sees_wall = false;
        let (n, unit) = (self.liquid.len(), self.liquid.flow.grid.unit);
        let (at, rows) = (&self.liquid.flow.at, &self.liquid.flow.wall_rows);
        let walls = n..n + self.liquid.flow.walls();
        let add = |j: usize, k: usize| {
            let away = |a: usize| at[a][k].wrapping_sub(at[a][j]) as f64 * unit[a];
            let r = (0..3).map(|a| away(a).powi(2)).sum::<f64>().sqrt();
            S::wall_to_wall(self, r / self.liquid.case.h)
        };
        // In the order of the walls: that of rows changes with the liquid.
        let own = |j: usize| {
            let others = rows.row(j).indices();
            let is_wall = |k: &usize| walls.contains(&self.liquid.flow.original(*k)) && *k != n + j;
            let mut others: Vec<usize> = others.filter(is_wall).collect();
            others.sort_unstable();
            add(n + j, n + j) + others.into_iter().map(|k| add(n + j, k)).sum::<f64>()
        };
        self.walls.own = walls.clone().map(|j| own(j - n)).collect();
        self.walls.is_seen = true;
    }

    /// (1) without the step: viscosity, gravity, tension at r^n.
    pub(super) fn hold(&mut self, ahead: f64) {
        self.liquid.set_body_force(ahead);
        resize(&mut self.own.held, self.liquid.len(), [0.0; 3]);
        match self.liquid.flow.is_axial() {
            true => self.look_around_rings(),
            false => S::look_around(self),
        }
        if self.liquid.removes_mist {
            let (around, factor) = (&self.own.around, self.sum_factor());
            self.own.kernel_sum.clear();
            let sums = around.iter().map(|sums| factor * sums.kernel);
            self.own.kernel_sum.extend(sums);
        }
        self.liquid.see_viscosity(&self.own.held);
        self.mark();
        self.liquid.body_force.add(&mut self.own.held);
        if self.liquid.follows_energy() {
            self.own.steady.clone_from(&self.own.held);
        }
        let ahead = match self.liquid.follows_energy() {
            true => ahead,
            false => 0.0,
        };
        let is_surface = &self.own.is_surface;
        let is_surface = |i: usize| is_surface[i];
        self.liquid
            .add_effects(ahead, &is_surface, &mut self.own.held);
        let held = &self.own.held;
        let square = |i: usize| held[i].iter().map(|a| (*a as f64).powi(2)).sum();
        let span = self.liquid.flow.span();
        self.liquid.now.max_acceleration = max(span, square).max(0.0).sqrt();
    }

    /// Records for viscosity.
    pub(in crate::method) fn pack_velocity(&mut self, weight: f32) {
        self.liquid.flow.pack_moving(
            true,
            |p, i| Moving {
                velocity: [0, 1, 2].map(|a| p.velocity[a][i] as f32),
                pressure: 0.0,
                weight,
            },
            |w, j| Moving {
                velocity: [0, 1, 2].map(|a| w.velocity[a][j] as f32),
                pressure: 0.0,
                weight,
            },
        );
    }

    /// Gives walls in these records the velocity of no slip, unless Eq. 8 stands as printed.
    pub(in crate::method) fn pack_no_slip(&mut self, weight: f32) {
        if self.is_printed() || !self.liquid.flow.has_walls() {
            return;
        }
        self.extrapolate();
        let sums = &self.walls.sums;
        let still = self.liquid.flow.wall.velocity.each_ref();
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
        let seen = &mut self.viscous;
        seen.clear();
        seen.extend((0..sums.len()).map(viscous));
        let seen = &*seen;
        self.liquid.flow.pack_moving_wall(|j| Moving {
            velocity: seen[j],
            pressure: 0.0,
            weight,
        });
    }

    /// Counts the particles of the surface in every support.
    fn mark(&mut self) {
        let n = self.liquid.len();
        let mut is_surface = std::mem::take(&mut self.own.is_surface);
        is_surface.resize(n, false);
        each_mut(&mut is_surface[..n], |i, out| *out = self.is_surface(i));
        let mark = |i: usize| f32::from(is_surface[i]);
        let flow = &mut self.liquid.flow;
        flow.pack(|_, i| Mark { mark: mark(i) }, |_, _| Mark { mark: 0.0 });
        let (cells, support) = (&flow.liquid_cells, 2.0 * self.liquid.case.h);
        self.band.mark(cells, |i| is_surface[i]);
        flow.join(self.band.marks());
        self.band.grow(&flow.grid, support);
        self.band.flags(cells, &mut self.own.near);
        self.own.is_surface = is_surface;
        self.own.marks.resize(n, 0.0);
        let pass = Marked {
            near: &self.own.near,
        };
        self.liquid.sum(&pass, &mut self.own.marks);
    }

    fn remember(&mut self) {
        let p = &self.liquid.flow.particles;
        for a in 0..3 {
            self.before[0][a].clone_from(&p.position[a]);
            self.before[1][a].clone_from(&p.velocity[a]);
        }
    }

    fn restore(&mut self) {
        let p = &mut self.liquid.flow.particles;
        for a in 0..3 {
            p.position[a].copy_from_slice(&self.before[0][a]);
            p.velocity[a].copy_from_slice(&self.before[1][a]);
        }
    }

    /// (1): v* and r*.
    fn predict(&mut self, dt: f64) {
        let n = self.liquid.len();
        let held = &self.own.held;
        let p = &mut self.liquid.flow.particles;
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
        self.fold_prediction();
    }

    /// Rate of damping, 1/s. A relaxation whose source is density puts it right by displacements at
    /// once (the top layer's lacks a quarter); carried on, the speed of that would overshoot, so
    /// that at least half of it goes in every step.
    fn damping(&self, dt: f64) -> f64 {
        let damping = self.liquid.case.damping;
        if damping > 0.0 && self.is_printed() {
            damping.max(1.0 / dt)
        } else {
            damping
        }
    }

    /// (3) and (4), from a part theta of the step to all of it, damped.
    fn correct(&mut self, dt: f64) {
        let theta = self.settings.theta;
        let n = self.liquid.len();
        let damp = 1.0 / (1.0 + self.damping(dt) * dt);
        let trapezoidal = S::TRAPEZOIDAL || theta < 1.0;
        let span = self.liquid.flow.span();
        let (push, before, friction) = (&self.own.push, &self.before, &self.liquid.friction);
        let p = &mut self.liquid.flow.particles;
        let weights = &p.weight;
        let [pressed, rubbed] = sum_mut(
            &mut self.liquid.pairs,
            span,
            (three(&mut p.position, n), three(&mut p.velocity, n)),
            |i, (x, mut v)| {
                let past = [0, 1, 2].map(|a| before[1][a][i]);
                for a in 0..3 {
                    let (v, old) = (&mut *v[a], past[a]);
                    let ahead = *v + theta * dt * push[i][a] as f64;
                    *v = damp * (old + (ahead - old) / theta);
                }
                let mut rubbed = 0.0;
                if !friction.is_empty() {
                    let [x, y, z] = v.each_mut().map(|v| &mut **v);
                    let free = [*x, *y, *z];
                    [*x, *y, *z] = friction[i].slowed(free, dt);
                    rubbed = frame::work(past, free, [*x, *y, *z]);
                }
                let mut pressed = 0.0;
                for a in 0..3 {
                    let (v, old) = (&mut *v[a], past[a]);
                    pressed += 0.5 * dt * (old + *v) * push[i][a] as f64;
                    let mean = match trapezoidal {
                        true => 0.5 * (old + *v),
                        false => *v,
                    };
                    *x[a] = before[0][a][i] + dt * mean;
                }
                [pressed, rubbed].map(|work| weight_of(weights, i) * work)
            },
        );
        self.liquid.ledger.corrected = [p.mass * pressed, p.mass * rubbed];
        self.fold_axis();
        self.liquid.now.max_speed = self.liquid.max_speed();
    }
}
