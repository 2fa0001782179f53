//! Contact angles of caps of known angle.

use coronet::measure::gauge::{Gauge, Row};
use coronet::scene::*;

use crate::measure_splash::{lattice, pool_scene};

fn value(row: &Row, name: &str) -> f64 {
    let found = row.iter().find(|(n, _)| n == name);
    found.unwrap_or_else(|| panic!("no column {name}")).1
}

/// A scene without a pool whose floor has a contact angle.
fn dry(dimension: Dimension, spacing: f64) -> Scene {
    let mut scene = pool_scene(dimension, spacing);
    scene.bodies.remove(0);
    scene.effects.wetting = Some(Wetting::of(60.0));
    scene
}

#[test]
fn caps_have_their_contact_angle() {
    for (dimension, spacing) in [(Dimension::Two, 0.1), (Dimension::Three, 0.25)] {
        let scene = dry(dimension, spacing);
        let y = if dimension == Dimension::Two {
            0.0
        } else {
            12.0
        };
        for angle in [45.0, 60.0, 90.0, 120.0, 150.0_f64] {
            let radius = 6.0;
            let centre = -radius * angle.to_radians().cos();
            let frame = lattice(&scene, |x, b, z| {
                (x - 12.0).hypot(b - y).hypot(z - centre) < radius
            });
            let row = Gauge::new(&scene).measure(&frame);
            let fitted = value(&row, "contact_angle_deg");
            assert!(
                (fitted - angle).abs() < 1.0,
                "{dimension:?} {angle}: {fitted}"
            );
            let built = value(&row, "contact_angle_base_deg");
            assert!(
                (built - angle).abs() < 5.0,
                "{dimension:?} {angle}: {built}"
            );
            if dimension == Dimension::Two {
                for side in ["low", "high"] {
                    let flank = value(&row, &format!("contact_angle_{side}_x_deg"));
                    // A lattice has few rows there.
                    assert!((flank - angle).abs() < 8.0, "{angle} {side}: {flank}");
                }
            }
        }
    }
}

#[test]
fn a_scene_without_contact_angle_has_no_such_column() {
    let mut scene = dry(Dimension::Two, 0.2);
    scene.effects.wetting = None;
    let frame = lattice(&scene, |x, _, z| (x - 12.0).hypot(z) < 4.0);
    let row = Gauge::new(&scene).measure(&frame);
    assert!(
        row.iter().all(|(name, _)| !name.contains("angle")),
        "{row:?}"
    );
    assert!(row.iter().any(|(name, _)| name == "spread_factor"));
}
