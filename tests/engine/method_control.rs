//! The step controller of WCSPH.

use super::method_scene::{EFFECTS, GRAVITY, disturbed, drop_scene, splash_scene, words};
use coronet::method::{self, Phase, Solver};
use coronet::scene::{Method, Scene, TensionIn, TimeStepping};
use coronet::simulate::{Simulation, scene};

/// Acoustic steps ten times and advective ones five times too long.
const DUAL: TimeStepping = TimeStepping::Dual {
    advective: 1.25,
    acoustic: 6.0,
};

/// One rate, ten times too long.
const ADAPTIVE: TimeStepping = TimeStepping::Adaptive {
    safety: 10.0,
    tension: TensionIn::Each,
};

/// A splash with such steps.
fn hasty(stepping: TimeStepping) -> Scene {
    let mut scene = splash_scene("modern", 2, &format!("{GRAVITY}{EFFECTS}"));
    let Method::Wcsph(settings) = &mut scene.method else {
        panic!("not WCSPH");
    };
    settings.time_stepping = stepping;
    scene
}

fn start(scene: &Scene) -> Box<dyn Solver> {
    method::build(scene, disturbed(scene, 0.1), Phase::Impact, Some(1.0)).unwrap()
}

fn named(solver: &dyn Solver, name: &str) -> f64 {
    let scalars = solver.state().scalars;
    scalars.iter().find(|s| s.0 == name).unwrap().1
}

/// Kinetic and potential energy, J/m.
fn energy(solver: &dyn Solver) -> f64 {
    let scalars = solver.frame().scalars;
    let of = |name: &str| scalars.iter().find(|s| s.0 == name).unwrap().1;
    of("kinetic_energy_J") + of("potential_energy_J")
}

/// To 12 ms: halvings at every advance, the largest and the last energy over the first, and the
/// rejected steps.
fn run(scene: &Scene) -> (Vec<f64>, [f64; 2], f64) {
    let mut solver = start(scene);
    let first = energy(solver.as_ref());
    let (mut halvings, mut most) = (Vec::new(), 1.0f64);
    while solver.time() < 12e-3 {
        solver.advance(&mut |_| ()).unwrap();
        halvings.push(named(solver.as_ref(), "step_halvings"));
        most = most.max(energy(solver.as_ref()) / first);
    }
    let last = energy(solver.as_ref()) / first;
    (
        halvings,
        [most, last],
        named(solver.as_ref(), "steps_rejected"),
    )
}

#[test]
fn steps_that_are_too_long_are_halved_and_grow_again() {
    let usual = splash_scene("modern", 2, &format!("{GRAVITY}{EFFECTS}"));
    let (_, wanted, few) = run(&usual);
    // One, as the drop meets the pool.
    assert!(few <= 1.0, "{few} rejected at the usual step");
    for stepping in [DUAL, ADAPTIVE] {
        let (halvings, found, rejected) = run(&hasty(stepping));
        println!("{stepping:?}: {rejected} rejected, energies {found:.3?}, usual {wanted:.3?}");
        assert!(rejected > 1.0);
        let grows = |pair: &[f64]| pair[1] < pair[0];
        assert!(halvings.windows(2).any(grows), "{halvings:?}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert!((found - wanted).abs() < 0.05, "{found} for {wanted}");
        }
    }
}

#[test]
fn a_restart_amid_shorter_steps_goes_on_bit_for_bit() {
    for stepping in [DUAL, ADAPTIVE] {
        let scene = hasty(stepping);
        let mut whole = start(&scene);
        while named(whole.as_ref(), "step_halvings") == 0.0 {
            whole.advance(&mut |_| ()).unwrap();
        }
        restart(&scene, whole);
    }
}

/// With one rate, too, at steps of which none is rejected.
#[test]
fn a_restart_with_one_rate_goes_on_bit_for_bit() {
    for tension in [TensionIn::Each, TensionIn::Held] {
        let safety = 1.0;
        let scene = hasty(TimeStepping::Adaptive { safety, tension });
        let mut whole = start(&scene);
        (0..5).for_each(|_| whole.advance(&mut |_| ()).unwrap());
        restart(&scene, whole);
    }
}

