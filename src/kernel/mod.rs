//! Smoothing kernels W(r, h) = norm / h^d w(q), q = r / h, zero for q >= 2.
//!
//! `slope(q)` is w'(q) / q, so that grad W = norm / h^(d+2) slope(q) r_ab: finite at q = 0 and
//! without a division for Wendland C2.

use crate::scene::KernelName;
use crate::space::lane::Lanes;

/// A kernel with support radius 2 h.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// Norm in `dimension` (2 or 3) dimensions.
    fn norm(dimension: usize) -> f64;
    /// w(q).
    fn w(q: f64) -> f64;
    /// w'(q) / q.
    fn slope(q: f64) -> f64;
    /// w(q), eight at once; zero for q >= 2.
    ///
    /// # Safety
    /// The processor has the features of `L`.
    unsafe fn w_lanes<L: Lanes>(q: L::F) -> L::F;
    /// The same of others alone: zero at q = 0, where the particle itself and padding are.
    ///
    /// # Safety
    /// The processor has the features of `L`.
    #[inline(always)]
    unsafe fn w_apart<L: Lanes>(q: L::F, q2: L::F) -> L::F {
        unsafe { L::if_less(L::splat(0.0), q2, Self::w_lanes::<L>(q)) }
    }
    /// w'(q) / q, eight at once; zero for q >= 2, finite for q = 0.
    ///
    /// # Safety
    /// The processor has the features of `L`.
    unsafe fn slope_lanes<L: Lanes>(q: L::F) -> L::F;
    /// The derivative of `slope` over q, so that
    /// grad grad W = norm / h^(d+2) (slope I + curve d d), d = r_ab / h.
    fn curve(q: f64) -> f64;
    /// The same, eight at once; zero for q >= 2, finite for q = 0.
    ///
    /// # Safety
    /// The processor has the features of `L`.
    unsafe fn curve_lanes<L: Lanes>(q: L::F) -> L::F;
}

/// Cubic spline (Monaghan & Lattanzio 1985; Nishio et al. Eq. 3).
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline;

/// Wendland C2 (Wendland 1995; Dehnen & Aly 2012).
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2;

/// Below this q the slope of the spline is taken at it: 0 / 0 otherwise.
const TINY: f64 = 1e-6;

impl Kernel for CubicSpline {
    fn norm(dimension: usize) -> f64 {
        use std::f64::consts::PI;
        if dimension == 3 {
            1.0 / PI
        } else {
            10.0 / (7.0 * PI)
        }
    }
    fn w(q: f64) -> f64 {
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        0.25 * a * a * a - b * b * b
    }
    fn slope(q: f64) -> f64 {
        let q = q.max(TINY);
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        (3.0 * b * b - 0.75 * a * a) / q
    }
    #[inline(always)]
    unsafe fn w_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let zero = L::splat(0.0);
            let a = L::max(L::sub(L::splat(2.0), q), zero);
            let b = L::max(L::sub(L::splat(1.0), q), zero);
            let a3 = L::mul(L::mul(a, a), L::mul(a, L::splat(0.25)));
            L::sub(a3, L::mul(L::mul(b, b), b))
        }
    }
    #[inline(always)]
    unsafe fn slope_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let zero = L::splat(0.0);
            let q = L::max(q, L::splat(TINY as f32));
            let a = L::max(L::sub(L::splat(2.0), q), zero);
            let b = L::max(L::sub(L::splat(1.0), q), zero);
            let b2 = L::mul(L::mul(b, b), L::splat(3.0));
            L::div(L::fma(L::mul(a, a), L::splat(-0.75), b2), q)
        }
    }
    fn curve(q: f64) -> f64 {
        let q = q.max(TINY);
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        ((1.5 * a - 6.0 * b) - Self::slope(q)) / (q * q)
    }
    #[inline(always)]
    unsafe fn curve_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let q = L::max(q, L::splat(TINY as f32));
            let a = L::max(L::sub(L::splat(2.0), q), L::splat(0.0));
            let b = L::max(L::sub(L::splat(1.0), q), L::splat(0.0));
            let second = L::fma(a, L::splat(1.5), L::mul(b, L::splat(-6.0)));
            L::div(L::sub(second, Self::slope_lanes::<L>(q)), L::mul(q, q))
        }
    }
}

