//! Pair sums over rings about an axis ([`crate::kernel::ring`]).
//!
//! They are those of [`super::pass`] with the kernel of two rings: with g_a = h^4 / norm dW/dx_a,
//! which is not the opposite of g_b, masses m that differ, and a ring as its own neighbour:
//! (1) d rho_a/dt = SUM m_b (v_a . dW/dx_a + v_b . dW/dx_b) + density diffusion
//! (2) dv_a/dt = -SUM m_b (P_a/rho_a^2 + P_b/rho_b^2) dW/dx_a: its work is that of (1)
//! (3) viscosity along the line of each pair of points, as Cleary & Ha 2002 have it, averaged over
//!     the angle f: with r = x_a - x_b, v = v_a - v_b, and W_yy the second derivative of the kernel
//!     by y = r^2 in place of their (grad W . r) / r^4, whose mean has no bound,
//!     dv_a/dt -= SUM K W_yy (v . r) r,  K = 4 mu m_b (1/rho_a^2 + 1/rho_b^2) norm / h^5:
//!     INT W_yy r^4 dV = 15/4 in three dimensions, so that this is nu (lap v + 2 grad div v). With
//!     c = 1 - cos f:  v . r = s + t c,  s = dv_r dr + dv_z dz,  t = v_r,a r_b + v_r,b r_a, and
//!     r = (dr + r_b c, dz);  the means of W_yy, W_yy c, W_yy c^2 are F_yy, F_yp / 2, F_pp / 4
//! Sums leave a ring itself out; [`crate::kernel::ring::Own`] is what it adds.
//! Tests: tests/engine/ring.rs.

use super::liquid::Liquid;
use super::pass::{Moving, Sparing, WallSums, beyond};
use crate::effect::tension::ringed::{Heavy, Look};
use crate::kernel::ring::{Radii, between, mass_apart, places};
use crate::payload;
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::room::resize;
use crate::space::sparse::Couple;
use crate::space::sweep::{Pair, Pass};

payload! {
    /// [`Moving`] of a ring.
    pub struct Ring<F> {
        /// v_r, m/s.
        radial: F,
        /// v_z, m/s.
        axial: F,
        /// P / rho^2.
        pressure: F,
        /// 1 / rho^2.
        weight: F,
        /// Mass over the nominal one.
        mass: F,
    }
}

impl Ring {
    /// A ring of this `mass` that moves so.
    pub fn of(moving: Moving, mass: f64) -> Self {
        Ring {
            radial: moving.velocity[0],
            axial: moving.velocity[2],
            pressure: moving.pressure,
            weight: moving.weight,
            mass: mass as f32,
        }
    }
}

/// (3), and the kernel sum.
pub struct Surrounded<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
    /// -4 mu / h, Pa s/m.
    pub viscosity: f32,
}

impl Pass<3> for Surrounded<'_> {
    type Payload = Ring;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Ring>, sum: &mut [F; 3]) {
        let (own, other) = (&pair.own, &pair.other);
        let ([r_a, r_b], is_far) = places(pair);
        let [dr, _, dz] = pair.d;
        let m = mass_apart(other.mass, pair.q2);
        let [value, ..] = self.radii.rings.first(is_far, pair.q2, r_a * r_b);
        sum[2] = m.mul_add(value, sum[2]);
        if self.viscosity == 0.0 {
            return;
        }
        let [none, one, two] = self.radii.rings.second(is_far, pair.q2, r_a * r_b);
        let (one, two) = (one * 0.5, two * 0.25);
        let along = (own.radial - other.radial).mul_add(dr, (own.axial - other.axial) * dz);
        let turn = own.radial.mul_add(r_b, other.radial * r_a);
        let k = m * (own.weight + other.weight) * self.viscosity;
        let plain = along.mul_add(none, turn * one);
        let turned = along.mul_add(one, turn * two);
        sum[0] = k.mul_add(r_b.mul_add(turned, dr * plain), sum[0]);
        sum[1] = (k * dz).mul_add(plain, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum;
    }
}

impl Surrounded<'_> {
    /// What a ring itself adds to the first sum, over `weight` = 1 / rho^2.
    pub fn alone(&self, i: usize, mass: f64, radial: f64) -> f64 {
        self.viscosity as f64 * mass * self.radii.own(i).hoop * radial
    }
}

payload! {
    /// [`Sparing`] of a ring.
    pub struct Compressed<F> {
        /// v_r, m/s.
        radial: F,
        /// v_z, m/s.
        axial: F,
        /// e = rho / rho0 - 1.
        excess: F,
        /// What differences of e are spared, times 2 delta c, m/s.
        spared: F,
        /// Mass over the nominal one.
        mass: F,
    }
}

impl Compressed {
    /// A ring of this `mass`.
    pub fn of(sparing: Sparing, mass: f64) -> Self {
        Compressed {
            radial: sparing.velocity[0],
            axial: sparing.velocity[2],
            excess: sparing.excess,
            spared: sparing.spared,
            mass: mass as f32,
        }
    }
}

/// (1): the rate, and its part from diffusion, as [`super::pass::Spared`].
#[derive(Clone, Copy)]
pub struct Continuity<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
    /// 2 delta c, m/s.
    pub diffusion: f32,
    /// 2 delta h / c times gravity along z, m/s.
    pub held: f32,
}

