//! The surface energy of rings about an axis: the sums of [`super::energy`] with the kernel of two
//! rings, [`crate::kernel::ring`].
//!
//! (1) phi_a = SUM V_b W, H n_a = H SUM V_b dW/dx_a, a itself among b
//! (2) m a_a = -alpha sigma / H SUM V_a V_b ((e'_a + e'_b) dW/dx_a + H g_a . d2W/dx_a dx_a
//!     + H g_b . d2W/dx_b dx_a): minus the derivative of E.
//! The curvature about the axis is in them.

use super::Tension;
use super::shore::Shore;
use crate::effect::surface::Surface;
use crate::kernel::ring::{Between, Radii, Rings, between, mass_apart, places};
use crate::payload;
use crate::space::lane::{Real, are_zero};
use crate::space::parallel::each_mut;
use crate::space::sweep::{self, Pair, Pass, Payload};

payload! {
    /// What [`Look`] reads.
    pub struct Heavy<F> {
        /// Mass over the nominal one.
        mass: F,
    }
}

/// (1) without a itself: H n_r, H n_z, phi, in that order at 0, 2 and 3.
pub struct Look<'a, W> {
    /// Where rings are.
    pub radii: Radii<'a>,
    /// Whether the sums of a ring are; others are zero.
    pub wanted: W,
}

impl<W: Fn(usize) -> bool + Sync> Pass<3> for Look<'_, W> {
    type Payload = Heavy;
    type Out = [f32; 4];
    #[inline(always)]
    fn skips(&self, target: usize) -> bool {
        !(self.wanted)(target)
    }
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Heavy>, sum: &mut [F; 3]) {
        let w = between(self.radii.rings, pair);
        let m = mass_apart(pair.other.mass, pair.q2);
        sum[0] = m.mul_add(w.radial[0], sum[0]);
        sum[1] = m.mul_add(w.axial, sum[1]);
        sum[2] = m.mul_add(w.value, sum[2]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [r, z, sum]: [f32; 3], out: &mut [f32; 4]) {
        *out = [r, 0.0, z, sum];
    }
}

payload! {
    /// What [`Pull`] reads.
    pub struct Energetic<F> {
        /// e'.
        slope: F,
        /// g_r / H.
        radial: F,
        /// Mass over the nominal one.
        mass: F,
        /// g_z / H.
        axial: F,
    }
}

/// Second derivatives of the kernel of two rings by their places.
pub(crate) struct Bent<F> {
    /// By r_a twice.
    pub rr: F,
    /// By r_a and z_a, minus that by r_a and z_b.
    pub rz: F,
    /// By z_a twice, minus that by z_a and z_b.
    pub zz: F,
    /// By r_a and r_b.
    pub mixed_rr: F,
    /// By z_a and r_b.
    pub mixed_zr: F,
}

impl<F: Real> Bent<F> {
    /// Of a pair whose target has its radius in `extra`.
    #[inline(always)]
    pub fn of<P: Payload>(rings: Rings, pair: &Pair<F, P>, w: &Between<F>) -> Self {
        let ([own, other], is_far) = places(pair);
        let [yy, yp, pp] = rings.second(is_far, pair.q2, own * other);
        let [r, z] = [pair.d[0] * 2.0, pair.d[2] * 2.0];
        let zero = pair.q2.splat(0.0);
        // By r_a and r_b of F_y, and of F_p.
        let y = [other.mul_add(yp, r * yy), own.mul_add(yp, zero - r * yy)];
        let p = [other.mul_add(pp, r * yp), own.mul_add(pp, zero - r * yp)];
        let twice = w.slope * 2.0;
        Bent {
            rr: twice + r.mul_add(y[0], other * p[0]),
            rz: z * y[0],
            zz: twice + z * z * yy,
            mixed_rr: w.turn - twice + r.mul_add(y[1], other * p[1]),
            mixed_zr: z * y[1],
        }
    }
}

/// What ring `i` adds to its own force, before its factor and over its mass, from e' and g_r / H.
pub fn alone(radii: Radii, i: usize, [slope, radial]: [f64; 2]) -> f64 {
    let radius = radii.liquid[i] / radii.length;
    let [_, turn, second, _] = radii.rings.own(radius);
    2.0 * slope * radius * turn + radial * (turn + 2.0 * radius * radius * second)
}

impl Energetic {
    /// A ring of this `mass`.
    pub fn of(energetic: super::pass::Energetic, mass: f64) -> Self {
        Energetic {
            slope: energetic.slope,
            radial: energetic.gradient[0],
            mass: mass as f32,
            axial: energetic.gradient[2],
        }
    }
}

/// (2) without a itself, before its factor.
pub struct Pull<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
}

