//! Cost of a WCSPH step. Lines `name value unit`; CPU seconds of the stepping alone.
//!
//! `cargo bench --bench wcsph [-- N ...]`

use coronet::method::{Phase, build};
use coronet::particle::{Particles, State};
use coronet::scene::*;

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

/// A jittered periodic lattice of `side`^3 particles.
fn scene(side: usize, preset: &str) -> Scene {
    let s0 = 0.25e-3;
    let size = [side as f64 * s0; 3];
    let modern = preset == "modern";
    Scene {
        name: "bench".into(),
        title: String::new(),
        dimension: Dimension::Three,
        domain: Domain {
            size,
            boundary: [[Side::Periodic; 2]; 3],
            wall_velocity: Default::default(),
        },
        density: 1100.0,
        effects: Effects {
            gravity: None,
            viscosity: Some(3.5e-3),
            tension: None,
        },
        bodies: vec![Body {
            name: "box".into(),
            shape: Shape::Block {
                low: [0.0; 3],
                high: size,
            },
            motion: Motion::Uniform([0.0; 3]),
            colour: [0; 3],
        }],
        pack: Pack {
            spacing: s0,
            arrangement: Arrangement::Lattice,
            tolerance: 0.1,
            seed: 1,
            iterations: 100,
        },
        relax: None,
        impact: Impact {
            end: 1.0,
            checkpoint_every: 60.0,
        },
        frames: Frames {
            interval: 1.0,
            time_scale: 1.0,
            colour: Colour::Body,
        },
        post: Post {
            panels: vec![],
            fields: vec![],
            references: vec![],
        },
        method: Method::Wcsph(Wcsph {
            kernel: if modern {
                KernelName::WendlandC2
            } else {
                KernelName::CubicSpline
            },
            smoothing: 1.3,
            density: if modern {
                Density::Continuity { diffusion: 0.1 }
            } else {
                Density::Summation
            },
            pressure: if modern {
                Pressure::Signed
            } else {
                Pressure::Clipped
            },
            exponent: if modern { 1.0 } else { 7.0 },
            sound_speed_factor: 10.0,
            reference_speed: Some(3.13),
            mass: Mass::LatticeSum,
            viscosity_form: if modern {
                ViscosityForm::Morris
            } else {
                ViscosityForm::TwoTerm
            },
            tension_form: TensionForm::RawColour,
            tension_strength: TensionStrength::Virial,
            tension_smoothing: 1.5,
            wall_pressure: WallPressure::Extrapolated,
            shifting: if modern { 1.0 } else { 0.0 },
            shock_dissipation: 0.0,
            time_stepping: if modern {
                TimeStepping::Dual {
                    advective: 0.25,
                    acoustic: 0.6,
                }
            } else {
                TimeStepping::Fixed { step: 1e-6 }
            },
        }),
    }
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
