//! What a step must keep, and what it must not cost.

use super::allocation::counted;
use super::method_scene::{
    EFFECTS, GRAVITY, disturbed, drop_scene, solver, splash, splash_scene, words,
};
use coronet::method::{self, Phase, Solver};
use coronet::particle::State;
use coronet::scene::{Problem, Scene};
use std::ops::ControlFlow::Continue;

/// Not "isph paper": its tension reaches across the small box; tests/engine/projection_flow.rs runs
/// it.
const PRESETS: [&str; 8] = [
    "paper",
    "corrected",
    "modern",
    "isph corrected",
    "isph modern",
    "mps paper",
    "mps corrected",
    "mps modern",
];

/// Presets that keep momentum: all but MPS as printed, whose Eq. 5 is no force of pairs.
fn keeping() -> impl Iterator<Item = &'static str> {
    PRESETS.into_iter().filter(|preset| *preset != "mps paper")
}

/// SUM m v and SUM m |v|, kg m/s.
fn momentum(state: &State) -> ([f64; 3], f64) {
    let p = &state.particles;
    let (mut sum, mut size) = ([0.0; 3], 0.0);
    for i in 0..p.len() {
        let v = [0, 1, 2].map(|a| p.velocity[a][i]);
        (0..3).for_each(|a| sum[a] += p.mass * v[a]);
        size += p.mass * v.iter().map(|v| v * v).sum::<f64>().sqrt();
    }
    (sum, size)
}

#[test]
fn an_isolated_drop_keeps_its_momentum() {
    for preset in keeping() {
        for dimension in [2, 3] {
            // Curvature times normal is no force of pairs.
            let raw = "[effects.tension]\nform = 'raw-colour'\n";
            let effects = match preset == "mps corrected" {
                true => &EFFECTS.replace("[effects.tension]\n", raw),
                false => EFFECTS,
            };
            let scene = drop_scene(preset, dimension, effects);
            let mut solver = solver(&scene, 0.1);
            let (before, scale) = momentum(&solver.state());
            let from = words(&solver.state());
            for _ in 0..10 {
                solver.advance(&mut |_| ()).unwrap();
            }
            let (after, _) = momentum(&solver.state());
            let change = (0..3)
                .map(|a| (after[a] - before[a]).abs())
                .fold(0.0, f64::max);
            assert!(
                change < 1e-7 * scale,
                "{preset} {dimension}-D: {}",
                change / scale
            );
            // And not because nothing happened.
            assert!(solver.step_count() >= 10 && words(&solver.state()) != from);
        }
    }
}

#[test]
fn gravity_gives_an_isolated_drop_exactly_its_weight() {
    for preset in keeping() {
        let scene = drop_scene(preset, 3, GRAVITY);
        let mut solver = solver(&scene, 0.01);
        let (before, _) = momentum(&solver.state());
        for _ in 0..3 {
            solver.advance(&mut |_| ()).unwrap();
        }
        let (after, _) = momentum(&solver.state());
        let p = solver.state().particles;
        assert_eq!(
            p.len(),
            disturbed(&scene, 0.01).particles.len(),
            "{preset}: lost some"
        );
        let wanted = -9.81 * solver.time() * p.mass * p.len() as f64;
        let got = after[2] - before[2];
        assert!(
            (got / wanted - 1.0).abs() < 1e-4,
            "{preset}: {got:e}, not {wanted:e}"
        );
        assert!(
            (after[0] - before[0]).abs() < 1e-4 * wanted.abs(),
            "{preset}"
        );
    }
}

/// Advances by `count` and tells the steps seen.
fn advance(solver: &mut dyn Solver, count: usize) -> usize {
    let mut steps = 0;
    for _ in 0..count {
        solver.advance(&mut |_| steps += 1).unwrap();
    }
    steps
}

