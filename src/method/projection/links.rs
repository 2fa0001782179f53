//! D G of rings ([`super::rings`]) as matrices: an equation is solved by many products with the
//! same derivatives of the kernel, which cost more than all else in them.
//!
//! (1) m_a (G p)_a = -c/rho0 SUM m_a m_b (p_a s_ab + p_b t_ab)
//! (2) m_a (D u)_a = -c SUM m_a m_b (u_a . s_ab + u_b . t_ba),  u = 0 in walls
//! s_ab: the rate of density of a by its own velocity, t_ab: that of b by the velocity of a
//! ([`Rates`]). Each component has a matrix for t_ab and one for t_ba; of s sums are enough. Where
//! density is not completed they are those of t_ab, and t_ba = -t_ab along z.
//! Test: tests/engine/ring_projection.rs.

use super::{Projection, Scheme};
use crate::effect::tension::ringed::Energetic;
use crate::kernel::ring::{Radii, mass_apart};
use crate::method::completed::Completed;
use crate::method::completed::ring::{Rates, alone_of};
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::sparse::{Couple, Sparse};
use crate::space::sweep::Pair;

/// m_a m_b times t_ab along r and z, then t_ba. Sums: of s_ab. `BENDS`: of a completed density.
struct Along<'a, const OF: usize, const BENDS: bool>(Radii<'a>);

impl<const OF: usize, const BENDS: bool> Couple<2> for Along<'_, OF, BENDS> {
    type Payload = Energetic;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.0.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Energetic>, sum: &mut [F; 2]) -> F {
        let rates = Rates::of::<BENDS>(self.0, pair);
        let masses = mass_apart(pair.own.mass * pair.other.mass, pair.q2);
        if BENDS && OF == 0 {
            for a in 0..2 {
                sum[a] = masses.mul_add(rates.own[a], sum[a]);
            }
        }
        let ([r, z], [back_r, back_z]) = (rates.of_other, rates.by_other);
        masses * [r, z, back_r, back_z][OF]
    }
}

/// The matrices.
#[derive(Default)]
pub(super) struct Links {
    of_other: [Sparse; 2],
    by_other: [Sparse; 2],
    /// Sums of s, with what a ring adds to its own.
    own: [Vec<f64>; 2],
    /// -G p rho0 / c, r and z, by unknown.
    push: [Vec<f64>; 2],
    /// Sums of rows that nothing needs, and of s, r and z.
    spare: (Vec<f64>, Vec<[f32; 2]>),
}

impl Links {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let matrices = self.of_other.iter().chain(&self.by_other);
        let (degree, sums) = &self.spare;
        let vectors = self.own.iter().chain(&self.push).map(Vec::capacity);
        let words = vectors.sum::<usize>() + degree.capacity() + sums.capacity();
        matrices.map(Sparse::memory).sum::<usize>() + 8 * words
    }
}

impl<S: Scheme> Projection<S> {
    /// Makes the matrices for the rings as they are.
    pub(super) fn link_rings(&mut self) {
        match self.transposed.completed.is_empty() {
            true => self.link::<false>(),
            false => self.link::<true>(),
        }
    }

    fn link<const BENDS: bool>(&mut self) {
        let completed = &self.transposed.completed;
        let of = |i: usize| completed.get(i).copied().unwrap_or_default();
        let whole = Completed::default();
        self.liquid.flow.repack(
            |p, i| Energetic::of(of(i).press(1.0), p.weight(i)),
            |w, j| Energetic::of(whole.press(1.0), w.weight(j)),
        );
        let mut links = std::mem::take(&mut self.transposed.links);
        let layout = self.walls.layout(&self.liquid.flow, self.liquid.case.h);
        let radii = self.sloping();
        let Links {
            of_other: [r, z],
            by_other: [back_r, back_z],
            own,
            spare: (degree, sums),
            ..
        } = &mut links;
        r.build(&layout, &Along::<0, BENDS>(radii), &mut own[0], sums);
        let [own_r, own_z] = own;
        if BENDS {
            own_r
                .iter_mut()
                .zip(&*sums)
                .for_each(|(own, s)| *own = s[0] as f64);
            own_z.clear();
            own_z.extend(sums.iter().map(|s| s[1] as f64));
        }
        let degree_z = if BENDS { &mut *degree } else { own_z };
        z.build(&layout, &Along::<1, BENDS>(radii), degree_z, sums);
        back_r.build(&layout, &Along::<2, BENDS>(radii), degree, sums);
        if BENDS {
            back_z.build(&layout, &Along::<3, BENDS>(radii), degree, sums);
        }
        let (p, completed) = (&self.liquid.flow.particles, &self.transposed.completed);
        each_mut(&mut own_r[..p.len()], |i, own| {
            let of = completed.get(i).copied().unwrap_or_default();
            *own += p.weight(i).powi(2) * alone_of(radii, i, &of);
        });
        self.transposed.links = links;
    }

    /// `out` = D G `x` times the masses.
    pub(super) fn multiply_rings(&mut self, x: &[f64], out: &mut [f64]) {
        let mut links = std::mem::take(&mut self.transposed.links);
        let (n, p) = (self.liquid.len(), &self.liquid.flow.particles);
        let Links {
            of_other,
            by_other: [r, z],
            own,
            push,
            ..
        } = &mut links;
        for (a, (along, matrix)) in push.iter_mut().zip(&*of_other).enumerate() {
            along.clear();
            along.resize(x.len(), 0.0);
            each_mut(&mut along[..n], |i, along| {
                *along = (matrix.dot(i, x) + own[a][i] * x[i]) / p.weight(i);
            });
        }
        let factor = S::weight(self).1.powi(2) / self.liquid.case.density;
        let [push_r, push_z] = &*push;
        each_mut(out, |i, out| {
            let own = own[0][i] * push_r[i] + own[1][i] * push_z[i];
            let by_z = match z.is_empty() {
                true => -of_other[1].dot(i, push_z),
                false => z.dot(i, push_z),
            };
            *out = factor * (own + r.dot(i, push_r) + by_z);
        });
        self.transposed.links = links;
    }
}
