//! The pressure equation's solvers, on equations of jittered clouds of particles.

use super::cloud::{Cloud, OPEN, PERIODIC};
use coronet::kernel::WendlandC2;
use coronet::method::isph::pass::{Coupled, Weights};
use coronet::method::pressure::multigrid::Domain;
use coronet::method::pressure::{Equation, Outcome, Rows, Solver};
use coronet::scene::{Dimension, Preconditioner};
use nalgebra::{DMatrix, DVector};
use std::marker::PhantomData;

const ALL: [Preconditioner; 4] = [
    Preconditioner::None,
    Preconditioner::Diagonal,
    Preconditioner::Ssor,
    Preconditioner::Multigrid,
];

/// h / s0.
const SMOOTHING: f64 = 1.5;

/// A cube of `side` spacings, free or periodic all around, and where its grids lie. A free one has
/// p = 0 beyond its sides: what its supports lack.
fn equation(dimension: Dimension, side: f64, periodic: bool) -> (Equation, Domain) {
    let depth = if dimension == Dimension::Two {
        0.0
    } else {
        side
    };
    let sides = if periodic { PERIODIC } else { OPEN };
    let cells = [side, depth, side];
    let mut cloud = Cloud::new(dimension, cells, sides, [SMOOTHING, 0.2], |_| true);
    let like = Coupled {
        density: 1.0,
        volume: 1.0,
        offset: 0.0,
    };
    cloud.flow.pack(|_, _| like, |_, _| Coupled::default());
    let flow = &cloud.flow;
    let layout = cloud.layout();
    let (mut e, mut sums) = (Equation::default(), Vec::new());
    let weights = Weights::<WendlandC2, false>(PhantomData);
    e.coupling
        .build(&layout, &weights, &mut e.diagonal, &mut sums);
    let (n, d) = (flow.liquid(), dimension.count() as f64);
    let full = e.diagonal.iter().fold(0.0f64, |a, b| a.max(*b));
    let lack = |degree: &f64| {
        if periodic {
            0.0
        } else {
            2.0 * (0.9 * full - degree).max(0.0)
        }
    };
    e.surface = e.diagonal.iter().map(lack).collect();
    e.diagonal
        .iter_mut()
        .zip(&e.surface)
        .for_each(|(d, s)| *d += s);
    e.share = sums
        .iter()
        .map(|s| s[0] as f64 * cloud.h * cloud.h / (2.0 * d))
        .collect();
    e.place = flow.particles.position.clone();
    e.right = (0..n).map(|_| cloud.random.signed()).collect();
    let domain = Domain {
        active: [true, dimension == Dimension::Three, true],
        periodic: flow.grid.periodic,
        size: flow.domain.size,
        pitch: 2.0 * cloud.h,
    };
    (e, domain)
}

/// A solver that knows the equation.
fn prepared(e: &Equation, domain: &Domain) -> Solver {
    let mut solver = Solver::default();
    solver.prepare(e, domain);
    solver
}

fn solve(e: &mut Equation, domain: &Domain, with: Preconditioner) -> (Vec<f64>, Outcome) {
    let mut x = vec![0.0; e.len()];
    let outcome = prepared(e, domain).solve(e, &mut Rows, with, (1e-8, 2000), &mut x);
    (x, outcome)
}

/// Largest difference over the largest value.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(0.0f64, |m, b| m.max(b.abs()));
    let worst = a
        .iter()
        .zip(b)
        .fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    worst / scale
}

#[test]
fn couplings_are_symmetric() {
    let (e, _) = equation(Dimension::Three, 9.0, true);
    for i in 0..e.len() {
        for (j, w) in e.coupling.row(i) {
            let (_, same) = e.coupling.row(j).find(|(k, _)| *k == i).unwrap();
            assert_eq!(same.to_bits(), w.to_bits());
        }
    }
}

