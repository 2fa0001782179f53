//! Projections of rings about an axis, with the kernel of two rings ([`crate::method::ring`]) and
//! the gradient that is the transpose of the divergence:
//! (1) (D v)_a = -SUM V_b (v_a . dK/dx_a + v_b . dK/dx_b),  (G p)_a = -1/rho0 SUM V_b (p_a + p_b)
//!     dK/dx_a,  a itself among b,  K: that of which -K'/r is the weight of the method's gradients,
//!     W for ISPH; near a surface whose tension has an energy: [`crate::method::completed`]
//! (2) (A p)_a = 2 SUM V_b w (p_a - p_b) / (n_a n_b),  w: the mean of the weight over the angle
//! (3) viscosity as that of WCSPH ([`Surrounded`])
//! Rows of the equation are multiplied by the masses of their rings: then it is symmetric, and the
//! work of G p is that of the volumes that D sees.
//! Tests: tests/engine/ring_projection.rs.

use super::correction::IDENTITY;
use super::look::{Local, Sums};
use super::{Projection, Scheme};
use crate::effect::tension::ringed::{Energetic, Pull};
use crate::kernel::ring::Radii;
use crate::method::completed::Completed;
use crate::method::completed::ring as completed;
use crate::method::pass::{Extrapolation as Plain, Sparing};
use crate::method::ring::{Compressed, Continuity, Extrapolation};
use crate::method::ring::{Joined, Laplacian, Surrounded};
use crate::space::parallel::each_mut;
use std::marker::PhantomData;

impl<S: Scheme> Projection<S> {
    /// What wall particles see of the liquid that is packed.
    pub(super) fn extrapolate(&mut self) {
        let (flow, sums) = (&self.liquid.flow, &mut self.walls.sums);
        if flow.is_axial() {
            let radii = flow.radii(self.liquid.case.h);
            return self.liquid.sum_at_walls(&Extrapolation { radii }, sums);
        }
        let pass = Plain::<S::Kernel> {
            kernel: PhantomData,
        };
        self.liquid.sum_at_walls(&pass, sums);
    }

