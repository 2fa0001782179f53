//! The pressure whose gradient is the transpose of the divergence.
//!
//! (1) (D v)_a = c SUM (v_a - v_b) . d_ab g_ab,  a: a liquid particle or a group of wall particles
//! (2) (G p)_a = c / rho0 SUM (p_a + p_b) d_ab g_ab,  d_ab = (r_a - r_b) / h
//! (3) v^(n+1) = v* + dt G p,  [(1 - beta) D G + beta A / rho0] p = (s - D v*) / dt
//! g: the weight of the method's gradients ([`Weight`]), c its factor; A: the Laplacian that
//! [`Scheme::couple`] has, which is also what multigrid makes smooth; s: what brings density back.
//!
//! The work of (2), SUM m v . G p = m / rho0 SUM p D v, is that of the volumes and of nothing else.
//! With A alone (beta = 1) (2) does not take away what (1) finds: where particles are in disorder
//! G p of a constant p is not zero, but A p is, so that an error stays which grows with p. A pool
//! of 40 layers burst. With D G alone that is gone, but fields that G does not see (every second
//! particle up, every second down) have no pressure. A mixture keeps both: over a step of which
//! theta is implicit a mode that A does not see keeps 1 - 1 / (theta (1 - beta)) of its divergence,
//! which is above -1 for beta < 1 - 1 / (2 theta) ([`share`]).
//! Walls: [`super::product`]. The matrix is applied by two passes over the pairs
//! ([`PressureForce`], [`Divergence`]); with a tension that has an energy those of ISPH are the
//! ones of [`completed`] near a surface. What s brings back there is the density of
//! [`super::surface`], whose half-space is that of a lattice.

use super::links::Links;
use super::product::extend;
use super::{Projection, SURFACE, Scheme};
use crate::effect::tension::pass::Pull;
use crate::kernel::Kernel;
use crate::method::completed::{self, Completed};
use crate::method::pressure::Outcome;
use crate::payload;
use crate::space::lane::{Real, dot};
use crate::space::parallel::each_mut;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// Part of the largest stable share of A in (3).
const PART: f64 = 0.6;

/// The solution that shows where liquid tears needs no more than so many times the tolerance, and
/// no more than so much.
const ROUGH: f64 = 10.0;
const ROUGHEST: f64 = 1e-2;

/// beta of (3).
pub(super) fn share(theta: f64) -> f64 {
    PART * (1.0 - 0.5 / theta)
}

/// The weight of gradients: grad f_a = -c SUM (f_b - f_a) d g with d = (r_a - r_b) / h.
pub trait Weight: Copy + Send + Sync {
    /// g from the squared distance over h.
    fn at<F: Real>(&self, q2: F) -> F;
}

/// -W'(q) / q.
#[derive(Clone, Copy)]
pub struct OfKernel<K>(pub PhantomData<K>);

impl<K: Kernel> Weight for OfKernel<K> {
    #[inline(always)]
    fn at<F: Real>(&self, q2: F) -> F {
        q2.splat(0.0) - K::slope_lanes(q2.sqrt())
    }
}

payload! {
    /// What [`Divergence`] reads.
    pub struct Flowing<F> {
        /// m/s, or m/s^2.
        velocity: [F; 3],
    }
}

payload! {
    /// What [`PressureForce`] reads.
    pub struct Pressing<F> {
        /// Pa.
        pressure: F,
    }
}

/// (1); for a wall particle its part of the group's.
pub struct Divergence<W> {
    /// g.
    pub weight: W,
    /// c, 1/m.
    pub factor: f64,
}

impl<W: Weight> Pass<1> for Divergence<W> {
    type Payload = Flowing;
    type Out = f64;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let weight = self.weight.at(q2);
        [weight, weight]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Flowing>, sum: &mut [F; 1]) {
        let v = [0, 1, 2].map(|a| pair.own.velocity[a] - pair.other.velocity[a]);
        sum[0] = pair.weight[0].mul_add(dot(v, pair.d), sum[0]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f64) {
        *out = self.factor * sum[0] as f64;
    }
}

/// (2).
pub struct PressureForce<W> {
    /// g.
    pub weight: W,
    /// c / rho0, m^2/kg.
    pub factor: f64,
}

impl<W: Weight> Pass<3> for PressureForce<W> {
    type Payload = Pressing;
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let weight = self.weight.at(q2);
        [weight, weight]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Pressing>, sum: &mut [F; 3]) {
        let f = pair.weight[0] * (pair.own.pressure + pair.other.pressure);
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}

