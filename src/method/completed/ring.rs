//! The sums of [`super`] over rings about an axis ([`crate::kernel::ring`]).

use super::Completed;
use crate::effect::tension::ringed::{Bent, Energetic, alone};
use crate::kernel::ring::{Radii, between, mass_apart};
use crate::method::ring::{self, Compressed};
use crate::space::lane::{Real, are_zero};
use crate::space::sweep::{Pair, Pass};

/// The rate of density, as [`ring::Continuity`] has it, by (2); without a itself, before its
/// factor: dC/dt, n_g . h d(grad C)/dt, the part from diffusion.
pub struct Continuity<'a> {
    /// What it is of a full support.
    pub plain: ring::Continuity<'a>,
    /// By ring.
    pub completed: &'a [Completed],
}

impl Pass<3> for Continuity<'_> {
    type Payload = Compressed;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        let [radius, ..] = self.plain.radii.of(target);
        let [r, _, z] = self.completed[target].along;
        [radius, r, z]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Compressed>, sum: &mut [F; 3]) {
        let (a, b) = (&pair.own, &pair.other);
        let w = between(self.plain.radii.rings, pair);
        let m = mass_apart(b.mass, pair.q2);
        let evened = self.plain.evened(pair) * (w.slope * 2.0);
        let axial = a.axial - b.axial;
        let closing = w.radial[0] * a.radial + w.radial[1].mul_add(b.radial, w.axial * axial);
        sum[0] = m.mul_add(closing, sum[0]);
        sum[2] = m.mul_add(evened, sum[2]);
        let [_, r, z] = pair.extra;
        if are_zero([r, r, z]) {
            return;
        }
        let bent = Bent::of(self.plain.radii.rings, pair, &w);
        let by_r = bent.rr * a.radial + bent.mixed_rr.mul_add(b.radial, bent.rz * axial);
        let by_z = bent.rz * a.radial + bent.mixed_zr.mul_add(b.radial, bent.zz * axial);
        sum[1] = m.mul_add(r.mul_add(by_r, z * by_z), sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum;
    }
}

impl Continuity<'_> {
    /// The rate of density of ring `i`, before its factor, from what the sums are and its mass and
    /// v_r.
    #[inline(always)]
    pub fn closing(&self, i: usize, [sums, gradients, _]: [f32; 3], push: f64) -> f64 {
        let completed = &self.completed[i];
        let own = push * alone_of(self.plain.radii, i, completed);
        completed.slope as f64 * sums as f64 + gradients as f64 + own
    }
}

/// What ring `i` adds to its own force divided by its mass and pressure, before the factor and its
/// sign.
pub fn alone_of(radii: Radii, i: usize, completed: &Completed) -> f64 {
    let Completed { slope, along, .. } = *completed;
    alone(radii, i, [slope, along[0]].map(f64::from))
}

/// Of a pair, along r and z, the rates of density times what is packed as their pressure.
pub struct Rates<F> {
    /// That of a by its own velocity.
    pub own: [F; 2],
    /// That of the other by the velocity of a.
    pub of_other: [F; 2],
    /// That of a by the velocity of the other.
    pub by_other: [F; 2],
}

impl<F: Real> Rates<F> {
    /// Of a pair whose target has its radius in `extra`; `BENDS`: whether gradients count, for
    /// which tables of a weight lack the second derivatives.
    #[inline(always)]
    pub fn of<const BENDS: bool>(radii: Radii, pair: &Pair<F, Energetic>) -> Self {
        let (a, b) = (&pair.own, &pair.other);
        let w = between(radii.rings, pair);
        let zero = pair.q2.splat(0.0);
        let mut rates = Rates {
            own: [a.slope * w.radial[0], a.slope * w.axial],
            of_other: [b.slope * w.radial[0], b.slope * w.axial],
            by_other: [a.slope * w.radial[1], zero - a.slope * w.axial],
        };
        if BENDS {
            let bent = Bent::of(radii.rings, pair, &w);
            let [r, z] = [a.radial, a.axial];
            rates.own[0] += r * bent.rr + z * bent.rz;
            rates.own[1] += r * bent.rz + z * bent.zz;
            rates.by_other[0] += r * bent.mixed_rr + z * bent.mixed_zr;
            rates.by_other[1] = rates.by_other[1] - (r * bent.rz + z * bent.zz);
            let [r, z] = [b.radial, b.axial];
            rates.of_other[0] += r * bent.mixed_rr - z * bent.rz;
            rates.of_other[1] += r * bent.mixed_zr - z * bent.zz;
        }
        rates
    }
}
