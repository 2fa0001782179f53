//! Several ranks give the bits of one process: frames, states, and what goes on from a state.

use super::method_scene::disturbed;
use coronet::method::{self, MethodError, Phase, Solver, shared};
use coronet::particle::{Frame, State};
use coronet::record::checkpoint::{self, Checkpoint};
use coronet::scene::{Scene, file};
use coronet::space::ranks::{Communicator, local};
use std::path::Path;
use std::sync::Arc;

const GRAVITY: &str = "[effects.gravity]\nacceleration = '9.81 m/s^2'\n";
const VISCOSITY: &str = "[effects.viscosity]\ndynamic = '20 mPa s'\n";
const TENSION: &str = "[effects.tension]\ncoefficient = '50 mN/m'\n";
const MODERN: &str = "name = 'wcsph'\n";

/// A drop above a pool that is 24 spacings wide, or 48 in two dimensions without a mirror plane.
fn scene(dimension: usize, sides: &str, effects: &str, method: &str) -> Scene {
    let (round, middle, lateral) = match (dimension, sides.contains("symmetry")) {
        (3, _) => ("sphere", "'4.8 mm', '4.8 mm'", "'9.6 mm', '9.6 mm'"),
        (_, true) => ("disc", "'4.8 mm'", "'9.6 mm'"),
        _ => ("disc", "'4.8 mm'", "'19.2 mm'"),
    };
    let text = format!(
        "dimension = {dimension}\n[box]\nsize = [{lateral}, '9.6 mm']\n{sides}\n[liquid]\n\
         density = '1100 kg/m^3'\n{effects}[body.pool]\nlayer = {{ depth = '1.6 mm' }}\n\
         [body.drop]\n{round} = {{ diameter = '3.2 mm', centre = [{middle}, '3.6 mm'] }}\n\
         velocity = '2 m/s'\n[pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\n{method}"
    );
    read(&text)
}

