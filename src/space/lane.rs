//! Eight f32 lanes: AVX2 + FMA where the processor has them, and a portable twin with the same
//! bits.
//!
//! Only exact IEEE operations (no reciprocal estimates), so both give the same result everywhere.
//! Every function is inlined into a caller that enables the features: see [`super::sweep`]. Code
//! over
//! lanes holds no closure, for a closure would be a function without the features.

/// One neighbour record: fixed-point x, y, z, then five f32 payloads, as bits. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(32))]
pub struct Record(pub [u32; 8]);

impl Record {
    /// Fixed-point coordinates and five payloads.
    #[inline(always)]
    pub fn new(at: [i32; 3], payload: [f32; 5]) -> Self {
        let [x, y, z] = at.map(|v| v as u32);
        let [a, b, c, d, e] = payload.map(f32::to_bits);
        Record([x, y, z, a, b, c, d, e])
    }

    /// Changes the payloads.
    #[inline(always)]
    pub fn carry(&mut self, payload: [f32; 5]) {
        self.0[3..].copy_from_slice(&payload.map(f32::to_bits));
    }

    /// Fixed-point coordinate of one axis.
    #[inline(always)]
    pub fn at(&self, axis: usize) -> i32 {
        self.0[axis] as i32
    }

    /// Payload `k` (0..5).
    #[inline(always)]
    pub fn payload(&self, k: usize) -> f32 {
        f32::from_bits(self.0[3 + k])
    }
}

/// Number of lanes.
pub const WIDTH: usize = 8;

