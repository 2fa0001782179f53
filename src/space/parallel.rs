//! Parallel loops over particles with fixed chunks, so that results never depend on thread count.
//!
//! What a loop does to a chunk is passed as a reference to a function, so that the machinery of
//! the threads is compiled once, and not once for each loop: it was a quarter of the program.

use super::larger::larger;
use super::ranks::span::Span;
use rayon::prelude::*;
use std::ops::Range;

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

/// Calls `f(c)` for every chunk `c < n`, on all threads.
pub fn chunks(n: usize, f: &(dyn Fn(usize) + Sync)) {
    match n {
        0 => {}
        1 => f(0),
        _ => (0..n).into_par_iter().for_each(f),
    }
}

/// The items of chunk `c` of `n`: `size` each, of which the last chunk has the rest.
#[inline(always)]
pub fn chunk(c: usize, size: usize, n: usize) -> Range<usize> {
    chunk_after(0, c, size, n)
}

/// The same where the first chunk lacks as many as `before`.
#[inline(always)]
pub fn chunk_after(before: usize, c: usize, size: usize, n: usize) -> Range<usize> {
    (c * size).saturating_sub(before)..((c + 1) * size - before).min(n)
}

/// Calls `f(i)` for every `i < n`.
pub fn each(n: usize, f: impl Fn(usize) + Sync) {
    chunks(n.div_ceil(CHUNK), &|c| chunk(c, CHUNK, n).for_each(&f));
}

/// A slice, or several slices of one length of which an item each is used at a time.
///
/// # Safety
/// Items of different numbers share no memory.
pub unsafe trait Items {
    /// An item, or one of each.
    type Item;
    /// Where they are, for all threads.
    type Slots: Sync;
    /// Gives them up, and how many there are.
    fn slots(self) -> (Self::Slots, usize);
    /// Item `i`.
    ///
    /// # Safety
    /// There are more than `i`, and nobody else uses the same item at a time.
    unsafe fn at(slots: &Self::Slots, i: usize) -> Self::Item;
}

// SAFETY: items of a slice are apart.
unsafe impl<'a, T: Send> Items for &'a mut [T] {
    type Item = &'a mut T;
    type Slots = Slots<'a, T>;
    fn slots(self) -> (Slots<'a, T>, usize) {
        let count = self.len();
        (Slots::new(self), count)
    }
    #[inline(always)]
    unsafe fn at(slots: &Slots<'a, T>, i: usize) -> &'a mut T {
        // SAFETY: as the caller says.
        unsafe { &mut *slots.start.add(i) }
    }
}

/// A slice in parts of a length, of which the last has the rest.
pub struct Parts<'a, T> {
    items: &'a mut [T],
    size: usize,
    before: usize,
}

impl<'a, T> Parts<'a, T> {
    /// Of `size` items each.
    pub fn of(items: &'a mut [T], size: usize) -> Self {
        Parts::after(0, items, size)
    }

    /// The same where the first part lacks as many as `before`.
    pub fn after(before: usize, items: &'a mut [T], size: usize) -> Self {
        assert!(before < size);
        Parts {
            items,
            size,
            before,
        }
    }
}

// SAFETY: parts of a slice are apart.
unsafe impl<'a, T: Send> Items for Parts<'a, T> {
    type Item = &'a mut [T];
    type Slots = (Slots<'a, T>, [usize; 2]);
    fn slots(self) -> (Self::Slots, usize) {
        let count = (self.items.len() + self.before).div_ceil(self.size);
        let slots = Slots::new(self.items);
        ((slots, [self.size, self.before]), count)
    }
    #[inline(always)]
    unsafe fn at((slots, [size, before]): &Self::Slots, i: usize) -> &'a mut [T] {
        let range = chunk_after(*before, i, *size, slots.len);
        // SAFETY: the range is within the slice, and nobody else uses it.
        unsafe { std::slice::from_raw_parts_mut(slots.start.add(range.start), range.len()) }
    }
}

// SAFETY: those of one vector are apart from each other, and so are vectors.
unsafe impl<A: Items, const K: usize> Items for [A; K] {
    type Item = [A::Item; K];
    type Slots = [A::Slots; K];
    fn slots(self) -> (Self::Slots, usize) {
        let mut count = usize::MAX;
        let slots = self.map(|items| {
            let (slots, many) = items.slots();
            count = count.min(many);
            slots
        });
        (slots, count)
    }
    #[inline(always)]
    unsafe fn at(slots: &Self::Slots, i: usize) -> Self::Item {
        // SAFETY: as the caller says, and of each.
        std::array::from_fn(|k| unsafe { A::at(&slots[k], i) })
    }
}

