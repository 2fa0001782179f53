//! Waves, pipes and threads as rings.

use super::{Point, affordable, figure, mean, oscillation, reaches, rings, swing};
use crate::{run, start};
use coronet::particle::column::{Columns, Retain};
use coronet::particle::{Particles, State};
use std::f64::consts::TAU;

/// J0 and J1 or, with `sign` 1, I0 and I1.
fn bessel(x: f64, sign: f64) -> [f64; 2] {
    let (mut zeroth, mut first) = (1.0, 0.5 * x);
    let (mut a, mut b) = (zeroth, first);
    for k in 1..40 {
        let k = k as f64;
        a *= sign * x * x / (4.0 * k * k);
        b *= sign * x * x / (4.0 * k * (k + 1.0));
        (zeroth, first) = (zeroth + a, first + b);
    }
    [zeroth, first]
}

/// First zero of J1.
const ZERO: f64 = 3.831_706;

#[test]
fn standing_wave() {
    println!();
    let mut reached = 1.0;
    for spacing in affordable(&["1 mm", "0.5 mm"]) {
        let sets = [
            "dimension=3",
            "box.size=['40 mm','40 mm','25 mm']",
            "box.y=wall",
            "effects.viscosity.dynamic=1 mPa s",
            "effects.tension.coefficient=72.8 mN/m",
            "impact.end=0.5 s",
            &format!("pack.spacing={spacing}"),
        ];
        let scene = rings("hydrostatic", &sets);
        let (radius, depth) = (0.02, 0.02);
        let k = ZERO / radius;
        let stiff = 9.81 * k + scene.effects.sigma().unwrap() * k.powi(3) / scene.density;
        let omega = (stiff * (k * depth).tanh()).sqrt();
        let field = |[x, z]: Point| {
            let [zeroth, first] = bessel(k * x, -1.0);
            let scale = (k * depth).sinh();
            [
                -first * (k * z).cosh() / scale,
                zeroth * (k * z).sinh() / scale,
            ]
        };
        // Smaller waves drown in what moves in liquid at rest.
        let speed = 1e-3 * omega;
        let end = scene.impact.end;
        let track = swing(&scene, field, speed, [end, 0.002 * end], |_| ());
        let [found, fall] = oscillation(&track).unwrap_or([f64::NAN; 2]);
        println!("  decay {fall:.2} 1/s");
        let case = format!("standing wave, R = {:.0} s0", radius / scene.spacing);
        reached = figure(&case, "frequency, 1/s", found, Some(omega), 0.01);
    }
    reaches("standing wave", reached, [0.11, 0.11, 0.11]);
}

/// Keeps the liquid within `radius` m of the axis.
fn thread(state: &mut State, radius: f64) {
    let p: &mut Particles = &mut state.particles;
    let inside = |i: &u32| p.position[0][*i as usize] < radius;
    let kept: Vec<u32> = (0..p.len() as u32).filter(inside).collect();
    p.visit(&mut Retain(&kept));
}

#[test]
fn pipe() {
    println!();
    let mut reached = 1.0;
    for spacing in affordable(&["0.25 mm", "0.125 mm"]) {
        let scene = rings("pipe", &[&format!("pack.spacing={spacing}")]);
        let radius = scene.domain.size[0];
        let mu = scene.effects.mu().unwrap();
        let force = -scene.density * scene.effects.gravity.unwrap()[2];
        let top = force * radius * radius / (4.0 * mu);
        let mut solver = start(&scene).expect("starts");
        let end = scene.impact.end;
        let (mut all, mut near) = (0.0, 0.0);
        run(solver.as_mut(), end, 0.02 * end, |f| {
            let wrong = |i: usize, [x, _]: Point| {
                let exact = -top * (1.0 - (x / radius).powi(2));
                ((f.velocity[2][i] as f64 - exact) / top).powi(2)
            };
            all = mean(f, |_| true, wrong).sqrt();
            near = mean(f, |at| at[0] < 4.0 * scene.spacing, wrong).sqrt();
        })
        .expect("stays stable");
        let case = format!("pipe, R = {:.0} s0", radius / scene.spacing);
        figure(&case, "rms of v over its largest", all, None, 0.01);
        figure(&case, "the same on the axis", near, None, 0.01);
        reached = all.max(near);
    }
    reaches("pipe", reached, [0.01, 0.01, 0.02]);
}

#[test]
fn rayleigh_plateau() {
    println!();
    let mut reached = 1.0;
    for columns in [8.0, 16.0] {
        let radius = 1e-3;
        // The length of the fastest wave, in whole spacings.
        let spacing = radius / columns;
        let layers = (TAU * radius / 0.697 / spacing).round();
        let length = layers * spacing;
        let x = TAU * radius / length;
        let sets = [
            format!("pack.spacing={spacing} m"),
            format!("box.size=['6 mm','6 mm','{length} m']"),
            format!("body.water.layer.depth={length} m"),
        ];
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        let scene = rings("thread", &sets);
        let [zeroth, first] = bessel(x, 1.0);
        let unit = (scene.effects.sigma().unwrap() / (scene.density * radius.powi(3))).sqrt();
        let omega = unit * (x * (1.0 - x * x) * first / zeroth).sqrt();
        let k = x / radius;
        let field = |[r, z]: Point| {
            let [zeroth, first] = bessel(k * r, 1.0);
            let [_, edge] = bessel(x, 1.0);
            [first * (k * z).cos() / edge, -zeroth * (k * z).sin() / edge]
        };
        let speed = 0.01 * radius * omega;
        let end = 3.0 / omega;
        let track = swing(&scene, field, speed, [end, 0.005 * end], |state| {
            thread(state, radius);
        });
        // From rest the velocity grows as cosh(omega t).
        let grown = |size: f64| track.iter().find(|(_, v)| *v >= size);
        let rate = |size: f64| grown(size).map_or(f64::NAN, |(t, v)| v.acosh() / t);
        let case = format!("Rayleigh-Plateau, R = {columns} s0");
        figure(
            &case,
            "growth until twice, 1/s",
            rate(2.0),
            Some(omega),
            0.05,
        );
        let what = "growth until four times, 1/s";
        reached = figure(&case, what, rate(4.0), Some(omega), 0.05);
    }
    reaches("Rayleigh-Plateau", reached, [0.3, 0.4, 0.4]);
}