/// Memory of the products.
#[derive(Default)]
pub(super) struct Transposed {
    /// D v*, by unknown.
    flux: Vec<f64>,
    /// Whether the pressure of a liquid particle is given.
    pub given: Vec<bool>,
    /// o of [`super::product`] by group of wall particles, Pa.
    pub beyond: Vec<f64>,
    /// Room for the values of products.
    pub wide: Vec<f64>,
    /// By wall particle, and by group.
    at_walls: Vec<f64>,
    pub at_groups: Vec<f64>,
    /// Of rings: kernel sums and rates of density.
    pub around: Vec<[f32; 4]>,
    pub rates: Vec<[f32; 3]>,
    pub links: Links,
    /// The density at a surface; empty where it is not completed.
    pub completed: Vec<Completed>,
}

impl Transposed {
    pub fn memory(&self) -> usize {
        let walls = self.at_walls.capacity() + self.at_groups.capacity();
        8 * (self.flux.capacity() + walls)
            + 8 * (self.beyond.capacity() + self.wide.capacity())
            + self.given.capacity()
            + 16 * self.around.capacity()
            + 12 * self.rates.capacity()
            + self.links.memory()
            + size_of::<Completed>() * self.completed.capacity()
    }
}

impl<S: Scheme> Projection<S> {
    /// D of v* or, without `moving`, of `push`, by unknown.
    pub(super) fn find_divergence(&mut self, moving: bool, out: &mut [f64]) {
        if self.liquid.flow.is_axial() {
            return self.find_divergence_of_rings(moving, out);
        }
        let n = self.liquid.len();
        let still = Flowing::default();
        let push = &self.own.push;
        if moving {
            self.liquid.flow.repack(
                |p, i| Flowing {
                    velocity: [0, 1, 2].map(|a| p.velocity[a][i] as f32),
                },
                |w, j| Flowing {
                    velocity: [0, 1, 2].map(|a| w.velocity[a][j] as f32),
                },
            );
        } else {
            let velocity = |i: usize| push[i];
            self.liquid.flow.repack(
                |_, i| Flowing {
                    velocity: velocity(i),
                },
                |_, _| still,
            );
        }
        let (weight, factor) = S::weight(self);
        let pass = Divergence { weight, factor };
        match &self.transposed.completed[..] {
            [] => self.liquid.sum(&pass, &mut out[..n]),
            completed => {
                let pass = completed::pass::Divergence::<S::Kernel> {
                    factor,
                    completed,
                    kernel: PhantomData,
                };
                self.liquid.sum(&pass, &mut out[..n]);
            }
        }
        if self.walls.len() == 0 {
            return;
        }
        let at_walls = &mut self.transposed.at_walls;
        at_walls.resize(self.liquid.flow.walls(), 0.0);
        self.liquid.sum_at_walls(&pass, at_walls);
        for g in 0..self.walls.len() {
            let members = self.walls.members(g).iter();
            out[n + g] = members.map(|&j| at_walls[j as usize]).sum();
        }
    }

    /// `push` = G of `x` and, with `lifted`, of the offsets of wall particles.
    pub(super) fn press(&mut self, x: &[f64], lifted: bool) {
        if self.liquid.flow.is_axial() {
            return self.press_rings(x, lifted);
        }
        let n = self.liquid.len();
        let walls = &self.walls;
        let value = |i: usize| x[i] as f32;
        let offset = |j: usize| if lifted { walls.offset[j] } else { 0.0 };
        let at_wall = |j: usize| value(n + walls.group[j] as usize) + offset(j);
        self.own.push.resize(n, [0.0; 3]);
        let (weight, factor) = S::weight(self);
        let factor = factor / self.liquid.case.density;
        let flow = &mut self.liquid.flow;
        let completed = &self.transposed.completed;
        if completed.is_empty() {
            flow.repack(
                |_, i| Pressing { pressure: value(i) },
                |_, j| Pressing {
                    pressure: at_wall(j),
                },
            );
            let pass = PressureForce { weight, factor };
            return self.liquid.sum(&pass, &mut self.own.push);
        }
        flow.repack(
            |_, i| completed[i].press(value(i)),
            |_, j| Completed::default().press(at_wall(j)),
        );
        let pass = Pull::<S::Kernel> {
            factor: -factor,
            kernel: PhantomData,
        };
        self.liquid.sum(&pass, &mut self.own.push);
    }

    /// Completes the density of particles near a surface.
    fn complete(&mut self) {
        if !S::COMPLETES || !self.liquid.follows_energy() {
            return;
        }
        let (local, marks, h) = (&self.own.local, &self.own.marks, self.liquid.case.h);
        let share = &self.closure.share;
        let completed = &mut self.transposed.completed;
        completed.resize(self.liquid.flow.liquid(), Completed::default());
        each_mut(&mut completed[..], |i, out| {
            *out = match marks[i] > 0.0 {
                false => Completed::default(),
                true => {
                    let gradient = local[i].slope.map(|s| h * s as f64);
                    Completed::of(share, local[i].kernel_sum as f64, gradient)
                }
            };
        });
    }

