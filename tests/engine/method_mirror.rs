//! Mirror planes: a part of a symmetric scene moves as the whole does.

use super::allocation::counted;
use super::method_scene::{EFFECTS, GRAVITY, disturbed, narrowed, words};
use coronet::method::{self, Phase, Solver};
use coronet::particle::State;
use coronet::scene::{Scene, file};
use std::path::Path;

const WETTING: &str = "[effects.wetting]\nangle = '70 deg'\n";

/// The high half (2-D) or quarter (3-D) of a drop above a pool, or on a floor without one; `sides`:
/// more lines of the box.
fn part(preset: &str, dimension: usize, sides: &str, effects: &str, is_pool: bool) -> Scene {
    let (method, preset) = preset.split_once(' ').unwrap_or(("wcsph", preset));
    let symmetry = ["half", "quarter"][dimension - 2];
    let (round, middle, lateral) = match dimension {
        3 => ("sphere", "'4.8 mm', '4.8 mm'", "'9.6 mm', '9.6 mm'"),
        _ => ("disc", "'4.8 mm'", "'9.6 mm'"),
    };
    let (pool, height) = match is_pool {
        true => ("[body.pool]\nlayer = { depth = '1.6 mm' }\n", "'3.4 mm'"),
        false => ("", "'1.6 mm'"),
    };
    let solution = match method {
        "wcsph" => String::new(),
        _ => format!("[method.{method}]\ntolerance = 1e-6\n"),
    };
    let effects = narrowed(method, preset, effects, 2.5);
    let text = format!(
        "dimension = {dimension}\n[box]\nsize = [{lateral}, '5.6 mm']\n\
         symmetry = '{symmetry}'\n{sides}\n[liquid]\ndensity = '1100 kg/m^3'\n{effects}{pool}\
         [body.drop]\n{round} = {{ diameter = '3.2 mm', centre = [{middle}, {height}] }}\n\
         velocity = '1 m/s'\n[pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\nname = '{method}'\n\
         preset = '{preset}'\n{solution}"
    );
    let loaded = file::read(&text, Path::new("part.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

/// The state of the whole: every particle and its images, in the order of the images.
fn unfolded(part: &Scene, state: &State) -> State {
    let mut all = state.clone();
    let p = &mut all.particles;
    for a in (0..3).filter(|&a| part.domain.fold(a) == Some(0)) {
        let n = p.len();
        let half = part.domain.size[a];
        for i in 0..n {
            p.id.push((n + i) as u32);
            p.body.push(p.body[i]);
            p.density.push(p.density[i]);
            for c in 0..3 {
                let sign = if c == a { -1.0 } else { 1.0 };
                let (x, v) = (sign * p.position[c][i], sign * p.velocity[c][i]);
                p.position[c].push(x);
                p.velocity[c].push(v);
            }
        }
        p.position[a].iter_mut().for_each(|x| *x += half);
    }
    all
}

/// Positions and velocities by id.
fn by_id(solver: &dyn Solver, count: usize) -> Vec<[f64; 6]> {
    let p = solver.state().particles;
    let mut all = vec![[f64::NAN; 6]; count];
    for i in 0..p.len() {
        let of = |k: usize| [&p.position, &p.velocity][k / 3][k % 3][i];
        if let Some(place) = all.get_mut(p.id[i] as usize) {
            *place = std::array::from_fn(of);
        }
    }
    all
}

/// Runs both and compares after some steps: places in spacings and velocities in m/s.
fn agree(part: &Scene, steps: usize, tolerance: f64, what: &str) {
    let state = disturbed(part, 0.1);
    let count = state.particles.len();
    let whole = part.whole();
    let all = unfolded(part, &state);
    let build = |scene, state| method::build(scene, state, Phase::Impact, Some(3.0)).unwrap();
    let (mut one, mut other) = (build(part, state), build(&whole, all));
    for _ in 0..steps {
        one.advance(&mut |_| ()).unwrap();
        other.advance(&mut |_| ()).unwrap();
    }
    let step = (one.time() / other.time() - 1.0).abs();
    assert!(step < 1e-5, "{what}: {} and {}", one.time(), other.time());
    let (one, other) = (by_id(one.as_ref(), count), by_id(other.as_ref(), count));
    let (mut far, mut fast) = (0.0f64, 0.0f64);
    for (a, b) in one.iter().zip(&other) {
        for c in 0..3 {
            let half = part.domain.fold(c).map_or(0.0, |_| part.domain.size[c]);
            let away = (a[c] + half - b[c]).abs();
            // Across a periodic side of the whole.
            far = far.max(away.min((away - 2.0 * half).abs()) / part.spacing);
            fast = fast.max((a[c + 3] - b[c + 3]).abs());
            assert!(away.is_finite(), "{what}: {a:?} {b:?}");
        }
    }
    assert!(far < tolerance, "{what}: {far:e} spacings");
    assert!(fast < tolerance, "{what}: {fast:e} m/s");
}

/// Presets, and by how much a few steps may differ: by round-off, and where an equation is solved
/// by what its residual leaves.
const PRESETS: [(&str, f64); 9] = [
    ("paper", 5e-6),
    ("corrected", 5e-6),
    ("modern", 5e-6),
    ("isph paper", 2e-4),
    ("isph corrected", 5e-6),
    ("isph modern", 5e-6),
    ("mps paper", 5e-5),
    ("mps corrected", 5e-6),
    ("mps modern", 5e-6),
];

#[test]
fn a_part_moves_as_the_whole() {
    for (preset, tolerance) in PRESETS {
        for dimension in [2, 3] {
            let effects = format!("{GRAVITY}{EFFECTS}");
            let part = part(preset, dimension, "", &effects, true);
            let steps = if dimension == 2 { 4 } else { 2 };
            agree(&part, steps, tolerance, &format!("{preset} {dimension}-D"));
        }
    }
}

/// Long after round-off has grown, particles have crossed planes and lists were made anew.
#[test]
fn the_energy_of_a_splash_is_that_of_the_whole() {
    for preset in ["modern", "isph modern", "mps modern"] {
        let part = part(preset, 2, "", &format!("{GRAVITY}{EFFECTS}"), true);
        let state = disturbed(&part, 0.1);
        let whole = unfolded(&part, &state);
        let run = |scene: &Scene, state: State| {
            let mut solver = method::build(scene, state, Phase::Impact, Some(3.0)).unwrap();
            let mut energy = Vec::new();
            while solver.time() < 1.5e-3 {
                solver.advance(&mut |_| ()).unwrap();
                energy.push((solver.time(), solver.unrest().0));
            }
            energy
        };
        let (one, two) = (run(&part, state), run(&part.whole(), whole));
        let at = |energy: &[(f64, f64)], t: f64| {
            let next = energy.partition_point(|e| e.0 < t).min(energy.len() - 1);
            energy[next].1
        };
        for t in [0.5e-3, 1e-3, 1.5e-3] {
            let ratio = 2.0 * at(&one, t) / at(&two, t);
            assert!((ratio - 1.0).abs() < 0.02, "{preset}: {ratio} at {t} s");
        }
    }
}

#[test]
fn threads_change_no_bit_of_a_part() {
    for preset in ["modern", "isph modern", "mps modern"] {
        let part = part(preset, 3, "", &format!("{GRAVITY}{EFFECTS}"), true);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let state = disturbed(&part, 0.1);
                let mut solver = method::build(&part, state, Phase::Impact, Some(3.0)).unwrap();
                (0..4).for_each(|_| solver.advance(&mut |_| ()).unwrap());
                words(&solver.state())
            })
        };
        let one = run(1);
        assert!(one == run(2) && one == run(5), "{preset}");
    }
}