#[test]
fn every_preconditioner_leads_to_the_dense_solution() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let side = if dimension == Dimension::Two {
            20.0
        } else {
            8.0
        };
        let (mut e, domain) = equation(dimension, side, false);
        let n = e.len();
        let mut dense = DMatrix::<f64>::zeros(n, n);
        for i in 0..n {
            dense[(i, i)] = e.diagonal[i];
            for (j, w) in e.coupling.row(i) {
                dense[(i, j)] -= w as f64;
            }
        }
        let right = DVector::from_column_slice(&e.right);
        let exact = dense.cholesky().expect("positive definite").solve(&right);
        for with in ALL {
            let (x, outcome) = solve(&mut e, &domain, with);
            assert!(outcome.converged, "{with:?} {outcome:?}");
            let error = apart(&x, exact.as_slice());
            assert!(error < 1e-6, "{with:?} {error:e}");
        }
    }
}

/// An equation whose solution is known: b = A x.
#[test]
fn a_smooth_solution_is_found_again() {
    let (mut e, domain) = equation(Dimension::Three, 16.0, false);
    let length = domain.pitch * 16.0 / (2.0 * SMOOTHING);
    let wave = |i: usize| {
        (0..3)
            .map(|a| (std::f64::consts::PI * e.place[a][i] / length).sin())
            .product::<f64>()
    };
    let known: Vec<f64> = (0..e.len()).map(wave).collect();
    e.right = (0..e.len()).map(|i| e.row(i, &known)).collect();
    for with in ALL {
        let (x, outcome) = solve(&mut e, &domain, with);
        assert!(outcome.converged && apart(&x, &known) < 1e-6, "{with:?}");
    }
    // From the solution itself there is nothing to do.
    let mut x = known.clone();
    let with = Preconditioner::Multigrid;
    let again = prepared(&e, &domain).solve(&mut e, &mut Rows, with, (1e-8, 10), &mut x);
    assert_eq!(again.iterations, 0);
}

#[test]
fn multigrid_takes_as_many_iterations_at_every_size() {
    for periodic in [false, true] {
        let count = |side: f64, with| {
            let (mut e, domain) = equation(Dimension::Three, side, periodic);
            let mut x = vec![0.0; e.len()];
            let outcome =
                prepared(&e, &domain).solve(&mut e, &mut Rows, with, (1e-6, 2000), &mut x);
            assert!(outcome.converged);
            outcome.iterations
        };
        let sides = [10.0, 20.0, 40.0];
        let [a, b, c] = sides.map(|side| count(side, Preconditioner::Multigrid));
        assert!(a.max(b).max(c) <= 15, "{periodic}: {a} {b} {c}");
        assert!(c as f64 <= 1.3 * a.max(8) as f64, "{periodic}: {a} {b} {c}");
        let plain = count(40.0, Preconditioner::Diagonal);
        assert!(plain > 2 * c, "{periodic}: {plain} without, {c} with");
    }
}

#[test]
fn threads_change_no_bit_of_a_solution() {
    for with in ALL {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let (mut e, domain) = equation(Dimension::Three, 18.0, false);
                let (x, outcome) = solve(&mut e, &domain, with);
                (x.iter().map(|x| x.to_bits()).collect::<Vec<_>>(), outcome)
            })
        };
        let one = on(1);
        assert!(one == on(2) && one == on(4), "{with:?}");
    }
}

#[test]
fn an_enclosed_liquid_has_a_pressure_of_zero_mean() {
    let (mut e, domain) = equation(Dimension::Three, 12.0, true);
    assert!(e.is_enclosed());
    // A right-hand side with a mean has no solution: the mean goes.
    e.right.iter_mut().for_each(|b| *b += 3.0);
    for with in ALL {
        let (x, outcome) = solve(&mut e, &domain, with);
        assert!(outcome.converged, "{with:?} {outcome:?}");
        assert!(
            (x.iter().sum::<f64>() / x.len() as f64).abs() < 1e-9,
            "{with:?}"
        );
    }
}

#[test]
fn too_few_iterations_are_told() {
    let (mut e, domain) = equation(Dimension::Three, 12.0, false);
    let mut x = vec![0.0; e.len()];
    let with = Preconditioner::Diagonal;
    let outcome = prepared(&e, &domain).solve(&mut e, &mut Rows, with, (1e-10, 3), &mut x);
    assert!(!outcome.converged && outcome.iterations == 3 && outcome.residual > 1e-10);
    let nothing = vec![0.0; e.len()];
    e.right.copy_from_slice(&nothing);
    let outcome = prepared(&e, &domain).solve(&mut e, &mut Rows, with, (1e-10, 3), &mut x);
    assert!(outcome.converged && x == nothing);
}
