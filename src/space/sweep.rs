//! Pair sums: one pass over the neighbours of many targets, eight at a time, gather only.
//!
//! A [`Pass`] says what a pair adds; the sweep says which pairs there are. A target's sum is taken
//! by
//! one thread in the order of its row, so the result does not depend on the number of threads.

use super::column::Columns;
use super::grid::Grid;
use super::lane::{Lanes, Portable, Record, WIDTH};
use super::row::{CHUNK, Rows, separation};

pub use super::row::Source;
use rayon::prelude::*;

/// Lanes of one pair: separation and the two records' payloads.
pub struct Pair<L: Lanes> {
    /// Own minus other, in units of the smoothing length.
    pub d: [L::F; 3],
    /// |d|^2; lanes that hold no pair are at 0 (padding of rows) or beyond the support.
    pub q2: L::F,
    /// [`Pass::own`] of the target, splatted.
    pub own: [L::F; 6],
    /// Payload of the neighbours; what they do not have is zero.
    pub other: [L::F; 6],
}

/// What one pair adds to `N` sums, and what becomes of the sums.
pub trait Pass<const N: usize>: Sync {
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
    ///
    /// # Safety
    /// The processor has the features of `L`.
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; N]);
    /// `target`: record index.
    fn finish(&self, target: usize, sum: [f32; N], out: &mut Self::Out);
}

/// Sums over neighbour rows; `out[k]` belongs to target `rows.first + k`.
/// `scale`: fixed-point units to multiples of the smoothing length.
pub fn rows<const N: usize, P: Pass<N>>(
    records: &[Record],
    rows: &Rows,
    scale: [f32; 3],
    pass: &P,
    out: &mut [P::Out],
) {
    assert_eq!(out.len(), rows.len());
    out.par_chunks_mut(CHUNK).enumerate().for_each(|(c, out)| {
        #[cfg(target_arch = "x86_64")]
        if super::lane::wide() {
            return unsafe { rows_avx2(records, rows, scale, pass, c * CHUNK, out) };
        }
        unsafe { rows_lanes::<Portable, N, P>(records, rows, scale, pass, c * CHUNK, out) }
    });
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt")]
unsafe fn rows_avx2<const N: usize, P: Pass<N>>(
    records: &[Record],
    rows: &Rows,
    scale: [f32; 3],
    pass: &P,
    from: usize,
    out: &mut [P::Out],
) {
    unsafe { rows_lanes::<super::lane::Avx2, N, P>(records, rows, scale, pass, from, out) }
}

#[inline(always)]
unsafe fn rows_lanes<L: Lanes, const N: usize, P: Pass<N>>(
    records: &[Record],
    rows: &Rows,
    scale: [f32; 3],
    pass: &P,
    from: usize,
    out: &mut [P::Out],
) {
    unsafe {
        let scale = L::splat3(scale);
        for (k, out) in out.iter_mut().enumerate() {
            let target = rows.first + from + k;
            if pass.skips(target) {
                pass.finish(target, [0.0; N], out);
                continue;
            }
            let record = &records[target];
            let at = [record.at(0), record.at(1), record.at(2)];
            let own = [0, 1, 2, 3, 4, 5].map(|c| if c < 5 { record.payload(c) } else { 0.0 });
            let own = splat::<L>(pass.own(target, own));
            let mut sum = [L::splat(0.0); N];
            for group in rows.row(from + k).chunks_exact(WIDTH) {
                let r = L::gather(records.as_ptr(), group.as_ptr());
                let d = separation::<L>(at, [r[0], r[1], r[2]], scale);
                let pair = Pair {
                    d,
                    q2: L::dot(d, d),
                    own,
                    other: [r[3], r[4], r[5], r[6], r[7], L::splat(0.0)],
                };
                pass.pair::<L>(&pair, &mut sum);
            }
            pass.finish(target, total::<L, N>(&sum), out);
        }
    }
}

#[inline(always)]
unsafe fn splat<L: Lanes>(own: [f32; 6]) -> [L::F; 6] {
    unsafe {
        let [a, b, c] = L::splat3([own[0], own[1], own[2]]);
        [
            a,
            b,
            c,
            L::splat(own[3]),
            L::splat(own[4]),
            L::splat(own[5]),
        ]
    }
}

#[inline(always)]
unsafe fn total<L: Lanes, const N: usize>(sum: &[L::F; N]) -> [f32; N] {
    let mut total = [0.0; N];
    for (total, sum) in total.iter_mut().zip(sum) {
        *total = unsafe { L::sum(*sum) };
    }
    total
}

/// Where the pairs of [`runs`] are.
#[derive(Clone, Copy)]
pub struct Field<'a, const W: usize = 3, const O: usize = 3> {
    pub grid: &'a Grid,
    /// Fixed-point coordinates and payloads of all points, with at least eight spare
    /// at the end.
    pub at: &'a [Vec<i32>; 3],
    pub payload: &'a [Vec<f32>; W],
    pub sources: &'a [Source<'a>],
    /// Positions, m, and payloads of the targets, indexed by target.
    pub position: &'a [Vec<f64>; 3],
    pub own: &'a [Vec<f32>; O],
    /// Search radius: support + what particles have moved since the sort, m.
    pub cutoff: f64,
    pub scale: [f32; 3],
}

