//! Pair sums of the wetting; numbers as in [`super`].

use crate::effect::normal::Coloured;
use crate::kernel::Kernel;
use crate::space::lane::{Real, dot};
use crate::space::sweep::{Pair, Pass, Payload};
use std::marker::PhantomData;

/// SUM w with separations sheared along a wall normal to `axis`: (2).
pub struct Sheared<'a, K> {
    pub axis: usize,
    /// The shear of each target.
    pub lean: &'a [Vec<f32>; 3],
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Sheared<'_, K> {
    /// w of a pair.
    #[inline(always)]
    fn w<F: Real, P: Payload>(&self, pair: &Pair<F, P>) -> F {
        let height = pair.d[self.axis];
        let mut d = pair.d;
        for (d, shear) in d.iter_mut().zip(pair.extra) {
            *d = shear.mul_add(height, *d);
        }
        let w = K::w_lanes(dot(d, d).sqrt());
        // Lanes without a pair are far away, but their separation is not.
        w.if_less(pair.q2, pair.q2.splat(NONE))
    }
}

impl<K: Kernel> Pass<1> for Sheared<'_, K> {
    type Payload = ();
    type Out = f32;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        let [x, y, z] = self.lean;
        [x[target], y[target], z[target]]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 1]) {
        sum[0] += self.w(pair);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// The same of rings, whose areas differ: SUM c w.
pub struct Weighed<'a, K>(pub Sheared<'a, K>);

impl<K: Kernel> Pass<1> for Weighed<'_, K> {
    type Payload = Coloured;
    type Out = f32;
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.0.extra(target)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Coloured>, sum: &mut [F; 1]) {
        sum[0] = pair.other.colour.mul_add(self.0.w(pair), sum[0]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// No pair is as far as this, in units of H^2.
const NONE: f32 = 1e6;

/// SUM c slope d and SUM slope d over the wall, c the colour.
pub struct Walls<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<6> for Walls<K> {
    type Payload = Coloured;
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Coloured>, sum: &mut [F; 6]) {
        let slope = K::slope_lanes(pair.q2.sqrt());
        let f = pair.other.colour * slope;
        for a in 0..3 {
            sum[a] = f.mul_add(pair.d[a], sum[a]);
            sum[3 + a] = slope.mul_add(pair.d[a], sum[3 + a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 6], out: &mut Self::Out) {
        *out = ([s[0], s[1], s[2]], [s[3], s[4], s[5]]);
    }
}
