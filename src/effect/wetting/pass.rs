//! Pair sums of the wetting; numbers as in [`super`].

use crate::kernel::Kernel;
use crate::space::lane::Lanes;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// SUM w with separations sheared along a wall normal to `axis`: (2). Own payload: the shear.
pub struct Sheared<K> {
    pub axis: usize,
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<1> for Sheared<K> {
    type Out = f32;
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 1]) {
        unsafe {
            let height = pair.d[self.axis];
            let mut d = pair.d;
            for (d, shear) in d.iter_mut().zip(pair.own) {
                *d = L::fma(shear, height, *d);
            }
            let w = K::w_lanes::<L>(L::sqrt(L::dot(d, d)));
            // Lanes without a pair are far away, but their separation is not.
            sum[0] = L::add(sum[0], L::if_less(pair.q2, L::splat(NONE), w));
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

/// No pair is as far as this, in units of H^2.
const NONE: f32 = 1e6;

/// SUM c slope d and SUM slope d over the wall. Payload 0: c.
pub struct Walls<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<6> for Walls<K> {
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 6]) {
        unsafe {
            let slope = K::slope_lanes::<L>(L::sqrt(pair.q2));
            let f = L::mul(pair.other[0], slope);
            for a in 0..3 {
                sum[a] = L::fma(f, pair.d[a], sum[a]);
                sum[3 + a] = L::fma(slope, pair.d[a], sum[3 + a]);
            }
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, s: [f32; 6], out: &mut Self::Out) {
        *out = ([s[0], s[1], s[2]], [s[3], s[4], s[5]]);
    }
}
