//! What it costs to share a run of the periodic box.
//!
//! Ranks are threads of this process, so that messages cost copies and no network. Traffic is what
//! a rank sends in a step, most of all ranks; the model of it: the particles within a support of
//! its two faces. The speed is that of two ranks with a thread each over one rank with two threads,
//! measured in turns; the memory that of a particle on rank 0 of two over that on a rank alone.

use crate::median::median;
use crate::meter::line;
use crate::scene;
use coronet::method::{Phase, Solver, build_shared, shared};
use coronet::scene::Scene;
use coronet::space::ranks::{Communicator, local};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// A rank that counts what it sends.
struct Counting {
    own: Arc<dyn Communicator>,
    bytes: AtomicU64,
    messages: AtomicU64,
}

impl Communicator for Counting {
    fn rank(&self) -> usize {
        self.own.rank()
    }
    fn size(&self) -> usize {
        self.own.size()
    }
    fn exchange(&self, to: &[(usize, Vec<u8>)], from: &[usize]) -> Vec<Vec<u8>> {
        let bytes: usize = to.iter().map(|(_, bytes)| bytes.len()).sum();
        self.bytes.fetch_add(bytes as u64, Relaxed);
        self.messages.fetch_add(to.len() as u64, Relaxed);
        self.own.exchange(to, from)
    }
}

/// What some advances took.
struct Cost {
    /// Particle-steps a second by the clock, of each advance.
    rates: Vec<f64>,
    /// Bytes and messages of a step, the most that a rank sends.
    bytes: f64,
    messages: f64,
    /// Of one rank, with what the rows take.
    memory: f64,
}

/// Speed at every side, traffic at the first.
pub fn measure(sides: &[usize]) {
    for preset in ["paper", "modern"] {
        for &side in sides {
            speed(side, preset);
        }
        let costs = [1, 2, 4, 8, 16].map(|size| (size as f64, traffic(sides[0], preset, size)));
        weak(sides[0], preset, &costs);
    }
}

/// The network of the extrapolation: bytes a second, and seconds that a message takes.
const BANDWIDTH: f64 = 10e9;
const LATENCY: f64 = 2e-6;

/// Particles of a rank in it, in a cube.
const EACH: f64 = 1e6;

/// Extrapolates to so many ranks with as many particles each, a core for each: work of the one rank
/// that was measured, bytes with the face of a rank, messages with the number of ranks (sums of all
/// go from each to each). Nothing overlaps.
fn weak(side: usize, preset: &str, costs: &[(f64, Cost)]) {
    let (_, alone) = &costs[0];
    let rate = median(&mut alone.rates.clone());
    let face = (EACH.cbrt() / side as f64).powi(2);
    let [(few, a), (many, b)] = [&costs[2], &costs[4]];
    let of_each = (b.messages - a.messages) / (many - few);
    for ranks in [16.0, 128.0, 1024.0] {
        let messages = b.messages + (ranks - many) * of_each;
        let sent = b.bytes * face / BANDWIDTH + messages * LATENCY;
        let part = 1.0 / (1.0 + sent * rate / EACH);
        let name = format!("ranks.{preset}.weak_{ranks}.n{EACH}");
        line(&name, part, "x_one_rank");
    }
}

/// Steps of the periodic box on so many ranks with so many threads each.
fn cost(scene: &Scene, side: usize, [size, threads]: [usize; 2], advances: usize) -> Cost {
    let ranks: Vec<Arc<Counting>> = local::ranks(size)
        .into_iter()
        .map(|own| {
            Arc::new(Counting {
                own,
                bytes: AtomicU64::new(0),
                messages: AtomicU64::new(0),
            })
        })
        .collect();
    let all = &ranks;
    let most = |of: fn(&Counting) -> &AtomicU64| {
        let counts = all.iter().map(|rank| of(rank).swap(0, Relaxed));
        counts.max().unwrap_or(0) as f64
    };
    let run = |rank: usize| {
        let with: Arc<dyn Communicator> = all[rank].clone();
        let state = (rank == 0).then(|| scene::state(scene, side));
        let built = build_shared(&with, scene, state, Phase::Impact, None);
        let mut solver = built.expect("the scene can be shared");
        if rank > 0 {
            shared::serve(solver, &*with);
            return None;
        }
        advance(&mut *solver);
        let (mut rates, mut steps) = (Vec::new(), 0.0);
        most(|rank| &rank.bytes);
        most(|rank| &rank.messages);
        for _ in 0..advances {
            let (taken, seconds) = advance(&mut *solver);
            steps += taken;
            rates.push(taken * solver.len() as f64 / seconds);
        }
        Some(Cost {
            rates,
            bytes: most(|rank| &rank.bytes) / steps,
            messages: most(|rank| &rank.messages) / steps,
            memory: solver.memory().1,
        })
    };
    std::thread::scope(|scope| {
        let run = &run;
        let parts: Vec<_> = (0..size)
            .map(|rank| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let pool = pool.expect("threads can be started");
                scope.spawn(move || pool.install(|| run(rank)))
            })
            .collect();
        let mut found = parts
            .into_iter()
            .map(|part| part.join().expect("a rank ends"));
        let first = found.next().flatten();
        found.for_each(drop);
        first.expect("rank 0 has the solver")
    })
}

/// Steps and seconds by the clock.
fn advance(solver: &mut dyn Solver) -> (f64, f64) {
    let (from, start) = (solver.step_count(), Instant::now());
    solver.advance(&mut |_| ()).expect("the bench is stable");
    let steps = (solver.step_count() - from) as f64;
    (steps, start.elapsed().as_secs_f64())
}

fn speed(side: usize, preset: &str) {
    let scene = scene::block(side, preset, true);
    let advances = if side < 64 { 5 } else { 2 };
    let mut share = 0.0;
    let mut gains: Vec<f64> = (0..3)
        .map(|_| {
            let [mut one, mut two] = [[1, 2], [2, 1]].map(|on| cost(&scene, side, on, advances));
            share = two.memory / one.memory;
            median(&mut two.rates) / median(&mut one.rates)
        })
        .collect();
    let name = |what: &str| format!("ranks.{preset}.{what}.n{}", side.pow(3));
    line(&name("two_over_one"), median(&mut gains), "x_two_threads");
    line(&name("memory_over_share_of_2"), share, "1");
}

fn traffic(side: usize, preset: &str, size: usize) -> Cost {
    let scene = scene::block(side, preset, true);
    let found = cost(&scene, side, [size, 1], 2);
    let n = side.pow(3);
    let name = |what: &str| format!("ranks.{preset}.{what}_of_{size}.n{n}");
    line(&name("traffic"), 1e-6 * found.bytes, "MB/step");
    let reach = 2.0 * scene::smoothing(&scene) / scene.spacing;
    let ghosts = 2.0 * reach * (side * side) as f64;
    line(&name("traffic_over_ghosts"), found.bytes / ghosts, "B/step");
    line(&name("messages"), found.messages, "1/step");
    line(&name("memory"), found.memory, "B/particle");
    found
}
