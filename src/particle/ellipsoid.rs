//! The nearest point of an ellipsoid or ellipse, and its curvature there.
//!
//! The nearest point y of x solves y_k = a_k^2 x_k / (a_k^2 + t) with SUM (y_k / a_k)^2 = 1, one
//! unknown t > -min a^2 (Eberly, "Distance from a point to an ellipse, an ellipsoid"): bisection
//! suffices near the surface. With g_k = y_k / a_k^2 the mean curvature is (|g|^2
//! SUM a_k^-2 - SUM g_k^2 a_k^-2) / ((d - 1) |g|^3), positive for a convex liquid.

use super::shape::axes;
use crate::scene::Dimension;

/// The surface near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Distance to it, positive inside.
    pub depth: f64,
    /// Outward unit normal.
    pub normal: [f64; 3],
    /// Mean curvature.
    pub curvature: f64,
}

/// The surface near `x`; `None` if `x` is certainly deeper than `reach` inside.
pub fn nearest(
    dimension: Dimension,
    semi_axes: [f64; 3],
    x: [f64; 3],
    reach: f64,
) -> Option<Surface> {
    let axes = axes(dimension);
    let a = semi_axes;
    let least = axes.iter().map(|&k| a[k]).fold(f64::INFINITY, f64::min);
    let level = norm(axes, |k| x[k] / a[k]);
    if (1.0 - level) * least >= reach {
        return None;
    }
    let t = root(axes, a, x, least);
    let mut y = [0.0; 3];
    for &k in axes {
        y[k] = a[k] * a[k] * x[k] / (a[k] * a[k] + t);
    }
    let g = |k: usize| y[k] / (a[k] * a[k]);
    let length = norm(axes, g).max(f64::MIN_POSITIVE);
    let mut normal = [0.0; 3];
    for &k in axes {
        normal[k] = g(k) / length;
    }
    let distance = norm(axes, |k| x[k] - y[k]);
    // At the very centre y is undetermined; the largest inner ellipsoid through x still bounds it.
    let inside = distance.max((1.0 - level) * least);
    Some(Surface {
        depth: if level < 1.0 { inside } else { -distance },
        normal,
        curvature: curvature(axes, a, normal, length),
    })
}

/// Least and largest mean curvature: both lie at tips of axes.
pub fn curvatures(dimension: Dimension, semi_axes: [f64; 3]) -> (f64, f64) {
    let axes = axes(dimension);
    let tip = |&k: &usize| {
        let mut normal = [0.0; 3];
        normal[k] = 1.0;
        curvature(axes, semi_axes, normal, 1.0 / semi_axes[k])
    };
    let tips = axes.iter().map(tip);
    tips.fold((f64::INFINITY, 0.0), |(low, high), c| {
        (c.min(low), c.max(high))
    })
}

/// Mean curvature from the unit normal and |g|.
fn curvature(axes: &[usize], a: [f64; 3], normal: [f64; 3], length: f64) -> f64 {
    let term = |&k: &usize| (1.0 - normal[k] * normal[k]) / (a[k] * a[k]);
    axes.iter().map(term).sum::<f64>() / ((axes.len() - 1) as f64 * length)
}

fn root(axes: &[usize], a: [f64; 3], x: [f64; 3], least: f64) -> f64 {
    let square = least * least;
    let excess = |t: f64| norm(axes, |k| a[k] * x[k] / (a[k] * a[k] + t)) - 1.0;
    let mut low = -square * (1.0 - 1e-12);
    let mut high = norm(axes, |k| a[k] * x[k]);
    for _ in 0..64 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn norm(axes: &[usize], component: impl Fn(usize) -> f64) -> f64 {
    axes.iter()
        .map(|&k| component(k).powi(2))
        .sum::<f64>()
        .sqrt()
}