impl Pass<2> for Pull<'_> {
    type Payload = Energetic;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Energetic>, sum: &mut [F; 2]) {
        let (a, b) = (&pair.own, &pair.other);
        let m = mass_apart(b.mass, pair.q2);
        let w = between(self.radii.rings, pair);
        let e = m * (a.slope + b.slope);
        sum[0] = e.mul_add(w.radial[0], sum[0]);
        sum[1] = e.mul_add(w.axial, sum[1]);
        let axial = a.axial.abs().max(b.axial.abs());
        if are_zero([a.radial, b.radial, axial]) {
            return;
        }
        let bent = Bent::of(self.radii.rings, pair, &w);
        let axial = a.axial - b.axial;
        let by_r = a.radial * bent.rr + b.radial.mul_add(bent.mixed_rr, axial * bent.rz);
        let by_z = a.radial * bent.rz + b.radial.mul_add(bent.mixed_zr, axial * bent.zz);
        sum[0] = m.mul_add(by_r, sum[0]);
        sum[1] = m.mul_add(by_z, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [r, z]: [f32; 2], out: &mut [f32; 3]) {
        *out = [r, 0.0, z];
    }
}

impl Tension {
    /// Masses of all points over the nominal one.
    fn masses(&mut self, flow: &Surface, [liquid, wall]: [&[f64]; 2]) -> Vec<f32> {
        let mut masses = std::mem::take(&mut self.energy.masses);
        masses.clear();
        masses.extend(liquid.iter().chain(wall).map(|m| *m as f32));
        masses.resize(flow.at[0].len(), 0.0);
        masses
    }

    fn radii<'a>(&self, flow: &'a Surface) -> Radii<'a> {
        Radii {
            liquid: &flow.position[0],
            wall: &flow.wall[0],
            length: self.length,
            rings: Default::default(),
        }
    }

    /// Sums of [`super::energy`] for the rings near the surface, a itself among them but for the
    /// kernel at its place in three dimensions, which is `own` and is added to all.
    pub(super) fn look_at_rings(
        &mut self,
        flow: &Surface,
        weights: [&[f64]; 2],
        own: f64,
        sums: &mut [[f32; 4]],
    ) {
        let words = [self.masses(flow, weights)];
        let radii = self.radii(flow);
        let wanted = |_| true;
        let pass = Look { radii, wanted };
        self.runs(flow, &words, (&self.near, &0.into(), &pass), sums);
        let near = &self.near;
        each_mut(&mut sums[..near.len()], |k, sums| {
            let i = near[k] as usize;
            let (of, mass) = (radii.own(i), weights[0][i]);
            sums[0] += (mass * of.gradient) as f32;
            sums[3] += (mass * of.value - own) as f32;
        });
        let [masses] = words;
        self.energy.masses = masses;
    }

    /// The same sums of all wall rings over liquid and wall; `own` as above.
    pub(super) fn look_from_walls(
        &mut self,
        flow: &Surface,
        weights: [&[f64]; 2],
        own: f64,
        shore: &mut Shore,
    ) {
        let walls = flow.wall[0].len();
        if shore.dry.len() != walls {
            shore.dry = shore.rings_alone(flow.wall, self.length, own);
            shore.weights = weights[1].to_vec();
            shore.near = (0..walls as u32).collect();
            shore.under = vec![false; walls];
            (shore.span, shore.walls) = (walls.into(), walls.into());
        }
        let words = [self.masses(flow, weights)];
        let radii = Radii {
            liquid: &flow.wall[0],
            ..self.radii(flow)
        };
        shore.sums.resize(walls, [0.0; 4]);
        let field = flow.about(flow.wall, flow.of_liquid(), &words, self.length);
        let wanted = |_| true;
        let pass = Look { radii, wanted };
        sweep::runs(field, &shore.near, &pass, &mut shore.sums);
        let dry = &shore.dry;
        each_mut(&mut shore.sums[..], |j, sums| {
            (0..4).for_each(|a| sums[a] += dry[j][a]);
        });
        let [masses] = words;
        self.energy.masses = masses;
    }

    /// (2), from e' and g that `words` has: its third place is free.
    pub(super) fn pull_rings(
        &mut self,
        flow: &Surface,
        weights: [&[f64]; 2],
        words: &mut [Vec<f32>; 4],
        factor: f64,
        force: &mut [[f32; 3]],
    ) {
        let masses = std::mem::take(&mut self.energy.masses);
        let empty = std::mem::replace(&mut words[2], masses);
        let radii = self.radii(flow);
        self.hold_lines(flow, (words, &[0, 1, 3]), (&Pull { radii }, factor));
        self.runs(
            flow,
            words,
            (&self.reached, &0.into(), &Pull { radii }),
            force,
        );
        let reached = &self.reached;
        each_mut(&mut force[..reached.len()], |k, force| {
            let i = reached[k] as usize;
            let own = alone(radii, i, [words[0][i], words[1][i]].map(f64::from));
            let r = force[0] as f64 + weights[0][i] * own;
            *force = [(factor * r) as f32, 0.0, (factor * force[2] as f64) as f32];
        });
        self.energy.masses = std::mem::replace(&mut words[2], empty);
    }
}
