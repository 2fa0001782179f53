//! Quality of a packing: spread of density and distances of nearest neighbours.

use super::crowd::Crowd;
use super::optimise::Local;
use crate::space::parallel::{self, each_mut};
use crate::space::ranks::span::Span;

/// Bins of the histogram of nearest distances: 0.05 spacings each, the last one open.
pub const BINS: usize = 32;

/// Distances to the nearest particle of the body, in units of the spacing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Nearest {
    /// Minimum.
    pub least: f64,
    /// Mean.
    pub mean: f64,
    /// Below these lie 1, 10, 50, 90 and 99 % of the particles.
    pub quantiles: [f64; 5],
    /// `histogram[k]`: particles whose nearest is at [0.05 k, 0.05 (k + 1)).
    pub histogram: [u64; BINS],
}

/// Measures the distances in a crowd; the support is the largest distance. Nothing on other ranks
/// than the first.
pub fn nearest(crowd: &Crowd, support: f64) -> Nearest {
    let mut distance = vec![0.0; crowd.len()];
    each_mut(&mut distance[..], |i, distance| {
        *distance = crowd.nearest(i).min(support)
    });
    let Some(mut distance) = crowd.collect(distance) else {
        return Nearest::default();
    };
    let n = distance.len();
    let mean = distance.iter().sum::<f64>() / n.max(1) as f64;
    distance.sort_by(f64::total_cmp);
    let mut histogram = [0; BINS];
    for d in &distance {
        histogram[((d / 0.05) as usize).min(BINS - 1)] += 1;
    }
    let quantile = |q: f64| {
        distance
            .get((q * n as f64) as usize)
            .copied()
            .unwrap_or(support)
    };
    Nearest {
        least: distance.first().copied().unwrap_or(support),
        mean,
        quantiles: [0.01, 0.10, 0.50, 0.90, 0.99].map(quantile),
        histogram,
    }
}

/// Least distance between particles.
pub fn closest(crowd: &Crowd) -> f64 {
    -parallel::max(crowd.span(), |i| -crowd.nearest(i))
}

/// Number of particles with full support, which have no completion, and the root mean square of
/// their rho / rho0 - 1 - `level`.
pub fn supported(span: Span, local: &[Local], level: f64) -> (usize, f64) {
    let [count, sum] = parallel::sum(span, |i| match local[i].missing == 0.0 {
        true => [1.0, local[i].residual(level).powi(2)],
        false => [0.0, 0.0],
    });
    (count as usize, (sum / f64::max(count, 1.0)).sqrt())
}
