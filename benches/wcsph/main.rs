//! Cost of a WCSPH step, as lines `name value unit`; what they say: docs/results/benchmarks.md.
//!
//! `cargo bench --bench wcsph [-- PART ...] [N ...]`. PART: `machine`, `step`, `part`, `effect`,
//! `tension`, `paper` (its tension), `record`, `ranks`; all if none is named. N: sides of the
//! periodic box in particles, 46 and 100 if none is given. A rate is of CPU seconds, so that other
//! programs disturb it little; a line is a median of several repeats, and what a ratio compares is
//! measured in turns.

mod hand;
mod machine;
mod median;
mod meter;
mod pool;
mod ranks;
mod scene;

use coronet::effect::viscosity::TwoTerm;
use coronet::kernel::CubicSpline;
use coronet::method::{Phase, Solver, build};
use hand::{Hand, PARTS, Part};
use median::median;
use meter::{cpu_seconds, line};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::Instant;

/// What is not yet named is run.
const ALL: [&str; 8] = [
    "machine", "step", "part", "effect", "tension", "paper", "record", "ranks",
];

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let named = |part: &str| words.iter().any(|word| word == part);
    let any = ALL.iter().any(|part| named(part));
    let wanted = |part: &str| !any || named(part);
    let mut sides: Vec<usize> = words.iter().filter_map(|word| word.parse().ok()).collect();
    if sides.is_empty() {
        sides = vec![46, 100];
    }
    let threads = [1, 2].map(pool_of);
    if wanted("machine") {
        machine::measure(&threads);
    }
    for &side in &sides {
        if wanted("step") {
            step(side, "paper", &threads);
            step(side, "modern", &threads);
        }
        if wanted("part") {
            parts(side, &threads);
        }
    }
    if wanted("effect") {
        effects_off(sides[0], &threads[0]);
    }
    if wanted("tension") {
        pool::tension(&threads[1]);
    }
    if wanted("paper") {
        pool::paper(&threads[1]);
    }
    if wanted("record") {
        pool::record(&threads[1]);
    }
    if wanted("ranks") {
        ranks::measure(&sides);
    }
}

fn pool_of(threads: usize) -> ThreadPool {
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    builder.build().expect("threads can be started")
}

fn solver(side: usize, preset: &str, viscous: bool) -> Box<dyn Solver> {
    let scene = scene::block(side, preset, viscous);
    let state = scene::state(&scene, side);
    build(&scene, state, Phase::Impact, None).expect("the scene can be built")
}

/// Particle-steps of one advance, CPU seconds, wall seconds.
fn advance(solver: &mut dyn Solver, pool: &ThreadPool) -> [f64; 3] {
    let (from, cpu, wall) = (solver.step_count(), cpu_seconds(), Instant::now());
    pool.install(|| solver.advance(&mut |_| ()))
        .expect("the bench is stable");
    let steps = (solver.step_count() - from) as f64;
    let work = steps * solver.len() as f64;
    [work, cpu_seconds() - cpu, wall.elapsed().as_secs_f64()]
}

/// The whole step with one thread and with two, in turns: five at least where they are short.
fn step(side: usize, preset: &str, threads: &[ThreadPool; 2]) {
    let mut solver = solver(side, preset, true);
    advance(solver.as_mut(), &threads[0]);
    let (mut rates, mut gains) = ([vec![], vec![]], vec![]);
    let (start, mut spent) = (cpu_seconds(), 0.0);
    while spent < 6.0 || gains.len() < 2 || (gains.len() < 5 && spent < 60.0) {
        let speed = [0, 1].map(|k| {
            let [work, cpu, wall] = advance(solver.as_mut(), &threads[k]);
            rates[k].push(work / cpu);
            work / wall
        });
        gains.push(speed[1] / speed[0]);
        spent = cpu_seconds() - start;
    }
    let n = solver.len();
    for k in [0, 1] {
        let name = format!("wcsph.{preset}.step.n{n}.t{}", k + 1);
        line(&name, median(&mut rates[k]), "particle-steps/s/core");
    }
    let name = format!("wcsph.{preset}.two_threads.n{n}");
    line(&name, median(&mut gains), "x_one_thread_wall");
    let (bare, whole) = solver.memory();
    line(&format!("wcsph.{preset}.memory.n{n}"), bare, "B/particle");
    let name = format!("wcsph.{preset}.memory_with_rows.n{n}");
    line(&name, whole, "B/particle");
}

