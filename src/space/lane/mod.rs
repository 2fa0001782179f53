//! Eight lanes, of f32 or of f64: AVX2 + FMA or NEON where the processor has them, and portable
//! twins with the same bits.
//!
//! Only exact IEEE operations (no reciprocal estimates), so both give the same result everywhere.
//! Features of the processor are proved by values. A value of a [`Lanes`] type is a token: it is
//! made only where the features were found. Only it makes the first number, so that a [`Real`] is a
//! proof too: sums over pairs are written with its operators and are safe. What reads or writes
//! through pointers is unsafe.
//!
//! Every function is inlined into a caller that enables the features: see [`run`]. Code over lanes
//! holds no closure, for a closure would be a function without the features.
//!
//! What the lanes of a [`Precision`] differ in: mixed takes the exact difference of fixed-point
//! coordinates and goes on in f32; single rounds the coordinates themselves to f32; double takes
//! the exact difference and goes on in f64. Payloads and results are f32 with all of them.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod double;
#[cfg(target_arch = "aarch64")]
mod neon;
mod portable;
mod record;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use double::Avx2Double;
#[cfg(target_arch = "aarch64")]
pub use neon::Neon;
pub use portable::{Portable, Scalar};
pub use record::{Half, Record};

use crate::scene::Precision;
use num_traits::AsPrimitive;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Number of lanes.
pub const WIDTH: usize = 8;

/// How many units the range of a fixed-point coordinate has.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
const TURN: f32 = 4294967296.0;

/// Eight numbers that are computed with together, f32 or f64. Only [`Lanes`] makes the first one,
/// where the processor has what it needs: whoever has a number may compute with it.
///
/// The operations are exact ones of IEEE 754, without branches that depend on data.
pub trait Real:
    Copy
    + AddAssign
    + Add<Output = Self>
    + Add<f32, Output = Self>
    + Sub<Output = Self>
    + Sub<f32, Output = Self>
    + Mul<Output = Self>
    + Mul<f32, Output = Self>
    + Div<Output = Self>
{
    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self;
    /// self b + c, rounded once.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// Without sign.
    fn abs(self) -> Self;
    /// The larger of the two; `b` where one is no number.
    fn max(self, b: Self) -> Self;
    /// The smaller of the two; `b` where one is no number.
    fn min(self, b: Self) -> Self;
    /// Itself where `a < b`, else 0.
    fn if_less(self, a: Self, b: Self) -> Self;
    /// Bit k set where self < b in lane k.
    fn less_mask(self, b: Self) -> u32;
    /// Sum of the lanes in a fixed order.
    fn sum(self) -> f32;
    /// The lanes one by one, rounded to f32.
    fn to_array(self) -> [f32; WIDTH];
    /// Lanes of these numbers.
    fn of_array(self, lanes: [f32; WIDTH]) -> Self;
    /// The first three words of the entries of a table at column `self` and row `row`, bilinear
    /// between them and on from those at its ends; both are at least 0. Rows have `columns`
    /// entries.
    ///
    /// # Panics
    /// With less than two rows or columns.
    #[inline(always)]
    fn look_up(self, row: Self, table: &[[f32; 4]], columns: usize) -> [Self; 3] {
        let last = ends(table, columns);
        let (across, along) = (self.to_array(), row.to_array());
        let mut found = [[0.0; WIDTH]; 3];
        for k in 0..WIDTH {
            let (i, j) = (
                (across[k] as usize).min(last[0]),
                (along[k] as usize).min(last[1]),
            );
            let (u, v) = (across[k] - i as f32, along[k] - j as f32);
            let at = j * columns + i;
            let (low, high) = (&table[at..at + 2], &table[at + columns..at + columns + 2]);
            for (c, found) in found.iter_mut().enumerate() {
                let below = low[0][c] + u * (low[1][c] - low[0][c]);
                let above = high[0][c] + u * (high[1][c] - high[0][c]);
                found[k] = below + v * (above - below);
            }
        }
        let [a, b, c] = found;
        [self.of_array(a), self.of_array(b), self.of_array(c)]
    }
    /// Three splats.
    #[inline(always)]
    fn splat3(self, [x, y, z]: [f32; 3]) -> [Self; 3] {
        [self.splat(x), self.splat(y), self.splat(z)]
    }
    /// The larger of itself and `x`.
    #[inline(always)]
    fn at_least(self, x: f32) -> Self {
        self.max(self.splat(x))
    }
}

