//! Parallel loops over particles with fixed chunks, so that results never depend on thread count.

use super::larger::larger;
use super::ranks::span::Span;
use rayon::prelude::*;

/// Particles per chunk.
const CHUNK: usize = 4096;

/// A slice that several threads write at different indices.
pub struct Slots<'a, T> {
    start: *mut T,
    len: usize,
    _life: std::marker::PhantomData<&'a mut [T]>,
}

// SAFETY: it gives access to different items only, each to one thread at a time, as [`Slots::at`]
// asks: it is as if the items themselves were sent.
unsafe impl<T: Send> Sync for Slots<'_, T> {}
// SAFETY: the same; it stands for the slice, which is borrowed by nobody else.
unsafe impl<T: Send> Send for Slots<'_, T> {}

impl<'a, T> Slots<'a, T> {
    /// The items of `slice`, which is borrowed for as long.
    pub fn new(slice: &'a mut [T]) -> Self {
        Slots {
            start: slice.as_mut_ptr(),
            len: slice.len(),
            _life: std::marker::PhantomData,
        }
    }

    /// Item `i`.
    ///
    /// # Safety
    /// `i` is below the length of the slice, and nobody else uses the same item at a time.
    #[expect(clippy::mut_from_ref, reason = "different items, says the contract")]
    #[inline(always)]
    pub unsafe fn at(&self, i: usize) -> &mut T {
        debug_assert!(i < self.len);
        // SAFETY: there is such an item, and nobody else uses it.
        unsafe { &mut *self.start.add(i) }
    }
}

/// Three components as slots.
pub fn slots3<T>(v: &mut [Vec<T>; 3]) -> [Slots<'_, T>; 3] {
    let [x, y, z] = v;
    [Slots::new(x), Slots::new(y), Slots::new(z)]
}

/// Calls `f(i)` for every `i < n`.
pub fn each(n: usize, f: impl Fn(usize) + Sync) {
    (0..n.div_ceil(CHUNK)).into_par_iter().for_each(|c| {
        for i in c * CHUNK..((c + 1) * CHUNK).min(n) {
            f(i);
        }
    });
}

/// Calls `f` with every item and its number: of a slice, or of several slices of one length.
pub fn each_mut<I>(items: I, f: impl Fn(usize, I::Item) + Sync + Send)
where
    I: IntoParallelIterator,
    I::Iter: IndexedParallelIterator,
{
    let items = items.into_par_iter().enumerate().with_min_len(CHUNK);
    items.for_each(|(i, item)| f(i, item));
}

/// The first `n` items of three components, together.
pub fn three<T: Send>(
    [x, y, z]: &mut [Vec<T>; 3],
    n: usize,
) -> impl IndexedParallelIterator<Item = [&mut T; 3]> {
    let items = (&mut x[..n], &mut y[..n], &mut z[..n]).into_par_iter();
    items.map(|(x, y, z)| [x, y, z])
}

/// [`sum_in`] of what `f` makes of every item, as in [`each_mut`].
pub fn sum_mut<const K: usize, I>(
    parts: &mut Vec<[f64; K]>,
    span: impl Into<Span>,
    items: I,
    f: impl Fn(usize, I::Item) -> [f64; K] + Sync + Send,
) -> [f64; K]
where
    I: IntoParallelIterator,
    I::Iter: IndexedParallelIterator,
{
    let items = items.into_par_iter().enumerate();
    let span = span.into();
    debug_assert_eq!(span.len(), items.len());
    if span.is_shared() {
        let each = items.with_min_len(CHUNK).map(|(i, item)| f(i, item));
        each.collect_into_vec(parts);
        return span.sum(CHUNK, parts);
    }
    parts.resize(items.len().div_ceil(CHUNK), [0.0; K]);
    items
        .fold_chunks(CHUNK, || [0.0; K], |sum, (i, item)| plus(sum, f(i, item)))
        .zip(parts.par_iter_mut())
        .for_each(|(sum, part)| *part = sum);
    parts.iter().fold([0.0; K], |s, p| plus(s, *p))
}

#[inline(always)]
fn plus<const K: usize>(mut a: [f64; K], b: [f64; K]) -> [f64; K] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

/// Largest `f(i)`; negative infinity for none. NaN wins.
pub fn max(span: impl Into<Span>, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    let span = span.into();
    let (begin, end) = (span.own.start, span.own.end);
    let own = (0..span.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|c| {
            let chunk = begin + c * CHUNK..(begin + (c + 1) * CHUNK).min(end);
            chunk.fold(f64::NEG_INFINITY, |m, i| larger(f(i), m))
        })
        .reduce(|| f64::NEG_INFINITY, larger);
    span.max(own)
}

/// Sums of `K` values over the items of a span: chunk by chunk, then in chunk order.
pub fn sum<const K: usize>(
    span: impl Into<Span>,
    f: impl Fn(usize) -> [f64; K] + Sync,
) -> [f64; K] {
    sum_in(&mut Vec::new(), span, f)
}

/// [`sum`] with room for the parts that the caller keeps, so that nothing is allocated.
pub fn sum_in<const K: usize>(
    parts: &mut Vec<[f64; K]>,
    span: impl Into<Span>,
    f: impl Fn(usize) -> [f64; K] + Sync,
) -> [f64; K] {
    let span = span.into();
    if span.is_shared() {
        let each = span.own.clone().into_par_iter().with_min_len(CHUNK).map(&f);
        each.collect_into_vec(parts);
        return span.sum(CHUNK, parts);
    }
    let n = span.len();
    parts.resize(n.div_ceil(CHUNK), [0.0; K]);
    parts.par_iter_mut().enumerate().for_each(|(c, part)| {
        *part = (c * CHUNK..((c + 1) * CHUNK).min(n)).fold([0.0; K], |s, i| plus(s, f(i)));
    });
    parts.iter().fold([0.0; K], |s, p| plus(s, *p))
}
