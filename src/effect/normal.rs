//! Raw normals of a surface, and what such sums read.

use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::Real;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

payload! {
    /// What sums over colours read.
    pub struct Coloured<F> {
        /// Colour of a particle.
        colour: F,
    }
}

payload! {
    /// What sums over stresses and normals read: a stress is |u|^2 I - u u, a normal is along u.
    pub struct Root<F> {
        /// u.
        u: [F; 3],
    }
}

impl Root {
    /// The unit vector along u.
    #[inline(always)]
    pub fn unit(self) -> Self {
        let [x, y, z] = self.u;
        let size = (x * x + y * y + z * z).sqrt();
        let u = self.u.map(|u| u / size.max(f32::MIN_POSITIVE));
        Root { u }
    }
}

/// SUM slope d: the raw normal, and nothing beside it.
pub struct Gradient<K>(pub PhantomData<K>);

impl<K: Kernel> Pass<3> for Gradient<K> {
    type Payload = ();
    type Out = ([f32; 3], [f32; 3]);
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 3]) {
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