/// [`Items`] of several.
macro_rules! together {
    ($($of:ident)*) => {
        // SAFETY: those of each are apart from each other, and so are they all.
        unsafe impl<$($of: Items),*> Items for ($($of,)*) {
            type Item = ($($of::Item,)*);
            type Slots = ($($of::Slots,)*);
            #[expect(non_snake_case, reason = "a value is named after its type")]
            fn slots(self) -> (Self::Slots, usize) {
                let ($($of,)*) = self;
                let mut count = usize::MAX;
                $(let ($of, many) = $of.slots(); count = count.min(many);)*
                (($($of,)*), count)
            }
            #[inline(always)]
            #[expect(non_snake_case, reason = "a value is named after its type")]
            unsafe fn at(($($of,)*): &Self::Slots, i: usize) -> Self::Item {
                // SAFETY: as the caller says, and of each.
                unsafe { ($($of::at($of, i),)*) }
            }
        }
    };
}
together!(A B);
together!(A B C);
together!(A B C D E F);

/// Calls `f` with every item and its number.
pub fn each_mut<I: Items>(items: I, f: impl Fn(usize, I::Item) + Sync) {
    in_chunks(items, CHUNK, f);
}

/// The same where an item is the work of a chunk.
pub fn each_part<I: Items>(items: I, f: impl Fn(usize, I::Item) + Sync) {
    in_chunks(items, 1, f);
}

#[inline(always)]
fn in_chunks<I: Items>(items: I, size: usize, f: impl Fn(usize, I::Item) + Sync) {
    let (slots, n) = items.slots();
    chunks(n.div_ceil(size), &|c| {
        for i in chunk(c, size, n) {
            // SAFETY: there is such an item, and it is of one chunk.
            f(i, unsafe { I::at(&slots, i) });
        }
    });
}

/// The first `n` items of three components, together.
pub fn three<T>(components: &mut [Vec<T>; 3], n: usize) -> [&mut [T]; 3] {
    components.each_mut().map(|component| &mut component[..n])
}

/// [`sum_in`] of what `f` makes of every item, as in [`each_mut`].
pub fn sum_mut<const K: usize, I: Items>(
    parts: &mut Vec<[f64; K]>,
    span: impl Into<Span>,
    items: I,
    f: impl Fn(usize, I::Item) -> [f64; K] + Sync,
) -> [f64; K] {
    let (slots, n) = items.slots();
    let span = span.into();
    debug_assert_eq!(span.len(), n);
    // SAFETY: there is such an item, and each is asked for once.
    sum_all(parts, span, n, |i| f(i, unsafe { I::at(&slots, i) }))
}

#[inline(always)]
fn plus<const K: usize>(mut a: [f64; K], b: [f64; K]) -> [f64; K] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

/// Largest `f(i)`; negative infinity for none. NaN wins.
pub fn max(span: impl Into<Span>, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    let span = span.into();
    let (begin, n) = (span.own.start, span.len());
    let largest = |c| {
        let chunk = chunk(c, CHUNK, n);
        chunk.fold(f64::NEG_INFINITY, |m, i| larger(f(begin + i), m))
    };
    span.max(largest_of(n.div_ceil(CHUNK), &largest))
}

/// Largest `f(c)` of the chunks `c < n`, as [`max`].
pub fn largest_of(n: usize, f: &(dyn Fn(usize) -> f64 + Sync)) -> f64 {
    let each = (0..n).into_par_iter().map(f);
    each.reduce(|| f64::NEG_INFINITY, larger)
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
    let (begin, n) = (span.own.start, span.len());
    sum_all(parts, span, n, |i| f(begin + i))
}

/// Sums of what `f` makes of the first `n` numbers, which are those of the span.
#[inline(always)]
fn sum_all<const K: usize>(
    parts: &mut Vec<[f64; K]>,
    span: Span,
    n: usize,
    f: impl Fn(usize) -> [f64; K] + Sync,
) -> [f64; K] {
    if span.is_shared() {
        parts.resize(n, [0.0; K]);
        each_mut(&mut parts[..], |i, part| *part = f(i));
        return span.sum(CHUNK, parts);
    }
    parts.resize(n.div_ceil(CHUNK), [0.0; K]);
    each_part(&mut parts[..], |c, part| {
        *part = chunk(c, CHUNK, n).fold([0.0; K], |s, i| plus(s, f(i)));
    });
    parts.iter().fold([0.0; K], |s, p| plus(s, *p))
}
