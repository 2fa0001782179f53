//! What accuracy costs: which of several runs nobody beats, and the powers by which error and time
//! grow.

use nalgebra::{DMatrix, DVector};

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Runs of one group differ in their spacing alone.
    pub group: usize,
    /// Particle spacing s0, m.
    pub spacing: f64,
    /// Particles.
    pub count: f64,
    /// Relative error; `NaN` if unknown.
    pub error: f64,
    /// Time of the run, s.
    pub seconds: f64,
}

/// How error and time of a group grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// p of error ~ s0^p.
    pub order: Option<f64>,
    /// q of time ~ N^q.
    pub work: Option<f64>,
    /// Time after over time before the error is halved.
    pub halving: Option<f64>,
}

/// Marks the samples that no other beats: none has at most the same error and time, and less of
/// one (the Pareto front). Samples of unknown error are on no front.
pub fn front(samples: &[Sample]) -> Vec<bool> {
    let beats = |a: &Sample, b: &Sample| {
        let no_worse = a.error <= b.error && a.seconds <= b.seconds;
        no_worse && (a.error < b.error || a.seconds < b.seconds)
    };
    let on = |s: &Sample| s.error.is_finite() && !samples.iter().any(|other| beats(other, s));
    samples.iter().map(on).collect()
}

/// Least squares of ln y = a + k ln x: k. `None` without two different x; pairs that have no
/// logarithm are left out.
pub fn exponent(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> = pairs
        .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
        .map(|(x, y)| (x.ln(), y.ln()))
        .collect();
    let first = logs.first()?.0;
    if logs.iter().all(|(x, _)| (x - first).abs() < 1e-9) {
        return None;
    }
    let design = DMatrix::from_fn(logs.len(), 2, |i, j| if j == 0 { 1.0 } else { logs[i].0 });
    let right = DVector::from_iterator(logs.len(), logs.iter().map(|(_, y)| *y));
    let fit = design.svd(true, true).solve(&right, 1e-12).ok()?;
    Some(fit[1])
}

/// The powers of one group.
pub fn growth(samples: &[Sample], group: usize) -> Growth {
    let own = || samples.iter().filter(move |s| s.group == group);
    let slope = exponent(own().map(|s| (s.error, s.seconds)));
    Growth {
        order: exponent(own().map(|s| (s.spacing, s.error))),
        work: exponent(own().map(|s| (s.count, s.seconds))),
        halving: slope.filter(|k| *k < 0.0).map(|k| 0.5f64.powf(k)),
    }
}