fn read(text: &str) -> Scene {
    let loaded = file::read(text, Path::new("ranks.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

/// The frames after each advance, and the state at the end.
type Seen = (Vec<Frame>, State);

fn run(solver: &mut dyn Solver, advances: usize) -> Seen {
    solver.meet(1e-4);
    let mut frames = vec![solver.frame()];
    for _ in 0..advances {
        let mut last = None;
        solver.advance(&mut |s| last = Some(s.frame())).unwrap();
        frames.extend(last);
    }
    let state = solver.state();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts.checkpoint");
    let (own, others) = solver.share();
    let checkpoint = Checkpoint::from(own);
    let written = checkpoint.write_with(others.as_deref(), &path, 1).unwrap();
    assert_eq!(written, Checkpoint::from(&state).digest());
    assert!(State::try_from(checkpoint::read(&path).unwrap()).unwrap() == state);
    (frames, state)
}

fn alone(scene: &Scene, state: &State, advances: usize) -> Seen {
    let mut solver = method::build(scene, state.clone(), Phase::Impact, None).unwrap();
    run(&mut *solver, advances)
}

/// Calls `f` on so many ranks, with so many threads each; what they return.
pub fn on_ranks<T: Send>(
    [size, threads]: [usize; 2],
    f: impl Fn(&Arc<dyn Communicator>) -> T + Sync,
) -> Vec<T> {
    std::thread::scope(|scope| {
        let ranks: Vec<_> = local::ranks(size)
            .into_iter()
            .map(|with| {
                let with: Arc<dyn Communicator> = with;
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let f = &f;
                scope.spawn(move || pool.unwrap().install(|| f(&with)))
            })
            .collect();
        ranks.into_iter().map(|rank| rank.join().unwrap()).collect()
    })
}

/// What rank 0 sees of a run on ranks, of which each has its part.
fn together(scene: &Scene, state: &State, ranks: [usize; 2], advances: usize) -> Seen {
    let mut all = on_ranks(ranks, |with| {
        let state = (with.rank() == 0).then(|| state.clone());
        let built = method::build_shared(with, scene, state, Phase::Impact, None);
        let mut solver = built.unwrap();
        if with.rank() > 0 {
            return Err(shared::serve(solver, &**with));
        }
        Ok(run(&mut *solver, advances))
    });
    let seen = all.remove(0).unwrap();
    let count = seen.1.particles.len();
    let others: usize = all.into_iter().map(|other| other.err().unwrap()).sum();
    let share = others as f64 / count as f64;
    // Slabs are few, and how many a rank gets depends on the time that was measured.
    let least = if ranks[0] > 1 { 0.1 } else { 0.0 };
    assert!(
        share >= least,
        "all but rank 0 of {ranks:?} have {share} of the particles"
    );
    seen
}

fn same(about: &str, (frames, end): &Seen, (found, state): &Seen) {
    assert_eq!(frames.len(), found.len(), "{about}");
    for (k, (frame, found)) in frames.iter().zip(found).enumerate() {
        assert_eq!(frame.scalars.len(), found.scalars.len(), "{about}");
        for (wanted, scalar) in frame.scalars.iter().zip(&found.scalars) {
            assert_eq!(wanted, scalar, "{about}, frame {k}");
        }
        assert!(frame == found, "{about}, frame {k}");
    }
    assert!(end == state, "{about}, the state at the end");
}

fn check(scene: &Scene, advances: usize) {
    let start = disturbed(scene, 0.1);
    let whole = alone(scene, &start, advances);
    for ranks in [[1, 1], [2, 1], [3, 2], [7, 1]] {
        let parts = together(scene, &start, ranks, advances);
        same(&format!("{ranks:?} ranks and threads"), &whole, &parts);
    }
}

#[test]
fn walls_and_periodic_sides() {
    let effects = format!("{GRAVITY}{VISCOSITY}");
    for sides in ["", "x = 'wall'\n"] {
        check(&scene(2, sides, &effects, MODERN), 30);
        check(&scene(3, sides, &effects, MODERN), 4);
    }
}

#[test]
fn what_leaves() {
    let effects = format!("{GRAVITY}{VISCOSITY}");
    let open = scene(2, "x = 'open'\n", &effects, MODERN);
    check(&open, 120);
    let start = disturbed(&open, 0.1);
    let (frames, _) = alone(&open, &start, 120);
    let gone = frames.last().unwrap().scalars.iter();
    let gone = gone.clone().find(|scalar| scalar.0 == "mass_removed_kg");
    assert!(gone.unwrap().1 > 0.0, "nothing leaves the box");
}

#[test]
fn tension() {
    let effects = format!("{GRAVITY}{VISCOSITY}{TENSION}");
    for sides in ["", "x = 'wall'\n"] {
        check(&scene(2, sides, &effects, MODERN), 30);
        check(&scene(3, sides, &effects, MODERN), 4);
    }
}

#[test]
fn a_contact_angle() {
    let wetting = "[effects.wetting]\nangle = '60 deg'\n";
    let effects = format!("{GRAVITY}{VISCOSITY}{TENSION}{wetting}");
    check(&scene(2, "x = 'wall'\n", &effects, MODERN), 30);
    check(&scene(3, "", &effects, MODERN), 4);
}

#[test]
fn advancing_and_receding_angles() {
    let wetting = "[effects.wetting]\nadvancing = '100 deg'\nreceding = '50 deg'\n";
    let effects = format!("{GRAVITY}{VISCOSITY}{TENSION}{wetting}");
    check(&scene(2, "x = 'wall'\n", &effects, MODERN), 30);
    check(&scene(2, "symmetry = 'half'\n", &effects, MODERN), 30);
    check(&scene(3, "", &effects, MODERN), 4);
    check(&scene(2, "x = 'wall'\n", &effects, "name = 'isph'\n"), 12);
}

#[test]
fn mirror_planes() {
    let effects = format!("{GRAVITY}{VISCOSITY}{TENSION}");
    check(&scene(2, "symmetry = 'half'\n", &effects, MODERN), 30);
    check(&scene(3, "symmetry = 'quarter'\n", &effects, MODERN), 4);
    check(
        &scene(
            3,
            "symmetry = 'quarter'\ny = 'wall'\nx = 'wall'\n",
            &effects,
            MODERN,
        ),
        4,
    );
}

/// All of the above by a projection: walls, periodic sides, mirror planes, what leaves.
fn by_projection(name: &str) {
    let method = format!("name = '{name}'\n");
    let tension = format!("{GRAVITY}{VISCOSITY}{TENSION}");
    let wetting = format!("{tension}[effects.wetting]\nangle = '60 deg'\n");
    for (dimension, sides, effects, advances) in [
        (2, "", &tension, 12),
        (2, "x = 'wall'\n", &tension, 12),
        (2, "x = 'wall'\n", &wetting, 12),
        (2, "x = 'open'\n", &tension, 60),
        (2, "symmetry = 'half'\n", &tension, 12),
        (3, "", &wetting, 3),
        (3, "x = 'wall'\n", &tension, 3),
        (3, "symmetry = 'quarter'\n", &tension, 3),
    ] {
        check(&scene(dimension, sides, effects, &method), advances);
    }
    let plain = format!("{GRAVITY}{VISCOSITY}");
    for (dimension, sides, advances) in [
        (2, "", 12),
        (2, "x = 'wall'\n", 12),
        (2, "x = 'open'\n", 60),
        (2, "symmetry = 'half'\n", 12),
        (3, "x = 'wall'\n", 3),
        (3, "symmetry = 'quarter'\n", 3),
    ] {
        check(&scene(dimension, sides, &plain, &method), advances);
    }
    let corrected = format!("{method}preset = 'corrected'\n");
    check(&scene(2, "x = 'wall'\n", &plain, &corrected), 4);
    for gradient in ["symmetric", "corrected", "transposed"] {
        // MPS has it with what is never negative.
        let pressure = match (name, gradient) {
            ("mps", "symmetric") => ", pressure = 'clipped'",
            _ => "",
        };
        let method = format!("{method}{name} = {{ gradient = '{gradient}'{pressure} }}\n");
        check(&scene(2, "x = 'wall'\n", &plain, &method), 6);
        for sides in ["x = 'periodic'\nz = 'periodic'\n", "z = 'wall'\n"] {
            check(&full(sides, &method), 6);
        }
    }
}

/// Liquid that fills its box.
fn full(sides: &str, method: &str) -> Scene {
    let text = format!(
        "dimension = 2\n[box]\nsize = ['19.2 mm', '9.6 mm']\n{sides}\n[liquid]\n\
         density = '1100 kg/m^3'\n{GRAVITY}{VISCOSITY}[body.all]\n\
         rectangle = {{ low = [0, 0], high = ['19.2 mm', '9.6 mm'] }}\n\
         [pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\n{method}"
    );
    read(&text)
}

#[test]
fn isph() {
    by_projection("isph");
}

#[test]
fn mps() {
    by_projection("mps");
}

#[test]
fn steps_of_one_rate() {
    let paper = "name = 'wcsph'\npreset = 'paper'\n\
                 wcsph = { time_stepping = { adaptive = { safety = 1 } } }\n";
    let effects = format!("{GRAVITY}{VISCOSITY}");
    check(&scene(2, "x = 'wall'\n", &effects, paper), 5);
}

#[test]
fn a_state_goes_on_with_other_ranks() {
    let effects = format!("{GRAVITY}{VISCOSITY}{TENSION}");
    let scene = scene(2, "", &effects, MODERN);
    let start = disturbed(&scene, 0.1);
    let whole = alone(&scene, &start, 20);
    let (_, middle) = together(&scene, &start, [4, 1], 10);
    let (_, end) = together(&scene, &middle, [3, 1], 10);
    assert!(whole.1 == end);
}

#[test]
fn what_ranks_cannot_share_is_refused() {
    let scene = scene(2, "", GRAVITY, "name = 'isph'\npreset = 'paper'\n");
    let state = disturbed(&scene, 0.1);
    let errors = on_ranks([2, 1], |with| {
        let state = (with.rank() == 0).then(|| state.clone());
        method::build_shared(with, &scene, state, Phase::Impact, None).err()
    });
    let is_alone = |error: &Option<_>| matches!(error, Some(MethodError::Alone(_)));
    assert!(errors.iter().all(is_alone), "{errors:?}");
}
