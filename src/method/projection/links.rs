//! D G of rings ([`super::rings`]) as matrices: an equation is solved by many products with the
//! same derivatives of the kernel, which cost more than all else in them.
//!
//! (1) m_a (G p)_a = -c/rho0 SUM m_a m_b (p_a + p_b) g_a
//! (2) m_a (D u)_a = -c SUM m_a m_b (u_a . g_a + u_b . g_b),  u = 0 in walls
//! of which r has two matrices, for g_a and for g_b, and z one, for there g_b = -g_a.
//! Test: tests/engine/ring_projection.rs.

use super::{Projection, Scheme};
use crate::effect::tension::ringed::Heavy;
use crate::kernel::ring::{Radii, between, mass_apart};
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::sparse::{Couple, Sparse};
use crate::space::sweep::Pair;

/// m_a m_b times a component of g: of g_a along r, of g_b along r, of g_a along z.
struct Along<'a, const OF: usize>(Radii<'a>);

impl<const OF: usize> Couple<0> for Along<'_, OF> {
    type Payload = Heavy;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.0.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Heavy>, _: &mut [F; 0]) -> F {
        let w = between(self.0.rings, pair);
        let masses = mass_apart(pair.own.mass * pair.other.mass, pair.q2);
        masses
            * match OF {
                0 | 1 => w.radial[OF],
                _ => w.axial,
            }
    }
}

/// The matrices.
#[derive(Default)]
pub(super) struct Links {
    radial: Sparse,
    radial_of_other: Sparse,
    axial: Sparse,
    /// Sums of the rows of the first and of the last, with what a ring adds to its own.
    degree: [Vec<f64>; 2],
    /// -G p rho0 / c, r and z, by unknown.
    push: [Vec<f64>; 2],
    spare: (Vec<f64>, Vec<[f32; 0]>),
}

impl Links {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let matrices = [&self.radial, &self.radial_of_other, &self.axial];
        let vectors = [
            &self.degree[0],
            &self.degree[1],
            &self.push[0],
            &self.push[1],
        ];
        matrices.map(Sparse::memory).iter().sum::<usize>()
            + 8 * vectors.map(Vec::capacity).iter().sum::<usize>()
    }
}

impl<S: Scheme> Projection<S> {
    /// Makes the matrices for the rings as they are.
    pub(super) fn link_rings(&mut self) {
        let heavy = |mass: f64| Heavy { mass: mass as f32 };
        let flow = &mut self.liquid.flow;
        flow.repack(|p, i| heavy(p.weight(i)), |w, j| heavy(w.weight(j)));
        let mut links = std::mem::take(&mut self.transposed.links);
        let layout = self.walls.layout(&self.liquid.flow, self.liquid.case.h);
        let radii = self.sloping();
        let Links {
            radial,
            radial_of_other,
            axial,
            degree: [r, z],
            spare: (unused, none),
            ..
        } = &mut links;
        radial.build(&layout, &Along::<0>(radii), r, none);
        radial_of_other.build(&layout, &Along::<1>(radii), unused, none);
        axial.build(&layout, &Along::<2>(radii), z, none);
        let p = &self.liquid.flow.particles;
        each_mut(&mut r[..p.len()], |i, degree| {
            *degree += 2.0 * p.weight(i).powi(2) * radii.own(i).gradient;
        });
        self.transposed.links = links;
    }

    /// `out` = D G `x` times the masses.
    pub(super) fn multiply_rings(&mut self, x: &[f64], out: &mut [f64]) {
        let mut links = std::mem::take(&mut self.transposed.links);
        let (n, p) = (self.liquid.len(), &self.liquid.flow.particles);
        let Links {
            radial,
            radial_of_other,
            axial,
            degree,
            push,
            ..
        } = &mut links;
        for (along, (matrix, degree)) in push
            .iter_mut()
            .zip([&*radial, &*axial].into_iter().zip(&*degree))
        {
            along.clear();
            along.resize(x.len(), 0.0);
            each_mut(&mut along[..n], |i, along| {
                *along = (matrix.dot(i, x) + degree[i] * x[i]) / p.weight(i);
            });
        }
        let factor = S::weight(self).1.powi(2) / self.liquid.case.density;
        let [r, z] = &*push;
        each_mut(out, |i, out| {
            let own = degree[0][i] * r[i] + degree[1][i] * z[i];
            let others = radial_of_other.dot(i, r) - axial.dot(i, z);
            *out = factor * (own + others);
        });
        self.transposed.links = links;
    }
}
