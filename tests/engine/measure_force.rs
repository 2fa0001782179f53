//! The force of walls on the liquid.

use coronet::measure::gauge::Gauge;
use coronet::particle::Frame;
use coronet::scene::{Scene, file};
use coronet::simulate::Simulation;
use std::f64::consts::TAU;
use std::path::Path;

fn scene(sides: &str, more: &str) -> Scene {
    let text = format!(
        "dimension = 2\n[box]\nsize = ['10 mm', '8 mm']\nx = '{sides}'\nz = ['wall', 'open']\n\
         [liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [effects.viscosity]\ndynamic = '50 mPa s'\n[body.pool]\nlayer = {{ depth = '4 mm' }}\n\
         [pack]\nspacing = '0.5 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '60 ms'\n[frames]\ninterval = '2 ms'\n{more}"
    );
    file::read(&text, Path::new("force.toml"), &[])
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

fn frame(time: f64, momentum: [f64; 3], removed: f64) -> Frame {
    let named = ["x", "y", "z"].map(|axis| format!("momentum_{axis}_kg_m_s"));
    let mut scalars: Vec<(String, f64)> = named.into_iter().zip(momentum).collect();
    scalars.push(("mass_kg".into(), 2.0));
    scalars.push(("mass_removed_kg".into(), removed));
    let zero = vec![0.0];
    Frame {
        time,
        id: vec![0],
        position: [vec![1e-3], zero.clone(), vec![1e-3]],
        velocity: [zero.clone(), zero.clone(), zero.clone()],
        pressure: zero.clone(),
        density: zero,
        scalars,
        ..Frame::default()
    }
}

/// The forces along x and z of each frame.
fn forces(scene: &Scene, frames: &[Frame]) -> Vec<[f64; 2]> {
    let mut gauge = Gauge::new(scene);
    let rows = frames.iter().map(|frame| {
        let row = gauge.measure(frame);
        assert!(row.iter().all(|(name, _)| name != "wall_force_y_N"));
        ["wall_force_x_N", "wall_force_z_N"].map(|name| {
            let found = row.iter().find(|(n, _)| n == name);
            found.expect("a column").1
        })
    });
    rows.collect()
}

#[test]
fn walls_exert_what_neither_weight_nor_vibration_explains() {
    let frequency = 40.0;
    let more = format!(
        "[effects.vibration]\namplitude = '0.1 mm'\nfrequency = '{frequency} Hz'\n\
         direction = [1, 0]\n"
    );
    let scene = scene("wall", &more);
    let frames = [
        frame(0.0, [0.0; 3], 0.0),
        frame(0.01, [0.3, 0.0, 0.5], 0.0),
        frame(0.02, [0.3, 0.0, 0.4], 0.1),
        frame(0.03, [0.3, 0.0, 0.4], 0.1),
    ];
    let found = forces(&scene, &frames);
    assert!(found[0].iter().all(|force| force.is_nan()));
    let omega = TAU * frequency;
    // INT A omega^2 sin(omega t) dt, and M g.
    let shaken = |t0: f64, t1: f64| 1e-4 * omega * ((omega * t0).cos() - (omega * t1).cos());
    let wanted = [
        (0.3 - 2.0 * shaken(0.0, 0.01)) / 0.01,
        (0.5 + 2.0 * 9.81 * 0.01) / 0.01,
    ];
    for (found, wanted) in found[1].iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 1e-9, "{found} {wanted}");
    }
    // Removed liquid takes an unknown momentum along.
    assert!(found[2].iter().all(|force| force.is_nan()));
    assert!((found[3][1] - 2.0 * 9.81).abs() < 1e-9);
}

#[test]
fn the_floor_bears_the_weight_of_a_pool() {
    for sides in ["wall", "periodic"] {
        let scene = scene(sides, "");
        let mut simulation = Simulation::new(&scene).unwrap();
        let series = simulation.run(|_, _| ()).unwrap();
        let [force, mass] =
            ["wall_force_z_N", "mass_kg"].map(|name| series.column(name).unwrap().to_vec());
        let late = &force[force.len() / 2..];
        let mean = late.iter().sum::<f64>() / late.len() as f64;
        let weight = 9.81 * mass[0];
        assert!((mean / weight - 1.0).abs() < 0.01, "{mean} {weight}");
    }
}

#[test]
fn a_scene_without_walls_has_no_such_columns() {
    let text = "[box]\nsize = ['4 mm', '4 mm', '4 mm']\nx = 'open'\ny = 'open'\n\
                z = ['open', 'open']\n[liquid]\ndensity = '1000 kg/m^3'\n\
                [body.drop]\nsphere = { diameter = '2 mm', centre = ['2 mm', '2 mm', '2 mm'] }\n\
                [pack]\nspacing = '0.5 mm'\n[impact]\nend = '1 ms'\n[frames]\ninterval = '1 ms'\n";
    let scene = file::read(text, Path::new("free.toml"), &[]).unwrap().scene;
    let row = Gauge::new(&scene).measure(&frame(0.0, [0.0; 3], 0.0));
    assert!(row.iter().all(|(name, _)| !name.starts_with("wall_force")));
}
