//! Taylor-Green vortices and the dam break.

use crate::{Figure, net_momentum, potential, presets, run, scalar, scene, start};
use coronet::method::Diverged;
use coronet::scene::Scene;

/// Decay rate of the kinetic energy by least squares on its logarithm down to 1 %, over theory, and
/// the largest net momentum over the sum of m |v|.
pub fn decay(scene: &Scene) -> Result<[f64; 3], Diverged> {
    let nu = scene.effects.mu().unwrap() / scene.density;
    let k = std::f64::consts::TAU / scene.domain.size[0];
    let mut solver = start(scene)?;
    let (mut track, mut net) = (Vec::new(), 0.0f64);
    run(
        solver.as_mut(),
        scene.impact.end,
        0.02 * scene.impact.end,
        |f| {
            track.push((f.time, scalar(f, "kinetic_energy_J")));
            net = net.max(net_momentum(f));
        },
    )?;
    let e0 = track[0].1;
    let used = track.iter().filter(|t| t.1 > 1e-2 * e0);
    let used: Vec<_> = used.map(|t| (t.0, t.1.ln())).collect();
    Ok([-slope(&used), 4.0 * nu * k * k, net])
}

/// Slope of y over x by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = points
        .iter()
        .fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
    let rise = points.iter().map(|p| (p.0 - mean.0) * (p.1 - mean.1));
    let run = points.iter().map(|p| (p.0 - mean.0).powi(2));
    rise.sum::<f64>() / run.sum::<f64>()
}

/// y at x between points in the order of x, or on the line through the last two.
pub fn between(points: &[(f64, f64)], x: f64) -> f64 {
    let k = points.iter().position(|p| p.0 >= x);
    let k = k.unwrap_or(points.len() - 1).max(1);
    let (p, q) = (points[k - 1], points[k]);
    p.1 + (q.1 - p.1) * (x - p.0) / (q.0 - p.0)
}

#[test]
fn taylor_green() {
    presets("taylor-green", |preset| {
        let scene = scene("taylor-green", preset, &[]);
        let [rate, theory, net] = decay(&scene)?;
        let figure = |what, got, theory, target| Figure {
            case: "taylor-green",
            preset,
            what,
            got,
            theory,
            target,
        };
        let rate = figure("decay rate of the energy, 1/s", rate, Some(theory), 0.03);
        let net = figure("net momentum over sum of m abs(v)", net, None, 1e-5);
        Ok(rate.row() & net.row())
    });
}

/// Front position of Martin & Moyce (1952), n^2 = 2, a = 2.25 in: T = t sqrt(2 g / a), Z = x / a.
pub const MARTIN_MOYCE: [(f64, f64); 15] = [
    (0.41, 1.11),
    (0.84, 1.22),
    (1.19, 1.44),
    (1.43, 1.67),
    (1.63, 1.89),
    (1.83, 2.11),
    (1.98, 2.33),
    (2.20, 2.56),
    (2.32, 2.78),
    (2.51, 3.00),
    (2.65, 3.22),
    (2.83, 3.44),
    (2.98, 3.67),
    (3.11, 3.89),
    (3.33, 4.11),
];

/// Front over the width a of the column, over t sqrt(2 g / a).
pub fn front(scene: &Scene) -> Result<Vec<(f64, f64)>, Diverged> {
    let a = 0.057;
    let clock = (2.0 * 9.81f64 / a).sqrt();
    let mut solver = start(scene)?;
    let mut track = Vec::new();
    run(solver.as_mut(), 3.5 / clock, 1e-3, |f| {
        let front = (0..f.id.len()).map(|i| f.position[0][i] as f64);
        let front = front.fold(0.0f64, f64::max) + 0.5 * scene.spacing;
        track.push((f.time * clock, front / a));
    })?;
    Ok(track)
}

/// Mean relative difference of a front from another, at the experiment's times.
pub fn front_error(track: &[(f64, f64)], theory: &[(f64, f64)]) -> f64 {
    let wrong = |(t, _): (f64, f64)| (between(track, t) / between(theory, t) - 1.0).abs();
    MARTIN_MOYCE.map(wrong).iter().sum::<f64>() / MARTIN_MOYCE.len() as f64
}

/// Speed of a front through the experiment's places from Z = 1.44 on, before which a membrane holds
/// the column back.
fn speed(track: &[(f64, f64)]) -> f64 {
    let turned: Vec<_> = track.iter().map(|(t, z)| (*z, *t)).collect();
    let reached = MARTIN_MOYCE[2..]
        .iter()
        .map(|p| (between(&turned, p.1), p.1));
    slope(&reached.collect::<Vec<_>>())
}

#[test]
fn dam_break() {
    let theory = potential::front(2.0, 3.5, &potential::Grid::new(0.01));
    presets("dam-break", |preset| {
        let scene = scene("dam-break", preset, &[]);
        let track = front(&scene)?;
        let figure = |what, got, theory| Figure {
            case: "dam-break",
            preset,
            what,
            got,
            theory,
            target: 0.05,
        };
        let error = front_error(&track, &theory);
        let error = figure("mean error of the front, potential flow", error, None).row();
        let experiment = front_error(&track, &MARTIN_MOYCE);
        figure(
            "the same, experiment by its published clock",
            experiment,
            None,
        )
        .row();
        let what = "speed of the front over sqrt(2g a), Z from 1.44 to 4.11";
        let speed = figure(what, speed(&track), Some(speed(&MARTIN_MOYCE)));
        Ok(error & speed.row())
    });
}
