//! AVX2 + FMA.

use super::{COMPRESS, Half, Lanes, Record, WIDTH};
use std::arch::x86_64::*;

/// Of the fixed-point coordinates.
const TURN: f32 = 4294967296.0;

/// The same words without sign, rounded once: both halves of a word are exact.
#[inline(always)]
unsafe fn unsigned(words: __m256i) -> __m256 {
    unsafe {
        let low = _mm256_cvtepi32_ps(_mm256_and_si256(words, _mm256_set1_epi32(0xFFFF)));
        let high = _mm256_cvtepi32_ps(_mm256_srli_epi32::<16>(words));
        _mm256_fmadd_ps(high, _mm256_set1_ps(65536.0), low)
    }
}

/// Eight f32; `ABSOLUTE`: coordinates are rounded before they are subtracted.
#[derive(Clone, Copy, Debug)]
pub struct Avx2<const ABSOLUTE: bool>;

/// Rows of the two 4 x 4 blocks in the halves of `r` become columns.
#[inline(always)]
unsafe fn transpose(r: [__m256; 4]) -> [__m256; 4] {
    unsafe {
        let a = [
            _mm256_unpacklo_ps(r[0], r[1]),
            _mm256_unpackhi_ps(r[0], r[1]),
            _mm256_unpacklo_ps(r[2], r[3]),
            _mm256_unpackhi_ps(r[2], r[3]),
        ];
        [
            _mm256_shuffle_ps::<0x44>(a[0], a[2]),
            _mm256_shuffle_ps::<0xEE>(a[0], a[2]),
            _mm256_shuffle_ps::<0x44>(a[1], a[3]),
            _mm256_shuffle_ps::<0xEE>(a[1], a[3]),
        ]
    }
}

