//! NEON, eight f32. Every processor of the architecture has it.

use super::{COMPRESS, Half, Lanes, Real, Record, TURN, WIDTH, operators};
use num_traits::AsPrimitive;
use std::arch::aarch64::*;

/// Eight f32; `ABSOLUTE`: coordinates are rounded before they are subtracted.
#[derive(Clone, Copy, Debug)]
pub struct Neon<const ABSOLUTE: bool>(());

impl<const ABSOLUTE: bool> Neon<ABSOLUTE> {
    /// Anywhere on this architecture.
    #[inline(always)]
    pub const fn new() -> Self {
        Neon(())
    }
}

/// Eight f32 in two registers.
#[derive(Clone, Copy, Debug)]
pub struct F32x8([float32x4_t; 2]);

/// `$f` of both registers.
macro_rules! both {
    ($f:expr, $($x:expr),*) => {
        [$f($($x[0]),*), $f($($x[1]),*)]
    };
}

macro_rules! of_f32 {
    ($($name:ident $with:ident $a:ident $($b:ident)*;)*) => {$(
        #[inline(always)]
        fn $name($a: F32x8, $($b: F32x8),*) -> F32x8 {
            // SAFETY: every processor of the architecture has the instruction.
            F32x8(unsafe { both!($with, $a.0 $(, $b.0)*) })
        }
    )*};
}

of_f32! {
    sum vaddq_f32 a b;
    difference vsubq_f32 a b;
    product vmulq_f32 a b;
    quotient vdivq_f32 a b;
    added vfmaq_f32 c a b;
    root vsqrtq_f32 a;
    without_sign vabsq_f32 a;
}

operators!([] F32x8: sum, difference, product, quotient);

/// Where a < b.
#[inline(always)]
fn less(a: F32x8, b: F32x8) -> [uint32x4_t; 2] {
    // SAFETY: every processor of the architecture has the instruction.
    unsafe { both!(vcltq_f32, a.0, b.0) }
}

/// `a` where `mask` is set, else `b`.
#[inline(always)]
fn choose(mask: [uint32x4_t; 2], a: F32x8, b: F32x8) -> F32x8 {
    // SAFETY: every processor of the architecture has the instruction.
    F32x8(unsafe { both!(vbslq_f32, mask, a.0, b.0) })
}

/// Signed words as numbers.
#[inline(always)]
fn converted(words: [int32x4_t; 2]) -> F32x8 {
    // SAFETY: every processor of the architecture has the instruction.
    F32x8(unsafe { both!(vcvtq_f32_s32, words) })
}

impl Real for F32x8 {
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        // SAFETY: every processor of the architecture has the instruction.
        F32x8(unsafe { [vdupq_n_f32(x); 2] })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        added(c, self, b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        root(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        without_sign(self)
    }
    // The instructions for these two treat what is no number in another way than the twins.
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        choose(less(b, self), self, b)
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        choose(less(self, b), self, b)
    }
    #[inline(always)]
    fn if_less(self, a: Self, b: Self) -> Self {
        choose(less(a, b), self, self.splat(0.0))
    }
    #[inline(always)]
    fn less_mask(self, b: Self) -> u32 {
        let less = less(self, b);
        // SAFETY: every processor of the architecture has the instructions.
        unsafe {
            let bits = [
                vld1q_u32([1, 2, 4, 8].as_ptr()),
                vld1q_u32([16, 32, 64, 128].as_ptr()),
            ];
            let [low, high] = both!(vandq_u32, less, bits);
            vaddvq_u32(vorrq_u32(low, high))
        }
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        let [low, high] = self.0;
        // SAFETY: every processor of the architecture has the instructions.
        unsafe {
            let q = vaddq_f32(low, high);
            vpadds_f32(vadd_f32(vget_low_f32(q), vget_high_f32(q)))
        }
    }
    #[inline(always)]
    fn to_array(self) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        // SAFETY: there is room for eight words.
        unsafe {
            vst1q_f32(out.as_mut_ptr(), self.0[0]);
            vst1q_f32(out.as_mut_ptr().add(4), self.0[1]);
        }
        out
    }
    #[inline(always)]
    fn of_array(self, lanes: [f32; WIDTH]) -> Self {
        // SAFETY: there are eight words.
        unsafe { load(lanes.as_ptr()) }
    }
}

/// Eight consecutive words.
///
/// # Safety
/// Eight words can be read from `words` on.
#[inline(always)]
unsafe fn load(words: *const f32) -> F32x8 {
    // SAFETY: there are eight words.
    F32x8(unsafe { [vld1q_f32(words), vld1q_f32(words.add(4))] })
}

