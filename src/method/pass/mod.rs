//! Pair sums of weakly compressible SPH. Lengths in units of h, `q = r / h`,
//! grad W = norm / h^(d+1) slope(q) d with d = r_ab / h.

mod walls;

pub use walls::{Extrapolation, WallSums};

use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::{Real, dot};
use crate::space::sweep::{Pair, Pass};
use serde::{Deserialize, Serialize};
use std::marker::PhantomData;

payload! {
    /// What forces read, and what looks at velocities.
    pub struct Moving<F> {
        /// m/s.
        velocity: [F; 3],
        /// P / rho^2.
        pressure: F,
        /// 1 / rho^2, negative where tension is controlled.
        weight: F,
    }
}

/// a - b.
#[inline(always)]
pub fn difference<F: Real>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Summation density (Nishio Eq. 4): out = self + factor x SUM w(q).
pub struct Summation<K> {
    /// m norm / h^d.
    pub factor: f64,
    /// m W(0).
    pub own: f64,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<1> for Summation<K> {
    type Payload = ();
    type Out = f64;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let w = K::w_apart(q2.sqrt(), q2);
        [w, w]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += pair.weight[0];
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f64) {
        *out = self.own + self.factor * sum[0] as f64;
    }
}

payload! {
    /// What [`Continuity`] reads.
    pub struct Compressed<F> {
        /// v + t f with t = delta h / c, m/s.
        velocity: [F; 3],
        /// e = rho / rho0 - 1.
        excess: F,
    }
}

/// Rate of density by continuity, with density diffusion that leaves liquid at rest alone.
///
/// d rho/dt = SUM m v_ab . grad W
///          - 2 delta h c SUM m (e_b - e_a - f . (r_b - r_a) / c^2) slope norm / h^(d+2)
///
/// f = (f_a + f_b) / 2 is the acceleration that the pressure holds: with gravity alone Fourtakas et
/// al. 2019 after Antuono et al. 2010, and here tension too. Without it density leaks from a drop
/// at rest, whose pressure falls within the width of the tension, into its rim, and the particles
/// follow: its core was 1 % too dense after 40 ms, its pressure 3 % too low, and more with more
/// particles.
pub struct Continuity<'a, K> {
    /// m norm / h^(d+1).
    pub factor: f64,
    /// 2 delta c, m/s.
    pub diffusion: f32,
    /// 2 t, s.
    pub lag: f32,
    /// f of each target, m/s^2, or one for all.
    pub held: &'a [[f32; 3]],
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<1> for Continuity<'_, K> {
    type Payload = Compressed;
    type Out = f32;
    #[inline(always)]
    fn own(&self, target: usize, mut own: Compressed) -> Compressed {
        let f = self.held[target.min(self.held.len() - 1)];
        for a in 0..3 {
            own.velocity[a] -= self.lag * f[a];
        }
        own
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Compressed>, sum: &mut [F; 1]) {
        let v = difference(pair.own.velocity, pair.other.velocity);
        let e = pair.own.excess - pair.other.excess;
        let rate = pair.q2.splat(self.diffusion).mul_add(e, dot(v, pair.d));
        let slope = pair.weight[0];
        sum[0] = slope.mul_add(rate, sum[0]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = (self.factor * sum[0] as f64) as f32;
    }
}

payload! {
    /// What [`Spared`] reads.
    pub struct Sparing<F> {
        /// m/s.
        velocity: [F; 3],
        /// e = rho / rho0 - 1.
        excess: F,
        /// What differences of e are spared, times 2 delta c, m/s.
        spared: F,
    }
}

/// What of a difference is evened out of a pair that spares `own` and `other`.
#[inline(always)]
pub fn beyond<F: Real>(difference: F, own: F, other: F) -> F {
    let spared = own.max(other);
    let least = spared.splat(0.0) - spared;
    difference - difference.max(least).min(spared)
}

/// [`Continuity`] with gravity alone as f, whose part from diffusion is known, for the budget of
/// energy: first the rate, then that part. It may spare small differences of density.
///
/// At a surface whose tension
/// is the derivative of an energy every particle needs the density that it has: it holds the force
/// on it. Diffusion would even it out, and the layer would creep, fed by it, as long as it lasts.
/// Without any, a splash is noise: a crater at d/8 was 20 % flat.
pub struct Spared<K> {
    /// m norm / h^(d+1).
    pub factor: f64,
    /// 2 delta c, m/s.
    pub diffusion: f32,
    /// 2 delta h / c times gravity, m/s.
    pub held: [f32; 3],
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K> Spared<K> {
    /// What diffusion evens out of a pair.
    #[inline(always)]
    pub fn evened<F: Real>(&self, pair: &Pair<F, Sparing>) -> F {
        let (own, other) = (&pair.own, &pair.other);
        let held = dot(pair.q2.splat3(self.held), pair.d);
        let evened = (own.excess - other.excess) * self.diffusion - held;
        beyond(evened, own.spared, other.spared)
    }
}

impl<K: Kernel> Pass<2> for Spared<K> {
    type Payload = Sparing;
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Sparing>, sum: &mut [F; 2]) {
        let v = difference(pair.own.velocity, pair.other.velocity);
        let evened = self.evened(pair);
        let rate = evened + dot(v, pair.d);
        let slope = pair.weight[0];
        sum[0] = slope.mul_add(rate, sum[0]);
        sum[1] = slope.mul_add(evened, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [rate, evened]: [f32; 2], out: &mut [f32; 3]) {
        *out = [rate, evened, 0.0].map(|s| (self.factor * s as f64) as f32);
    }
}

/// Pair force of pressure and of viscosity `V` (Nishio Eq. 5).
///
/// `CONTROL`: where marked, a negative own pressure enters with its sign turned, so that the pair
/// sees P_b - P_a, which is blind to a common tension and does not clump (Sun, Colagrossi, Marrone,
/// Antuono & Zhang 2018).
pub struct Force<K, V, const CONTROL: bool> {
    /// m norm / h^(d+1).
    pub factor: f64,
    /// The viscous part of a pair.
    pub viscosity: V,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel, V: PairViscosity, const CONTROL: bool> Pass<3> for Force<K, V, CONTROL> {
    type Payload = Moving;
    type Out = [f32; 3];
    #[inline(always)]
    fn own(&self, _: usize, mut own: Moving) -> Moving {
        if CONTROL && own.weight < 0.0 {
            own.pressure = own.pressure.abs();
        }
        own
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 3]) {
        let slope = pair.weight[0];
        let (own, other) = (&pair.own, &pair.other);
        let p = own.pressure + other.pressure;
        if V::PRESENT {
            let v = difference(own.velocity, other.velocity);
            let weight = if CONTROL {
                own.weight.abs() + other.weight.abs()
            } else {
                own.weight + other.weight
            };
            self.viscosity.add(slope, pair.q2, pair.d, v, weight, sum);
        }
        let f = pair.q2.splat(0.0) - slope * p;
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| (self.factor * s as f64) as f32);
    }
}

