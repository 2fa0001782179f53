//! Steps of MPS where a pressure equation is hard, and where the answer is known at once.

use super::isph_flow::{named, run, solver};
use super::method_scene::{GRAVITY, drop_scene, scene, splash_scene};

const PRESETS: [&str; 3] = ["mps paper", "mps corrected", "mps modern"];

#[test]
fn a_particle_alone_falls() {
    for preset in PRESETS {
        for dimension in [2, 3] {
            let scene = drop_scene(preset, dimension, GRAVITY);
            let middle =
                |x: [f64; 3]| (0..3).all(|a| (x[a] - 2.4e-3).abs() < 0.2e-3 || x[a] == 0.0);
            let mut solver = solver(&scene, middle);
            assert_eq!(solver.len(), 1);
            let frame = run(solver.as_mut(), 5);
            let wanted = -9.81 * frame.time;
            let error = frame.velocity[2][0] as f64 / wanted - 1.0;
            assert!(error.abs() < 1e-4, "{preset}");
            assert_eq!(frame.pressure[0], 0.0, "{preset}");
        }
    }
}

#[test]
fn a_film_one_particle_thick_falls_as_it_is() {
    for preset in PRESETS {
        for dimension in [2, 3] {
            let scene = drop_scene(preset, dimension, GRAVITY);
            let layer = |x: [f64; 3]| (x[2] - 2.4e-3).abs() < 0.2e-3;
            let mut solver = solver(&scene, layer);
            let frame = run(solver.as_mut(), 5);
            for v in &frame.velocity[2] {
                let error = *v as f64 / (-9.81 * frame.time) - 1.0;
                assert!(error.abs() < 0.01, "{preset}: {v}");
            }
            assert_eq!(named(&frame, "pressure_repeated"), 0.0, "{preset}");
        }
    }
}

#[test]
fn a_drop_that_just_touches_a_pool_is_solved() {
    for preset in PRESETS {
        for dimension in [2, 3] {
            let scene = splash_scene(preset, dimension, GRAVITY);
            let mut solver = solver(&scene, |_| true);
            let frame = run(solver.as_mut(), 12);
            assert_eq!(named(&frame, "pressure_repeated"), 0.0, "{preset}");
            assert!(named(&frame, "pressure_residual") <= 1e-6);
            assert!(named(&frame, "pressure_iterations") > 0.0);
        }
    }
}

fn full_box(preset: &str, dimension: usize, depth: &str) -> coronet::scene::Scene {
    let sides = ["x = 'wall'", "y = 'wall'", "z = 'wall'"];
    let sides = if dimension == 3 {
        sides.join("\n")
    } else {
        [sides[0], sides[2]].join("\n")
    };
    let body = format!("[body.liquid]\nlayer = {{ depth = '{depth}' }}\n");
    scene(preset, dimension, &sides, &format!("{GRAVITY}{body}"))
}

/// Walls all around and no surface: the matrix is singular, and gravity moves nothing.
#[test]
fn a_full_box_stays_at_rest() {
    for dimension in [2, 3] {
        let scene = full_box("mps modern", dimension, "4.8 mm");
        let mut solver = solver(&scene, |_| true);
        let frame = run(solver.as_mut(), 5);
        let free = 9.81 * frame.time;
        let speed = named(&frame, "speed_max_m_s");
        assert!(speed < 0.1 * free, "{dimension}-D: {speed} of {free}");
    }
}

/// A layer nine particles deep on a wall carries its weight from the first step on.
#[test]
fn the_pressure_of_a_layer_at_rest_is_that_of_its_depth() {
    for dimension in [2, 3] {
        let scene = full_box("mps modern", dimension, "3.6 mm");
        let mut solver = solver(&scene, |_| true);
        let frame = run(solver.as_mut(), 5);
        let top = 1100.0 * 9.81 * 3.6e-3;
        for (p, z) in frame.pressure.iter().zip(&frame.position[2]) {
            let wanted = 1100.0 * 9.81 * (3.6e-3 - *z as f64);
            let error = (*p as f64 - wanted) / top;
            assert!(error.abs() < 0.05, "{dimension}-D z {z}: {p} for {wanted}");
        }
    }
}

/// As printed and as corrected a pressure below zero is clipped.
#[test]
fn clipped_pressure_is_never_negative() {
    for preset in ["mps paper", "mps corrected"] {
        let scene = splash_scene(preset, 3, GRAVITY);
        let mut solver = solver(&scene, |_| true);
        let mut largest: f32 = 0.0;
        for _ in 0..20 {
            let frame = run(solver.as_mut(), 1);
            assert!(frame.pressure.iter().all(|p| *p >= 0.0), "{preset}");
            largest = frame.pressure.iter().fold(largest, |m, p| m.max(*p));
        }
        assert!(largest > 0.0, "{preset}");
    }
}