/// A restart from any state between two advances goes on bit for bit.
fn restarts(what: &str, scene: &Problem, state: State, phase: Phase) {
    let mut whole = method::build(scene, state, phase, Some(3.0)).unwrap();
    for _ in 0..2 {
        advance(whole.as_mut(), 1);
        let kept = whole.state();
        let mut again = method::build(scene, kept.clone(), phase, None).unwrap();
        assert_eq!(
            words(&again.state()),
            words(&kept),
            "{what}: not what was kept"
        );
        // As it is after its own future, not only at once.
        advance(whole.as_mut(), 2);
        advance(again.as_mut(), 2);
        for (a, b) in words(&again.state()).iter().zip(&words(&whole.state())) {
            assert!(a == b, "{what}: {} differs after a restart", a.0);
        }
        assert_eq!(again.frame(), whole.frame(), "{what}");
        assert_eq!(again.limits(), whole.limits(), "{what}");
    }
}

#[test]
fn a_restored_state_goes_on_bit_for_bit() {
    let effects = format!("{GRAVITY}{EFFECTS}");
    for preset in PRESETS {
        for dimension in [2, 3] {
            let scene = splash_scene(preset, dimension, &effects);
            let name = format!("{preset} {dimension}-D");
            restarts(&name, &scene, disturbed(&scene, 0.1), Phase::Impact);
            let relax = Phase::Relax { damping: 300.0 };
            for (index, what) in ["pool", "drop"].into_iter().enumerate() {
                let problem = scene.resting(index);
                let state = method::resting(&problem, &body(&scene, index));
                restarts(&format!("{name}, {what} at rest"), &problem, state, relax);
            }
        }
    }
}

fn body(scene: &Scene, body: usize) -> coronet::particle::Particles {
    coronet::particle::pack::pack(&scene.pack_input(body), &mut |_| Continue(()))
        .unwrap()
        .0
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for preset in PRESETS {
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let mut solver = splash(preset, 3);
                advance(solver.as_mut(), 4);
                words(&solver.state())
            })
        };
        let one = run(1);
        assert!(one == run(2) && one == run(5), "{preset}");
    }
}

#[test]
fn steps_allocate_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build().unwrap().install(|| {
        for preset in PRESETS {
            for dimension in [2, 3] {
                let mut solver = splash(preset, dimension);
                // Buffers, rows of neighbours above all, grow to their size.
                let warm = match preset {
                    "isph modern" | "mps modern" => 20,
                    _ if preset.ends_with("modern") => 10,
                    _ => 5,
                };
                advance(solver.as_mut(), warm);
                let (particles, advances) = (solver.len(), 4);
                let count = counted(|| {
                    advance(solver.as_mut(), advances);
                });
                assert_eq!(
                    solver.len(),
                    particles,
                    "{preset} {dimension}-D: some have left"
                );
                // One may still grow, but what every advance allocates would count to four.
                assert!(
                    count < advances,
                    "{preset} {dimension}-D: {count} allocations"
                );
            }
        }
    });
}

#[test]
fn an_absent_tension_holds_nothing() {
    for preset in PRESETS {
        // What shifting holds, which the tension of `modern` does without, is left out.
        let shifts = match preset {
            "modern" => "[method.wcsph]\nshifting = 0\n",
            _ => "",
        };
        let bare = splash_scene(preset, 3, &format!("{GRAVITY}{shifts}"));
        let whole = splash_scene(preset, 3, &format!("{GRAVITY}{EFFECTS}"));
        let [bare, whole] = [bare, whole].map(|scene| {
            let mut solver = solver(&scene, 0.1);
            advance(solver.as_mut(), 2);
            let names: Vec<String> = words(&solver.state()).into_iter().map(|w| w.0).collect();
            (solver.memory(), names)
        });
        assert!(
            whole.1.contains(&"tension_strength".to_string()),
            "{preset}"
        );
        assert!(
            !bare.1.iter().any(|name| name.contains("tension")),
            "{preset}"
        );
        // Vectors, forces and indices of at least the particles at the surface.
        let saved = whole.0.0 - bare.0.0;
        assert!(saved > 12.0, "{preset}: {saved} B/particle");
    }
}
