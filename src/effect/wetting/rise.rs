//! How the surface bends along itself towards the wall: d cos / dz of (5) in [`super`].
//!
//! (1) H t . B t = SUM w (t . u_b) (t . d) / SUM w (t . d)^2,  w = -slope max(0, u_a . u_b)
//! u the unit normals, t the tangent towards the wall: the least-squares slope of the normals in
//! that direction. [`crate::effect::tension::level`] divides by all of |d|^2, as good where
//! neighbours lie all around; at 0.4 H above a wall it would have 0.83 of the slope (integrals of
//! w over the rest of the plane).

use crate::effect::normal::Root;
use crate::kernel::Kernel;
use crate::space::lane::{Real, dot};
use crate::space::sweep::{self, Field, Pair, Pass};
use std::marker::PhantomData;

/// (1) with its scratch memory.
#[derive(Default)]
pub struct Rises {
    /// t by particle, of those at contact lines only.
    tangent: Vec<[f32; 3]>,
    /// H d cos / dz of each of them.
    pub of: Vec<f32>,
}

impl Rises {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        12 * self.tangent.capacity() + 4 * self.of.capacity()
    }

    /// (1) of the particles `lines` with `field` over those with a stress; `count`: of all;
    /// `place`: u and SUM slope d over the wall of each of `lines`.
    pub fn measure<K: Kernel>(
        &mut self,
        field: Field<3, 3>,
        lines: &[u32],
        count: usize,
        place: impl Fn(usize) -> [[f32; 3]; 2],
    ) {
        self.tangent.resize(count, [0.0; 3]);
        for (line, &i) in lines.iter().enumerate() {
            let [u, wall] = place(line);
            self.tangent[i as usize] = tangent(u, wall);
        }
        self.of.resize(lines.len(), 0.0);
        let pass = Bent::<K> {
            tangent: &self.tangent,
            kernel: PhantomData,
        };
        sweep::runs(field, lines, &pass, &mut self.of);
    }
}

/// Unit vector across `normal` towards `wall`; zero where they are parallel.
fn tangent(normal: [f32; 3], wall: [f32; 3]) -> [f32; 3] {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let part = dot(normal, wall) / dot(normal, normal);
    let t = [0, 1, 2].map(|a| wall[a] - part * normal[a]);
    let size = dot(t, t).sqrt().max(f32::MIN_POSITIVE);
    t.map(|t| t / size)
}

/// Sums of (1).
struct Bent<'a, K> {
    tangent: &'a [[f32; 3]],
    kernel: PhantomData<K>,
}

impl<K: Kernel> Pass<2> for Bent<'_, K> {
    type Payload = Root;
    type Out = f32;
    #[inline(always)]
    fn own(&self, _: usize, own: Root) -> Root {
        own.unit()
    }
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.tangent[target]
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Root>, sum: &mut [F; 2]) {
        let (normal, tangent, other) = (pair.own.u, pair.extra, pair.other.u);
        let size = dot(other, other)
            .sqrt()
            .max(pair.q2.splat(f32::MIN_POSITIVE));
        let zero = pair.q2.splat(0.0);
        // Normals that point apart belong to another surface.
        let alike = (dot(normal, other) / size).max(zero);
        let slope = K::slope_lanes(pair.q2.sqrt());
        let far = dot(tangent, pair.d);
        let weight = (zero - slope * alike) * far;
        sum[0] = weight.mul_add(dot(tangent, other) / size, sum[0]);
        sum[1] = weight.mul_add(far, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, [turned, far]: [f32; 2], out: &mut f32) {
        *out = turned / far.max(f32::MIN_POSITIVE);
    }
}