/// The last column and row from which [`Real::look_up`] goes on.
#[inline(always)]
fn ends(table: &[[f32; 4]], columns: usize) -> [usize; 2] {
    let rows = table.len() / columns;
    assert!(columns >= 2 && rows >= 2 && table.len() < 1 << 29);
    [columns - 2, rows - 2]
}

/// a . b
#[inline(always)]
pub fn dot<F: Real>(a: [F; 3], b: [F; 3]) -> F {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Whether all lanes of three are zero, so that what is multiplied by them need not be found.
#[inline(always)]
pub fn are_zero<F: Real>([x, y, z]: [F; 3]) -> bool {
    let most = x.abs().max(y.abs()).max(z.abs());
    x.splat(0.0).less_mask(most) == 0
}

/// The operators of a type, by the functions of their names; those with f32 by a splat.
macro_rules! operators {
    ([$($bound:tt)*] $type:ty: $sum:path, $difference:path, $product:path, $quotient:path) => {
        impl<$($bound)*> std::ops::Add for $type {
            type Output = Self;
            #[inline(always)]
            fn add(self, b: Self) -> Self {
                $sum(self, b)
            }
        }
        impl<$($bound)*> std::ops::Sub for $type {
            type Output = Self;
            #[inline(always)]
            fn sub(self, b: Self) -> Self {
                $difference(self, b)
            }
        }
        impl<$($bound)*> std::ops::Mul for $type {
            type Output = Self;
            #[inline(always)]
            fn mul(self, b: Self) -> Self {
                $product(self, b)
            }
        }
        impl<$($bound)*> std::ops::Div for $type {
            type Output = Self;
            #[inline(always)]
            fn div(self, b: Self) -> Self {
                $quotient(self, b)
            }
        }
        impl<$($bound)*> std::ops::AddAssign for $type {
            #[inline(always)]
            fn add_assign(&mut self, b: Self) {
                *self = $sum(*self, b);
            }
        }
        impl<$($bound)*> std::ops::Add<f32> for $type {
            type Output = Self;
            #[inline(always)]
            fn add(self, b: f32) -> Self {
                self + self.splat(b)
            }
        }
        impl<$($bound)*> std::ops::Sub<f32> for $type {
            type Output = Self;
            #[inline(always)]
            fn sub(self, b: f32) -> Self {
                self - self.splat(b)
            }
        }
        impl<$($bound)*> std::ops::Mul<f32> for $type {
            type Output = Self;
            #[inline(always)]
            fn mul(self, b: f32) -> Self {
                self * self.splat(b)
            }
        }
    };
}
use operators;

/// What the lanes of a processor read, write and make. A value is the proof that the processor has
/// the features that they use: see the [module](self).
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Eight numbers.
    type F: Real;
    /// Eight fixed-point coordinates.
    type I: Copy;
    /// `x` in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// `x` in all lanes, as exactly as they can.
    fn constant(self, x: f64) -> Self::F;
    /// Own minus other, wrapped.
    fn difference(self, own: i32, other: Self::I) -> Self::F;
    /// `value` in the first `count` lanes, `other` in the rest.
    fn first(self, count: usize, value: Self::F, other: Self::F) -> Self::F;
    /// Eight records: their coordinates and payloads, lane k of record k.
    ///
    /// # Safety
    /// Eight indices can be read from `index` on, and each is that of a record behind `records`.
    unsafe fn gather<J: AsPrimitive<usize>>(
        self,
        records: *const Record,
        index: *const J,
    ) -> ([Self::I; 3], [Self::F; 5]);
    /// Eight points: their coordinates and words, lane k of point k.
    ///
    /// # Safety
    /// Eight indices can be read from `index` on, and each is that of a point behind `points`.
    unsafe fn gather_halves(
        self,
        points: *const Half,
        index: *const u16,
    ) -> ([Self::I; 3], Self::F);
    /// Eight consecutive words.
    ///
    /// # Safety
    /// Eight words can be read from `words` on.
    unsafe fn load(self, words: *const f32) -> Self::F;
    /// Eight consecutive coordinates.
    ///
    /// # Safety
    /// Eight words can be read from `words` on.
    unsafe fn load_fixed(self, words: *const i32) -> Self::I;
    /// Coordinates `from .. from + 8`.
    ///
    /// # Safety
    /// Each of the three arrays has at least `from + 8` words.
    #[inline(always)]
    unsafe fn load_fixed_at(self, [x, y, z]: &[Vec<i32>; 3], from: usize) -> [Self::I; 3] {
        debug_assert!(from + WIDTH <= x.len().min(y.len()).min(z.len()));
        // SAFETY: the arrays have eight words from `from` on.
        unsafe {
            [
                self.load_fixed(x.as_ptr().add(from)),
                self.load_fixed(y.as_ptr().add(from)),
                self.load_fixed(z.as_ptr().add(from)),
            ]
        }
    }
    /// Writes `words[k]` for every set bit k of `mask`, of 8 bits, to `out`; how many.
    ///
    /// # Safety
    /// Eight words can be read from `words` on, and eight can be written from `out` on. The two may
    /// overlap if `out` is not behind `words`.
    unsafe fn compress(self, mask: u32, words: *const u32, out: *mut u32) -> usize;
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

/// Something to do with lanes.
pub trait Job {
    /// Does it.
    fn run<L: Lanes>(self, lanes: L);
}

/// Does `job` with the lanes of `precision`.
#[inline(always)]
pub fn run(precision: Precision, job: impl Job) {
    #[cfg(target_arch = "x86_64")]
    if wide() {
        // SAFETY: `wide` has found the features.
        return unsafe {
            match precision {
                Precision::Single => with_features(Avx2::<true>::new(), job),
                Precision::Mixed => with_features(Avx2::<false>::new(), job),
                Precision::Double => with_features(Avx2Double::new(), job),
            }
        };
    }
    #[cfg(target_arch = "aarch64")]
    if wide() {
        return match precision {
            Precision::Single => job.run(Neon::<true>::new()),
            Precision::Mixed => job.run(Neon::<false>::new()),
            Precision::Double => job.run(Scalar::<f64, false>::new()),
        };
    }
    match precision {
        Precision::Single => job.run(Scalar::<f32, true>::new()),
        Precision::Mixed => job.run(Portable::new()),
        Precision::Double => job.run(Scalar::<f64, false>::new()),
    }
}

/// The same where the precision is no matter of choice.
#[inline(always)]
pub fn run_mixed(job: impl Job) {
    #[cfg(target_arch = "x86_64")]
    if wide() {
        // SAFETY: `wide` has found the features.
        return unsafe { with_features(Avx2::<false>::new(), job) };
    }
    #[cfg(target_arch = "aarch64")]
    if wide() {
        return job.run(Neon::<false>::new());
    }
    job.run(Portable::new())
}

/// Asks for the words at `place`, which need not be there.
#[inline(always)]
pub fn prefetch<T>(place: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 has the instruction, and it reads nothing that the program sees.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(place as *const i8);
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// What is inlined into it is compiled for the features.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt")]
fn with_features<L: Lanes>(lanes: L, job: impl Job) {
    job.run(lanes)
}

/// Whether the path of AVX2 + FMA, or of NEON, may run; `CORONET_LANES=portable` forces the twin.
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
        let able = cfg!(target_arch = "aarch64");
        able && !forced
    })
}