/// Operations of an entry of a row, as counted in the source: separation and square 11, root 1,
/// the value of the spline 10, the sum 1; its slope 13, both terms of Nishio Eq. 5 37.
const DENSITY: f64 = 23.0;
const FORCE: f64 = 62.0;

/// What a target reads and writes beside its row, bytes: a record, and a result of three numbers.
/// Records of neighbours are in a near cache.
const STREAMED: f64 = 44.0;

/// The parts of the step of `paper`, from the hand-written loop.
fn parts(side: usize, threads: &[ThreadPool; 2]) {
    let scene = scene::block(side, "paper", true);
    let viscosity = TwoTerm {
        factor: (scene.effects.mu().unwrap_or(0.0) / scene::smoothing(&scene)) as f32,
    };
    let state = scene::state(&scene, side);
    let mut hand = Hand::<CubicSpline, _>::new(&scene, state.particles, viscosity);
    for (k, pool) in threads.iter().enumerate() {
        pool.install(|| hand.cycle());
        hand.clear();
        let repeats = if side < 64 { 5 } else { 1 };
        (0..repeats).for_each(|_| pool.install(|| hand.cycle()));
        let n = hand.len();
        let work = (hand.steps * n) as f64;
        let name = |part: &str| format!("wcsph.paper.{part}.n{n}.t{}", k + 1);
        for (part, seconds) in PARTS.iter().zip(hand.seconds) {
            let (what, unit) = match part {
                Part::Sort | Part::Rows | Part::Look => {
                    line(
                        &name(&format!("{}_share", part.name())),
                        100.0 * seconds / hand.whole(),
                        "%_of_step",
                    );
                    ((hand.builds * n) as f64, "particles/s/core")
                }
                _ => (work, "particle-steps/s/core"),
            };
            line(&name(part.name()), what / seconds, unit);
        }
        line(
            &name("sum_of_parts"),
            work / hand.whole(),
            "particle-steps/s/core",
        );
        let entries = hand.entries() as f64 / n as f64;
        line(&name("row_entries"), entries, "1/particle");
        for (part, operations) in [(Part::Density, DENSITY), (Part::Force, FORCE)] {
            let rate = 1e-9 * work / hand.seconds[part as usize];
            let name = |what: &str| name(&format!("{}_{what}", part.name()));
            line(&name("arithmetic"), operations * entries * rate, "GFLOP/s");
            line(&name("traffic"), (4.0 * entries + STREAMED) * rate, "GB/s");
        }
        line(
            &name("steps_on_rows"),
            hand.steps as f64 / hand.builds as f64,
            "1",
        );
    }
}

/// The solver of a scene without effects against a loop that never heard of them.
fn effects_off(side: usize, pool: &ThreadPool) {
    let mut solver = solver(side, "paper", false);
    let scene = scene::block(side, "paper", false);
    let state = scene::state(&scene, side);
    let mut hand = Hand::<CubicSpline, ()>::new(&scene, state.particles, ());
    advance(solver.as_mut(), pool);
    pool.install(|| hand.cycle());
    let (mut ratios, mut rates) = (vec![], vec![]);
    for _ in 0..9 {
        let [work, cpu, _] = advance(solver.as_mut(), pool);
        hand.clear();
        pool.install(|| hand.cycle());
        let stripped = (hand.steps * hand.len()) as f64 / hand.whole();
        rates.push(stripped);
        ratios.push(work / cpu / stripped);
    }
    assert_eq!(
        solver.step_count() as usize,
        hand.all_steps,
        "both take the same steps"
    );
    let n = hand.len();
    line(
        &format!("wcsph.stripped.step.n{n}.t1"),
        median(&mut rates),
        "particle-steps/s/core",
    );
    line(
        &format!("wcsph.effects_off.n{n}.t1"),
        median(&mut ratios),
        "x_stripped_rate",
    );
}
