//! Cost of the pressure of ISPH, as lines `name value unit`; see docs/results/benchmarks.md.
//!
//! `cargo bench --bench isph [-- SPACING ...]`, in mm; 1.15, 0.54 and 0.25 if none is given: 1e4,
//! 1e5 and 1e6 particles. The equation is that of the default scene on a lattice, its drop 0.3 ms
//! in the pool, solved from zero to 1e-6 in turns. Seconds are of CPU time.

#[path = "wcsph/machine.rs"]
mod machine;
#[path = "wcsph/median.rs"]
mod median;
#[path = "wcsph/meter.rs"]
mod meter;

use coronet::method::pressure::multigrid::Domain;
use coronet::method::pressure::{Equation, Outcome, Rows, Solver as PressureSolver};
use coronet::method::{Phase, Solver, build, calibrate, initial};
use coronet::particle::Particles;
use coronet::particle::pack::pack;
use coronet::scene::{Preconditioner, file};
use coronet::space::parallel::{Slots, each};
use median::median;
use meter::{cpu_seconds, line};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

const TOLERANCE: f64 = 1e-6;
const MOST: usize = 5000;

/// Simulated time from the first touch, s.
const INTO: f64 = 0.3e-3;

fn main() {
    let words = std::env::args().skip(1);
    let mut spacings: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
    if spacings.is_empty() {
        spacings = vec![1.15, 0.54, 0.25];
    }
    let [_, triad] = machine::measure(&[1, 2].map(pool));
    for spacing in spacings {
        let mut solver = impact(spacing);
        let n = solver.len();
        step(solver.as_mut());
        let (equation, domain) = solver.equation().expect("ISPH has a pressure equation");
        solve(equation, &domain, n);
        product(equation, n, triad);
    }
}

fn pool(threads: usize) -> ThreadPool {
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("threads can be started")
}

/// The default scene at a spacing, mm, shortly after the drop touched the pool.
fn impact(spacing: f64) -> Box<dyn Solver> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipeline.toml");
    // Periodic sides are whole spacings.
    let size = (40.0 / spacing).round() * spacing;
    let sets = [
        "method.name=isph".to_string(),
        "pack.arrangement=lattice".to_string(),
        format!("pack.spacing={spacing} mm"),
        format!("box.size=['{size} mm', '{size} mm', '30 mm']"),
        format!("body.drop.sphere.gap={spacing} mm"),
    ];
    let loaded = file::load(&path, &sets).unwrap_or_else(|error| panic!("{error}"));
    let scene = loaded.scene;
    let place = |body: usize| {
        let packed = pack(&scene.pack_input(body), &mut |_| ControlFlow::Continue(()));
        let mut particles = packed.expect("a lattice can be placed").0;
        particles.body.fill(body as u8);
        particles
    };
    let bodies: Vec<Particles> = (0..scene.bodies.len()).map(place).collect();
    let input = scene.calibrate_input().expect("the scene has tension");
    let strength = calibrate(&input.bodies, &bodies).expect("the pool has a surface");
    let state = initial(&scene.impact_input(), &bodies);
    let built = build(&scene, state, Phase::Impact, Some(strength.strength));
    let mut solver = built.expect("the scene can be built");
    let touch = 1e-3 * spacing / 3.13;
    while solver.time() < touch + INTO {
        advance(solver.as_mut());
    }
    solver
}

fn advance(solver: &mut dyn Solver) {
    solver.advance(&mut |_| ()).expect("the bench is stable");
}

/// CPU and wall seconds of whole steps.
fn step(solver: &mut dyn Solver) {
    let (mut cpu, mut wall) = (Vec::new(), Vec::new());
    for _ in 0..3 {
        let (c, w) = (cpu_seconds(), Instant::now());
        advance(solver);
        cpu.push(cpu_seconds() - c);
        wall.push(w.elapsed().as_secs_f64());
    }
    let n = solver.len();
    line(&format!("isph.step.cpu.n{n}"), median(&mut cpu), "s");
    line(&format!("isph.step.wall.n{n}"), median(&mut wall), "s");
    let (bare, whole) = solver.memory();
    line(&format!("isph.memory.n{n}"), bare, "B/particle");
    line(&format!("isph.memory_with_rows.n{n}"), whole, "B/particle");
}

/// Iterations and seconds, set-up included, of each preconditioner.
fn solve(equation: &mut Equation, domain: &Domain, n: usize) {
    let mut seconds = Vec::new();
    for (name, with) in [
        ("diagonal", Preconditioner::Diagonal),
        ("ssor", Preconditioner::Ssor),
        ("multigrid", Preconditioner::Multigrid),
    ] {
        let (mut times, mut last) = (Vec::new(), Outcome::default());
        for _ in 0..3 {
            let (mut x, mut solver) = (vec![0.0; equation.len()], PressureSolver::default());
            let from = cpu_seconds();
            if with == Preconditioner::Multigrid {
                solver.prepare(equation, domain);
            }
            last = solver.solve(equation, &mut Rows, with, (TOLERANCE, MOST), &mut x);
            times.push(cpu_seconds() - from);
        }
        assert!(last.converged, "{name}: residual {:.2e}", last.residual);
        let name = format!("isph.pressure.{name}");
        let iterations = format!("{name}.iterations.n{n}");
        line(&iterations, last.iterations as f64, "iterations");
        let time = median(&mut times);
        line(&format!("{name}.cpu.n{n}"), time, "s");
        seconds.push(time);
    }
    let name = format!("isph.pressure.multigrid.gain.n{n}");
    line(&name, seconds[0] / seconds[2], "x_diagonal_cpu");
}

/// Bandwidth of the product of matrix and vector, by the bytes it must move: weight and index of
/// each coupling; diagonal, vector and image of each unknown.
fn product(equation: &Equation, n: usize, triad: f64) {
    let x = vec![1.0f64; equation.len()];
    let mut y = vec![0.0f64; equation.len()];
    let bytes = 8 * equation.coupling.entries() + 24 * equation.len();
    let mut times: Vec<f64> = (0..9)
        .map(|_| {
            let (out, start) = (Slots::new(&mut y), Instant::now());
            // SAFETY: every item is visited once.
            each(x.len(), |i| *unsafe { out.at(i) } = equation.row(i, &x));
            start.elapsed().as_secs_f64()
        })
        .collect();
    let rate = 1e-9 * bytes as f64 / median(&mut times);
    line(&format!("isph.pressure.product.n{n}"), rate, "GB/s");
    let name = format!("isph.pressure.product_of_triad.n{n}");
    line(&name, 100.0 * rate / triad, "%");
}
