//! What accuracy costs.

use coronet::measure::tradeoff::{Sample, exponent, front, growth, meeting, predict, worst};

fn sample(group: usize, spacing: f64, error: f64, seconds: f64) -> Sample {
    let count = spacing.powi(-3);
    Sample {
        group,
        spacing,
        count,
        error,
        cost: seconds,
    }
}

/// error = 2 s0^1.5, time = 3 N^1.25: a halving costs 2^(3 x 1.25 / 1.5).
#[test]
fn powers_are_found() {
    let run = |s: f64| sample(0, s, 2.0 * s.powf(1.5), 3.0 * s.powf(-3.75));
    let mut samples: Vec<Sample> = [0.1, 0.2, 0.4].map(run).to_vec();
    samples.push(sample(1, 0.1, 0.5, 7.0));
    let found = growth(&samples, 0);
    assert!((found.order.unwrap() - 1.5).abs() < 1e-9);
    assert!((found.work.unwrap() - 1.25).abs() < 1e-9);
    assert!((found.halving.unwrap() - 2f64.powf(2.5)).abs() < 1e-9);
    // One run tells no power.
    assert_eq!(growth(&samples, 1).order, None);
    assert_eq!(
        exponent([(1.0, 2.0), (1.0, 3.0), (-1.0, 2.0)].into_iter()),
        None
    );
}

#[test]
fn the_front_is_whom_nobody_beats() {
    let runs = [
        (0.10, 1.0),
        (0.05, 4.0),
        (0.06, 5.0),
        (0.05, 4.0),
        (f64::NAN, 0.5),
        (0.2, 1.0),
    ];
    let samples: Vec<Sample> = runs.map(|(e, t)| sample(0, 1.0, e, t)).to_vec();
    assert_eq!(front(&samples), [true, true, false, true, false, false]);
}

#[test]
fn of_what_repeats_the_worst_counts() {
    let runs = [(0.10, 1.0), (0.30, 1.1), (0.20, 1.2)];
    let mut samples: Vec<Sample> = runs.map(|(e, t)| sample(0, 0.2, e, t)).to_vec();
    samples.push(sample(0, 0.1, 0.1, 9.0));
    samples.push(sample(1, 0.2, 0.05, 2.0));
    assert_eq!(worst(&samples), [1, 3, 4]);
    let order = growth(&samples, 0).order.unwrap();
    assert!((order - 3f64.log2()).abs() < 1e-9, "{order}");
    // A failure is worse than any error, and of equals the first counts.
    samples.push(sample(1, 0.2, f64::NAN, 2.0));
    samples.push(sample(0, 0.1, 0.1, 8.0));
    assert_eq!(worst(&samples), [1, 3, 5]);
}

#[test]
fn settings_between_two_samples_are_predicted() {
    // error = 10 s0^2, time = s0^-4; a lucky coarse run in front.
    let run = |s: f64| sample(0, s, 10.0 * s * s, s.powi(-4));
    let mut samples: Vec<Sample> = [0.4, 0.2, 0.1, 0.05].map(run).to_vec();
    samples.push(sample(0, 0.8, 1e-3, 1.0));
    samples.push(sample(1, 0.1, 0.9, 1.0));
    let found = meeting(&samples, 0.225);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].sample, found[0].coarser), (2, Some(1)));
    assert!((found[0].spacing - 0.15).abs() < 1e-12);
    let (error, seconds) = predict(&samples, &found[0], 0.15);
    assert!((error - 0.225).abs() < 1e-12);
    assert!((seconds / 0.15f64.powi(-4) - 1.0).abs() < 1e-9);
    // What no run meets, and what the coarsest meets.
    assert!(meeting(&samples, 0.01).is_empty());
    let all = meeting(&samples, 2.0);
    assert_eq!((all[0].sample, all[0].coarser), (4, None));
    assert_eq!(predict(&samples, &all[0], 0.8), (1e-3, 1.0));
}