#[test]
fn steps_of_a_part_allocate_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build().unwrap().install(|| {
        for preset in ["modern", "isph modern", "mps modern"] {
            let part = part(preset, 3, "", &format!("{GRAVITY}{EFFECTS}"), true);
            let state = disturbed(&part, 0.1);
            let mut solver = method::build(&part, state, Phase::Impact, Some(3.0)).unwrap();
            let mut steps =
                |count: usize| (0..count).for_each(|_| solver.advance(&mut |_| ()).unwrap());
            // Buffers grow to their size, and those of ISPH still do so after 40 steps.
            steps(60);
            let count = counted(|| steps(4));
            assert!(count < 4, "{preset}: {count} allocations");
        }
    });
}

#[test]
fn with_walls_at_the_other_sides_too() {
    for (preset, tolerance) in [
        ("modern", 1e-4),
        ("isph modern", 1e-3),
        ("mps modern", 1e-3),
    ] {
        let effects = format!("{GRAVITY}{EFFECTS}");
        let part = part(preset, 2, "x = 'wall'", &effects, true);
        agree(&part, 4, tolerance, preset);
    }
}

#[test]
fn a_contact_angle_is_the_same() {
    for dimension in [2, 3] {
        let effects = format!("{GRAVITY}{EFFECTS}{WETTING}");
        let part = part("modern", dimension, "", &effects, false);
        agree(&part, 3, 5e-6, &format!("{dimension}-D"));
    }
}

#[test]
fn a_part_restarts_bit_for_bit_and_keeps_its_mass() {
    for preset in ["corrected", "modern", "isph modern", "mps modern"] {
        let effects = format!("{GRAVITY}{EFFECTS}");
        let part = part(preset, 2, "", &effects, true);
        let build = |state, alpha| method::build(&part, state, Phase::Impact, alpha).unwrap();
        let mut whole = build(disturbed(&part, 1.0), Some(3.0));
        let count = whole.len();
        for _ in 0..3 {
            whole.advance(&mut |_| ()).unwrap();
            let mut again = build(whole.state(), None);
            again.advance(&mut |_| ()).unwrap();
            let mut on = build(whole.state(), None);
            on.advance(&mut |_| ()).unwrap();
            assert_eq!(words(&again.state()), words(&on.state()), "{preset}");
            whole.advance(&mut |_| ()).unwrap();
            assert_eq!(words(&again.state()), words(&whole.state()), "{preset}");
        }
        assert_eq!(whole.len(), count, "{preset}");
        for x in &whole.state().particles.position[0] {
            assert!(*x > -0.2 * part.spacing, "{preset}: {x:e}");
        }
    }
}
