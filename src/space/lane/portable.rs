//! The scalar twins: same operations, one lane after the other. They serve tests, and processors
//! without AVX2 or NEON: what would be long is not inlined, for it would be a third of the program.

use super::{COMPRESS, Half, Lanes, Real, Record, WIDTH, operators};
use num_traits::{AsPrimitive, Float};
use std::marker::PhantomData;

/// Lanes of `T`; `ABSOLUTE`: coordinates are rounded before they are subtracted. They need no
/// feature of the processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scalar<T, const ABSOLUTE: bool>(PhantomData<T>);

impl<T, const ABSOLUTE: bool> Scalar<T, ABSOLUTE> {
    /// Anywhere.
    #[inline(always)]
    pub const fn new() -> Self {
        Scalar(PhantomData)
    }
}

/// The twin of the default lanes.
pub type Portable = Scalar<f32, false>;

/// Eight numbers of the scalar twins.
#[derive(Clone, Copy, Debug)]
pub struct Eight<T>([T; WIDTH]);

#[inline(always)]
fn each<T>(f: impl Fn(usize) -> T) -> [T; WIDTH] {
    std::array::from_fn(f)
}

/// a b + c, rounded once: mostly a call for every lane.
#[inline(never)]
fn fused<T: Number>(a: [T; WIDTH], b: [T; WIDTH], c: [T; WIDTH]) -> [T; WIDTH] {
    each(|k| a[k].mul_add(b[k], c[k]))
}

/// What the numbers of a lane can do.
pub trait Number: Float + AsPrimitive<f32> + Send + Sync {
    /// The same number.
    fn of(x: f32) -> Self;
}

impl Number for f32 {
    #[inline(always)]
    fn of(x: f32) -> f32 {
        x
    }
}

impl Number for f64 {
    #[inline(always)]
    fn of(x: f32) -> f64 {
        x as f64
    }
}

#[inline(always)]
fn sum<T: Number>(a: Eight<T>, b: Eight<T>) -> Eight<T> {
    Eight(each(|k| a.0[k] + b.0[k]))
}

#[inline(always)]
fn difference<T: Number>(a: Eight<T>, b: Eight<T>) -> Eight<T> {
    Eight(each(|k| a.0[k] - b.0[k]))
}

#[inline(always)]
fn product<T: Number>(a: Eight<T>, b: Eight<T>) -> Eight<T> {
    Eight(each(|k| a.0[k] * b.0[k]))
}

#[inline(always)]
fn quotient<T: Number>(a: Eight<T>, b: Eight<T>) -> Eight<T> {
    Eight(each(|k| a.0[k] / b.0[k]))
}

operators!([T: Number] Eight<T>: sum, difference, product, quotient);

impl<T: Number> Real for Eight<T> {
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        Eight([T::of(x); WIDTH])
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Eight(fused(self.0, b.0, c.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Eight(each(|k| self.0[k].sqrt()))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Eight(each(|k| self.0[k].abs()))
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        Eight(each(|k| {
            if self.0[k] > b.0[k] {
                self.0[k]
            } else {
                b.0[k]
            }
        }))
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        Eight(each(|k| {
            if self.0[k] < b.0[k] {
                self.0[k]
            } else {
                b.0[k]
            }
        }))
    }
    #[inline(always)]
    fn if_less(self, a: Self, b: Self) -> Self {
        Eight(each(|k| {
            if a.0[k] < b.0[k] {
                self.0[k]
            } else {
                T::zero()
            }
        }))
    }
    #[inline(never)]
    fn less_mask(self, b: Self) -> u32 {
        (0..WIDTH).fold(0, |m, k| m | (((self.0[k] < b.0[k]) as u32) << k))
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        let a = self.0;
        let q = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
        ((q[0] + q[2]) + (q[1] + q[3])).as_()
    }
    #[inline(always)]
    fn to_array(self) -> [f32; WIDTH] {
        each(|k| self.0[k].as_())
    }
    #[inline(always)]
    fn of_array(self, lanes: [f32; WIDTH]) -> Self {
        Eight(each(|k| T::of(lanes[k])))
    }
}

impl<T, const ABSOLUTE: bool> Lanes for Scalar<T, ABSOLUTE>
where
    T: Number,
    f32: AsPrimitive<T>,
    f64: AsPrimitive<T>,
    i32: AsPrimitive<T>,
    u32: AsPrimitive<T>,
{
    type F = Eight<T>;
    type I = [i32; WIDTH];
    #[inline(always)]
    fn splat(self, x: f32) -> Eight<T> {
        Eight([x.as_(); WIDTH])
    }
    #[inline(always)]
    fn constant(self, x: f64) -> Eight<T> {
        Eight([x.as_(); WIDTH])
    }
    #[inline(never)]
    fn difference(self, own: i32, other: [i32; WIDTH]) -> Eight<T> {
        if !ABSOLUTE {
            return Eight(each(|k| own.wrapping_sub(other[k]).as_()));
        }
        // From the low corner on, as a coordinate would be.
        let (turn, half): (T, T) = (4294967296.0.as_(), 2147483648.0.as_());
        Eight(each(|k| {
            let d = (own as u32).as_() - (other[k] as u32).as_();
            let d = if half < d { d - turn } else { d };
            if d < -half { d + turn } else { d }
        }))
    }
    #[inline(never)]
    fn first(self, count: usize, value: Eight<T>, other: Eight<T>) -> Eight<T> {
        Eight(each(|k| if k < count { value.0[k] } else { other.0[k] }))
    }
    #[inline(never)]
    unsafe fn gather<J: AsPrimitive<usize>>(
        self,
        records: *const Record,
        index: *const J,
    ) -> ([[i32; WIDTH]; 3], [Eight<T>; 5]) {
        // SAFETY: there are eight indices, all of records.
        let records: [&Record; WIDTH] = each(|k| unsafe { &*records.add((*index.add(k)).as_()) });
        let at = std::array::from_fn(|a| each(|k| records[k].at(a)));
        let payload = std::array::from_fn(|c| Eight(each(|k| records[k].payload(c).as_())));
        (at, payload)
    }
    #[inline(never)]
    unsafe fn gather_halves(
        self,
        points: *const Half,
        index: *const u16,
    ) -> ([[i32; WIDTH]; 3], Eight<T>) {
        // SAFETY: there are eight indices, all of points.
        let points: [Half; WIDTH] = each(|k| unsafe { *points.add(*index.add(k) as usize) });
        let at = std::array::from_fn(|a| each(|k| points[k].0[a] as i32));
        (at, Eight(each(|k| f32::from_bits(points[k].0[3]).as_())))
    }
    #[inline(always)]
    unsafe fn load(self, words: *const f32) -> Eight<T> {
        // SAFETY: there are eight words.
        let words = unsafe { std::ptr::read_unaligned(words as *const [f32; WIDTH]) };
        Eight(each(|k| words[k].as_()))
    }
    #[inline(always)]
    unsafe fn load_fixed(self, words: *const i32) -> [i32; WIDTH] {
        // SAFETY: there are eight words.
        unsafe { std::ptr::read_unaligned(words as *const [i32; WIDTH]) }
    }
    #[inline(never)]
    unsafe fn compress(self, mask: u32, words: *const u32, out: *mut u32) -> usize {
        let count = mask.count_ones() as usize;
        for k in 0..count {
            // SAFETY: entries of the table are below eight, and so is k for a mask of 8 bits.
            unsafe { *out.add(k) = *words.add(COMPRESS[mask as usize][k] as usize) };
        }
        count
    }
}