impl<const ABSOLUTE: bool> Lanes for Avx2<ABSOLUTE> {
    type F = __m256;
    type I = __m256i;
    #[inline(always)]
    unsafe fn splat(x: f32) -> __m256 {
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    unsafe fn constant(x: f64) -> __m256 {
        unsafe { _mm256_set1_ps(x as f32) }
    }
    #[inline(always)]
    unsafe fn add(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn div(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn fma(a: __m256, b: __m256, c: __m256) -> __m256 {
        unsafe { _mm256_fmadd_ps(a, b, c) }
    }
    #[inline(always)]
    unsafe fn sqrt(a: __m256) -> __m256 {
        unsafe { _mm256_sqrt_ps(a) }
    }
    #[inline(always)]
    unsafe fn abs(a: __m256) -> __m256 {
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
    }
    #[inline(always)]
    unsafe fn max(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn min(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn if_less(a: __m256, b: __m256, value: __m256) -> __m256 {
        unsafe { _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b), value) }
    }
    #[inline(always)]
    unsafe fn less_mask(a: __m256, b: __m256) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32 }
    }
    #[inline(always)]
    unsafe fn sum(a: __m256) -> f32 {
        unsafe {
            let q = _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let h = _mm_add_ps(q, _mm_movehl_ps(q, q));
            _mm_cvtss_f32(_mm_add_ss(h, _mm_shuffle_ps::<1>(h, h)))
        }
    }
    #[inline(always)]
    unsafe fn to_array(a: __m256) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), a) };
        out
    }
    #[inline(always)]
    unsafe fn gather(records: *const Record, index: *const u32) -> ([__m256i; 3], [__m256; 5]) {
        unsafe {
            let mut half = [[_mm256_setzero_ps(); 4]; 2];
            for k in 0..4 {
                let low = records.add(*index.add(k) as usize) as *const f32;
                let high = records.add(*index.add(k + 4) as usize) as *const f32;
                for (h, half) in half.iter_mut().enumerate() {
                    // Joined as they are loaded: cheaper than to swap halves of registers, and
                    // a pass that asks for no words of a half does not load it.
                    half[k] = _mm256_insertf128_ps::<1>(
                        _mm256_castps128_ps256(_mm_load_ps(low.add(4 * h))),
                        _mm_load_ps(high.add(4 * h)),
                    );
                }
            }
            let [x, y, z, d] = transpose(half[0]);
            let [e, f, g, h] = transpose(half[1]);
            let [x, y, z] = [
                _mm256_castps_si256(x),
                _mm256_castps_si256(y),
                _mm256_castps_si256(z),
            ];
            ([x, y, z], [d, e, f, g, h])
        }
    }
    #[inline(always)]
    unsafe fn gather_halves(points: *const Half, index: *const u16) -> ([__m256i; 3], __m256) {
        unsafe {
            let mut joined = [_mm256_setzero_ps(); 4];
            for (k, joined) in joined.iter_mut().enumerate() {
                let low = points.add(*index.add(k) as usize) as *const f32;
                let high = points.add(*index.add(k + 4) as usize) as *const f32;
                *joined = _mm256_insertf128_ps::<1>(
                    _mm256_castps128_ps256(_mm_load_ps(low)),
                    _mm_load_ps(high),
                );
            }
            let [x, y, z, word] = transpose(joined);
            (
                [
                    _mm256_castps_si256(x),
                    _mm256_castps_si256(y),
                    _mm256_castps_si256(z),
                ],
                word,
            )
        }
    }
    #[inline(always)]
    unsafe fn load(words: *const f32) -> __m256 {
        unsafe { _mm256_loadu_ps(words) }
    }
    #[inline(always)]
    unsafe fn load_fixed(words: *const i32) -> __m256i {
        unsafe { _mm256_loadu_si256(words as *const __m256i) }
    }
    #[inline(always)]
    unsafe fn difference(own: i32, other: __m256i) -> __m256 {
        unsafe {
            if !ABSOLUTE {
                return _mm256_cvtepi32_ps(_mm256_sub_epi32(_mm256_set1_epi32(own), other));
            }
            let own = _mm256_set1_ps(own as u32 as f32);
            let d = _mm256_sub_ps(own, unsigned(other));
            let (turn, half) = (_mm256_set1_ps(TURN), _mm256_set1_ps(0.5 * TURN));
            let above = _mm256_cmp_ps::<_CMP_LT_OQ>(half, d);
            let d = _mm256_sub_ps(d, _mm256_and_ps(above, turn));
            let half = _mm256_set1_ps(-0.5 * TURN);
            let below = _mm256_cmp_ps::<_CMP_LT_OQ>(d, half);
            _mm256_add_ps(d, _mm256_and_ps(below, turn))
        }
    }
    #[inline(always)]
    unsafe fn first(count: usize, value: __m256, other: __m256) -> __m256 {
        unsafe {
            let lane = _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
            let mask = _mm256_cmp_ps::<_CMP_LT_OQ>(lane, _mm256_set1_ps(count as f32));
            _mm256_blendv_ps(other, value, mask)
        }
    }
    #[inline(always)]
    unsafe fn compress(mask: u32, words: *const u32, out: *mut u32) -> usize {
        unsafe {
            let bytes = COMPRESS[mask as usize].as_ptr() as *const __m128i;
            let lane = _mm256_cvtepu8_epi32(_mm_loadl_epi64(bytes));
            let words = _mm256_loadu_si256(words as *const __m256i);
            let chosen = _mm256_permutevar8x32_epi32(words, lane);
            _mm256_storeu_si256(out as *mut __m256i, chosen);
        }
        mask.count_ones() as usize
    }
}

/// Eight f64: two registers.
#[derive(Clone, Copy, Debug)]
pub struct Avx2Double;

/// The f32 lanes whose words it loads.
type Words = Avx2<false>;

/// `$f` of both registers.
macro_rules! both {
    ($f:expr, $($x:ident),*) => {
        [$f($($x[0]),*), $f($($x[1]),*)]
    };
}

#[inline(always)]
unsafe fn widen(a: __m256) -> [__m256d; 2] {
    unsafe {
        [
            _mm256_cvtps_pd(_mm256_castps256_ps128(a)),
            _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a)),
        ]
    }
}

