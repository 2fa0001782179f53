//! Taylor-Green vortices and the dam break.

use crate::{report, run, scalar, scene, start};

#[test]
fn taylor_green() {
    let scene = scene("taylor-green", &[]);
    let nu = scene.effects.viscosity.unwrap() / scene.density;
    let k = std::f64::consts::TAU / scene.domain.size[0];
    let mut solver = start(&scene);
    let mut track = Vec::new();
    run(
        solver.as_mut(),
        scene.impact.end,
        0.02 * scene.impact.end,
        |f| {
            track.push((f.time, scalar(f, "kinetic_energy_J")));
        },
    );
    // Decay rate of the energy by least squares on its logarithm.
    let (first, e0) = track[0];
    let used: Vec<_> = track.iter().filter(|t| t.1 > 1e-2 * e0).collect();
    let n = used.len() as f64;
    let (tm, lm) = used
        .iter()
        .fold((0.0, 0.0), |s, t| (s.0 + t.0 / n, s.1 + t.1.ln() / n));
    let slope = used
        .iter()
        .map(|t| (t.0 - tm) * (t.1.ln() - lm))
        .sum::<f64>()
        / used.iter().map(|t| (t.0 - tm).powi(2)).sum::<f64>();
    println!(
        "  from t {first:.2e}: {} frames to E/E0 {:.2e}",
        used.len(),
        used[used.len() - 1].1 / e0
    );
    assert!(report(
        "taylor-green",
        "decay rate, 1/s",
        -slope,
        4.0 * nu * k * k,
        0.03
    ));
}

/// Front position of Martin & Moyce (1952), n^2 = 2, a = 2.25 in: T = t sqrt(2 g / a), Z = x / a.
const MARTIN_MOYCE: [(f64, f64); 15] = [
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

#[test]
fn dam_break() {
    let scene = scene("dam-break", &[]);
    let a = 0.057;
    let mut solver = start(&scene);
    let mut track = Vec::new();
    run(
        solver.as_mut(),
        3.5 / (2.0 * 9.81f64 / a).sqrt(),
        1e-3,
        |f| {
            let front = f.position[0].iter().fold(0.0f64, |m, x| m.max(*x as f64));
            track.push((
                f.time * (2.0 * 9.81 / a).sqrt(),
                (front + 0.5 * scene.pack.spacing) / a,
            ));
        },
    );
    let at = |t: f64| {
        let k = track
            .iter()
            .position(|p| p.0 >= t)
            .unwrap_or(track.len() - 1)
            .max(1);
        let (p, q) = (track[k - 1], track[k]);
        p.1 + (q.1 - p.1) * (t - p.0) / (q.0 - p.0)
    };
    let mut sum = 0.0;
    for (t, z) in MARTIN_MOYCE {
        println!(
            "  T {t:.2}: {:.3} measured {z:.3} ({:+.1} %)",
            at(t),
            100.0 * (at(t) / z - 1.0)
        );
        sum += (at(t) / z - 1.0).abs() / MARTIN_MOYCE.len() as f64;
    }
    assert!(report(
        "dam-break",
        "1 + mean front error",
        1.0 + sum,
        1.0,
        0.05
    ));
}
