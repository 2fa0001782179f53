//! AVX2 + FMA, eight f32.

use super::{COMPRESS, Half, Lanes, Real, Record, TURN, WIDTH, ends, operators};
use num_traits::AsPrimitive;
use std::arch::x86_64::*;

/// Eight f32; `ABSOLUTE`: coordinates are rounded before they are subtracted.
#[derive(Clone, Copy, Debug)]
pub struct Avx2<const ABSOLUTE: bool>(());

impl<const ABSOLUTE: bool> Avx2<ABSOLUTE> {
    /// The proof that the processor has what these lanes use.
    ///
    /// # Safety
    /// The processor has AVX2, FMA and POPCNT.
    #[inline(always)]
    pub unsafe fn new() -> Self {
        Avx2(())
    }

    /// The same words without sign, rounded once: both halves of a word are exact.
    #[inline(always)]
    fn unsigned(self, words: __m256i) -> __m256 {
        // SAFETY: there are such lanes only where the processor has AVX2 and FMA.
        unsafe {
            let low = _mm256_cvtepi32_ps(_mm256_and_si256(words, _mm256_set1_epi32(0xFFFF)));
            let high = _mm256_cvtepi32_ps(_mm256_srli_epi32::<16>(words));
            _mm256_fmadd_ps(high, _mm256_set1_ps(65536.0), low)
        }
    }
}

/// Rows of the two 4 x 4 blocks in the halves of `r` become columns.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn transpose(r: [__m256; 4]) -> [__m256; 4] {
    // SAFETY: as of the whole.
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

/// Cells of a table with places in them, from 0 to `last`.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn cells(place: __m256, last: usize) -> (__m256i, __m256) {
    // SAFETY: as of the whole.
    unsafe {
        // What is no number stays so, and becomes the first cell.
        let within = _mm256_min_ps(_mm256_set1_ps(last as f32), place);
        let cell = _mm256_max_epi32(_mm256_cvttps_epi32(within), _mm256_setzero_si256());
        (cell, _mm256_sub_ps(place, _mm256_cvtepi32_ps(cell)))
    }
}

/// a + t (b - a), rounded thrice, t of lanes `LANE` and `LANE` + 4; `LANE`: 0x55 times that.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn between<const LANE: i32>(a: __m256, b: __m256, t: __m256) -> __m256 {
    // SAFETY: as of the whole.
    unsafe {
        let t = _mm256_permute_ps::<LANE>(t);
        _mm256_add_ps(a, _mm256_mul_ps(t, _mm256_sub_ps(b, a)))
    }
}

/// Entries from `low` and from `high` on side by side, between those of the next row too, which is
/// `row` words further.
///
/// # Safety
/// The processor has AVX2; there are two entries from each, and as many in the next row.
#[inline(always)]
unsafe fn entry<const LANE: i32>(
    [low, high]: [*const f32; 2],
    row: usize,
    [u, v]: [__m256; 2],
) -> __m256 {
    // SAFETY: the entries are there.
    unsafe {
        let mut corners = [_mm256_setzero_ps(); 4];
        for (corner, at) in corners.iter_mut().zip([0, 4, row, row + 4]) {
            *corner = _mm256_insertf128_ps::<1>(
                _mm256_castps128_ps256(_mm_loadu_ps(low.add(at))),
                _mm_loadu_ps(high.add(at)),
            );
        }
        let [a, b, c, d] = corners;
        between::<LANE>(between::<LANE>(a, b, u), between::<LANE>(c, d, u), v)
    }
}

/// Eight f32 in a register. There is one only where the processor has AVX2 and FMA: that is why the
/// functions below may use them.
#[derive(Clone, Copy, Debug)]
pub struct F32x8(pub(super) __m256);

macro_rules! of_f32 {
    ($($name:ident $with:ident $a:ident $($b:ident)*;)*) => {$(
        #[inline(always)]
        fn $name($a: F32x8, $($b: F32x8),*) -> F32x8 {
            // SAFETY: there are such numbers only where the processor has AVX2 and FMA.
            F32x8(unsafe { $with($a.0, $($b.0),*) })
        }
    )*};
}

of_f32! {
    sum _mm256_add_ps a b;
    difference _mm256_sub_ps a b;
    product _mm256_mul_ps a b;
    quotient _mm256_div_ps a b;
    fused _mm256_fmadd_ps a b c;
    root _mm256_sqrt_ps a;
    larger _mm256_max_ps a b;
    smaller _mm256_min_ps a b;
}

operators!([] F32x8: sum, difference, product, quotient);