/// Tension that is held while rows last moves a drop as tension that is found in each step.
#[test]
fn held_tension_moves_a_drop_as_that_of_each_step() {
    let [mut each, mut held] = [TensionIn::Each, TensionIn::Held].map(|tension| {
        let mut scene = drop_scene("corrected", 2, EFFECTS);
        if let Method::Wcsph(settings) = &mut scene.method {
            let safety = 1.0;
            settings.time_stepping = TimeStepping::Adaptive { safety, tension };
        }
        start(&scene)
    });
    let (mut moved, mut apart) = (0.0f64, 0.0f64);
    let places = |solver: &dyn Solver| {
        let p = solver.state().particles;
        let mut at = vec![[0.0; 2]; p.len()];
        for i in 0..p.len() {
            at[p.id[i] as usize] = [p.position[0][i], p.position[2][i]];
        }
        at
    };
    let first = places(each.as_ref());
    for solver in [&mut each, &mut held] {
        while solver.time() < 2e-3 {
            solver.advance(&mut |_| ()).unwrap();
        }
    }
    let far = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let (a, b) = (places(each.as_ref()), places(held.as_ref()));
    for i in 0..first.len() {
        moved = moved.max(far(a[i], first[i]));
        apart = apart.max(far(a[i], b[i]));
    }
    println!("moved {moved:e} m, apart {apart:e} m");
    assert!(
        apart > 0.0 && apart < 0.02 * moved,
        "{apart:e} of {moved:e} m"
    );
}

/// The same bits after 60 advances from the state of `whole` as without a restart.
fn restart(scene: &Scene, mut whole: Box<dyn Solver>) {
    let mut again = method::build(scene, whole.state(), Phase::Impact, None).unwrap();
    for solver in [&mut whole, &mut again] {
        (0..60).for_each(|_| solver.advance(&mut |_| ()).unwrap());
    }
    assert!(words(&whole.state()) == words(&again.state()));
}

/// A step that cannot be helped ends as diverged: one particle at a speed beyond that of sound.
#[test]
fn what_no_shorter_step_can_mend_is_said() {
    let scene = hasty(DUAL);
    let mut state = disturbed(&scene, 0.1);
    state.particles.velocity[0][0] = 1e4;
    let mut solver = method::build(&scene, state, Phase::Impact, Some(1.0)).unwrap();
    let error = solver.advance(&mut |_| ()).unwrap_err();
    assert!(error.to_string().contains("sound speed"), "{error}");
}

/// A step that throws particles out of the box and is rejected begins again with all of them.
#[test]
fn a_rejected_step_may_have_removed_particles() {
    let text = "dimension = 2
[box]
size = ['8 mm', '9 mm']
[liquid]
density = '1100 kg/m^3'
[effects.gravity]
acceleration = '9.81 m/s^2'
[effects.viscosity]
dynamic = '3.5 mPa s'
[effects.tension]
coefficient = '67 mN/m'
[body.pool]
layer = { depth = '3 mm' }
[body.drop]
disc = { diameter = '2 mm', centre = ['4 mm', '4.3 mm'] }
velocity = '8 m/s'
[pack]
spacing = '0.2 mm'
[impact]
end = '1 ms'
[frames]
interval = '0.05 ms'
[method]
name = 'wcsph'
[method.wcsph.time_stepping.dual]
acoustic = 2
";
    let scene = coronet::simulate::scene(text).unwrap();
    let mut run = coronet::simulate::Simulation::new(&scene).unwrap();
    // Whether it holds in the end is not asked: it must not panic.
    let _ = run.run(|_, _| {});
    let scalars = run.frame().scalars;
    let value = |name: &str| scalars.iter().find(|s| s.0 == name).unwrap().1;
    assert!(value("steps_rejected") > 0.0);
}

/// Walls push liquid that is not at rest, which gives it a fiftieth of its little energy in the
/// shortest step.
#[test]
fn a_pool_that_was_not_relaxed_settles() {
    let text = "[box]\nsize = ['8 mm', '8 mm', '6 mm']\nx = 'wall'\ny = 'wall'\n\
                z = ['wall', 'open']\n[liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\n\
                acceleration = '9.81 m/s^2'\n[effects.viscosity]\ndynamic = '20 mPa s'\n\
                [body.pool]\nlayer = { depth = '3 mm' }\n[pack]\nspacing = '0.4 mm'\n\
                [impact]\nend = '3 ms'\n[frames]\ninterval = '3 ms'\n";
    let mut simulation = Simulation::new(&scene(text).unwrap()).unwrap();
    let mut last = 0.0;
    let done = simulation.run(|frame, _| last = frame.time);
    done.unwrap();
    assert_eq!(last, 3e-3);
}

/// What a lattice has of compression at the start is no energy of the first step.
#[test]
fn summed_density_and_dual_steps_begin() {
    let text = "dimension = 2
[box]
size = ['6 mm', '6 mm']
x = 'wall'
z = ['wall', 'open']
[liquid]
density = '1000 kg/m^3'
[effects.gravity]
acceleration = '9.81 m/s^2'
[body.pool]
layer = { depth = '3 mm' }
[pack]
spacing = '0.5 mm'
arrangement = 'lattice'
[impact]
end = '5 ms'
[frames]
interval = '1 ms'
[method.wcsph]
density = 'summation'
wall_pressure = 'summation'
";
    let mut run = Simulation::new(&coronet::simulate::scene(text).unwrap()).unwrap();
    run.run(|_, _| ()).unwrap();
}
