//! Smoothing kernels W(r, h) = norm / h^d w(q), q = r / h, zero for q >= 2.
//!
//! `slope(q)` is w'(q) / q, so that grad W = norm / h^(d+2) slope(q) r_ab: finite at q = 0 and
//! without a division for Wendland C2.

pub mod ring;

use crate::scene::KernelName;
use crate::space::lane::Real;

/// A kernel with support radius 2 h.
pub trait Kernel: Copy + Send + Sync + 'static {
    /// Norm in `dimension` (2 or 3) dimensions.
    fn norm(dimension: usize) -> f64;
    /// w(q).
    fn w(q: f64) -> f64;
    /// w'(q) / q.
    fn slope(q: f64) -> f64;
    /// w(q), eight at once; zero for q >= 2.
    fn w_lanes<F: Real>(q: F) -> F;
    /// w(q) of other particles: zero at q = 0, where the particle itself and padding are.
    #[inline(always)]
    fn w_apart<F: Real>(q: F, q2: F) -> F {
        Self::w_lanes(q).if_less(q.splat(0.0), q2)
    }
    /// w'(q) / q, eight at once; zero for q >= 2, finite for q = 0.
    fn slope_lanes<F: Real>(q: F) -> F;
    /// [`Kernel::w_apart`] and [`Kernel::slope_lanes`] at the squared distance `q2`.
    #[inline(always)]
    fn both_lanes<F: Real>(q2: F) -> [F; 2] {
        let q = q2.sqrt();
        [Self::w_apart(q, q2), Self::slope_lanes(q)]
    }
    /// [`Kernel::slope_lanes`] at the squared distance `q2`, twice.
    #[inline(always)]
    fn slope_alone<F: Real>(q2: F) -> [F; 2] {
        let slope = Self::slope_lanes(q2.sqrt());
        [slope, slope]
    }
    /// The distance and [`Kernel::slope_lanes`] at the squared distance `q2`.
    #[inline(always)]
    fn root_and_slope<F: Real>(q2: F) -> [F; 2] {
        let q = q2.sqrt();
        [q, Self::slope_lanes(q)]
    }
    /// The derivative of `slope` over q, so that
    /// grad grad W = norm / h^(d+2) (slope I + curve d d), d = r_ab / h.
    fn curve(q: f64) -> f64;
    /// `curve`, eight at once; zero for q >= 2, finite for q = 0.
    fn curve_lanes<F: Real>(q: F) -> F;
}

/// Cubic spline (Monaghan & Lattanzio 1985; Nishio et al. Eq. 3).
#[derive(Clone, Copy, Debug)]
pub struct CubicSpline;

/// Wendland C2 (Wendland 1995; Dehnen & Aly 2012).
#[derive(Clone, Copy, Debug)]
pub struct WendlandC2;

/// Smaller q are replaced by this one in the slope of the spline, which would be 0 / 0.
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
    fn w_lanes<F: Real>(q: F) -> F {
        let zero = q.splat(0.0);
        let a = (q.splat(2.0) - q).max(zero);
        let b = (q.splat(1.0) - q).max(zero);
        let a3 = a * a * (a * 0.25);
        a3 - b * b * b
    }
    #[inline(always)]
    fn slope_lanes<F: Real>(q: F) -> F {
        let zero = q.splat(0.0);
        let q = q.max(q.splat(TINY as f32));
        let a = (q.splat(2.0) - q).max(zero);
        let b = (q.splat(1.0) - q).max(zero);
        let b2 = b * b * 3.0;
        (a * a).mul_add(q.splat(-0.75), b2) / q
    }
    fn curve(q: f64) -> f64 {
        let q = q.max(TINY);
        let (a, b) = ((2.0 - q).max(0.0), (1.0 - q).max(0.0));
        ((1.5 * a - 6.0 * b) - Self::slope(q)) / (q * q)
    }
    #[inline(always)]
    fn curve_lanes<F: Real>(q: F) -> F {
        let q = q.max(q.splat(TINY as f32));
        let a = (q.splat(2.0) - q).max(q.splat(0.0));
        let b = (q.splat(1.0) - q).max(q.splat(0.0));
        let second = a.mul_add(q.splat(1.5), b * -6.0);
        (second - Self::slope_lanes(q)) / (q * q)
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
    fn w_lanes<F: Real>(q: F) -> F {
        let one = q.splat(1.0);
        let t = q.mul_add(q.splat(-0.5), one).max(q.splat(0.0));
        let t2 = t * t;
        t2 * t2 * q.mul_add(q.splat(2.0), one)
    }
    #[inline(always)]
    fn slope_lanes<F: Real>(q: F) -> F {
        let t = q.mul_add(q.splat(-0.5), q.splat(1.0)).max(q.splat(0.0));
        t * t * (t * -5.0)
    }
    fn curve(q: f64) -> f64 {
        let t = (1.0 - 0.5 * q).max(0.0);
        7.5 * t * t / q.max(TINY)
    }
    #[inline(always)]
    fn curve_lanes<F: Real>(q: F) -> F {
        let q = q.max(q.splat(TINY as f32));
        let t = q.mul_add(q.splat(-0.5), q.splat(1.0)).max(q.splat(0.0));
        t * t * 7.5 / q
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
    // Midpoint rule in the plane: the slope of the integrand vanishes at its end.
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
