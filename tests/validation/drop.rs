//! Drops without gravity.

use crate::{report, run, scalar, scene, start};
use coronet::particle::Frame;
use coronet::scene::Shape;

/// Mean pressure of the particles within `part` of the radius from the centre of mass, Pa.
fn core_pressure(frame: &Frame, radius: f64) -> f64 {
    let n = frame.id.len() as f64;
    let centre: Vec<f64> = frame
        .position
        .iter()
        .map(|x| x.iter().map(|x| *x as f64).sum::<f64>() / n)
        .collect();
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..frame.id.len() {
        let r2: f64 = (0..3)
            .map(|a| (frame.position[a][i] as f64 - centre[a]).powi(2))
            .sum();
        if r2 < radius * radius {
            sum += frame.pressure[i] as f64;
            count += 1.0;
        }
    }
    sum / count
}

fn young_laplace(name: &str, sets: &[&str], dimension: f64) -> f64 {
    let scene = scene(name, sets);
    let mut solver = start(&scene);
    let Shape::Sphere { radius, .. } = scene.bodies[0].shape else {
        panic!("a round drop")
    };
    let wanted = (dimension - 1.0) * scene.effects.tension.unwrap() / radius;
    let (mut sum, mut count, mut speed) = (0.0, 0.0, 0.0);
    let end = scene.impact.end;
    run(solver.as_mut(), end, 0.02 * end, |f| {
        let p = core_pressure(f, 0.6 * radius);
        println!(
            "  t {:.2e} p {p:.2} ({:+.2} %) KE {:.2e} umax {:.2e} dt {:.2e}",
            f.time,
            100.0 * (p / wanted - 1.0),
            scalar(f, "kinetic_energy_J"),
            scalar(f, "speed_max_m_s"),
            scalar(f, "time_step_s")
        );
        if f.time > 0.5 * end {
            sum += p;
            count += 1.0;
            speed = scalar(f, "speed_max_m_s");
        }
    });
    let mu = scene.effects.viscosity.unwrap_or(0.0);
    println!(
        "  spurious Ca = {:.2e}",
        mu * speed / scene.effects.tension.unwrap()
    );
    report(name, "pressure, Pa", sum / count, wanted, 0.03);
    sum / count / wanted - 1.0
}

#[test]
fn static_drop_2d() {
    let error = young_laplace("static-drop-2d", &[], 2.0);
    assert!(error.abs() <= 0.03);
}

#[test]
fn static_drop() {
    let error = young_laplace("static-drop", &[], 3.0);
    assert!(error.abs() <= 0.03);
}

#[test]
fn oscillating_drop() {
    let scene = scene("oscillating-drop", &[]);
    let Shape::Sphere { radius, .. } = scene.bodies[0].shape else {
        panic!("a round drop")
    };
    let sigma = scene.effects.tension.unwrap();
    let omega = (8.0 * sigma / (scene.density * radius.powi(3))).sqrt();
    let mut solver = start(&scene);
    let mut track = Vec::new();
    run(solver.as_mut(), scene.impact.end, 2e-4, |f| {
        let n = f.id.len() as f64;
        let moment = |a: usize| {
            let mean = f.position[a].iter().map(|x| *x as f64).sum::<f64>() / n;
            f.position[a]
                .iter()
                .map(|x| (*x as f64 - mean).powi(2))
                .sum::<f64>()
                / n
        };
        let (x, y, z) = (moment(0), moment(1), moment(2));
        track.push((f.time, (z / (0.5 * (x + y))).sqrt() - 1.0));
    });
    let crossings = crossings(&track);
    println!(
        "  crossings {crossings:?}; amplitude {:?}",
        track.iter().map(|t| t.1).fold(0.0, f64::max)
    );
    assert!(crossings.len() >= 3, "the drop oscillates");
    let half = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    assert!(report(
        "oscillating-drop",
        "period, s",
        2.0 * half,
        std::f64::consts::TAU / omega,
        0.03
    ));
}

/// Times at which a signal crosses its mean, interpolated, after the start.
fn crossings(track: &[(f64, f64)]) -> Vec<f64> {
    let mut found = Vec::new();
    for w in track.windows(2) {
        let ((t0, a), (t1, b)) = (w[0], w[1]);
        if a * b < 0.0 {
            found.push(t0 + (t1 - t0) * a / (a - b));
        }
    }
    found
}
