//! Raw normals of a surface.

use crate::kernel::Kernel;
use crate::space::lane::Real;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// SUM slope d: the raw normal, and nothing beside it.
pub struct Gradient<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<3> for Gradient<K> {
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F>, sum: &mut [F; 3]) {
        let slope = K::slope_lanes(pair.q2.sqrt());
        for a in 0..3 {
            sum[a] = slope.mul_add(pair.d[a], sum[a]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 3], out: &mut Self::Out) {
        *out = (sum, [0.0; 3]);
    }
}
