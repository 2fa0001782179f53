//! Cost of a WCSPH step. Lines `name value unit`; CPU seconds of the stepping alone.
//!
//! `cargo bench --bench wcsph [-- N ...]`

use coronet::method::{Phase, build};
use coronet::particle::{Particles, State};
use coronet::scene::{Scene, file};

fn main() {
    let sizes: Vec<usize> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let sizes = if sizes.is_empty() {
        vec![46, 100]
    } else {
        sizes
    };
    for side in sizes {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                for preset in ["paper", "modern"] {
                    step(side, threads, preset);
                }
            });
        }
    }
}

/// A periodic box of `side`^3 particles.
fn scene(side: usize, preset: &str) -> Scene {
    let size = side as f64 * 0.25;
    let text = format!(
        "title = 'bench'\n\
         [box]\nsize = ['{size} mm', '{size} mm', '{size} mm']\n\
         x = 'periodic'\ny = 'periodic'\nz = 'periodic'\n\
         [liquid]\ndensity = '1100 kg/m^3'\n\
         [effects.viscosity]\ndynamic = '3.5 mPa s'\n\
         [body.box]\n\
         block = {{ low = [0, 0, 0], high = ['{size} mm', '{size} mm', '{size} mm'] }}\n\
         [pack]\nspacing = '0.25 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = 'wcsph'\npreset = '{preset}'\n\
         [method.wcsph]\nreference_speed = '3.13 m/s'\n"
    );
    let loaded = file::read(&text, std::path::Path::new("bench.toml"), &[]);
    loaded.unwrap_or_else(|error| panic!("{error}")).scene
}

fn state(scene: &Scene, side: usize) -> State {
    let s0 = scene.pack.spacing;
    let mut seed = 1u64;
    let mut random = move || {
        seed = seed
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    let n = side * side * side;
    let mut p = Particles {
        mass: scene.density * s0.powi(3),
        ..Particles::default()
    };
    for i in 0..n {
        let cell = [i / side / side, i / side % side, i % side];
        for (a, c) in cell.iter().enumerate() {
            p.position[a].push((*c as f64 + 0.5 + 0.2 * random()) * s0);
            p.velocity[a].push(2.0 * random());
        }
        p.density.push(scene.density);
        p.id.push(i as u32);
        p.body.push(0);
    }
    State {
        particles: p,
        ..State::default()
    }
}

fn step(side: usize, threads: usize, preset: &str) {
    let scene = scene(side, preset);
    let mut solver = build(&scene, state(&scene, side), Phase::Impact, None).unwrap();
    solver.advance(&mut |_| ()).unwrap();
    let start = cpu_seconds();
    let mut rates = Vec::new();
    while cpu_seconds() - start < 3.0 || rates.len() < 3 {
        let (from, at) = (solver.step_count(), cpu_seconds());
        while cpu_seconds() - at < 0.5 {
            solver.advance(&mut |_| ()).unwrap();
        }
        let steps = (solver.step_count() - from) as f64;
        rates.push(steps * solver.len() as f64 / (cpu_seconds() - at));
    }
    rates.sort_by(f64::total_cmp);
    let n = solver.len();
    let median = rates[rates.len() / 2];
    println!("wcsph.{preset}.step.n{n}.t{threads} {median:.3e} particle-steps/s/core");
    let (bare, whole) = solver.memory();
    if threads == 1 {
        println!("wcsph.{preset}.memory.n{n} {bare:.0} B/particle");
        println!("wcsph.{preset}.memory_with_rows.n{n} {whole:.0} B/particle");
    }
}

/// CPU seconds of this process so far, all threads.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap();
    let after = stat.rsplit(')').next().unwrap();
    let ticks: f64 = after
        .split_whitespace()
        .skip(11)
        .take(2)
        .map(|t| t.parse::<f64>().unwrap())
        .sum();
    ticks / 100.0
}