impl<'a, const W: usize, const O: usize> Field<'a, W, O> {
    /// The same targets among other points.
    pub fn among<const V: usize>(
        self,
        at: &'a [Vec<i32>; 3],
        payload: &'a [Vec<f32>; V],
        sources: &'a [Source<'a>],
    ) -> Field<'a, V, O> {
        Field {
            grid: self.grid,
            at,
            payload,
            sources,
            position: self.position,
            own: self.own,
            cutoff: self.cutoff,
            scale: self.scale,
        }
    }

    /// The same with other payloads of the targets.
    pub fn owning<const P: usize>(self, own: &'a [Vec<f32>; P]) -> Field<'a, W, P> {
        Field {
            grid: self.grid,
            at: self.at,
            payload: self.payload,
            sources: self.sources,
            position: self.position,
            own,
            cutoff: self.cutoff,
            scale: self.scale,
        }
    }
}

/// Sums over whole cell columns, for few targets or long supports: no list is kept.
/// `out[k]` belongs to `targets[k]`. Lanes beyond the support must add nothing.
pub fn runs<const N: usize, const W: usize, const O: usize, P: Pass<N>>(
    field: Field<W, O>,
    targets: &[u32],
    pass: &P,
    out: &mut [P::Out],
) {
    assert_eq!(out.len(), targets.len());
    out.par_chunks_mut(CHUNK)
        .zip(targets.par_chunks(CHUNK))
        .for_each(|(out, targets)| {
            #[cfg(target_arch = "x86_64")]
            if super::lane::wide() {
                return unsafe { runs_avx2(field, targets, pass, out) };
            }
            unsafe { runs_lanes::<Portable, N, W, O, P>(field, targets, pass, out) }
        });
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt")]
unsafe fn runs_avx2<const N: usize, const W: usize, const O: usize, P: Pass<N>>(
    field: Field<W, O>,
    targets: &[u32],
    pass: &P,
    out: &mut [P::Out],
) {
    unsafe { runs_lanes::<super::lane::Avx2, N, W, O, P>(field, targets, pass, out) }
}

#[inline(always)]
unsafe fn runs_lanes<L: Lanes, const N: usize, const W: usize, const O: usize, P: Pass<N>>(
    field: Field<W, O>,
    targets: &[u32],
    pass: &P,
    out: &mut [P::Out],
) {
    unsafe {
        let scale = L::splat3(field.scale);
        let (far, zero) = (L::splat(FAR), L::splat(0.0));
        let mut columns = Columns::new(field.grid, field.cutoff);
        for (&target, out) in targets.iter().zip(out) {
            let i = target as usize;
            let [x, y, z] = field.position;
            let x = [x[i], y[i], z[i]];
            let at = field.grid.fix3(x);
            let own = std::array::from_fn(|c| field.own.get(c).map_or(0.0, |own| own[i]));
            let own = splat::<L>(pass.own(i, own));
            let mut sum = [zero; N];
            for &column in columns.around(x, field.cutoff) {
                for source in field.sources {
                    let (mut j, end) = source.run(column);
                    while j < end {
                        let d = separation::<L>(at, L::load_at(field.at, j), scale);
                        let words = L::load_at(field.payload, j);
                        let mut pair = Pair {
                            d,
                            q2: L::dot(d, d),
                            own,
                            other: std::array::from_fn(|c| words.get(c).copied().unwrap_or(zero)),
                        };
                        if end - j < WIDTH {
                            pair.q2 = L::first(end - j, pair.q2, far);
                        }
                        pass.pair::<L>(&pair, &mut sum);
                        j += WIDTH;
                    }
                }
            }
            pass.finish(i, total::<L, N>(&sum), out);
        }
    }
}

/// A squared distance beyond every support, in units of h^2.
const FAR: f32 = 1e12;
