//! Rings about an axis: cases with known answers, preset `modern` of the method under test.

mod law;
mod wall;
mod wave;

use crate::{Figure, begin, method_name, run, start, with};
use coronet::method::{self, Phase};
use coronet::particle::{Frame, State};
use coronet::scene::Scene;
use std::f64::consts::PI;

/// Distance from the axis and height, m.
type Point = [f64; 2];

/// A scene of `scenes/verification`, as rings.
fn rings(name: &str, sets: &[&str]) -> Scene {
    let method = format!("method.name={}", method_name());
    with(name, vec!["box.symmetry=axis".to_string(), method], sets)
}

/// Prints a figure; its error.
fn figure(case: &str, what: &str, got: f64, theory: Option<f64>, target: f64) -> f64 {
    let preset = "modern";
    let figure = Figure {
        case,
        preset,
        what,
        got,
        theory,
        target,
    };
    figure.row();
    theory.map_or(got, |theory| got / theory - 1.0).abs()
}

/// Requires of the finest spacing of a case what WCSPH, ISPH and MPS are known to reach.
fn reaches(what: &str, error: f64, [wcsph, isph, mps]: [f64; 3]) {
    let most = match method_name().as_str() {
        "wcsph" => wcsph,
        "isph" => isph,
        _ => mps,
    };
    assert!(error <= most, "{what}: {error} above {most}");
}

/// All of these for WCSPH, and all but the last for the projections, which need more time.
fn affordable<T>(all: &[T]) -> &[T] {
    match method_name().as_str() {
        "wcsph" => all,
        _ => &all[..all.len() - 1],
    }
}

/// Mean over rings of a frame, by mass, of those that `takes` takes.
fn mean(f: &Frame, takes: impl Fn(Point) -> bool, of: impl Fn(usize, Point) -> f64) -> f64 {
    let (mut sum, mut mass) = (0.0, 0.0);
    for i in 0..f.id.len() {
        let at = [f.position[0][i] as f64, f.position[2][i] as f64];
        if takes(at) {
            sum += f.mass[i] as f64 * of(i, at);
            mass += f.mass[i] as f64;
        }
    }
    sum / mass
}

/// Gives `state` the velocity `field`, m/s.
fn stir(state: &mut State, field: impl Fn(Point) -> Point) {
    let p = &mut state.particles;
    for i in 0..p.len() {
        let [u, w] = field([p.position[0][i], p.position[2][i]]);
        (p.velocity[0][i], p.velocity[2][i]) = (u, w);
    }
}

/// How much of `field` the velocities of a frame have: 1 where they are that field.
fn share(f: &Frame, field: impl Fn(Point) -> Point) -> f64 {
    let dot = |i: usize, at: Point| {
        let [u, w] = field(at);
        f.velocity[0][i] as f64 * u + f.velocity[2][i] as f64 * w
    };
    let square = |_: usize, at: Point| field(at).iter().map(|v| v * v).sum::<f64>();
    mean(f, |_| true, dot) / mean(f, |_| true, square)
}

/// Times at which a signal changes sign, interpolated.
fn crossings(track: &[(f64, f64)]) -> Vec<f64> {
    let pairs = track.windows(2).map(|w| (w[0], w[1]));
    let across = pairs.filter(|(a, b)| a.1 * b.1 < 0.0);
    across
        .map(|(a, b)| a.0 + (b.0 - a.0) * a.1 / (a.1 - b.1))
        .collect()
}

/// Frequency, 1/s, and decay, 1/s, of a damped cosine: from its zeros, and from the areas of the
/// half-waves between them.
fn oscillation(track: &[(f64, f64)]) -> Option<[f64; 2]> {
    let zeros = crossings(track);
    let last = zeros.len().checked_sub(1).filter(|last| *last >= 2)?;
    let half = (zeros[last] - zeros[0]) / last as f64;
    let area = |k: usize| {
        let inside = |t: f64| (zeros[k]..zeros[k + 1]).contains(&t);
        let part = track.iter().filter(|(t, _)| inside(*t));
        part.map(|(_, v)| v.abs()).sum::<f64>()
    };
    let fall = (area(0) / area(last - 1)).ln() / (last - 1) as f64;
    Some([PI / half, fall / half])
}

/// Packs and relaxes, lets `shape` change what there is, sets it in motion by `speed` times
/// `field`, and follows how much of that motion is left, every so often up to the end.
fn swing(
    scene: &Scene,
    field: impl Fn(Point) -> Point,
    speed: f64,
    [end, every]: [f64; 2],
    shape: impl Fn(&mut State),
) -> Vec<(f64, f64)> {
    let (mut state, strength) = begin(scene).expect("packs and relaxes");
    shape(&mut state);
    stir(&mut state, |at| field(at).map(|v| speed * v));
    let built = method::build(scene, state, Phase::Impact, strength);
    let mut solver = built.expect("builds");
    let mut track = Vec::new();
    run(solver.as_mut(), end, every, |f| {
        track.push((f.time, share(f, &field) / speed));
    })
    .expect("stays stable");
    track
}

