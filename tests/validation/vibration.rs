//! The first mode of a tank that is driven below, at and above its frequency.

use crate::{Figure, presets, run, scalar, scene, start};
use coronet::method::Diverged;
use std::f64::consts::{PI, TAU};

/// omega of the first mode, 1/s: omega^2 = (g k + sigma k^3 / rho) tanh(k H), k = pi / L (Lamb
/// 1932, arts. 228, 267), of a tank L wide and filled to H, m.
fn first_mode(width: f64, depth: f64, tension: f64, density: f64) -> f64 {
    let k = PI / width;
    ((9.81 * k + tension * k.powi(3) / density) * (k * depth).tanh()).sqrt()
}

/// Velocity of q'' + 2 gamma q' + omega^2 q = sin(drive t) from rest, at the times `at`, s.
fn response(omega: f64, gamma: f64, drive: f64, at: &[f64]) -> Vec<f64> {
    let rate = |t: f64, [q, v]: [f64; 2]| {
        let a = (drive * t).sin() - 2.0 * gamma * v - omega * omega * q;
        [v, a]
    };
    let (mut t, mut y) = (0.0, [0.0; 2]);
    let mut found = Vec::new();
    for &end in at {
        let steps = ((end - t) * omega.max(drive) / 0.02).ceil().max(1.0);
        let h = (end - t) / steps;
        for _ in 0..steps as usize {
            // Classical Runge-Kutta.
            let ahead = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
            let k1 = rate(t, y);
            let k2 = rate(t + 0.5 * h, ahead(k1, 0.5));
            let k3 = rate(t + 0.5 * h, ahead(k2, 0.5));
            let k4 = rate(t + h, ahead(k3, 1.0));
            for c in 0..2 {
                y[c] += h / 6.0 * (k1[c] + 2.0 * k2[c] + 2.0 * k3[c] + k4[c]);
            }
            t += h;
        }
        found.push(y[1]);
    }
    found
}

/// What of `values` no multiple of the response explains, as a part of their squares.
fn misfit(omega: f64, gamma: f64, drive: f64, at: &[f64], values: &[f64]) -> f64 {
    let model = response(omega, gamma, drive, at);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = dot(&model, values) / dot(&model, &model);
    let left = model
        .iter()
        .zip(values)
        .map(|(m, v)| (v - scale * m).powi(2));
    left.sum::<f64>() / dot(values, values)
}

/// The frequency and damping, 1/s, that explain `values` best, near `guess`.
fn fitted(guess: f64, drive: f64, at: &[f64], values: &[f64]) -> [f64; 3] {
    let mut best = [f64::INFINITY, guess, 0.0];
    let (mut width, mut damping) = (0.2 * guess, 0.1 * guess);
    while width > 1e-4 * guess {
        let [_, omega, gamma] = best;
        for i in -10..=10 {
            for j in -5..=5 {
                let omega = omega + 0.1 * i as f64 * width;
                let gamma = (gamma + 0.2 * j as f64 * damping).max(0.0);
                let left = misfit(omega, gamma, drive, at, values);
                if left < best[0] {
                    best = [left, omega, gamma];
                }
            }
        }
        (width, damping) = (0.3 * width, 0.3 * damping);
    }
    best
}

/// A tank of water, `width` wide and half as deep, in which a wave of `amplitude`, both in mm, is
/// driven at `part` of its first frequency; whether that is met or known not to be.
fn drive(
    case: &str,
    preset: &str,
    width: f64,
    [part, amplitude]: [f64; 2],
) -> Result<bool, Diverged> {
    let depth = 0.5 * width;
    let free = first_mode(1e-3 * width, 1e-3 * depth, 72.8e-3, 998.0);
    let drive = part * free;
    let end = 8.0 * TAU / free;
    let sets = [
        format!("box.size=['{width} mm','{} mm']", 0.8 * width),
        format!("body.pool.layer.depth={depth} mm"),
        format!("pack.spacing={} mm", width / 80.0),
        format!("effects.vibration.frequency={} Hz", drive / TAU),
        format!("effects.vibration.amplitude={amplitude} mm"),
    ];
    let scene = scene(
        "vibrating-tank",
        preset,
        &sets.each_ref().map(String::as_str),
    );
    let mut solver = start(&scene)?;
    let (mut at, mut values) = (Vec::new(), Vec::new());
    run(&mut *solver, end, end / 300.0, |frame| {
        at.push(frame.time);
        values.push(scalar(frame, "momentum_x_kg_m_s"));
    })?;
    let [left, omega, gamma] = fitted(free, drive, &at, &values);
    println!(
        "  damping {gamma:.2} 1/s, {:.2} % unexplained",
        100.0 * left
    );
    let figure = Figure {
        case,
        preset,
        what: &format!("first mode driven at {part} of it, 1/s"),
        got: omega,
        theory: Some(free),
        target: 0.02,
    };
    Ok(figure.row())
}

/// Waves one to two spacings high; smaller ones bend the layers at the surface without moving them.
#[test]
fn vibrating_tank() {
    presets("vibrating tank", |preset| {
        let mut good = true;
        for driven in [[0.8, 0.3], [1.0, 0.05], [1.25, 0.2]] {
            good &= drive("vibrating tank", preset, 40.0, driven)?;
        }
        Ok(good & drive("narrow tank", preset, 20.0, [1.0, 0.05])?)
    });
}