impl Continuity<'_> {
    /// What diffusion evens out of a pair, before the slope of the kernel.
    #[inline(always)]
    pub fn evened<F: Real>(&self, pair: &Pair<F, Compressed>) -> F {
        let (own, other) = (&pair.own, &pair.other);
        let held = pair.d[2] * self.held;
        let evened = (own.excess - other.excess) * self.diffusion - held;
        beyond(evened, own.spared, other.spared)
    }
}

impl Pass<2> for Continuity<'_> {
    type Payload = Compressed;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Compressed>, sum: &mut [F; 2]) {
        let (own, other) = (&pair.own, &pair.other);
        let w = between(self.radii.rings, pair);
        let m = mass_apart(other.mass, pair.q2);
        let evened = self.evened(pair) * (w.slope * 2.0);
        let closing = w.radial[0] * own.radial
            + w.radial[1].mul_add(other.radial, w.axial * (own.axial - other.axial));
        sum[0] = m.mul_add(closing + evened, sum[0]);
        sum[1] = m.mul_add(evened, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [rate, evened]: [f32; 2], out: &mut [f32; 3]) {
        *out = [rate, evened, 0.0];
    }
}

/// (2).
pub struct Force<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
}

impl Pass<2> for Force<'_> {
    type Payload = Ring;
    type Out = [f32; 3];
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Ring>, sum: &mut [F; 2]) {
        let w = between(self.radii.rings, pair);
        let p = pair.own.pressure + pair.other.pressure;
        let push = pair.q2.splat(0.0) - mass_apart(pair.other.mass, pair.q2) * p;
        sum[0] = push.mul_add(w.radial[0], sum[0]);
        sum[1] = push.mul_add(w.axial, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [r, z]: [f32; 2], out: &mut [f32; 3]) {
        *out = [r, 0.0, z];
    }
}

/// As [`super::pass::Extrapolation`], to a wall particle.
pub struct Extrapolation<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
}

impl Pass<7> for Extrapolation<'_> {
    type Payload = Ring;
    type Out = WallSums;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Ring>, sum: &mut [F; 7]) {
        let other = &pair.other;
        let w = between(self.radii.rings, pair);
        let m = mass_apart(other.mass, pair.q2);
        let value = m * w.value;
        sum[0] += value;
        sum[1] = value.mul_add(other.pressure / other.weight.abs(), sum[1]);
        sum[2] = value.mul_add(pair.d[0], sum[2]);
        sum[3] = value.mul_add(pair.d[2], sum[3]);
        sum[4] = value.mul_add(other.radial, sum[4]);
        sum[5] = value.mul_add(other.axial, sum[5]);
        let closing = w.axial * other.axial - w.radial[1] * other.radial;
        sum[6] = m.mul_add(closing, sum[6]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 7], out: &mut WallSums) {
        *out = WallSums {
            weight: s[0],
            pressure: s[1],
            lever: [s[2], 0.0, s[3]],
            velocity: [s[4], 0.0, s[5]],
            closing: s[6],
        };
    }
}

payload! {
    /// What [`Laplacian`] reads.
    pub struct Joined<F> {
        /// Mass over the nominal one, over the density n of `projection::surface::Share`.
        volume: F,
        /// c of a wall particle, Pa.
        offset: F,
    }
}

/// Weights of the Laplacian, -2 F_y V_a V_b, and their sums as those of [`super::isph::pass`]: of
/// distances in the half-plane, where the pressure differs.
pub struct Laplacian<'a> {
    /// Where rings are.
    pub radii: Radii<'a>,
}

impl<const N: usize> Couple<N> for Laplacian<'_> {
    type Payload = Joined;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.radii.of(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Joined>, sum: &mut [F; N]) -> F {
        let ([own, other], is_far) = places(pair);
        let [_, slope, _] = self.radii.rings.first(is_far, pair.q2, own * other);
        let volumes = mass_apart(pair.own.volume * pair.other.volume, pair.q2);
        let w = volumes * slope * -2.0;
        sum[0] = w.mul_add(pair.q2, sum[0]);
        sum[1] = w.mul_add(pair.other.offset, sum[1]);
        for a in 0..3 {
            sum[2 + a] = w.mul_add(pair.d[a], sum[2 + a]);
        }
        sum[5] = w.mul_add(pair.own.offset, sum[5]);
        w
    }
}

impl Liquid {
    /// Kernel sums and their gradients of the rings for which they are `wanted`, over norm / h^3
    /// and h: along r and z at 0 and 2, the sum at 3. `has_moved`: whether places must be packed.
    pub fn sum_rings<W: Fn(usize) -> bool + Sync>(
        &mut self,
        has_moved: bool,
        wanted: W,
        sums: &mut Vec<[f32; 4]>,
    ) {
        let heavy = |mass: f64| Heavy { mass: mass as f32 };
        let flow = &mut self.flow;
        match has_moved {
            true => flow.pack(|p, i| heavy(p.weight(i)), |w, j| heavy(w.weight(j))),
            false => flow.repack(|p, i| heavy(p.weight(i)), |w, j| heavy(w.weight(j))),
        }
        resize(sums, self.len(), [0.0; 4]);
        let radii = self.flow.radii(self.case.h);
        self.sum(&Look { radii, wanted }, sums);
        let p = &self.flow.particles;
        each_mut(&mut sums[..], |i, sums| {
            let (own, mass) = (radii.own(i), p.weight(i));
            sums[0] += (mass * own.gradient) as f32;
            sums[3] += (mass * own.value) as f32;
        });
    }
}
