//! Pair sums: one pass over the neighbours of many targets, eight at a time, gather only.
//!
//! A [`Pass`] says what a pair adds; the sweep says which pairs there are. A target's sum is taken
//! by one thread in the order of its row, so the result does not depend on the number of threads.

mod block;
mod candidates;
mod kept;
mod near;
mod payload;
mod shared;
mod stage;

use super::grid::Scale;
use super::lane::{self, Job, Lanes, Real, Record};
use super::parallel::{Parts, each_part};
use super::row::{CHUNK, Rows};
use payload::IN_RECORD;

pub use super::row::Source;
pub use kept::Kept;
pub use near::{Field, runs};
pub use payload::{Fields, Payload, PayloadField, Records, WORDS, words_of};
pub use shared::runs_shared;
pub(super) use stage::{STAGED, Stage};

/// Rows name records that are not there.
pub(super) const TOO_FEW: &str = "rows of more points than there are records";

/// A squared distance beyond every support, in units of h^2.
const FAR: f32 = 1e12;

/// Lanes of one pair: separation and the payloads of both points.
pub struct Pair<F: Copy, P: Payload> {
    /// Own minus other, in units of the smoothing length.
    pub d: [F; 3],
    /// |d|^2; lanes that hold no pair are at 0 (padding of rows) or beyond the support.
    pub q2: F,
    /// [`Pass::weigh`] of `q2`.
    pub weight: [F; 2],
    /// [`Pass::own`] of the target, splatted.
    pub own: P::Of<F>,
    /// Payload of the neighbours.
    pub other: P::Of<F>,
    /// [`Pass::extra`] of the target, splatted.
    pub extra: [F; 3],
}

/// `own` and `extra` of a [`Pair`].
pub(super) type Own<F, P> = (<P as Payload>::Of<F>, [F; 3]);

/// What one pair adds to `N` sums, and what becomes of the sums.
pub trait Pass<const N: usize>: Sync {
    /// What the points carry.
    type Payload: Payload;
    /// What a target gets.
    type Out: Send;
    /// Whether two points whose payloads are all zeros add nothing to each other. Where most are,
    /// [`runs`] need not look at them.
    const SKIPS_ZEROS: bool = false;
    /// Whether nothing adds to this target, so that its row need not be read.
    #[inline(always)]
    fn skips(&self, _target: usize) -> bool {
        false
    }
    /// The payload of a target as its own pairs see it. `target`: record index.
    #[inline(always)]
    fn own(&self, _target: usize, payload: Self::Payload) -> Self::Payload {
        payload
    }
    /// What the pass itself knows of a target.
    #[inline(always)]
    fn extra(&self, _target: usize) -> [f32; 3] {
        [0.0; 3]
    }
    /// What the sums need of the distance alone, |d|^2 given: the distance, or values of a kernel.
    /// These are long chains of operations (a root, then mostly a division), and a processor waits
    /// for them where each eight pairs are finished at once: they are found for many pairs first.
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let q = q2.sqrt();
        [q, q]
    }
    /// Adds eight pairs. A padding pair (d = 0, own = other) must add nothing.
    fn pair<F: Real>(&self, pair: &Pair<F, Self::Payload>, sum: &mut [F; N]);
    /// Makes `out` of the sums of `target`, a record index.
    fn finish(&self, target: usize, sum: [f32; N], out: &mut Self::Out);
}

/// Sums over neighbour rows; `out[k]` belongs to target `rows.first + k`.
/// `scale`: fixed-point units to multiples of the smoothing length.
///
/// # Panics
/// If `rows` was built for more points than there are records, or if they carry what the pass does
/// not read.
pub fn rows<const N: usize, P: Pass<N>>(
    records: &Records,
    rows: &Rows,
    scale: Scale,
    pass: &P,
    out: &mut [P::Out],
) {
    assert_eq!(out.len(), rows.len());
    assert!(rows.bound() <= records.len(), "{TOO_FEW}");
    records.check::<P::Payload>();
    each_part(Parts::of(out, CHUNK), |c, out| {
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
        let mut stage = Stage::<L::F, P::Payload>::new(lanes);
        for (k, out) in self.out.iter_mut().enumerate() {
            let target = rows.first + from + k;
            if pass.skips(target) {
                pass.finish(target, [0.0; N], out);
                continue;
            }
            let record = &records[target];
            let at = [record.at(0), record.at(1), record.at(2)];
            let own = pass.own(target, carried(record));
            let own = splat(lanes, own, pass.extra(target));
            let mut sum = [lanes.splat(0.0); N];
            for part in rows.row(from + k).chunks(STAGED) {
                // SAFETY: indices are below the bound of the rows, and there are so many records.
                let count = unsafe { stage.gather(lanes, records, part, at, scale) };
                stage.add(count, pass, own, &mut sum);
            }
            pass.finish(target, total(&sum), out);
        }
    }
}

/// The payload of a record.
#[inline(always)]
pub(super) fn carried<P: Payload>(record: &Record) -> P {
    let mut words = [0.0; WORDS];
    for (c, word) in words[..IN_RECORD].iter_mut().enumerate() {
        *word = record.payload(c);
    }
    P::from_words(words)
}

/// What a target has of its own, in all lanes.
#[inline(always)]
pub(super) fn splat<L: Lanes, P: Payload>(lanes: L, own: P, extra: [f32; 3]) -> Own<L::F, P> {
    let ([a, b, c, d, e, f], zero) = (own.to_words(), lanes.splat(0.0));
    let ([a, b, c], [d, e, f]) = (zero.splat3([a, b, c]), zero.splat3([d, e, f]));
    (P::Of::from_words([a, b, c, d, e, f]), zero.splat3(extra))
}

#[inline(always)]
fn total<F: Real, const N: usize>(sum: &[F; N]) -> [f32; N] {
    let mut total = [0.0; N];
    for (total, sum) in total.iter_mut().zip(sum) {
        *total = sum.sum();
    }
    total
}
