//! Walls: hydrostatic column, Poiseuille flow.

use crate::{report, run, scalar, scene, start};

#[test]
fn hydrostatic() {
    let scene = scene("hydrostatic", &[]);
    let depth = 0.02;
    let mut solver = start(&scene);
    let scale = scene.density * 9.81 * depth;
    let (mut worst, mut energy): (f64, Vec<f64>) = (0.0, Vec::new());
    run(
        solver.as_mut(),
        scene.impact.end,
        0.02 * scene.impact.end,
        |f| {
            let n = f.id.len() as f64;
            let mut square = 0.0;
            for i in 0..f.id.len() {
                let wanted = scene.density * 9.81 * (depth - f.position[2][i] as f64);
                square += (f.pressure[i] as f64 - wanted).powi(2) / n;
            }
            worst = square.sqrt() / scale;
            energy.push(scalar(f, "kinetic_energy_J"));
            println!(
                "  t {:.3e} rms {:.4} KE {:.3e}",
                f.time,
                worst,
                energy[energy.len() - 1]
            );
        },
    );
    report(
        "hydrostatic",
        "1 + rms pressure error / rho g H",
        1.0 + worst,
        1.0,
        0.01,
    );
    let half = energy.len() / 2;
    let mean = |e: &[f64]| e.iter().sum::<f64>() / e.len() as f64;
    println!(
        "  KE first half {:.3e}, second half {:.3e}",
        mean(&energy[..half]),
        mean(&energy[half..])
    );
    assert!(worst <= 0.01 && mean(&energy[half..]) <= 1.05 * mean(&energy[..half]));
}

#[test]
fn poiseuille() {
    let scene = scene("poiseuille", &[]);
    let width = scene.domain.size[2];
    let nu = scene.effects.viscosity.unwrap() / scene.density;
    let force = scene.effects.gravity.unwrap()[0];
    let top = force * width * width / (8.0 * nu);
    let mut solver = start(&scene);
    let mut worst = 0.0;
    run(
        solver.as_mut(),
        scene.impact.end,
        0.1 * scene.impact.end,
        |f| {
            worst = (0..f.id.len())
                .map(|i| {
                    let z = f.position[2][i] as f64;
                    let wanted = force / (2.0 * nu) * z * (width - z)
                        - start_up(force, nu, width, z, f.time);
                    (f.velocity[0][i] as f64 - wanted).abs() / top
                })
                .fold(0.0, f64::max);
            println!(
                "  t {:.3e} worst {:.4} umax {:.4e} of {top:.4e}",
                f.time,
                worst,
                scalar(f, "speed_max_m_s")
            );
        },
    );
    assert!(report(
        "poiseuille",
        "1 + worst velocity error / u_max",
        1.0 + worst,
        1.0,
        0.01
    ));
}

/// What start-up still lacks of the steady profile (Morris, Fox & Zhu 1997).
fn start_up(force: f64, nu: f64, width: f64, z: f64, t: f64) -> f64 {
    use std::f64::consts::PI;
    (0..50)
        .map(|n| {
            let m = (2 * n + 1) as f64;
            4.0 * force * width * width / (nu * (PI * m).powi(3))
                * (PI * z * m / width).sin()
                * (-m * m * PI * PI * nu * t / (width * width)).exp()
        })
        .sum()
}
