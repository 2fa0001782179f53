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
use std::time::{Duration, Instant};

/// A rank that counts what it sends.
struct Counting {
    own: Arc<dyn Communicator>,
    bytes: AtomicU64,
    /// Of these, what goes beside work.
    beside: AtomicU64,
    messages: AtomicU64,
}

impl Communicator for Counting {
    fn rank(&self) -> usize {
        self.own.rank()
    }
    fn size(&self) -> usize {
        self.own.size()
    }
    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        let bytes = to.iter().map(|(_, bytes)| bytes.len() as u64).sum();
        self.bytes.fetch_add(bytes, Relaxed);
        self.messages.fetch_add(to.len() as u64, Relaxed);
        // Ghosts are of a known length.
        if from.iter().any(|(_, size)| size.is_some()) {
            self.beside.fetch_add(bytes, Relaxed);
        }
        self.own.exchange_while(to, from, meanwhile)
    }
}

/// What a message takes in [`Late`].
const DELAY: Duration = Duration::from_millis(1);

/// A rank that gets what others send only [`DELAY`] later.
struct Late {
    own: Arc<dyn Communicator>,
    /// When all ranks began to count.
    since: Instant,
    /// Whether work goes on meanwhile.
    overlaps: bool,
}

impl Late {
    fn stamped(&self, to: &[(usize, Vec<u8>)]) -> Vec<(usize, Vec<u8>)> {
        let now = (self.since.elapsed().as_nanos() as u64).to_le_bytes();
        let to = to.iter();
        to.map(|(rank, bytes)| (*rank, [&now, &bytes[..]].concat()))
            .collect()
    }

    fn arrived(&self, all: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
        let open = |mut bytes: Vec<u8>| {
            let rest = bytes.split_off(8);
            let sent = u64::from_le_bytes(bytes.try_into().expect("8 bytes"));
            let due = self.since + Duration::from_nanos(sent) + DELAY;
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            rest
        };
        all.into_iter().map(open).collect()
    }
}

impl Communicator for Late {
    fn rank(&self) -> usize {
        self.own.rank()
    }
    fn size(&self) -> usize {
        self.own.size()
    }
    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        if !self.overlaps {
            meanwhile();
        }
        let to = self.stamped(to);
        let from = from
            .iter()
            .map(|(rank, size)| (*rank, size.map(|size| size + 8)));
        let from: Vec<_> = from.collect();
        let all = self.own.exchange_while(&to, &from, &mut || {
            if self.overlaps {
                meanwhile();
            }
        });
        self.arrived(all)
    }
}

/// What some advances took.
struct Cost {
    /// Particle-steps a second by the clock, of each advance.
    rates: Vec<f64>,
    /// Bytes, those of them that go beside work, and messages of a step, the most of a rank.
    bytes: f64,
    beside: f64,
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
        overlap(sides[0], preset);
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
/// that was measured; what ghosts send grows with the face of a rank, the rest, mostly sums over
/// chunks of all particles, with their number; messages with the binary digits of the number of
/// ranks. Nothing overlaps.
fn weak(side: usize, preset: &str, costs: &[(f64, Cost)]) {
    let (_, alone) = &costs[0];
    let rate = median(&mut alone.rates.clone());
    let face = (EACH.cbrt() / side as f64).powi(2);
    let [(few, a), (many, b)] = [&costs[2], &costs[4]];
    let of_each = (b.messages - a.messages) / (many / few).log2();
    for ranks in [16.0, 128.0, 1024.0] {
        let messages = b.messages + (ranks / many).log2() * of_each;
        let of_sums = (b.bytes - b.beside) * ranks * EACH / (side as f64).powi(3);
        let sent = (b.beside * face + of_sums) / BANDWIDTH + messages * LATENCY;
        let part = 1.0 / (1.0 + sent * rate / EACH);
        let name = format!("ranks.{preset}.weak_{ranks}.n{EACH}");
        line(&name, part, "x_one_rank");
    }
}

/// So many ranks that know each other; `late`: as [`cost`] has it.
fn counting(size: usize, late: Option<bool>) -> Vec<Arc<Counting>> {
    let since = Instant::now();
    let counting = |own: Arc<local::Local>| {
        let own: Arc<dyn Communicator> = match late {
            None => own,
            Some(overlaps) => Arc::new(Late {
                own,
                since,
                overlaps,
            }),
        };
        Arc::new(Counting {
            own,
            bytes: AtomicU64::new(0),
            beside: AtomicU64::new(0),
            messages: AtomicU64::new(0),
        })
    };
    local::ranks(size).into_iter().map(counting).collect()
}

/// Steps of the periodic box on so many ranks with so many threads each; `late`: messages are, and
/// work goes on meanwhile or not.
fn cost(
    scene: &Scene,
    side: usize,
    [size, threads]: [usize; 2],
    (advances, late): (usize, Option<bool>),
) -> Cost {
    let ranks = counting(size, late);
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
        most(|rank| &rank.beside);
        most(|rank| &rank.messages);
        for _ in 0..advances {
            let (taken, seconds) = advance(&mut *solver);
            steps += taken;
            rates.push(taken * solver.len() as f64 / seconds);
        }
        Some(Cost {
            rates,
            bytes: most(|rank| &rank.bytes) / steps,
            beside: most(|rank| &rank.beside) / steps,
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
            let [mut one, mut two] =
                [[1, 2], [2, 1]].map(|on| cost(&scene, side, on, (advances, None)));
            share = two.memory / one.memory;
            median(&mut two.rates) / median(&mut one.rates)
        })
        .collect();
    let name = |what: &str| format!("ranks.{preset}.{what}.n{}", side.pow(3));
    line(&name("two_over_one"), median(&mut gains), "x_two_threads");
    line(&name("memory_over_share_of_2"), share, "1");
}

/// The speed of two ranks with a thread each whose messages are late, over that without delay: with
/// other work meanwhile, and without.
fn overlap(side: usize, preset: &str) {
    let scene = scene::block(side, preset, true);
    let turns = || {
        [None, Some(true), Some(false)].map(|late| {
            let mut found = cost(&scene, side, [2, 1], (5, late));
            median(&mut found.rates)
        })
    };
    let all: Vec<[f64; 3]> = (0..3).map(|_| turns()).collect();
    for (k, name) in [(1, "late"), (2, "late_alone")] {
        let mut parts: Vec<f64> = all.iter().map(|rates| rates[k] / rates[0]).collect();
        let name = format!("ranks.{preset}.{name}.n{}", side.pow(3));
        line(&name, median(&mut parts), "x_at_once");
    }
}

fn traffic(side: usize, preset: &str, size: usize) -> Cost {
    let scene = scene::block(side, preset, true);
    let found = cost(&scene, side, [size, 1], (2, None));
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
