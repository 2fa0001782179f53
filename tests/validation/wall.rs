//! Walls: hydrostatic column, Poiseuille and Couette flow.

use crate::{Figure, presets, run, scalar, scene, start};
use coronet::method::Diverged;
use coronet::scene::Scene;
use std::f64::consts::PI;

#[test]
fn hydrostatic() {
    presets("hydrostatic", |preset| {
        let scene = scene("hydrostatic", preset, &[]);
        let depth = 0.02;
        let mut solver = start(&scene)?;
        let scale = scene.density * 9.81 * depth;
        let (mut errors, mut energy): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let end = scene.impact.end;
        run(solver.as_mut(), end, 0.02 * end, |f| {
            let wrong = |i: usize| {
                let wanted = scene.density * 9.81 * (depth - f.position[2][i] as f64);
                (f.pressure[i] as f64 - wanted).powi(2)
            };
            let n = f.id.len();
            errors.push(((0..n).map(wrong).sum::<f64>() / n as f64).sqrt() / scale);
            energy.push(scalar(f, "kinetic_energy_J") / scalar(f, "mass_kg"));
        })?;
        let half = errors.len() / 2;
        let mean = |e: &[f64]| e.iter().sum::<f64>() / e.len() as f64;
        // Over what the column would gain by falling by one spacing.
        let unit = 9.81 * scene.spacing;
        println!(
            "  kinetic energy over g s0: {:.1e} in the first half, {:.1e} in the second",
            mean(&energy[..half]) / unit,
            mean(&energy[half..]) / unit
        );
        let figure = |what, got, target| Figure {
            case: "hydrostatic",
            preset,
            what,
            got,
            theory: None,
            target,
        };
        let pressure = figure(
            "rms of p over rho g H, second half",
            mean(&errors[half..]),
            0.01,
        );
        let last = figure("the same at the end", errors[errors.len() - 1], 0.01);
        let still = mean(&energy[half + half / 2..]) / unit;
        let motion = figure("kinetic energy over g s0 at the end", still, 1e-4);
        Ok([pressure.row(), last.row(), motion.row()]
            .iter()
            .all(|kept| *kept))
    });
}

/// Largest error of v_x over `top` at any of ten times, and at the end.
pub fn profile(
    scene: &Scene,
    top: f64,
    theory: impl Fn(f64, f64) -> f64,
) -> Result<[f64; 2], Diverged> {
    let mut solver = start(scene)?;
    let (mut worst, mut last): (f64, f64) = (0.0, 0.0);
    run(
        solver.as_mut(),
        scene.impact.end,
        0.1 * scene.impact.end,
        |f| {
            let wrong = |i: usize| {
                let wanted = theory(f.position[2][i] as f64, f.time);
                (f.velocity[0][i] as f64 - wanted).abs() / top
            };
            last = (0..f.id.len()).map(wrong).fold(0.0, f64::max);
            // The plate starts in no time; its layer must first be wider than the spacing.
            if f.time > 0.05 * scene.impact.end {
                worst = worst.max(last);
            }
        },
    )?;
    Ok([worst, last])
}

/// Errors of [`profile`] in the scene of Poiseuille flow.
pub fn poiseuille_errors(scene: &Scene) -> Result<[f64; 2], Diverged> {
    let width = scene.domain.size[2];
    let nu = scene.effects.mu().unwrap() / scene.density;
    let force = scene.effects.gravity.unwrap()[0];
    let top = force * width * width / (8.0 * nu);
    profile(scene, top, |z, t| {
        // What start-up still lacks of the steady profile (Morris, Fox & Zhu 1997).
        let lack = |n: i32| {
            let m = (2 * n + 1) as f64;
            4.0 * force * width * width / (nu * (PI * m).powi(3))
                * (PI * z * m / width).sin()
                * (-m * m * PI * PI * nu * t / (width * width)).exp()
        };
        force / (2.0 * nu) * z * (width - z) - (0..50).map(lack).sum::<f64>()
    })
}

fn couette_errors(scene: &Scene) -> Result<[f64; 2], Diverged> {
    let width = scene.domain.size[2];
    let nu = scene.effects.mu().unwrap() / scene.density;
    let speed = 0.01;
    profile(scene, speed, |z, t| {
        let lack = |n: i32| {
            let m = n as f64;
            2.0 * speed / (m * PI)
                * f64::powi(-1.0, n)
                * (m * PI * z / width).sin()
                * (-nu * (m * PI / width).powi(2) * t).exp()
        };
        speed * z / width + (1..200).map(lack).sum::<f64>()
    })
}

fn rows(case: &str, preset: &str, errors: [f64; 2]) -> bool {
    let what = [
        "worst error of v over v_max, from t/10 on",
        "the same in the steady state",
    ];
    let row = |k: usize| {
        Figure {
            case,
            preset,
            what: what[k],
            got: errors[k],
            theory: None,
            target: 0.01,
        }
        .row()
    };
    row(0) & row(1)
}

#[test]
fn poiseuille() {
    presets("poiseuille", |preset| {
        let scene = scene("poiseuille", preset, &[]);
        Ok(rows("poiseuille", preset, poiseuille_errors(&scene)?))
    });
}

#[test]
fn couette() {
    presets("couette", |preset| {
        let scene = scene("couette", preset, &[]);
        Ok(rows("couette", preset, couette_errors(&scene)?))
    });
}

/// Steady profile of a film without stress at its surface (Nusselt 1916).
#[test]
fn film() {
    presets("film", |preset| {
        let scene = scene("film", preset, &[]);
        let depth = 2e-3;
        let nu = scene.effects.mu().unwrap() / scene.density;
        let force = scene.effects.gravity.unwrap()[0];
        let top = force * depth * depth / (2.0 * nu);
        let mut solver = start(&scene)?;
        let (mut square, mut mean) = (0.0, 0.0);
        run(solver.as_mut(), scene.impact.end, scene.impact.end, |f| {
            let n = f.id.len() as f64;
            let wrong = |i: usize| {
                let z = f.position[2][i] as f64;
                let wanted = force / (2.0 * nu) * z * (2.0 * depth - z);
                f.velocity[0][i] as f64 - wanted
            };
            square = (0..f.id.len()).map(|i| wrong(i).powi(2)).sum::<f64>() / n;
            mean = (0..f.id.len())
                .map(|i| f.velocity[0][i] as f64)
                .sum::<f64>()
                / n;
        })?;
        let figure = |what, got, theory| Figure {
            case: "film",
            preset,
            what,
            got,
            theory,
            target: 0.01,
        };
        let profile = figure("rms error of v over v_max", square.sqrt() / top, None);
        let flow = figure("mean velocity, m/s", mean, Some(2.0 / 3.0 * top));
        Ok(profile.row() & flow.row())
    });
}
