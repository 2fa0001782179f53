//! The cost of accuracy: the Pareto front of several runs, and the powers of error and cost.

use nalgebra::{DMatrix, DVector};

/// One run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Runs of one group differ only in their spacing.
    pub group: usize,
    /// Particle spacing s0, m.
    pub spacing: f64,
    /// Number of particles.
    pub count: f64,
    /// Relative error; `NaN` if unknown.
    pub error: f64,
    /// Cost of the run: time or memory.
    pub cost: f64,
}

/// Powers of error and cost of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// p of error ~ s0^p.
    pub order: Option<f64>,
    /// q of cost ~ N^q.
    pub work: Option<f64>,
    /// Factor of the cost when the error is halved.
    pub halving: Option<f64>,
}

/// Marks the Pareto front: samples for which no other one has at most the same error and cost, and
/// less of one. Samples of unknown error are not on the front.
pub fn front(samples: &[Sample]) -> Vec<bool> {
    let beats = |a: &Sample, b: &Sample| {
        let no_worse = a.error <= b.error && a.cost <= b.cost;
        no_worse && (a.error < b.error || a.cost < b.cost)
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

/// Of samples of one group and spacing, which repeat each other, the one with the largest error; an
/// unknown error counts as the largest. Indices, in order.
pub fn worst(samples: &[Sample]) -> Vec<usize> {
    let beats = |a: usize, b: usize| {
        let (first, second) = (&samples[a], &samples[b]);
        let same = first.group == second.group && first.spacing == second.spacing;
        let error = |s: &Sample| {
            if s.error.is_nan() {
                f64::INFINITY
            } else {
                s.error
            }
        };
        let order = error(first).total_cmp(&error(second));
        same && (order.is_gt() || (order.is_eq() && a < b))
    };
    let all = 0..samples.len();
    all.clone()
        .filter(|k| !all.clone().any(|other| other != *k && beats(other, *k)))
        .collect()
}

/// The powers of one group.
pub fn growth(samples: &[Sample], group: usize) -> Growth {
    let worst = worst(samples);
    let own = || {
        worst
            .iter()
            .map(|k| &samples[*k])
            .filter(move |s| s.group == group)
    };
    let slope = exponent(own().map(|s| (s.error, s.cost)));
    Growth {
        order: exponent(own().map(|s| (s.spacing, s.error))),
        work: exponent(own().map(|s| (s.count, s.cost))),
        halving: slope.filter(|k| *k < 0.0).map(|k| 0.5f64.powf(k)),
    }
}

/// Settings that are expected to meet an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Its base: the coarsest sample of its group that, with all finer ones, meets the error.
    pub sample: usize,
    /// The next coarser sample, which does not meet it.
    pub coarser: Option<usize>,
    /// Largest spacing that is expected to meet the error, m.
    pub spacing: f64,
}

/// The choice of each group to meet `error`: the coarsest sample that meets it together with all
/// finer ones, and the spacing between that and the next coarser one where ln error, linear in ln
/// spacing, reaches it. An unknown error (NaN) is left out, an infinite one is of a run that
/// failed. A single good sample among worse ones does not count.
pub fn meeting(samples: &[Sample], error: f64) -> Vec<Choice> {
    let groups = samples.iter().map(|s| s.group + 1).max().unwrap_or(0);
    let choose = |group: usize| {
        let known = |k: &usize| samples[*k].group == group && !samples[*k].error.is_nan();
        let mut own: Vec<usize> = (0..samples.len()).filter(known).collect();
        own.sort_by(|a, b| samples[*a].spacing.total_cmp(&samples[*b].spacing));
        let good = own.iter().take_while(|k| samples[**k].error <= error);
        let count = good.count();
        let sample = *own.get(count.checked_sub(1)?)?;
        let coarser = own.get(count).copied();
        let spacing = coarser.map_or(samples[sample].spacing, |coarser| {
            let (fine, coarse) = (&samples[sample], &samples[coarser]);
            let part = ratio(error, fine.error, coarse.error);
            fine.spacing * (coarse.spacing / fine.spacing).powf(part)
        });
        Some(Choice {
            sample,
            coarser,
            spacing,
        })
    };
    (0..groups).filter_map(choose).collect()
}

/// Error and cost at `spacing`, m, between the samples of a choice, by powers of it.
pub fn predict(samples: &[Sample], choice: &Choice, spacing: f64) -> (f64, f64) {
    let fine = &samples[choice.sample];
    let Some(coarse) = choice.coarser.map(|k| &samples[k]) else {
        return (fine.error, fine.cost);
    };
    let part = ratio(spacing, fine.spacing, coarse.spacing);
    let between = |a: f64, b: f64| if a > 0.0 { a * (b / a).powf(part) } else { b };
    (
        between(fine.error, coarse.error),
        between(fine.cost, coarse.cost),
    )
}

/// Position of ln x between ln a (0) and ln b (1); 0 if it is undetermined.
fn ratio(x: f64, a: f64, b: f64) -> f64 {
    let part = (x / a).ln() / (b / a).ln();
    if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        0.0
    }
}
