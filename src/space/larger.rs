//! Largest numbers.

/// The larger of two. NaN wins, so that it cannot hide.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}