    /// Solves (3), `dt` s; `density`: the part of its deviation that goes. Liquid at a surface
    /// holds no more than its cohesion: where the first solution has a lower pressure, that one is
    /// given, and the rest solved again. The first is a rough one if the last step had such a
    /// pressure anywhere.
    pub(super) fn solve_transposed(&mut self, dt: f64, density: f64) -> Outcome {
        self.transposed.given.clear();
        self.transposed.given.resize(self.liquid.len(), false);
        self.complete();
        if self.equation.is_enclosed() {
            // No wall is dry, and constants must not be seen.
            self.walls.share.fill(1.0);
        }
        self.set_right_transposed(dt, density);
        if self.liquid.flow.is_axial() {
            self.link_rings();
        }
        self.guess();
        let (tolerance, held) = (self.settings.tolerance, self.cohesion());
        let has_torn = self.own.pressure.iter().any(|p| *p <= -held);
        let has_torn = self.liquid.flow.any(has_torn);
        let first = self.go_on(match has_torn {
            true => (ROUGH * tolerance).min(ROUGHEST),
            false => tolerance,
        });
        if !first.converged {
            return first;
        }
        let n = self.liquid.len();
        let (local, p) = (&self.own.local, &self.unknown);
        let given = &mut self.transposed.given[..n];
        each_mut(
            (given, &mut self.equation.right[..n]),
            |i, (given, right)| {
                if (local[i].kernel_sum as f64) < SURFACE && p[i] < -held {
                    (*given, *right) = (true, 0.0);
                }
            },
        );
        let tears = self.liquid.flow.any(self.transposed.given.contains(&true));
        if !has_torn && !tears {
            return first;
        }
        let second = self.go_on(tolerance);
        Outcome {
            iterations: first.iterations + second.iterations,
            ..second
        }
    }

    /// Gives `x` the pressures that are given.
    pub(super) fn hold_given(&self, x: &mut [f64]) {
        let (given, held) = (&self.transposed.given, self.cohesion());
        each_mut(&mut x[..given.len()], |i, p| {
            if given[i] {
                *p = -held
            }
        });
    }

    /// `push` = G of the solution.
    pub(super) fn press_all(&mut self) {
        let (mut x, n) = (std::mem::take(&mut self.unknown), self.liquid.len());
        self.equation.fill(&mut x);
        let Transposed { wide, beyond, .. } = &mut self.transposed;
        wide.clear();
        wide.resize(beyond.len(), 0.0);
        extend(&self.equation, &self.walls.share, (n, &x), wide);
        let walls = x[n..].iter_mut().zip(&*wide);
        walls.zip(&*beyond).for_each(|((p, e), o)| *p = e + o);
        self.press(&x, true);
        self.unknown = x;
    }

    /// The right-hand side of (3) over the unit of the rows, `dt` s.
    fn set_right_transposed(&mut self, dt: f64, density: f64) {
        let mut flux = std::mem::take(&mut self.transposed.flux);
        let (n, count) = (self.liquid.len(), self.equation.len());
        let walled = self.liquid.flow.has_walls();
        flux.resize(count, 0.0);
        let beta = share(self.settings.theta);
        let mut lift = std::mem::take(&mut self.equation.right);
        lift.clear();
        lift.resize(count, 0.0);
        let mut beyond = std::mem::take(&mut self.transposed.beyond);
        beyond.clear();
        beyond.extend((n..count).map(|i| self.wall_flux(i, dt) / self.equation.diagonal[i]));
        if walled {
            let mut x = std::mem::take(&mut self.transposed.wide);
            x.clear();
            x.resize(n, 0.0);
            x.extend_from_slice(&beyond);
            self.press(&x, true);
            self.transposed.wide = x;
            self.find_divergence(false, &mut lift);
        }
        self.find_divergence(true, &mut flux);
        let (this, unit) = (&*self, S::unit(self));
        let span = this.span(dt);
        each_mut(&mut lift[..count], |i, right| {
            let flux = flux[i] + (1.0 - beta) * dt * *right;
            if i >= n {
                // What the rows of the liquid have of it, and of o.
                let f = this.walls.share[i - n];
                let own = -f * flux / (dt * unit) / this.equation.diagonal[i];
                *right = own + beta * (2.0 - f) * beyond[i - n];
                return;
            }
            let rate = this.mass(i) * density * this.excess(i) / span - flux;
            *right = rate / (dt * unit) + beta * this.sums[i][1] as f64;
        });
        self.transposed.beyond = beyond;
        if walled {
            self.share_out(&mut lift);
        }
        self.equation.right = lift;
        self.transposed.flux = flux;
    }
}
