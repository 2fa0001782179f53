//! AVX2 + FMA, eight f64.

use super::avx2::{Avx2, F32x8};
use super::{Half, Lanes, Real, Record, WIDTH, operators};
use num_traits::AsPrimitive;
use std::arch::x86_64::*;

/// Eight f64: two registers. The words are loaded by lanes of f32.
#[derive(Clone, Copy, Debug)]
pub struct Avx2Double(Avx2<false>);

impl Avx2Double {
    /// The proof that the processor has what these lanes use.
    ///
    /// # Safety
    /// The processor has AVX2, FMA and POPCNT.
    #[inline(always)]
    pub unsafe fn new() -> Self {
        // SAFETY: it has the same features.
        Avx2Double(unsafe { Avx2::new() })
    }
}

/// `$f` of both registers.
macro_rules! both {
    ($f:expr, $($x:ident),*) => {
        [$f($($x[0]),*), $f($($x[1]),*)]
    };
}

#[inline(always)]
fn widen(a: F32x8) -> F64x8 {
    // SAFETY: see [`F32x8`].
    unsafe {
        F64x8([
            _mm256_cvtps_pd(_mm256_castps256_ps128(a.0)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a.0)),
        ])
    }
}

/// As [`F32x8`], eight f64 in two registers.
#[derive(Clone, Copy, Debug)]
pub struct F64x8([__m256d; 2]);

macro_rules! of_f64 {
    ($($name:ident $with:ident $a:ident $($b:ident)*;)*) => {$(
        #[inline(always)]
        fn $name($a: F64x8, $($b: F64x8),*) -> F64x8 {
            let $a = $a.0;
            $(let $b = $b.0;)*
            // SAFETY: there are such numbers only where the processor has AVX2 and FMA.
            F64x8(unsafe { both!($with, $a $(, $b)*) })
        }
    )*};
}

of_f64! {
    sum _mm256_add_pd a b;
    difference _mm256_sub_pd a b;
    product _mm256_mul_pd a b;
    quotient _mm256_div_pd a b;
    fused _mm256_fmadd_pd a b c;
    root _mm256_sqrt_pd a;
    larger _mm256_max_pd a b;
    smaller _mm256_min_pd a b;
}

operators!([] F64x8: sum, difference, product, quotient);

impl Real for F64x8 {
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        // SAFETY: see [`F64x8`].
        F64x8(unsafe { [_mm256_set1_pd(x as f64); 2] })
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        fused(self, b, c)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        root(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let a = self.0;
        // SAFETY: see [`F64x8`].
        F64x8(unsafe {
            let sign = [_mm256_set1_pd(-0.0); 2];
            both!(_mm256_andnot_pd, sign, a)
        })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        larger(self, b)
    }
    #[inline(always)]
    fn min(self, b: Self) -> Self {
        smaller(self, b)
    }
    #[inline(always)]
    fn if_less(self, a: Self, b: Self) -> Self {
        let (value, a, b) = (self.0, a.0, b.0);
        // SAFETY: see [`F64x8`].
        F64x8(unsafe {
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b);
            both!(_mm256_and_pd, mask, value)
        })
    }
    #[inline(always)]
    fn less_mask(self, b: Self) -> u32 {
        let (a, b) = (self.0, b.0);
        // SAFETY: see [`F64x8`].
        unsafe {
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b);
            let [low, high] = both!(_mm256_movemask_pd, mask);
            (low | high << 4) as u32
        }
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        let a = self.0;
        // SAFETY: see [`F64x8`].
        unsafe {
            let q = _mm256_add_pd(a[0], a[1]);
            let h = _mm_add_pd(_mm256_castpd256_pd128(q), _mm256_extractf128_pd::<1>(q));
            _mm_cvtsd_f64(_mm_add_sd(h, _mm_unpackhi_pd(h, h))) as f32
        }
    }
    #[inline(always)]
    fn to_array(self) -> [f32; WIDTH] {
        let a = self.0;
        // SAFETY: see [`F64x8`].
        unsafe {
            let [low, high] = both!(_mm256_cvtpd_ps, a);
            F32x8(_mm256_insertf128_ps::<1>(_mm256_castps128_ps256(low), high)).to_array()
        }
    }
    #[inline(always)]
    fn of_array(self, lanes: [f32; WIDTH]) -> Self {
        // SAFETY: see [`F64x8`].
        widen(F32x8(unsafe { _mm256_loadu_ps(lanes.as_ptr()) }))
    }
}

impl Lanes for Avx2Double {
    type F = F64x8;
    type I = __m256i;
    #[inline(always)]
    fn splat(self, x: f32) -> F64x8 {
        self.constant(x as f64)
    }
    #[inline(always)]
    fn constant(self, x: f64) -> F64x8 {
        // SAFETY: see [`Avx2Double::new`].
        F64x8(unsafe { [_mm256_set1_pd(x); 2] })
    }
    #[inline(always)]
    fn difference(self, own: i32, other: __m256i) -> F64x8 {
        // SAFETY: see [`Avx2Double::new`].
        unsafe {
            let d = _mm256_sub_epi32(_mm256_set1_epi32(own), other);
            F64x8([
                _mm256_cvtepi32_pd(_mm256_castsi256_si128(d)),
                _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(d)),
            ])
        }
    }
    #[inline(always)]
    fn first(self, count: usize, value: F64x8, other: F64x8) -> F64x8 {
        // SAFETY: see [`Avx2Double::new`].
        unsafe {
            let lane = [
                _mm256_setr_pd(0.0, 1.0, 2.0, 3.0),
                _mm256_setr_pd(4.0, 5.0, 6.0, 7.0),
            ];
            let count = [_mm256_set1_pd(count as f64); 2];
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, lane, count);
            let (other, value) = (other.0, value.0);
            F64x8(both!(_mm256_blendv_pd, other, value, mask))
        }
    }
    #[inline(always)]
    unsafe fn gather<J: AsPrimitive<usize>>(
        self,
        records: *const Record,
        index: *const J,
    ) -> ([__m256i; 3], [F64x8; 5]) {
        // SAFETY: the lanes of f32 ask the same.
        let (at, [a, b, c, d, e]) = unsafe { self.0.gather(records, index) };
        (at, [widen(a), widen(b), widen(c), widen(d), widen(e)])
    }
    #[inline(always)]
    unsafe fn gather_halves(self, points: *const Half, index: *const u16) -> ([__m256i; 3], F64x8) {
        // SAFETY: the lanes of f32 ask the same.
        let (at, word) = unsafe { self.0.gather_halves(points, index) };
        (at, widen(word))
    }
    #[inline(always)]
    unsafe fn load(self, words: *const f32) -> F64x8 {
        // SAFETY: the lanes of f32 ask the same.
        widen(unsafe { self.0.load(words) })
    }
    #[inline(always)]
    unsafe fn load_fixed(self, words: *const i32) -> __m256i {
        // SAFETY: the lanes of f32 ask the same.
        unsafe { self.0.load_fixed(words) }
    }
    #[inline(always)]
    unsafe fn compress(self, mask: u32, words: *const u32, out: *mut u32) -> usize {
        // SAFETY: the lanes of f32 ask the same.
        unsafe { self.0.compress(mask, words, out) }
    }
}
