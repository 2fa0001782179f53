//! The scalar twins: same operations, one lane after the other.

use super::{COMPRESS, Half, Lanes, Record, WIDTH};
use num_traits::{AsPrimitive, Float};
use std::marker::PhantomData;

/// Lanes of `T`; `ABSOLUTE`: coordinates are rounded before they are subtracted.
#[derive(Clone, Copy, Debug)]
pub struct Scalar<T, const ABSOLUTE: bool>(PhantomData<T>);

/// The twin of the default lanes.
pub type Portable = Scalar<f32, false>;

#[inline(always)]
fn each<T>(f: impl Fn(usize) -> T) -> [T; WIDTH] {
    std::array::from_fn(f)
}

impl<T, const ABSOLUTE: bool> Lanes for Scalar<T, ABSOLUTE>
where
    T: Float + AsPrimitive<f32> + Send + Sync,
    f32: AsPrimitive<T>,
    f64: AsPrimitive<T>,
    i32: AsPrimitive<T>,
    u32: AsPrimitive<T>,
{
    type F = [T; WIDTH];
    type I = [i32; WIDTH];
    #[inline(always)]
    unsafe fn splat(x: f32) -> [T; WIDTH] {
        [x.as_(); WIDTH]
    }
    #[inline(always)]
    unsafe fn constant(x: f64) -> [T; WIDTH] {
        [x.as_(); WIDTH]
    }
    #[inline(always)]
    unsafe fn add(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k] + b[k])
    }
    #[inline(always)]
    unsafe fn sub(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k] - b[k])
    }
    #[inline(always)]
    unsafe fn mul(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k] * b[k])
    }
    #[inline(always)]
    unsafe fn div(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k] / b[k])
    }
    #[inline(always)]
    unsafe fn fma(a: [T; WIDTH], b: [T; WIDTH], c: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k].mul_add(b[k], c[k]))
    }
    #[inline(always)]
    unsafe fn sqrt(a: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k].sqrt())
    }
    #[inline(always)]
    unsafe fn abs(a: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| a[k].abs())
    }
    #[inline(always)]
    unsafe fn max(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| if a[k] > b[k] { a[k] } else { b[k] })
    }
    #[inline(always)]
    unsafe fn min(a: [T; WIDTH], b: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| if a[k] < b[k] { a[k] } else { b[k] })
    }
    #[inline(always)]
    unsafe fn if_less(a: [T; WIDTH], b: [T; WIDTH], value: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| if a[k] < b[k] { value[k] } else { T::zero() })
    }
    #[inline(always)]
    unsafe fn less_mask(a: [T; WIDTH], b: [T; WIDTH]) -> u32 {
        (0..WIDTH).fold(0, |m, k| m | (((a[k] < b[k]) as u32) << k))
    }
    #[inline(always)]
    unsafe fn sum(a: [T; WIDTH]) -> f32 {
        let q = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
        ((q[0] + q[2]) + (q[1] + q[3])).as_()
    }
    #[inline(always)]
    unsafe fn to_array(a: [T; WIDTH]) -> [f32; WIDTH] {
        each(|k| a[k].as_())
    }
    #[inline(always)]
    unsafe fn gather(
        records: *const Record,
        index: *const u32,
    ) -> ([[i32; WIDTH]; 3], [[T; WIDTH]; 5]) {
        unsafe {
            let records: [&Record; WIDTH] = each(|k| &*records.add(*index.add(k) as usize));
            let at = std::array::from_fn(|a| each(|k| records[k].at(a)));
            let payload = std::array::from_fn(|c| each(|k| records[k].payload(c).as_()));
            (at, payload)
        }
    }
    #[inline(always)]
    unsafe fn gather_halves(
        points: *const Half,
        index: *const u16,
    ) -> ([[i32; WIDTH]; 3], [T; WIDTH]) {
        unsafe {
            let points: [Half; WIDTH] = each(|k| *points.add(*index.add(k) as usize));
            let at = std::array::from_fn(|a| each(|k| points[k].0[a] as i32));
            (at, each(|k| f32::from_bits(points[k].0[3]).as_()))
        }
    }
    #[inline(always)]
    unsafe fn load(words: *const f32) -> [T; WIDTH] {
        let words = unsafe { std::ptr::read_unaligned(words as *const [f32; WIDTH]) };
        each(|k| words[k].as_())
    }
    #[inline(always)]
    unsafe fn load_fixed(words: *const i32) -> [i32; WIDTH] {
        unsafe { std::ptr::read_unaligned(words as *const [i32; WIDTH]) }
    }
    #[inline(always)]
    unsafe fn difference(own: i32, other: [i32; WIDTH]) -> [T; WIDTH] {
        if !ABSOLUTE {
            return each(|k| own.wrapping_sub(other[k]).as_());
        }
        // From the low corner on, as a coordinate would be.
        let (turn, half): (T, T) = (4294967296.0.as_(), 2147483648.0.as_());
        each(|k| {
            let d = (own as u32).as_() - (other[k] as u32).as_();
            let d = if half < d { d - turn } else { d };
            if d < -half { d + turn } else { d }
        })
    }
    #[inline(always)]
    unsafe fn first(count: usize, value: [T; WIDTH], other: [T; WIDTH]) -> [T; WIDTH] {
        each(|k| if k < count { value[k] } else { other[k] })
    }
    #[inline(always)]
    unsafe fn compress(mask: u32, words: *const u32, out: *mut u32) -> usize {
        let count = mask.count_ones() as usize;
        for k in 0..count {
            unsafe { *out.add(k) = *words.add(COMPRESS[mask as usize][k] as usize) };
        }
        count
    }
}