    /// Where rings are, with the kernel of gradients.
    pub(super) fn sloping(&self) -> Radii<'_> {
        let [rings, _] = self.scheme.of_rings();
        self.liquid.flow.radii_of(rings, self.liquid.case.h)
    }

    /// The same with that of the equation.
    fn joined(&self) -> Radii<'_> {
        let [_, rings] = self.scheme.of_rings();
        self.liquid.flow.radii_of(rings, self.liquid.case.h)
    }

    /// [`Scheme::look_around`] of rings.
    pub(super) fn look_around_rings(&mut self) {
        let n = self.liquid.len();
        self.own.held.fill([0.0; 3]);
        let viscosity = self.liquid.case.effects.mu();
        if let Some(dynamic) = viscosity {
            self.pack_velocity(1.0);
            self.pack_no_slip(1.0);
            let factor = dynamic / self.liquid.case.density * self.factor(2);
            let pass = Surrounded {
                radii: self.liquid.flow.radii(self.liquid.case.h),
                viscosity: -4.0,
            };
            self.liquid.sum(&pass, &mut self.own.held);
            let p = &self.liquid.flow.particles;
            each_mut(&mut self.own.held[..n], |i, held| {
                let r = held[0] as f64 + pass.alone(i, p.weight(i), p.velocity[0][i]);
                *held = [factor * r, 0.0, factor * held[1] as f64].map(|a| a as f32);
            });
        }
        let mut sums = std::mem::take(&mut self.transposed.around);
        let has_moved = viscosity.is_none();
        self.liquid.sum_rings(has_moved, |_| true, &mut sums);
        self.own.around.resize(n, Sums::default());
        each_mut(&mut self.own.around[..n], |i, around| {
            let [r, _, z, kernel] = sums[i];
            *around = Sums {
                kernel,
                slope: [r, 0.0, z],
                ..Sums::default()
            };
        });
        self.transposed.around = sums;
    }

    /// [`Scheme::look`] of rings.
    pub(super) fn look_at_rings(&mut self) {
        let mut sums = std::mem::take(&mut self.transposed.around);
        self.liquid.sum_rings(false, |_| true, &mut sums);
        let (value, gradient) = (self.factor(0), self.factor(1));
        let full = self.closure.lattice() as f32;
        each_mut(&mut self.own.local[..sums.len()], |i, local| {
            let [r, _, z, kernel] = sums[i].map(f64::from);
            let kernel_sum = (value * kernel) as f32;
            *local = Local {
                number: kernel_sum / full,
                kernel_sum,
                slope: [(gradient * r) as f32, 0.0, (gradient * z) as f32],
                moment: IDENTITY,
                correction: IDENTITY,
                ..Local::default()
            };
        });
        self.transposed.around = sums;
    }

    /// [`Scheme::couple`] of rings.
    pub(in crate::method) fn couple_rings<const N: usize>(&mut self)
    where
        S: Scheme<Row = [f32; N]>,
    {
        let (local, walls) = (&self.own.local, &self.walls);
        self.liquid.flow.pack(
            |p, i| Joined {
                volume: p.weight(i) as f32 / local[i].density,
                offset: 0.0,
            },
            |w, j| Joined {
                volume: w.weight(j) as f32,
                offset: walls.offset[j],
            },
        );
        self.walls.number(&self.liquid.flow);
        let layout = self.walls.layout(&self.liquid.flow, self.liquid.case.h);
        let [_, rings] = self.scheme.of_rings();
        let radii = self.liquid.flow.radii_of(rings, self.liquid.case.h);
        let e = &mut self.equation;
        let (sparse, degree) = (&mut e.coupling, &mut e.diagonal);
        sparse.build(&layout, &Laplacian { radii }, degree, &mut self.sums);
    }

    /// What ring `i` adds to its own couplings, which the equation leaves out: along it p is one.
    pub(super) fn coupled_alone(&self, i: usize) -> f64 {
        let flow = &self.liquid.flow;
        if !flow.is_axial() {
            return 0.0;
        }
        let dense = self.own.local[i].density as f64;
        let slope = self.joined().own(i).slope;
        -2.0 * flow.particles.weight(i) * slope / (dense * dense)
    }

    /// D of (1) times the masses; see [`Projection::find_divergence`].
    pub(super) fn find_divergence_of_rings(&mut self, moving: bool, out: &mut [f64]) {
        let n = self.liquid.len();
        self.pack_flux(moving);
        let factor = -S::weight(self).1;
        let mut sums = std::mem::take(&mut self.transposed.rates);
        sums.resize(n.max(self.liquid.flow.walls()), [0.0; 3]);
        let (p, push) = (&self.liquid.flow.particles, &self.own.push);
        let radial = |i: usize| match moving {
            true => p.velocity[0][i],
            false => push[i][0] as f64,
        };
        let pass = Continuity {
            radii: self.sloping(),
            diffusion: 0.0,
            held: 0.0,
        };
        let radii = pass.radii;
        match &self.transposed.completed[..] {
            [] => {
                self.liquid.sum(&pass, &mut sums[..n]);
                each_mut(&mut out[..n], |i, out| {
                    let mass = p.weight(i);
                    let own = 2.0 * mass * radii.own(i).gradient * radial(i);
                    *out = factor * mass * (sums[i][0] as f64 + own);
                });
            }
            completed => {
                let pass = completed::Continuity {
                    plain: pass,
                    completed,
                };
                self.liquid.sum(&pass, &mut sums[..n]);
                each_mut(&mut out[..n], |i, out| {
                    let mass = p.weight(i);
                    *out = factor * mass * pass.closing(i, sums[i], mass * radial(i));
                });
            }
        }
        let walls = self.liquid.flow.walls();
        if walls > 0 {
            self.liquid.sum_at_walls(&pass, &mut sums[..walls]);
            let wall = &self.liquid.flow.wall;
            for g in 0..self.walls.len() {
                let members = self.walls.members(g).iter().map(|&j| j as usize);
                let of = |j: usize| wall.weight(j) * sums[j][0] as f64;
                out[n + g] = factor * members.map(of).sum::<f64>();
            }
        }
        self.transposed.rates = sums;
    }

    /// Packs v* or, without `moving`, `push`.
    fn pack_flux(&mut self, moving: bool) {
        let push = &self.own.push;
        let of = |velocity: [f32; 3], mass: f64| {
            let moving = Sparing {
                velocity,
                ..Sparing::default()
            };
            Compressed::of(moving, mass)
        };
        let narrow = |v: &[Vec<f64>; 3], i: usize| [0, 1, 2].map(|a| v[a][i] as f32);
        let flow = &mut self.liquid.flow;
        match moving {
            true => flow.repack(
                |p, i| of(narrow(&p.velocity, i), p.weight(i)),
                |w, j| of(narrow(&w.velocity, j), w.weight(j)),
            ),
            false => flow.repack(
                |p, i| of(push[i], p.weight(i)),
                |w, j| of([0.0; 3], w.weight(j)),
            ),
        }
    }

    /// G of (1); see [`Projection::press`].
    pub(super) fn press_rings(&mut self, x: &[f64], lifted: bool) {
        let n = self.liquid.len();
        let walls = &self.walls;
        let value = |i: usize| x[i];
        let offset = |j: usize| if lifted { walls.offset[j] } else { 0.0 };
        let at_wall = |j: usize| value(n + walls.group[j] as usize) as f32 + offset(j);
        let completed = &self.transposed.completed;
        let of = |i: usize| completed.get(i).copied().unwrap_or_default();
        self.liquid.flow.repack(
            |p, i| Energetic::of(of(i).press(value(i) as f32), p.weight(i)),
            |w, j| Energetic::of(Completed::default().press(at_wall(j)), w.weight(j)),
        );
        let mut push = std::mem::take(&mut self.own.push);
        push.resize(n, [0.0; 3]);
        let radii = self.sloping();
        self.liquid.sum(&Pull { radii }, &mut push);
        let factor = -S::weight(self).1 / self.liquid.case.density;
        let p = &self.liquid.flow.particles;
        each_mut(&mut push[..n], |i, push| {
            let own = p.weight(i) * value(i) * completed::alone_of(radii, i, &of(i));
            let [r, z] = [push[0] as f64 + own, push[2] as f64];
            *push = [(factor * r) as f32, 0.0, (factor * z) as f32];
        });
        self.own.push = push;
    }

    /// Puts what a prediction took across the axis back, with its past: the ring on the other side
    /// is the same one.
    pub(super) fn fold_prediction(&mut self) {
        if !self.liquid.flow.is_axial() {
            return;
        }
        let n = self.liquid.len();
        let p = &mut self.liquid.flow.particles;
        let [[old, ..], [speed, ..]] = &mut self.before;
        let present = (&mut p.position[0][..n], &mut p.velocity[0][..n]);
        let past = (&mut old[..n], &mut speed[..n]);
        let held = &mut self.own.held[..n];
        each_mut((present, past, held), |_, ((x, v), (old, speed), held)| {
            if *x < 0.0 {
                (*x, *v, held[0]) = (-*x, -*v, -held[0]);
                (*old, *speed) = (-*old, -*speed);
            }
        });
    }

    /// Puts what a step took across the axis back.
    pub(super) fn fold_axis(&mut self) {
        if !self.liquid.flow.is_axial() {
            return;
        }
        let n = self.liquid.len();
        let p = &mut self.liquid.flow.particles;
        let present = (&mut p.position[0][..n], &mut p.velocity[0][..n]);
        each_mut(present, |_, (x, v)| {
            if *x < 0.0 {
                (*x, *v) = (-*x, -*v);
            }
        });
    }

    /// Merges and splits rings; whether there were any.
    pub(super) fn adapt(&mut self) -> bool {
        let Some(plan) = self.adaption.plan(&self.liquid) else {
            return false;
        };
        let before = self.stored();
        self.liquid.adapt(&plan, &mut self.own, &mut self.adaption);
        self.liquid.ledger.removal += self.stored() - before;
        true
    }
}