impl Lanes for Avx2Double {
    type F = [__m256d; 2];
    type I = __m256i;
    #[inline(always)]
    unsafe fn splat(x: f32) -> [__m256d; 2] {
        unsafe { [_mm256_set1_pd(x as f64); 2] }
    }
    #[inline(always)]
    unsafe fn constant(x: f64) -> [__m256d; 2] {
        unsafe { [_mm256_set1_pd(x); 2] }
    }
    #[inline(always)]
    unsafe fn add(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_add_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_sub_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_mul_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn div(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_div_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn fma(a: [__m256d; 2], b: [__m256d; 2], c: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_fmadd_pd, a, b, c) }
    }
    #[inline(always)]
    unsafe fn sqrt(a: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_sqrt_pd, a) }
    }
    #[inline(always)]
    unsafe fn abs(a: [__m256d; 2]) -> [__m256d; 2] {
        unsafe {
            let sign = [_mm256_set1_pd(-0.0); 2];
            both!(_mm256_andnot_pd, sign, a)
        }
    }
    #[inline(always)]
    unsafe fn max(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_max_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn min(a: [__m256d; 2], b: [__m256d; 2]) -> [__m256d; 2] {
        unsafe { both!(_mm256_min_pd, a, b) }
    }
    #[inline(always)]
    unsafe fn if_less(a: [__m256d; 2], b: [__m256d; 2], value: [__m256d; 2]) -> [__m256d; 2] {
        unsafe {
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b);
            both!(_mm256_and_pd, mask, value)
        }
    }
    #[inline(always)]
    unsafe fn less_mask(a: [__m256d; 2], b: [__m256d; 2]) -> u32 {
        unsafe {
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, a, b);
            let [low, high] = both!(_mm256_movemask_pd, mask);
            (low | high << 4) as u32
        }
    }
    #[inline(always)]
    unsafe fn sum(a: [__m256d; 2]) -> f32 {
        unsafe {
            let q = _mm256_add_pd(a[0], a[1]);
            let h = _mm_add_pd(_mm256_castpd256_pd128(q), _mm256_extractf128_pd::<1>(q));
            _mm_cvtsd_f64(_mm_add_sd(h, _mm_unpackhi_pd(h, h))) as f32
        }
    }
    #[inline(always)]
    unsafe fn to_array(a: [__m256d; 2]) -> [f32; WIDTH] {
        unsafe {
            let [low, high] = both!(_mm256_cvtpd_ps, a);
            Words::to_array(_mm256_insertf128_ps::<1>(_mm256_castps128_ps256(low), high))
        }
    }
    #[inline(always)]
    unsafe fn gather(
        records: *const Record,
        index: *const u32,
    ) -> ([__m256i; 3], [[__m256d; 2]; 5]) {
        unsafe {
            let (at, [a, b, c, d, e]) = Words::gather(records, index);
            (at, [widen(a), widen(b), widen(c), widen(d), widen(e)])
        }
    }
    #[inline(always)]
    unsafe fn gather_halves(
        points: *const Half,
        index: *const u16,
    ) -> ([__m256i; 3], [__m256d; 2]) {
        unsafe {
            let (at, word) = Words::gather_halves(points, index);
            (at, widen(word))
        }
    }
    #[inline(always)]
    unsafe fn load(words: *const f32) -> [__m256d; 2] {
        unsafe { widen(Words::load(words)) }
    }
    #[inline(always)]
    unsafe fn load_fixed(words: *const i32) -> __m256i {
        unsafe { Words::load_fixed(words) }
    }
    #[inline(always)]
    unsafe fn difference(own: i32, other: __m256i) -> [__m256d; 2] {
        unsafe {
            let d = _mm256_sub_epi32(_mm256_set1_epi32(own), other);
            [
                _mm256_cvtepi32_pd(_mm256_castsi256_si128(d)),
                _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(d)),
            ]
        }
    }
    #[inline(always)]
    unsafe fn first(count: usize, value: [__m256d; 2], other: [__m256d; 2]) -> [__m256d; 2] {
        unsafe {
            let lane = [
                _mm256_setr_pd(0.0, 1.0, 2.0, 3.0),
                _mm256_setr_pd(4.0, 5.0, 6.0, 7.0),
            ];
            let count = [_mm256_set1_pd(count as f64); 2];
            let mask = both!(_mm256_cmp_pd::<_CMP_LT_OQ>, lane, count);
            both!(_mm256_blendv_pd, other, value, mask)
        }
    }
    #[inline(always)]
    unsafe fn compress(mask: u32, words: *const u32, out: *mut u32) -> usize {
        unsafe { Words::compress(mask, words, out) }
    }
}
