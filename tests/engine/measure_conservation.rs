//! What a run must keep.

use coronet::measure::conservation::{Conservation, FIGURES};
use coronet::measure::series::Series;
use coronet::particle::Frame;
use coronet::scene::{Scene, file};
use std::path::Path;

fn scene() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/hard/tank.toml");
    file::load(&path, &[]).unwrap().scene
}

/// Two particles of 1 kg, some removed, at these x and z.
fn frame(at: [[f32; 2]; 2], gone: f64) -> Frame {
    let count = 2 - gone as usize;
    let column = |axis: usize| at[..count].iter().map(|p| p[axis]).collect::<Vec<f32>>();
    let zero = vec![0.0; count];
    Frame {
        id: (0..count as u32).collect(),
        position: [column(0), zero.clone(), column(1)],
        velocity: [zero.clone(), zero.clone(), zero.clone()],
        pressure: zero.clone(),
        density: zero,
        scalars: vec![
            ("mass_kg".into(), count as f64),
            ("mass_removed_kg".into(), gone),
        ],
        ..Frame::default()
    }
}

fn figure(frames: &[Frame], measures: &Series, name: &str) -> f64 {
    let scene = scene();
    let mut conservation = Conservation::new(&scene);
    frames.iter().for_each(|frame| conservation.take(frame));
    let figures = conservation.figures(measures);
    assert_eq!(figures.len(), FIGURES.len());
    figures.iter().find(|f| f.0 == name).unwrap().1
}

#[test]
fn walls_particles_and_numbers_are_watched() {
    let inside = [[1e-3, 1e-3], [2e-3, 2e-3]];
    let none = Series::default();
    let fine = [frame(inside, 0.0), frame(inside, 1.0)];
    for name in ["not_a_number", "mass_error", "wall_crossing"] {
        assert_eq!(figure(&fine, &none, name), 0.0, "{name}");
    }
    // A quarter of the spacing of 0.25 mm below the floor, and beside the wall at 12 mm.
    let low = frame([[1e-3, -0.0625e-3], [12.05e-3, 1e-3]], 0.0);
    let crossing = figure(&[low], &none, "wall_crossing");
    assert!((crossing - 0.25).abs() < 1e-6, "{crossing}");
    // Above the open top nothing is crossed.
    let high = frame([[1e-3, 0.5], [1e-3, 1e-3]], 0.0);
    assert_eq!(figure(&[high], &none, "wall_crossing"), 0.0);

    let mut lost = frame(inside, 1.0);
    lost.scalars[1].1 = 0.0;
    assert_eq!(
        figure(&[frame(inside, 0.0), lost], &none, "mass_error"),
        1.0
    );
    let mut wild = frame(inside, 0.0);
    wild.velocity[2][1] = f32::NAN;
    wild.scalars[0].1 = f64::INFINITY;
    assert_eq!(figure(&[wild], &none, "not_a_number"), 2.0);
}

#[test]
fn energy_and_momentum_are_weighed() {
    let scene = scene();
    let speed = coronet::scene::numbers::reference_speed(&scene);
    let mut measures = Series::default();
    for (time, energy, momentum, removed) in [
        (0.0, 1.0, 0.0, 0.0),
        (1.0, 1.5, 3.0, 0.0),
        (2.0, 0.5, 9.0, 1.0),
    ] {
        let row = [
            ("time_s", time),
            ("kinetic_energy_J", energy),
            ("momentum_x_kg_m_s", momentum),
            ("momentum_y_kg_m_s", 0.0),
            ("momentum_z_kg_m_s", 4.0 * f64::from(momentum > 0.0)),
            ("mass_removed_kg", removed),
        ];
        measures.push(&row.map(|(name, value)| (name.to_string(), value)).to_vec());
    }
    let frames = [frame([[1e-3, 1e-3], [2e-3, 2e-3]], 0.0)];
    let found = |name: &str| figure(&frames, &measures, name);
    assert!((found("energy_growth") - 0.5 / (0.5 * 2.0 * speed * speed)).abs() < 1e-12);
    // The last row is after a particle has left.
    assert!((found("momentum_change") - 5.0 / (2.0 * speed)).abs() < 1e-12);
    assert_eq!(found("removed"), 0.5);
    // No tension in this scene.
    assert!(found("capillary_number").is_nan());
}
