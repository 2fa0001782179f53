//! What accuracy costs: which of several runs nobody beats, and the powers by which error and cost
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
    /// What the run cost: seconds, or memory.
    pub cost: f64,
}

/// How error and cost of a group grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// p of error ~ s0^p.
    pub order: Option<f64>,
    /// q of cost ~ N^q.
    pub work: Option<f64>,
    /// Cost after over cost before the error is halved.
    pub halving: Option<f64>,
}

/// Marks the samples that no other beats: none has at most the same error and cost, and less of
/// one (the Pareto front). Samples of unknown error are on no front.
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

/// Of samples of one group and spacing, which repeat each other, the one with the largest error:
/// indices, in order. Of what repeats a failure, none.
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

/// Settings that should meet an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The sample that it is taken from: the coarsest of its group that meets the error, as do all
    /// finer ones.
    pub sample: usize,
    /// The next coarser sample, which does not.
    pub coarser: Option<usize>,
    /// Largest spacing that should meet the error, m.
    pub spacing: f64,
}

/// What each group offers to meet `error`: the coarsest sample from which on all meet it, and where
/// between that and the next coarser one ln error, taken as linear in ln spacing, passes it. One
/// lucky sample among worse ones counts for nothing.
pub fn meeting(samples: &[Sample], error: f64) -> Vec<Choice> {
    let groups = samples.iter().map(|s| s.group + 1).max().unwrap_or(0);
    let choose = |group: usize| {
        let known = |k: &usize| samples[*k].group == group && samples[*k].error.is_finite();
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

/// Where ln x lies between ln a (0) and ln b (1); 0 if there is no telling.
fn ratio(x: f64, a: f64, b: f64) -> f64 {
    let part = (x / a).ln() / (b / a).ln();
    if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        0.0
    }
}