impl Kernel for WendlandC2 {
    fn norm(dimension: usize) -> f64 {
        use std::f64::consts::PI;
        if dimension == 3 {
            21.0 / (16.0 * PI)
        } else {
            7.0 / (4.0 * PI)
        }
    }
    fn w(q: f64) -> f64 {
        let t = (1.0 - 0.5 * q).max(0.0);
        t * t * t * t * (1.0 + 2.0 * q)
    }
    fn slope(q: f64) -> f64 {
        let t = (1.0 - 0.5 * q).max(0.0);
        -5.0 * t * t * t
    }
    #[inline(always)]
    unsafe fn w_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let one = L::splat(1.0);
            let t = L::max(L::fma(q, L::splat(-0.5), one), L::splat(0.0));
            let t2 = L::mul(t, t);
            L::mul(L::mul(t2, t2), L::fma(q, L::splat(2.0), one))
        }
    }
    #[inline(always)]
    unsafe fn slope_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let t = L::max(L::fma(q, L::splat(-0.5), L::splat(1.0)), L::splat(0.0));
            L::mul(L::mul(t, t), L::mul(t, L::splat(-5.0)))
        }
    }
    fn curve(q: f64) -> f64 {
        let t = (1.0 - 0.5 * q).max(0.0);
        7.5 * t * t / q.max(TINY)
    }
    #[inline(always)]
    unsafe fn curve_lanes<L: Lanes>(q: L::F) -> L::F {
        unsafe {
            let q = L::max(q, L::splat(TINY as f32));
            let t = L::max(L::fma(q, L::splat(-0.5), L::splat(1.0)), L::splat(0.0));
            L::div(L::mul(L::mul(t, t), L::splat(7.5)), q)
        }
    }
}

/// W(r, h), 1/m^d, by name.
pub fn value(kernel: KernelName, dimension: usize, r: f64, h: f64) -> f64 {
    let scale = h.powi(dimension as i32);
    match kernel {
        KernelName::CubicSpline => CubicSpline::norm(dimension) * CubicSpline::w(r / h) / scale,
        KernelName::WendlandC2 => WendlandC2::norm(dimension) * WendlandC2::w(r / h) / scale,
    }
}

/// W'(r, h) / r, 1/m^(d+2), by name: grad W = this x r_ab.
pub fn slope(kernel: KernelName, dimension: usize, r: f64, h: f64) -> f64 {
    let scale = h.powi(dimension as i32 + 2);
    match kernel {
        KernelName::CubicSpline => CubicSpline::norm(dimension) * CubicSpline::slope(r / h) / scale,
        KernelName::WendlandC2 => WendlandC2::norm(dimension) * WendlandC2::slope(r / h) / scale,
    }
}

/// SUM W s0^d over the square or cubic lattice of spacing `s0`, the particle itself included.
pub fn lattice_sum(kernel: KernelName, dimension: usize, s0: f64, h: f64) -> f64 {
    let n = (2.0 * h / s0).ceil() as i64;
    let depth = if dimension == 3 { n } else { 0 };
    let mut sum = 0.0;
    for x in -n..=n {
        for z in -n..=n {
            for y in -depth..=depth {
                let r = s0 * ((x * x + y * y + z * z) as f64).sqrt();
                sum += value(kernel, dimension, r, h);
            }
        }
    }
    sum * s0.powi(dimension as i32)
}

/// W summed over a plane at distance `q` h, in units of 1/h: the derivative of the kernel sum
/// across the surface of a half-space.
pub fn plane(kernel: KernelName, dimension: usize, q: f64) -> f64 {
    // Midpoints in the plane: the integrand ends with a vanishing slope.
    const CELLS: usize = 256;
    let step = 2.0 / CELLS as f64;
    let part = |k: usize| {
        let r = (k as f64 + 0.5) * step;
        let ring = match dimension {
            2 => 2.0,
            _ => std::f64::consts::TAU * r,
        };
        ring * value(kernel, dimension, (r * r + q * q).sqrt(), 1.0) * step
    };
    (0..CELLS).map(part).sum()
}
