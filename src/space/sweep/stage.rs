//! Pairs of one target between where they are read and where they are summed.
//!
//! From the first index to the last sum eight pairs are one long chain of operations, mostly of
//! waiting: a root, a division or two. A processor looks ahead over some hundred operations, which
//! are only two such groups. So the work goes in three loops over a part of a row, each of short
//! chains: read and subtract; roots and kernels; sum. Bits are those of one loop.

use super::{Fields, Own, Pair, Pass, Payload, WORDS};
use crate::space::eights::{Group, Groups};
use crate::space::lane::{Lanes, Real, Record, dot, prefetch};
use crate::space::row::separation;

/// Groups of eight pairs that are staged at once: they stay in the nearest cache.
pub const STAGED: usize = 32;

/// How far ahead the groups of rows are fetched, which are read once and come from far, bytes.
const AHEAD: usize = 1280;

/// What is known of eight pairs before they are summed: fields as in [`Pair`]. They lie together,
/// so that they are written line by line.
#[derive(Clone, Copy)]
struct Staged<F: Copy, P: Payload> {
    d: [F; 3],
    q2: F,
    other: P::Of<F>,
}

impl<F: Real, P: Payload> Staged<F, P> {
    /// With their weights and what the target has.
    #[inline(always)]
    fn pair(&self, weight: [F; 2], (own, extra): Own<F, P>) -> Pair<F, P> {
        Pair {
            d: self.d,
            q2: self.q2,
            weight,
            own,
            other: self.other,
            extra,
        }
    }
}

/// Up to [`STAGED`] times eight pairs of one target.
pub struct Stage<F: Copy, P: Payload> {
    staged: [Staged<F, P>; STAGED],
    weight: [[F; 2]; STAGED],
}

impl<F: Real, P: Payload> Stage<F, P> {
    /// Room for them, in lanes of a kind.
    #[inline(always)]
    pub fn new<L: Lanes<F = F>>(lanes: L) -> Self {
        let zero = lanes.splat(0.0);
        let empty = Staged {
            d: [zero; 3],
            q2: zero,
            other: P::Of::from_words([zero; WORDS]),
        };
        Stage {
            staged: [empty; STAGED],
            weight: [[zero; 2]; STAGED],
        }
    }

    /// Puts eight pairs at place `k`.
    #[inline(always)]
    pub fn put(&mut self, k: usize, d: [F; 3], q2: F, words: [F; WORDS]) {
        let other = P::Of::from_words(words);
        self.staged[k] = Staged { d, q2, other };
    }

    /// |d|^2 of place `k`.
    #[inline(always)]
    pub fn q2(&mut self, k: usize) -> &mut F {
        &mut self.staged[k].q2
    }

    /// The pairs of a target and the records of `part`, at most [`STAGED`] groups; how many groups.
    ///
    /// # Safety
    /// All indices of `part` are below `records.len()`.
    #[inline(always)]
    pub unsafe fn gather<L: Lanes<F = F>>(
        &mut self,
        lanes: L,
        records: &[Record],
        part: Groups,
        at: [i32; 3],
        scale: [F; 3],
    ) -> usize {
        let (count, first) = (part.len(), records.as_ptr());
        for (staged, group) in self.staged[..count].iter_mut().zip(part.packed) {
            prefetch(std::ptr::from_ref(group).wrapping_byte_add(AHEAD));
            // SAFETY: there are eight indices, all of records, and a base is one of them.
            let (other, words) = unsafe {
                match part.open(group) {
                    Group::Near(base, beyond) => {
                        lanes.gather(first.add(base as usize), beyond.as_ptr())
                    }
                    Group::Wide(indices) => lanes.gather(first, indices.as_ptr()),
                }
            };
            let [a, b, c, d, e] = words;
            let other_words = P::Of::from_words([a, b, c, d, e, lanes.splat(0.0)]);
            let away = separation(lanes, at, other, scale);
            *staged = Staged {
                d: away,
                q2: dot(away, away),
                other: other_words,
            };
        }
        count
    }

    /// Sets [`Pass::weigh`] of place `k`.
    #[inline(always)]
    pub fn weight(&mut self, k: usize, weight: [F; 2]) {
        self.weight[k] = weight;
    }

    /// Those of place `k`, with what the target has.
    #[inline(always)]
    pub fn pair(&self, k: usize, (own, extra): Own<F, P>) -> Pair<F, P> {
        self.staged[k].pair(self.weight[k], (own, extra))
    }

    /// Adds the first `count` to the sums of their target.
    #[inline(always)]
    pub fn add<const N: usize, Q: Pass<N, Payload = P>>(
        &mut self,
        count: usize,
        pass: &Q,
        own: Own<F, P>,
        sum: &mut [F; N],
    ) {
        let (staged, weight) = (&self.staged[..count], &mut self.weight[..count]);
        for (staged, weight) in staged.iter().zip(&mut *weight) {
            *weight = pass.weigh(staged.q2);
        }
        let mut found = *sum;
        for (staged, weight) in staged.iter().zip(&*weight) {
            pass.pair(&staged.pair(*weight, own), &mut found);
        }
        *sum = found;
    }
}