/// Eight lanes of f32.
///
/// # Safety
/// Every function requires the processor features of the implementation.
pub trait Lanes: Copy + Send + Sync + 'static {
    type F: Copy;
    unsafe fn splat(x: f32) -> Self::F;
    /// Three splats.
    #[inline(always)]
    unsafe fn splat3(x: [f32; 3]) -> [Self::F; 3] {
        unsafe { [Self::splat(x[0]), Self::splat(x[1]), Self::splat(x[2])] }
    }
    /// a . b
    #[inline(always)]
    unsafe fn dot(a: [Self::F; 3], b: [Self::F; 3]) -> Self::F {
        unsafe { Self::fma(a[2], b[2], Self::fma(a[1], b[1], Self::mul(a[0], b[0]))) }
    }
    unsafe fn add(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn div(a: Self::F, b: Self::F) -> Self::F;
    /// a b + c, rounded once.
    unsafe fn fma(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    unsafe fn sqrt(a: Self::F) -> Self::F;
    unsafe fn abs(a: Self::F) -> Self::F;
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F;
    /// `value` where `a < b`, else 0.
    unsafe fn if_less(a: Self::F, b: Self::F, value: Self::F) -> Self::F;
    /// Bit k set where `a[k] < b[k]`.
    unsafe fn less_mask(a: Self::F, b: Self::F) -> u32;
    /// Sum of the lanes in a fixed order.
    unsafe fn sum(a: Self::F) -> f32;
    /// Eight records, transposed: lane k of result c is word c of record k.
    unsafe fn gather(records: *const Record, index: *const u32) -> [Self::F; 8];
    /// Eight consecutive words (any 32-bit type).
    unsafe fn load<T>(words: *const T) -> Self::F;
    /// Words `from .. from + 8` of some arrays.
    #[inline(always)]
    unsafe fn load_at<T, const N: usize>(words: &[Vec<T>; N], from: usize) -> [Self::F; N] {
        std::array::from_fn(|a| {
            debug_assert!(from + WIDTH <= words[a].len());
            unsafe { Self::load(words[a].as_ptr().add(from)) }
        })
    }
    /// (own - other) as f32, for fixed-point lanes `other`: exact difference, one rounding.
    unsafe fn difference(own: i32, other: Self::F) -> Self::F;
    /// `value` in the first `count` lanes, `other` in the rest.
    unsafe fn first(count: usize, value: Self::F, other: Self::F) -> Self::F;
    /// Writes `words[k]` for every set bit k of `mask` to `out` (room for 8); how many.
    unsafe fn compress(mask: u32, words: *const u32, out: *mut u32) -> usize;
}

/// Byte k of entry `m`: position of the k-th set bit of `m`.
const COMPRESS: [[u8; 8]; 256] = {
    let mut table = [[0u8; 8]; 256];
    let mut m = 0;
    while m < 256 {
        let (mut k, mut n) = (0, 0);
        while k < 8 {
            if m >> k & 1 == 1 {
                table[m][n] = k as u8;
                n += 1;
            }
            k += 1;
        }
        m += 1;
    }
    table
};

/// The scalar twin: same operations, one lane after the other.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

#[inline(always)]
fn each(f: impl Fn(usize) -> f32) -> [f32; 8] {
    std::array::from_fn(f)
}

impl Lanes for Portable {
    type F = [f32; 8];
    #[inline(always)]
    unsafe fn splat(x: f32) -> [f32; 8] {
        [x; 8]
    }
    #[inline(always)]
    unsafe fn add(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] + b[k])
    }
    #[inline(always)]
    unsafe fn sub(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] - b[k])
    }
    #[inline(always)]
    unsafe fn mul(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] * b[k])
    }
    #[inline(always)]
    unsafe fn div(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| a[k] / b[k])
    }
    #[inline(always)]
    unsafe fn fma(a: [f32; 8], b: [f32; 8], c: [f32; 8]) -> [f32; 8] {
        each(|k| a[k].mul_add(b[k], c[k]))
    }
    #[inline(always)]
    unsafe fn sqrt(a: [f32; 8]) -> [f32; 8] {
        each(|k| a[k].sqrt())
    }
    #[inline(always)]
    unsafe fn abs(a: [f32; 8]) -> [f32; 8] {
        each(|k| a[k].abs())
    }
    #[inline(always)]
    unsafe fn max(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| if a[k] > b[k] { a[k] } else { b[k] })
    }
    #[inline(always)]
    unsafe fn min(a: [f32; 8], b: [f32; 8]) -> [f32; 8] {
        each(|k| if a[k] < b[k] { a[k] } else { b[k] })
    }
    #[inline(always)]
    unsafe fn if_less(a: [f32; 8], b: [f32; 8], value: [f32; 8]) -> [f32; 8] {
        each(|k| if a[k] < b[k] { value[k] } else { 0.0 })
    }
    #[inline(always)]
    unsafe fn less_mask(a: [f32; 8], b: [f32; 8]) -> u32 {
        (0..8).fold(0, |m, k| m | (((a[k] < b[k]) as u32) << k))
    }
    #[inline(always)]
    unsafe fn sum(a: [f32; 8]) -> f32 {
        let q = [a[0] + a[4], a[1] + a[5], a[2] + a[6], a[3] + a[7]];
        (q[0] + q[2]) + (q[1] + q[3])
    }
    #[inline(always)]
    unsafe fn gather(records: *const Record, index: *const u32) -> [[f32; 8]; 8] {
        std::array::from_fn(|c| {
            each(|k| f32::from_bits(unsafe { (*records.add(*index.add(k) as usize)).0[c] }))
        })
    }
    #[inline(always)]
    unsafe fn load<T>(words: *const T) -> [f32; 8] {
        unsafe { std::ptr::read_unaligned(words as *const [f32; 8]) }
    }
    #[inline(always)]
    unsafe fn difference(own: i32, other: [f32; 8]) -> [f32; 8] {
        each(|k| own.wrapping_sub(other[k].to_bits() as i32) as f32)
    }
    #[inline(always)]
    unsafe fn first(count: usize, value: [f32; 8], other: [f32; 8]) -> [f32; 8] {
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

#[cfg(target_arch = "x86_64")]
pub use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Lanes, Record};
    use std::arch::x86_64::*;

    /// AVX2 + FMA.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2;

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

    impl Lanes for Avx2 {
        type F = __m256;
        #[inline(always)]
        unsafe fn splat(x: f32) -> __m256 {
            unsafe { _mm256_set1_ps(x) }
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
        unsafe fn gather(records: *const Record, index: *const u32) -> [__m256; 8] {
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
                let [a, b, c, d] = transpose(half[0]);
                let [e, f, g, h] = transpose(half[1]);
                [a, b, c, d, e, f, g, h]
            }
        }
        #[inline(always)]
        unsafe fn load<T>(words: *const T) -> __m256 {
            unsafe { _mm256_loadu_ps(words as *const f32) }
        }
        #[inline(always)]
        unsafe fn difference(own: i32, other: __m256) -> __m256 {
            unsafe {
                let d = _mm256_sub_epi32(_mm256_set1_epi32(own), _mm256_castps_si256(other));
                _mm256_cvtepi32_ps(d)
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
                let bytes = super::COMPRESS[mask as usize].as_ptr() as *const __m128i;
                let lane = _mm256_cvtepu8_epi32(_mm_loadl_epi64(bytes));
                let words = _mm256_loadu_si256(words as *const __m256i);
                let chosen = _mm256_permutevar8x32_epi32(words, lane);
                _mm256_storeu_si256(out as *mut __m256i, chosen);
            }
            mask.count_ones() as usize
        }
    }
}

/// Whether the AVX2 + FMA path may run; `CORONET_LANES=portable` forces the twin.
pub fn wide() -> bool {
    use std::sync::OnceLock;
    static WIDE: OnceLock<bool> = OnceLock::new();
    *WIDE.get_or_init(|| {
        let forced = std::env::var("CORONET_LANES").is_ok_and(|v| v == "portable");
        #[cfg(target_arch = "x86_64")]
        let able = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("popcnt");
        #[cfg(not(target_arch = "x86_64"))]
        let able = false;
        able && !forced
    })
}