impl Real for F32x8 {
    #[inline(always)]
    fn splat(self, x: f32) -> Self {
        // SAFETY: see [`F32x8`].
        F32x8(unsafe { _mm256_set1_ps(x) })
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
        // SAFETY: see [`F32x8`].
        F32x8(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
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
        // SAFETY: see [`F32x8`].
        F32x8(unsafe { _mm256_and_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a.0, b.0), self.0) })
    }
    #[inline(always)]
    fn less_mask(self, b: Self) -> u32 {
        // SAFETY: see [`F32x8`].
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, b.0)) as u32 }
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        let a = self.0;
        // SAFETY: see [`F32x8`].
        unsafe {
            let q = _mm_add_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let h = _mm_add_ps(q, _mm_movehl_ps(q, q));
            _mm_cvtss_f32(_mm_add_ss(h, _mm_shuffle_ps::<1>(h, h)))
        }
    }
    #[inline(always)]
    fn look_up(self, row: Self, table: &[[f32; 4]], columns: usize) -> [Self; 3] {
        let last = ends(table, columns);
        let mut at = [0u32; WIDTH];
        // SAFETY: see [`F32x8`]; cells have an entry beside and above them.
        unsafe {
            let (i, u) = cells(self.0, last[0]);
            let (j, v) = cells(row.0, last[1]);
            let place = _mm256_mullo_epi32(j, _mm256_set1_epi32(columns as i32));
            let place = _mm256_add_epi32(place, i);
            _mm256_storeu_si256(at.as_mut_ptr() as *mut __m256i, place);
            let first = table.as_ptr() as *const f32;
            let (row, parts) = (4 * columns, [u, v]);
            let [a, b, c, d, e, f, g, h] = at.map(|at| first.add(4 * at as usize));
            let [x, y, z, _] = transpose([
                entry::<0x00>([a, e], row, parts),
                entry::<0x55>([b, f], row, parts),
                entry::<0xAA>([c, g], row, parts),
                entry::<0xFF>([d, h], row, parts),
            ]);
            [F32x8(x), F32x8(y), F32x8(z)]
        }
    }
    #[inline(always)]
    fn to_array(self) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        // SAFETY: see [`F32x8`].
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn of_array(self, lanes: [f32; WIDTH]) -> Self {
        // SAFETY: see [`F32x8`].
        F32x8(unsafe { _mm256_loadu_ps(lanes.as_ptr()) })
    }
}

impl<const ABSOLUTE: bool> Lanes for Avx2<ABSOLUTE> {
    type F = F32x8;
    type I = __m256i;
    #[inline(always)]
    fn splat(self, x: f32) -> F32x8 {
        // SAFETY: see [`Avx2::new`].
        F32x8(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn constant(self, x: f64) -> F32x8 {
        self.splat(x as f32)
    }
    #[inline(always)]
    fn difference(self, own: i32, other: __m256i) -> F32x8 {
        // SAFETY: see [`Avx2::new`].
        F32x8(unsafe {
            if !ABSOLUTE {
                let d = _mm256_sub_epi32(_mm256_set1_epi32(own), other);
                return F32x8(_mm256_cvtepi32_ps(d));
            }
            let own = _mm256_set1_ps(own as u32 as f32);
            let d = _mm256_sub_ps(own, self.unsigned(other));
            let (turn, half) = (_mm256_set1_ps(TURN), _mm256_set1_ps(0.5 * TURN));
            let above = _mm256_cmp_ps::<_CMP_LT_OQ>(half, d);
            let d = _mm256_sub_ps(d, _mm256_and_ps(above, turn));
            let half = _mm256_set1_ps(-0.5 * TURN);
            let below = _mm256_cmp_ps::<_CMP_LT_OQ>(d, half);
            _mm256_add_ps(d, _mm256_and_ps(below, turn))
        })
    }
    #[inline(always)]
    fn first(self, count: usize, value: F32x8, other: F32x8) -> F32x8 {
        // SAFETY: see [`Avx2::new`].
        unsafe {
            let lane = _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
            let mask = _mm256_cmp_ps::<_CMP_LT_OQ>(lane, _mm256_set1_ps(count as f32));
            F32x8(_mm256_blendv_ps(other.0, value.0, mask))
        }
    }
    #[inline(always)]
    unsafe fn gather<J: AsPrimitive<usize>>(
        self,
        records: *const Record,
        index: *const J,
    ) -> ([__m256i; 3], [F32x8; 5]) {
        // SAFETY: there are eight indices, all of records; a record is aligned to 32 bytes.
        unsafe {
            let mut half = [[_mm256_setzero_ps(); 4]; 2];
            for k in 0..4 {
                let low = records.add((*index.add(k)).as_()) as *const f32;
                let high = records.add((*index.add(k + 4)).as_()) as *const f32;
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
            ([x, y, z], [d, e, f, g, h].map(F32x8))
        }
    }
    #[inline(always)]
    unsafe fn gather_halves(self, points: *const Half, index: *const u16) -> ([__m256i; 3], F32x8) {
        // SAFETY: there are eight indices, all of points; a point is aligned to 16 bytes.
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
                F32x8(word),
            )
        }
    }
    #[inline(always)]
    unsafe fn load(self, words: *const f32) -> F32x8 {
        // SAFETY: there are eight words.
        F32x8(unsafe { _mm256_loadu_ps(words) })
    }
    #[inline(always)]
    unsafe fn load_fixed(self, words: *const i32) -> __m256i {
        // SAFETY: there are eight words.
        unsafe { _mm256_loadu_si256(words as *const __m256i) }
    }
    #[inline(always)]
    unsafe fn compress(self, mask: u32, words: *const u32, out: *mut u32) -> usize {
        let bytes = COMPRESS[mask as usize].as_ptr() as *const __m128i;
        // SAFETY: an entry of the table has eight bytes; eight words are read and written.
        unsafe {
            let lane = _mm256_cvtepu8_epi32(_mm_loadl_epi64(bytes));
            let words = _mm256_loadu_si256(words as *const __m256i);
            let chosen = _mm256_permutevar8x32_epi32(words, lane);
            _mm256_storeu_si256(out as *mut __m256i, chosen);
        }
        mask.count_ones() as usize
    }
}
