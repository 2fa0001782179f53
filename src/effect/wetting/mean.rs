//! Weighted sums over the particles at contact lines.

use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::Real;
use crate::space::sweep::{self, Pair, Pass};
use std::marker::PhantomData;

/// Two words of every point, of most of them zero, and their sums with a kernel.
#[derive(Clone, Debug, Default)]
pub struct Means {
    words: [Vec<f32>; 2],
    sums: Vec<[f32; 2]>,
}

impl Means {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        8 * (self.words[0].capacity() + self.sums.capacity())
    }

    pub fn clear(&mut self, flow: &Surface) {
        for words in &mut self.words {
            words.clear();
            words.resize(flow.at[0].len(), 0.0);
        }
    }

    /// Of liquid particle `i`.
    pub fn set(&mut self, i: usize, words: [f32; 2]) {
        (0..2).for_each(|k| self.words[k][i] = words[k]);
    }

    /// SUM w of both words over the liquid about the points `targets` of `position`, m; `length`:
    /// smoothing length, m.
    pub fn sum<K: Kernel>(
        &mut self,
        flow: &Surface,
        (position, targets): (&[Vec<f64>; 3], &[u32]),
        length: f64,
    ) -> &[[f32; 2]] {
        self.words.iter_mut().for_each(|words| flow.share(words));
        self.sums.resize(targets.len(), [0.0; 2]);
        let field = flow.about(position, flow.of_liquid(), &self.words, length);
        let (span, pass) = (flow.list(targets.len()), Both::<K>(PhantomData));
        sweep::runs_shared(field, &span, targets, &pass, &mut self.sums);
        &self.sums
    }
}

payload! {
    struct Words<F> { first: F, second: F }
}

struct Both<K>(PhantomData<K>);

impl<K: Kernel> Pass<2> for Both<K> {
    type Payload = Words;
    type Out = [f32; 2];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Words>, sum: &mut [F; 2]) {
        let w = K::w_lanes(pair.q2.sqrt());
        sum[0] = w.mul_add(pair.other.first, sum[0]);
        sum[1] = w.mul_add(pair.other.second, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 2], out: &mut [f32; 2]) {
        *out = sum;
    }
}