/// [`Force`] and, from the same pairs, SUM slope d: times norm s0^d / h^(d+1) it is grad C, 1/m.
pub struct ForceAndGradient<K, V, const CONTROL: bool>(pub Force<K, V, CONTROL>);

impl<K: Kernel, V: PairViscosity, const CONTROL: bool> Pass<6> for ForceAndGradient<K, V, CONTROL> {
    type Payload = Moving;
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    fn own(&self, target: usize, own: Moving) -> Moving {
        self.0.own(target, own)
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        self.0.weigh(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 6]) {
        let mut force = [sum[0], sum[1], sum[2]];
        self.0.pair(pair, &mut force);
        let slope = pair.weight[0];
        for a in 0..3 {
            sum[a] = force[a];
            sum[3 + a] = slope.mul_add(pair.d[a], sum[3 + a]);
        }
    }
    #[inline(always)]
    fn finish(&self, target: usize, s: [f32; 6], out: &mut Self::Out) {
        self.0.finish(target, [s[0], s[1], s[2]], &mut out.0);
        out.1 = [s[3], s[4], s[5]];
    }
}

/// Everything that an advective step asks of the neighbourhood: viscosity, and the kernel sum that
/// shows the free surface.
pub struct Neighbourhood<K, V> {
    /// m norm / h^(d+1).
    pub factor: f64,
    /// The viscous part of a pair.
    pub viscosity: V,
    /// The kernel.
    pub kernel: PhantomData<K>,
}

/// Sums of [`Neighbourhood`].
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Surroundings {
    /// Viscous acceleration, m/s^2; once that is held, a normal of the surface of any length.
    pub vector: [f32; 3],
    /// SUM w without the particle itself: times norm s0^d / h^d it is the kernel sum.
    pub sum: f32,
    /// SUM w |v_ab|^2 (where velocities are packed).
    pub stir: f32,
}

impl Surroundings {
    /// The kernel sum: 1 inside, 0.77 at a flat surface. `factor`: norm s0^d / h^d.
    #[inline(always)]
    pub fn kernel_sum(&self, factor: f32) -> f32 {
        factor * (self.sum + 1.0)
    }

    /// Root mean square of |v_ab| over the neighbours, weighted with W, m/s.
    #[inline(always)]
    pub fn relative_speed(&self) -> f32 {
        (self.stir / self.sum.max(f32::MIN_POSITIVE)).sqrt()
    }
}

impl<K: Kernel, V: PairViscosity> Pass<5> for Neighbourhood<K, V> {
    type Payload = Moving;
    type Out = Surroundings;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Moving>, sum: &mut [F; 5]) {
        let [w, slope] = pair.weight;
        if V::PRESENT {
            let v = difference(pair.own.velocity, pair.other.velocity);
            let mut s = [sum[0], sum[1], sum[2]];
            let weight = pair.own.weight + pair.other.weight;
            self.viscosity
                .add(slope, pair.q2, pair.d, v, weight, &mut s);
            [sum[0], sum[1], sum[2]] = s;
            let v2 = v[0].mul_add(v[0], v[1].mul_add(v[1], v[2] * v[2]));
            sum[4] = w.mul_add(v2, sum[4]);
        }
        sum[3] += w;
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 5], out: &mut Surroundings) {
        *out = Surroundings {
            vector: [s[0], s[1], s[2]].map(|s| (self.factor * s as f64) as f32),
            sum: s[3],
            stir: s[4],
        };
    }
}

payload! {
    /// What [`Marked`] reads.
    pub struct Mark<F> {
        /// 1 where a particle is marked, else 0.
        mark: F,
    }
}

/// How many neighbours in the support are marked.
pub struct Marked<'a> {
    /// Whether any neighbour of a target may be marked.
    pub near: &'a [bool],
}

impl Pass<1> for Marked<'_> {
    type Payload = Mark;
    type Out = f32;
    #[inline(always)]
    fn skips(&self, target: usize) -> bool {
        !self.near[target]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Mark>, sum: &mut [F; 1]) {
        let seen = pair.other.mark.if_less(pair.q2, pair.q2.splat(4.0));
        sum[0] += seen;
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}