#[test]
fn column_at_rest() {
    println!();
    let mut reached = 1.0;
    for spacing in affordable(&["1 mm", "0.5 mm", "0.25 mm"]) {
        let sets = [
            "dimension=3",
            "box.size=['20 mm','20 mm','25 mm']",
            "box.y=wall",
            &format!("pack.spacing={spacing}"),
        ];
        let scene = rings("hydrostatic", &sets);
        let depth = 0.02;
        let scale = scene.density * 9.81 * depth;
        let mut solver = start(&scene).expect("starts");
        let end = scene.impact.end;
        let (mut errors, mut energy) = (Vec::new(), Vec::new());
        run(solver.as_mut(), end, 0.02 * end, |f| {
            let wrong = |i: usize, at: Point| {
                (f.pressure[i] as f64 - scene.density * 9.81 * (depth - at[1])).powi(2)
            };
            let near = 4.0 * scene.spacing;
            let off = mean(f, |_| true, wrong).sqrt() / scale;
            let on = mean(f, |at| at[0] < near, wrong).sqrt() / scale;
            errors.push([on, off]);
            energy.push(crate::scalar(f, "kinetic_energy_J") / crate::scalar(f, "mass_kg"));
        })
        .expect("stays stable");
        let half = errors.len() / 2;
        let late = |k: usize| {
            let late = errors[half..].iter().map(|e| e[k]);
            late.sum::<f64>() / (errors.len() - half) as f64
        };
        let case = format!("column at rest, {spacing}");
        let all = figure(&case, "rms of p over rho g H", late(1), None, 0.005);
        let axis = figure(&case, "the same on the axis", late(0), None, 0.005);
        reached = all.max(axis);
        let part = |range: std::ops::Range<usize>| {
            let n = range.len() as f64;
            energy[range].iter().sum::<f64>() / n
        };
        let growth = part(half..energy.len()) / part(1..half);
        figure(
            &case,
            "kinetic energy, second half over first",
            growth,
            None,
            1.0,
        );
    }
    reaches("column at rest", reached, [0.006, 0.006, 0.025]);
}

#[test]
fn drop_at_rest() {
    println!();
    let mut reached = 1.0;
    for spacing in affordable(&["0.2 mm", "0.1 mm", "0.05 mm"]) {
        let scene = rings("static-drop", &[&format!("pack.spacing={spacing}")]);
        let (radius, middle) = (0.002, 0.003);
        let theory = 2.0 * scene.effects.sigma().unwrap() / radius;
        let mut solver = start(&scene).expect("starts");
        let end = scene.impact.end;
        let mut found = [0.0; 3];
        run(solver.as_mut(), end, 0.01 * end, |f| {
            if f.time > 0.5 * end {
                let p = |i: usize, _: Point| f.pressure[i] as f64;
                let inside = |at: Point| at[0].hypot(at[1] - middle) < 0.6 * radius;
                let near = |at: Point| inside(at) && at[0] < 4.0 * scene.spacing;
                found[0] += mean(f, inside, p);
                found[1] += mean(f, near, p);
                found[2] += 1.0;
            }
        })
        .expect("stays stable");
        let case = format!("drop at rest, R = {:.0} s0", radius / scene.spacing);
        let got = |k: usize| found[k] / found[2];
        let what = "pressure in the core, Pa";
        reached = figure(&case, what, got(0), Some(theory), 0.01);
        figure(&case, "the same on the axis", got(1), Some(theory), 0.01);
    }
    reaches("drop at rest", reached, [0.01, 0.06, 0.06]);
}

/// The velocity of a drop in mode `n`: the gradient of r^n P_n(cos t), 1 at the pole.
fn mode(n: i32, radius: f64, middle: f64, [x, z]: Point) -> Point {
    let z = z - middle;
    // Solid harmonics of the axis and their gradients.
    let [u, w] = match n {
        2 => [-x, 2.0 * z],
        3 => [-3.0 * x * z, 3.0 * z * z - 1.5 * x * x],
        _ => [
            -6.0 * x * z * z + 1.5 * x.powi(3),
            4.0 * z.powi(3) - 6.0 * x * x * z,
        ],
    };
    let scale = n as f64 * radius.powi(n - 1);
    [u / scale, w / scale]
}

#[test]
fn oscillating_drop() {
    println!();
    let mut reached = 1.0;
    for spacing in affordable(&["0.125 mm", "0.0625 mm"]) {
        for n in [2, 3, 4] {
            let sets = [
                format!("pack.spacing={spacing}"),
                "body.drop.stretch={rate=0}".into(),
                format!("impact.end={} ms", [60, 32, 20][n as usize - 2]),
            ];
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let scene = rings("oscillating-drop", &sets);
            let (radius, middle) = (0.002f64, 0.003);
            let (sigma, rho) = (scene.effects.sigma().unwrap(), scene.density);
            let nu = scene.effects.mu().unwrap() / rho;
            let order = n as f64;
            let square = order * (order - 1.0) * (order + 2.0) * sigma / (rho * radius.powi(3));
            let decay = (order - 1.0) * (2.0 * order + 1.0) * nu / (radius * radius);
            let omega = (square - decay * decay).sqrt();
            let speed = 0.03 * radius * omega;
            let field = |at: Point| mode(n, radius, middle, at);
            let end = scene.impact.end;
            let track = swing(&scene, field, speed, [end, 0.0025 * end], |_| ());
            let [found, fall] = oscillation(&track).unwrap_or([f64::NAN; 2]);
            let case = format!("mode {n}, R = {:.0} s0", radius / scene.spacing);
            let wrong = figure(&case, "frequency, 1/s", found, Some(omega), 0.01);
            figure(&case, "decay, 1/s", fall, Some(decay), 0.15);
            if n == 2 {
                reached = wrong;
            }
        }
    }
    reaches("mode 2", reached, [0.01, 0.09, 0.03]);
}
