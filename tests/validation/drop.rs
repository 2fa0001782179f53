//! Drops without gravity.

use crate::{Figure, net_momentum, presets, run, scalar, scene, start};
use coronet::method::Diverged;
use coronet::particle::Frame;
use coronet::scene::{Scene, Shape};
use std::f64::consts::{PI, TAU};

/// Distances of all particles from the centre of mass, m.
fn distances(frame: &Frame) -> Vec<f64> {
    let n = frame.id.len() as f64;
    let mean = |x: &Vec<f32>| x.iter().map(|x| *x as f64).sum::<f64>() / n;
    let centre = [0, 1, 2].map(|a| mean(&frame.position[a]));
    let square = |i: usize, a: usize| (frame.position[a][i] as f64 - centre[a]).powi(2);
    (0..frame.id.len())
        .map(|i| (0..3).map(|a| square(i, a)).sum::<f64>().sqrt())
        .collect()
}

/// The largest distance in each of 32 sectors of the x-z plane, m.
fn outline(frame: &Frame, r: &[f64]) -> Vec<f64> {
    let n = frame.id.len() as f64;
    let mean = [0, 2].map(|a| frame.position[a].iter().map(|x| *x as f64).sum::<f64>() / n);
    let mut farthest = vec![0.0f64; 32];
    for i in 0..r.len() {
        let x = frame.position[0][i] as f64 - mean[0];
        let z = frame.position[2][i] as f64 - mean[1];
        let sector = ((z.atan2(x) / TAU + 0.5) * 32.0) as usize;
        farthest[sector.min(31)] = farthest[sector.min(31)].max(r[i]);
    }
    farthest
}

/// What a drop shows over the second half of a run.
pub struct Rest {
    /// Mean pressure within 0.6 R of the centre, Pa, and its standard deviation in time.
    pub pressure: f64,
    pub scatter: f64,
    /// Radius from the second moment, m.
    pub radius: f64,
    /// Capillary number of the largest speed, and largest net momentum over sum of m |v|.
    pub capillary: f64,
    pub net: f64,
    /// Mass that left as spray over what is left.
    pub lost: f64,
    /// Kinetic energy, J: last over largest of the run.
    pub energy: f64,
    /// Standard deviation over mean of the outline's distance at the end (2-D).
    pub out_of_round: f64,
}

pub fn rest(scene: &Scene, radius: f64) -> Result<Rest, Diverged> {
    let d = scene.dimension.count() as f64;
    let mut solver = start(scene)?;
    let (mut pressures, mut radii, mut energy) = (Vec::new(), Vec::new(), Vec::new());
    let (mut speed, mut net, mut round, mut lost) = (0.0, 0.0f64, 0.0, 0.0);
    let end = scene.impact.end;
    run(solver.as_mut(), end, 0.01 * end, |f| {
        let r = distances(f);
        energy.push(scalar(f, "kinetic_energy_J"));
        if f.time < 0.5 * end {
            return;
        }
        let core: Vec<usize> = (0..r.len()).filter(|i| r[*i] < 0.6 * radius).collect();
        let sum: f64 = core.iter().map(|i| f.pressure[*i] as f64).sum();
        pressures.push(sum / core.len() as f64);
        let second = r.iter().map(|r| r * r).sum::<f64>() / r.len() as f64;
        radii.push((second * (d + 2.0) / d).sqrt());
        speed = f64::max(speed, scalar(f, "speed_max_m_s"));
        net = net.max(net_momentum(f));
        lost = scalar(f, "mass_removed_kg") / scalar(f, "mass_kg");
        let edge = outline(f, &r);
        let (mean, deviation) = mean_and_deviation(&edge);
        round = deviation / mean;
    })?;
    let (pressure, scatter) = mean_and_deviation(&pressures);
    let sigma = scene.effects.sigma().unwrap();
    Ok(Rest {
        pressure,
        scatter,
        radius: mean_and_deviation(&radii).0,
        capillary: scene.effects.mu().unwrap_or(0.0) * speed / sigma,
        net,
        lost,
        energy: energy[energy.len() - 1] / energy.iter().fold(0.0, |m: f64, e| m.max(*e)),
        out_of_round: round,
    })
}

fn mean_and_deviation(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let square = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    (mean, square.sqrt())
}

pub fn sphere(scene: &Scene) -> f64 {
    match scene.bodies[0].shape {
        Shape::Sphere { radius, .. } => radius,
        _ => panic!("a round drop"),
    }
}