/// Rows of a 4 x 4 block become columns.
#[inline(always)]
fn transpose(r: [float32x4_t; 4]) -> [float32x4_t; 4] {
    // SAFETY: every processor of the architecture has the instructions.
    unsafe {
        let a = [
            vtrn1q_f32(r[0], r[1]),
            vtrn2q_f32(r[0], r[1]),
            vtrn1q_f32(r[2], r[3]),
            vtrn2q_f32(r[2], r[3]),
        ]
        .map(|a| vreinterpretq_f64_f32(a));
        [
            vtrn1q_f64(a[0], a[2]),
            vtrn1q_f64(a[1], a[3]),
            vtrn2q_f64(a[0], a[2]),
            vtrn2q_f64(a[1], a[3]),
        ]
        .map(|a| vreinterpretq_f32_f64(a))
    }
}

/// Columns of the four words at each of eight places.
///
/// # Safety
/// Four words can be read from each place on.
#[inline(always)]
unsafe fn columns(places: [*const f32; WIDTH]) -> [F32x8; 4] {
    let [a, b, c, d, e, f, g, h] = places;
    // SAFETY: there are four words.
    let (low, high) = unsafe {
        (
            transpose([vld1q_f32(a), vld1q_f32(b), vld1q_f32(c), vld1q_f32(d)]),
            transpose([vld1q_f32(e), vld1q_f32(f), vld1q_f32(g), vld1q_f32(h)]),
        )
    };
    std::array::from_fn(|c| F32x8([low[c], high[c]]))
}

/// The same words, not as numbers.
#[inline(always)]
fn words(of: F32x8) -> [int32x4_t; 2] {
    // SAFETY: every processor of the architecture has the instruction.
    unsafe { both!(vreinterpretq_s32_f32, of.0) }
}

impl<const ABSOLUTE: bool> Lanes for Neon<ABSOLUTE> {
    type F = F32x8;
    type I = [int32x4_t; 2];
    #[inline(always)]
    fn splat(self, x: f32) -> F32x8 {
        // SAFETY: every processor of the architecture has the instruction.
        F32x8(unsafe { [vdupq_n_f32(x); 2] })
    }
    #[inline(always)]
    fn constant(self, x: f64) -> F32x8 {
        self.splat(x as f32)
    }
    #[inline(always)]
    fn difference(self, own: i32, other: [int32x4_t; 2]) -> F32x8 {
        // SAFETY: every processor of the architecture has the instructions.
        unsafe {
            if !ABSOLUTE {
                let own = [vdupq_n_s32(own); 2];
                return converted(both!(vsubq_s32, own, other));
            }
            let other = both!(vreinterpretq_u32_s32, other);
            let other = F32x8(both!(vcvtq_f32_u32, other));
            let d = self.splat(own as u32 as f32) - other;
            let (turn, half) = (self.splat(TURN), self.splat(0.5 * TURN));
            let d = d - turn.if_less(half, d);
            d + turn.if_less(d, self.splat(-0.5 * TURN))
        }
    }
    #[inline(always)]
    fn first(self, count: usize, value: F32x8, other: F32x8) -> F32x8 {
        let lane = value.of_array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        choose(less(lane, self.splat(count as f32)), value, other)
    }
    #[inline(always)]
    unsafe fn gather<J: AsPrimitive<usize>>(
        self,
        records: *const Record,
        index: *const J,
    ) -> ([[int32x4_t; 2]; 3], [F32x8; 5]) {
        // SAFETY: there are eight indices, all of records of eight words.
        unsafe {
            let mut low = [records as *const f32; WIDTH];
            for (k, low) in low.iter_mut().enumerate() {
                *low = records.add((*index.add(k)).as_()) as *const f32;
            }
            let [x, y, z, d] = columns(low);
            let [e, f, g, h] = columns(low.map(|low| low.add(4)));
            ([words(x), words(y), words(z)], [d, e, f, g, h])
        }
    }
    #[inline(always)]
    unsafe fn gather_halves(
        self,
        points: *const Half,
        index: *const u16,
    ) -> ([[int32x4_t; 2]; 3], F32x8) {
        // SAFETY: there are eight indices, all of points of four words.
        unsafe {
            let mut low = [points as *const f32; WIDTH];
            for (k, low) in low.iter_mut().enumerate() {
                *low = points.add(*index.add(k) as usize) as *const f32;
            }
            let [x, y, z, word] = columns(low);
            ([words(x), words(y), words(z)], word)
        }
    }
    #[inline(always)]
    unsafe fn load(self, words: *const f32) -> F32x8 {
        // SAFETY: there are eight words.
        unsafe { load(words) }
    }
    #[inline(always)]
    unsafe fn load_fixed(self, words: *const i32) -> [int32x4_t; 2] {
        // SAFETY: there are eight words.
        unsafe { [vld1q_s32(words), vld1q_s32(words.add(4))] }
    }
    #[inline(always)]
    unsafe fn compress(self, mask: u32, words: *const u32, out: *mut u32) -> usize {
        let lanes = &COMPRESS[mask as usize];
        // SAFETY: entries of the table are below eight; eight words are read and written.
        unsafe {
            let mut chosen = [0; WIDTH];
            for (chosen, lane) in chosen.iter_mut().zip(lanes) {
                *chosen = *words.add(*lane as usize);
            }
            (out as *mut [u32; WIDTH]).write_unaligned(chosen);
        }
        mask.count_ones() as usize
    }
}
