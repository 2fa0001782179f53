//! What tension, and what logging and checkpoints cost in the default scene, a drop on a pool of
//! 128,000 particles, and what the tension of Nishio et al. costs in theirs, of a million; placed
//! on a lattice.

use crate::median::median;
use crate::meter::{cpu_seconds, line};
use crate::{advance, scene};
use coronet::method::{Phase, Solver, build};
use coronet::particle::{State, wall};
use coronet::record::Checkpoint;
use coronet::record::background::CheckpointWriter;
use coronet::record::checkpoint::LEVEL;
use coronet::record::log::{self, LogSetup, LogWriter};
use rayon::ThreadPool;
use std::time::Instant;

/// Simulated time of a deep crater with a crown, s.
const CRATER: f64 = 10e-3;

/// Wall seconds between rolling checkpoints: the default of `impact.checkpoint_every`.
const EVERY: f64 = 30.0;

/// Solver of the pool without and with tension, from `state` or from the start.
fn pair(of: &[&str], state: Option<&State>) -> [Box<dyn Solver>; 2] {
    [false, true].map(|tension| {
        let (scene, start, strength) = scene::pool(of, tension);
        let state = state.cloned().unwrap_or(start);
        build(&scene, state, Phase::Impact, strength).expect("the scene can be built")
    })
}

/// What tension adds to a step and to a simulated second: before the impact and with a crater.
pub fn tension(pool: &ThreadPool) {
    let mut solver = pool.install(|| pair(&scene::DEFAULT, None));
    compare("start", &mut solver, pool);
    let [_, mut with] = solver;
    while with.time() < CRATER {
        advance(with.as_mut(), pool);
    }
    let state = with.state();
    let mut solver = pool.install(|| pair(&scene::DEFAULT, Some(&state)));
    compare("crater", &mut solver, pool);
}

/// A step of the pool of Nishio et al., without their tension, with it and with it held.
pub fn paper(pool: &ThreadPool) {
    let [without, with] = pool.install(|| pair(&scene::NISHIO, None));
    let [_, held] = pool.install(|| pair(&scene::HELD, None));
    let mut solver = [without, with, held];
    for solver in solver.iter_mut() {
        advance(solver.as_mut(), pool);
    }
    let (mut rates, mut ratios) = ([vec![], vec![], vec![]], [vec![], vec![], vec![]]);
    for _ in 0..5 {
        let now = [0, 1, 2].map(|k| {
            let [work, cpu, _] = advance(solver[k].as_mut(), pool);
            work / cpu
        });
        for k in 0..3 {
            rates[k].push(now[k]);
            ratios[k].push(now[k] / now[0]);
        }
    }
    let n = solver[0].len();
    for (k, what) in ["no_tension", "tension", "held_tension"].iter().enumerate() {
        let name = format!("wcsph.paper.pool.{what}.n{n}");
        line(&name, median(&mut rates[k]), "particle-steps/s/core");
        line(&name, median(&mut ratios[k]), "x_rate_without");
    }
}

/// Few steps: without tension a crater that tension made soon sheds spray.
fn compare(when: &str, solver: &mut [Box<dyn Solver>; 2], pool: &ThreadPool) {
    for solver in solver.iter_mut() {
        advance(solver.as_mut(), pool);
    }
    let (mut steps, mut seconds) = (Vec::new(), Vec::new());
    for _ in 0..9 {
        let cost = [0, 1].map(|k| {
            let from = solver[k].time();
            let [work, cpu, _] = advance(solver[k].as_mut(), pool);
            [cpu / work, cpu / (solver[k].time() - from)]
        });
        steps.push(100.0 * (cost[1][0] / cost[0][0] - 1.0));
        seconds.push(100.0 * (cost[1][1] / cost[0][1] - 1.0));
    }
    let name = format!("wcsph.modern.tension_adds.{when}");
    line(&name, median(&mut steps), "%_of_step");
    let name = format!("wcsph.modern.tension_adds_to_time.{when}");
    line(&name, median(&mut seconds), "%_of_simulated_second");
}

/// A quarter of the default impact as its stage runs it, with what frames and checkpoints take:
/// CPU time of their threads, and for how long the solver stands still for them.
pub fn record(pool: &ThreadPool) {
    let (scene, state, strength) = pool.install(|| scene::pool(&scene::DEFAULT, true));
    let folder = tempfile::tempdir().expect("a folder for results");
    let setup = LogSetup::new(
        &scene,
        &scene.frames,
        &wall::build(&scene),
        String::new(),
        Vec::new(),
    );
    let log = LogWriter::create(folder.path(), 0, None, &setup);
    let mut log = log.expect("a log can be written");
    let mut checkpoints = CheckpointWriter::new(LEVEL).expect("checkpoints can be written");
    let built = build(&scene, state, Phase::Impact, strength);
    let mut solver = built.expect("the scene can be built");
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let (mut next, mut last, mut held, mut count) = (0.0, Instant::now(), 0.0, 0);
    while solver.time() < CRATER {
        advance(solver.as_mut(), pool);
        let from = Instant::now();
        if solver.time() >= next {
            log.frame(solver.frame()).expect("a frame can be written");
            next += scene.frames.interval;
        }
        if solver.time() >= CRATER || last.elapsed().as_secs_f64() >= EVERY {
            let flush = log.flush(solver.time()).expect("a log can be flushed");
            let path = folder.path().join(format!("{count}.checkpoint"));
            let checkpoint = Checkpoint::from(solver.state());
            let submitted = checkpoints.submit(checkpoint, path, Some(flush));
            submitted.expect("a checkpoint can be written");
            (last, count) = (Instant::now(), count + 1);
        }
        held += from.elapsed().as_secs_f64();
    }
    let from = Instant::now();
    checkpoints.wait().expect("checkpoints can be written");
    let threads = thread_seconds("log") + thread_seconds("checkpoint");
    let before = cpu_seconds();
    let frames = log.finish().expect("a log can be ended");
    let segments = log::segments(folder.path()).expect("a log can be read");
    log::merge(&segments, &folder.path().join("all.mcap")).expect("a log can be merged");
    let merging = cpu_seconds() - before;
    held += from.elapsed().as_secs_f64();
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
    line("record.frames", frames as f64, "1");
    line("record.checkpoints", count as f64, "1");
    line(
        "record.solver_waits",
        100.0 * held / (wall - held),
        "%_of_wall",
    );
    let own = threads + merging;
    line("record.background", 100.0 * own / (cpu - own), "%_of_cpu");
    // The background takes what it needs from the solver's threads when all cores are busy.
    let cores = pool.current_num_threads() as f64;
    let added = held + threads / cores;
    line(
        "record.adds_at_most",
        100.0 * added / (wall - added),
        "%_of_wall",
    );
}

/// CPU seconds of the thread of this name.
fn thread_seconds(name: &str) -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task")
        .into_iter()
        .flatten()
        .flatten();
    let seconds = tasks.map(|task| {
        let read = |file: &str| std::fs::read_to_string(task.path().join(file)).unwrap_or_default();
        let found = read("comm").trim() == name;
        let text = read("schedstat");
        let nanoseconds = text
            .split_whitespace()
            .next()
            .and_then(|n| n.parse::<f64>().ok());
        if found {
            1e-9 * nanoseconds.unwrap_or(0.0)
        } else {
            0.0
        }
    });
    seconds.sum()
}
