//! Cost of a step with each effect on and off, alone and together, for each method, as lines
//! `METHOD.effects.WHICH value unit`; what they say: docs/results/benchmarks.md.
//!
//! `cargo bench --bench effect [-- METHOD ...]`. A pool of 16 x 16 x 4 mm between two walls, so
//! that it has two contact lines, with a drop above it, on a lattice of 0.5 mm, in the preset
//! `modern`; medians of CPU seconds a particle and step, the combinations measured in turns, on
//! one thread.

#[path = "wcsph/median.rs"]
mod median;
#[path = "wcsph/meter.rs"]
mod meter;

use coronet::method::{Phase, Solver, build, initial};
use coronet::particle::pack::pack;
use coronet::scene::file;
use median::median;
use meter::{cpu_seconds, line};
use std::ops::ControlFlow::Continue;
use std::path::Path;

/// Tables of the effects.
const EFFECTS: [(&str, &str); 5] = [
    (
        "gravity",
        "[effects.gravity]\nacceleration = '9.81 m/s^2'\n",
    ),
    ("viscosity", "[effects.viscosity]\ndynamic = '3.5 mPa s'\n"),
    ("tension", "[effects.tension]\ncoefficient = '67 mN/m'\n"),
    ("wetting", "[effects.wetting]\nangle = '60 deg'\n"),
    (
        "hysteresis",
        "[effects.wetting]\nadvancing = '120 deg'\nreceding = '60 deg'\n",
    ),
];

/// What is measured: effects by their place above. Wetting needs tension.
const COMBINATIONS: [&[usize]; 11] = [
    &[],
    &[0],
    &[1],
    &[0, 1],
    &[2],
    &[0, 2],
    &[1, 2],
    &[0, 1, 2],
    &[2, 3],
    &[0, 1, 2, 3],
    &[0, 1, 2, 4],
];

/// Advances that are measured for each combination.
const REPEATS: usize = 7;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let methods = ["wcsph", "isph", "mps"];
    let any = methods
        .iter()
        .any(|method| words.iter().any(|w| w == method));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("threads can be started");
    for method in methods {
        if !any || words.iter().any(|word| word == method) {
            pool.install(|| measure(method));
        }
    }
}

fn measure(method: &str) {
    let solvers = COMBINATIONS.map(|which| solver(method, which));
    let mut solvers = Vec::from(solvers);
    let mut costs = vec![Vec::new(); COMBINATIONS.len()];
    for repeat in 0..=REPEATS {
        for (solver, costs) in solvers.iter_mut().zip(&mut costs) {
            let (from, cpu) = (solver.step_count(), cpu_seconds());
            solver.advance(&mut |_| ()).expect("the bench is stable");
            let work = (solver.step_count() - from) as f64 * solver.len() as f64;
            // The first one allocates.
            if repeat > 0 {
                costs.push(1e9 * (cpu_seconds() - cpu) / work);
            }
        }
    }
    for (which, costs) in COMBINATIONS.iter().zip(&mut costs) {
        let name = format!("{method}.effects.{}", name(which));
        line(&name, median(costs), "ns/particle-step");
    }
}

fn name(which: &[usize]) -> String {
    let names: Vec<&str> = which.iter().map(|k| EFFECTS[*k].0).collect();
    match names.is_empty() {
        true => "none".to_string(),
        false => names.join("+"),
    }
}

fn solver(method: &str, which: &[usize]) -> Box<dyn Solver> {
    let effects: String = which.iter().map(|k| EFFECTS[*k].1).collect();
    let text = format!(
        "title = 'bench'\n[box]\nsize = ['16 mm', '16 mm', '12 mm']\n\
         x = 'wall'\ny = 'periodic'\nz = ['wall', 'open']\n\
         [liquid]\ndensity = '1100 kg/m^3'\n{effects}[body.pool]\nlayer = {{ depth = '4 mm' }}\n\
         [body.drop]\nsphere = {{ diameter = '4 mm', gap = '0.5 mm', above = 'pool' }}\n\
         velocity = '3 m/s'\n[pack]\nspacing = '0.5 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\nname = '{method}'\n"
    );
    let loaded = file::read(&text, Path::new("bench.toml"), &[]);
    let scene = loaded.unwrap_or_else(|error| panic!("{error}")).scene;
    let bodies: Vec<_> = (0..scene.bodies.len())
        .map(|body| {
            pack(&scene.pack_input(body), &mut |_| Continue(()))
                .expect("a lattice")
                .0
        })
        .collect();
    let state = initial(&scene.impact_input(), &bodies);
    build(&scene, state, Phase::Impact, Some(3.0)).expect("the scene can be built")
}
