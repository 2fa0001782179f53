//! Pair sums: one pass over the neighbours of many targets, eight at a time, gather only.
//!
//! A [`Pass`] says what a pair adds; the sweep says which pairs there are. A target's sum is taken
//! by one thread in the order of its row, so the result does not depend on the number of threads.

mod block;
mod kept;
mod near;

use super::grid::Scale;
use super::lane::{self, Job, Lanes, Real, Record, WIDTH, dot};
use super::row::{CHUNK, Rows, separation};

pub use super::row::Source;
pub use kept::Kept;
pub use near::{Field, runs};
use rayon::prelude::*;

/// Rows name records that are not there.
pub(super) const TOO_FEW: &str = "rows of more points than there are records";

/// A squared distance beyond every support, in units of h^2.
const FAR: f32 = 1e12;

/// Lanes of one pair: separation and the two records' payloads.
pub struct Pair<F> {
    /// Own minus other, in units of the smoothing length.
    pub d: [F; 3],
    /// |d|^2; lanes that hold no pair are at 0 (padding of rows) or beyond the support.
    pub q2: F,
    /// [`Pass::own`] of the target, splatted.
    pub own: [F; 6],
    /// Payload of the neighbours; what they do not have is zero.
    pub other: [F; 6],
}

/// The pairs of a target and the eight records of `group`.
///
/// # Safety
/// `group` has eight indices, all below `records.len()`.
#[inline(always)]
pub(super) unsafe fn gathered<L: Lanes>(
    lanes: L,
    records: &[Record],
    group: &[u32],
    at: [i32; 3],
    own: [L::F; 6],
    scale: [L::F; 3],
) -> Pair<L::F> {
    // SAFETY: there are eight indices, all of records.
    let (other, [a, b, c, d, e]) = unsafe { lanes.gather(records.as_ptr(), group.as_ptr()) };
    let separation = separation(lanes, at, other, scale);
    Pair {
        d: separation,
        q2: dot(separation, separation),
        own,
        other: [a, b, c, d, e, lanes.splat(0.0)],
    }
}

/// What one pair adds to `N` sums, and what becomes of the sums.
pub trait Pass<const N: usize>: Sync {
    /// What a target gets.
    type Out: Send;
    /// Whether nothing adds to this target, so that its row need not be read.
    #[inline(always)]
    fn skips(&self, _target: usize) -> bool {
        false
    }
    /// The payload of a target as its own pairs see it. `target`: record index.
    #[inline(always)]
    fn own(&self, _target: usize, payload: [f32; 6]) -> [f32; 6] {
        payload
    }
    /// Adds eight pairs. A padding pair (d = 0, own = other) must add nothing.
    fn pair<F: Real>(&self, pair: &Pair<F>, sum: &mut [F; N]);
    /// Makes `out` of the sums of `target`, a record index.
    fn finish(&self, target: usize, sum: [f32; N], out: &mut Self::Out);
}

/// Sums over neighbour rows; `out[k]` belongs to target `rows.first + k`.
/// `scale`: fixed-point units to multiples of the smoothing length.
///
/// # Panics
/// If `rows` was built for more points than there are records.
pub fn rows<const N: usize, P: Pass<N>>(
    records: &[Record],
    rows: &Rows,
    scale: Scale,
    pass: &P,
    out: &mut [P::Out],
) {
    assert_eq!(out.len(), rows.len());
    assert!(rows.bound() <= records.len(), "{TOO_FEW}");
    out.par_chunks_mut(CHUNK).enumerate().for_each(|(c, out)| {
        let from = c * CHUNK;
        let job = InRows {
            records,
            rows,
            scale,
            pass,
            from,
            out,
        };
        lane::run(scale.precision, job);
    });
}

/// Some targets of [`rows`].
struct InRows<'a, const N: usize, P: Pass<N>> {
    records: &'a [Record],
    rows: &'a Rows,
    scale: Scale,
    pass: &'a P,
    from: usize,
    out: &'a mut [P::Out],
}

impl<const N: usize, P: Pass<N>> Job for InRows<'_, N, P> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (records, rows, pass, from) = (self.records, self.rows, self.pass, self.from);
        let scale = self.scale.lanes(lanes);
        for (k, out) in self.out.iter_mut().enumerate() {
            let target = rows.first + from + k;
            if pass.skips(target) {
                pass.finish(target, [0.0; N], out);
                continue;
            }
            let record = &records[target];
            let at = [record.at(0), record.at(1), record.at(2)];
            let own = [0, 1, 2, 3, 4, 5].map(|c| if c < 5 { record.payload(c) } else { 0.0 });
            let own = splat(lanes, pass.own(target, own));
            let mut sum = [lanes.splat(0.0); N];
            for group in rows.row(from + k).chunks_exact(WIDTH) {
                // SAFETY: indices are below the bound of the rows, and there are so many records.
                let pair = unsafe { gathered(lanes, records, group, at, own, scale) };
                pass.pair(&pair, &mut sum);
            }
            pass.finish(target, total(&sum), out);
        }
    }
}

#[inline(always)]
fn splat<L: Lanes>(lanes: L, own: [f32; 6]) -> [L::F; 6] {
    [
        lanes.splat(own[0]),
        lanes.splat(own[1]),
        lanes.splat(own[2]),
        lanes.splat(own[3]),
        lanes.splat(own[4]),
        lanes.splat(own[5]),
    ]
}

#[inline(always)]
fn total<F: Real, const N: usize>(sum: &[F; N]) -> [f32; N] {
    let mut total = [0.0; N];
    for (total, sum) in total.iter_mut().zip(sum) {
        *total = sum.sum();
    }
    total
}
