//! Physics against theory, in full length:
//! `cargo test --release --test validation -- --nocapture --test-threads=1`. Prints one row of the
//! table in docs/validation.md for each case.
mod drop;
mod flow;
mod wall;

use coronet::method::{self, Phase, Solver};
use coronet::particle::{Frame, Particles, pack::pack};
use coronet::scene::{Scene, file};
use std::ops::ControlFlow::Continue;
use std::path::Path;

/// A verification scene with overrides.
pub fn scene(name: &str, sets: &[&str]) -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/verification");
    let mut sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    sets.extend(
        std::env::var("CORONET_SET")
            .ok()
            .iter()
            .flat_map(|s| s.split(';'))
            .map(String::from),
    );
    file::load(&root.join(format!("{name}.toml")), &sets)
        .expect("the scene is valid")
        .scene
}

/// Relaxes a body as the relax stage does.
pub fn relax(scene: &Scene, body: &Particles) -> Particles {
    let Some(relax) = &scene.relax else {
        return body.clone();
    };
    let state = method::resting(scene, body);
    let mass = state.particles.mass * state.particles.len() as f64;
    let phase = Phase::Relax {
        damping: relax.damping,
    };
    let mut solver = method::build(scene, state, phase, None).expect("builds");
    // At rest means calm for a tenth of the time: at the very start nothing moves yet.
    let mut calm_since = f64::INFINITY;
    while solver.time() < relax.time && solver.time() - calm_since < 0.1 * relax.time {
        solver.advance(&mut |_| ()).expect("relaxes");
        let (kinetic, spread) = solver.unrest();
        let calm = kinetic / mass < relax.kinetic_energy && spread < relax.density_spread;
        calm_since = if calm {
            calm_since.min(solver.time())
        } else {
            f64::INFINITY
        };
    }
    let (kinetic, spread) = solver.unrest();
    println!(
        "  relaxed for {:.3e} s: {:.2e} J/kg, density spread {spread:.3} kg/m^3",
        solver.time(),
        kinetic / mass
    );
    method::relaxed(scene, &solver.state())
}

/// Packs, relaxes, calibrates, builds.
pub fn start(scene: &Scene) -> Box<dyn Solver> {
    let bodies: Vec<Particles> = (0..scene.bodies.len())
        .map(|b| {
            relax(
                scene,
                &pack(scene, b, &mut |_| Continue(())).expect("packs").0,
            )
        })
        .collect();
    let strength = scene.effects.tension.map(|_| {
        let c = method::calibrate(scene, &bodies).expect("calibrates");
        println!("  calibration {c:?}");
        c.strength
    });
    let state = method::initial(scene, &bodies);
    method::build(scene, state, Phase::Impact, strength).expect("builds")
}

/// Runs to `end` s, calling `see` about every `interval` s.
pub fn run(solver: &mut dyn Solver, end: f64, interval: f64, mut see: impl FnMut(&Frame)) {
    let mut next = solver.time();
    while solver.time() < end {
        solver
            .advance(&mut |s| {
                if s.time() >= next {
                    see(&s.frame());
                    next += interval;
                }
            })
            .expect("stays stable");
    }
}

/// A named scalar of a frame.
pub fn scalar(frame: &Frame, name: &str) -> f64 {
    frame
        .scalars
        .iter()
        .find(|s| s.0 == name)
        .expect("the scalar exists")
        .1
}

/// Prints and checks one figure.
pub fn report(case: &str, what: &str, got: f64, wanted: f64, tolerance: f64) -> bool {
    let error = got / wanted - 1.0;
    let good = error.abs() <= tolerance;
    let verdict = if good { "meets" } else { "MISSES" };
    println!(
        "| {case} | {what} | {got:.5e} | {wanted:.5e} | {:+.2} % | {:.0} % | {verdict} |",
        100.0 * error,
        100.0 * tolerance
    );
    good
}