fn young_laplace(case: &str, preset: &str, sets: &[&str], target: f64) -> Result<bool, Diverged> {
    let scene = scene(case, preset, sets);
    let radius = sphere(&scene);
    let theory = (scene.dimension.count() as f64 - 1.0) * scene.effects.sigma().unwrap() / radius;
    let rest = rest(&scene, radius)?;
    println!(
        "  R = {:.1} s0, scatter of p {:.2} %, Ca {:.1e}, radius {:+.2} %, KE {:.1e} of its peak, \
         spray {:.1e}",
        radius / scene.spacing,
        100.0 * rest.scatter / theory,
        rest.capillary,
        100.0 * (rest.radius / radius - 1.0),
        rest.energy,
        rest.lost
    );
    let figure = |what, got, theory, target| Figure {
        case,
        preset,
        what,
        got,
        theory,
        target,
    };
    figure(
        "pressure in the core, Pa",
        rest.pressure,
        Some(theory),
        target,
    )
    .row();
    figure("net momentum over sum of m abs(v)", rest.net, None, 1e-3).row();
    Ok(figure(
        "capillary number of the currents",
        rest.capillary,
        None,
        0.01,
    )
    .row())
}

#[test]
fn static_drop_2d() {
    presets("static-drop-2d", |preset| {
        young_laplace("static-drop-2d", preset, &[], 0.03)
    });
}

#[test]
fn static_drop() {
    presets("static-drop", |preset| {
        let coarse = ["pack.spacing=0.2 mm", "impact.end=10 ms"];
        let sets: &[&str] = if preset == "modern" { &[] } else { &coarse };
        young_laplace("static-drop", preset, sets, 0.03)
    });
}

#[test]
fn square_to_circle() {
    presets("square-to-circle", |preset| {
        let scene = scene("square-to-circle", preset, &[]);
        let radius = 4e-3 / PI.sqrt();
        let rest = rest(&scene, radius)?;
        let theory = scene.effects.sigma().unwrap() / radius;
        println!(
            "  KE {:.1e} of its peak, Ca {:.1e}",
            rest.energy, rest.capillary
        );
        let figure = |what, got, theory, target| Figure {
            case: "square-to-circle",
            preset,
            what,
            got,
            theory,
            target,
        };
        let size = figure("radius, m", rest.radius, Some(radius), 0.01);
        let round = figure(
            "deviation from a circle over R",
            rest.out_of_round,
            None,
            0.01,
        );
        figure(
            "pressure in the core, Pa",
            rest.pressure,
            Some(theory),
            0.05,
        )
        .row();
        Ok(size.row() & round.row())
    });
}

/// Period of the second mode, s, and the amplitude of the first swing over R.
fn period(scene: &Scene) -> Result<[f64; 2], Diverged> {
    let mut solver = start(scene)?;
    let mut track = Vec::new();
    run(solver.as_mut(), scene.impact.end, 2e-4, |f| {
        let n = f.id.len() as f64;
        let moment = |a: usize| {
            let mean = f.position[a].iter().map(|x| *x as f64).sum::<f64>() / n;
            let square = |x: &f32| (*x as f64 - mean).powi(2);
            f.position[a].iter().map(square).sum::<f64>() / n
        };
        let (x, y, z) = (moment(0), moment(1), moment(2));
        track.push((f.time, (z / (0.5 * (x + y))).sqrt() - 1.0));
    })?;
    let found = crossings(&track);
    assert!(found.len() >= 3, "the drop oscillates: {found:?}");
    let half = (found[found.len() - 1] - found[0]) / (found.len() - 1) as f64;
    // The ratio of the axes moves by 3/2 of the amplitude of the pole.
    let swing = track.iter().map(|t| t.1).fold(0.0, f64::max) / 1.5;
    Ok([2.0 * half, swing])
}

#[test]
fn oscillating_drop() {
    presets("oscillating-drop", |preset| {
        let coarse = ["pack.spacing=0.25 mm"];
        let sets: &[&str] = if preset == "modern" { &[] } else { &coarse };
        let scene = scene("oscillating-drop", preset, sets);
        let radius = sphere(&scene);
        let sigma = scene.effects.sigma().unwrap();
        let omega = (8.0 * sigma / (scene.density * radius.powi(3))).sqrt();
        let [period, swing] = period(&scene)?;
        println!(
            "  R = {:.0} s0, amplitude {swing:.3} R",
            radius / scene.spacing
        );
        let figure = Figure {
            case: "oscillating-drop",
            preset,
            what: "period, s",
            got: period,
            theory: Some(TAU / omega),
            target: 0.03,
        };
        Ok(figure.row())
    });
}

/// Times at which a signal changes sign, interpolated.
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
