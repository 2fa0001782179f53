//! Extents do not depend on where between the nodes of the raster the liquid lies.

use coronet::measure::gauge::Gauge;
use coronet::particle::Frame;
use coronet::scene::*;

use crate::measure_splash::{Splash, lattice, pool_scene, splash};

/// Difference of the largest and the least of a column, mm, of a frame that is moved along x by
/// parts of the spacing, mm, which is two of the raster's.
fn spread(scene: &Scene, frame: &Frame, column: &str, factor: f64, spacing: f64) -> f64 {
    let found = (0..8).map(|k| {
        let mut moved = frame.clone();
        let along = 1e-3 * spacing * f64::from(k) / 8.0;
        let size = scene.domain.size[0];
        let moved_x = |x: f32| ((f64::from(x) + along) % size) as f32;
        moved.position[0].iter_mut().for_each(|x| *x = moved_x(*x));
        let row = Gauge::new(scene).measure(&moved);
        let found = row.iter().find(|(name, _)| name == column);
        factor * found.map_or(f64::NAN, |(_, value)| *value)
    });
    let [least, most] = found.fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], x| {
        assert!(x.is_finite(), "{column} was not found");
        [a.min(x), b.max(x)]
    });
    most - least
}

#[test]
fn extents_do_not_jump_from_node_to_node() {
    for (dimension, spacing, y) in [(Dimension::Two, 0.2, 0.0), (Dimension::Three, 0.4, 12.0)] {
        let mut scene = pool_scene(dimension, spacing);
        let shape = Splash {
            crater: 5.3,
            crown: [5.3, 7.1, 2.0],
            ..Splash::default()
        };
        let crater = splash(&scene, &shape);
        let jump = spread(&scene, &crater, "crater_diameter_m", 1e3, spacing);
        assert!(jump < 0.1 * spacing, "{dimension:?}: crater {jump} mm");
        scene.bodies.remove(0);
        let cap = lattice(&scene, |x, b, z| {
            (x - 12.0).hypot(b - y).hypot(z + 1.5) < 5.0
        });
        for column in ["spread_factor", "max_diameter_factor"] {
            // Over the drop's diameter, 4 mm.
            let jump = spread(&scene, &cap, column, 4.0, spacing);
            assert!(jump < 0.1 * spacing, "{dimension:?}: {column} {jump} mm");
        }
    }
}

/// Frames hold particles that have just passed a periodic side and are not yet back in the box.
#[test]
fn a_body_that_has_just_touched_a_periodic_side_is_in_one_piece() {
    let mut scene = pool_scene(Dimension::Two, 0.4);
    scene.bodies.remove(0);
    scene.domain.boundary[2][0] = Side::Open;
    scene.effects.gravity = None;
    let round = lattice(&scene, |x, _, z| (x - 12.0).hypot(z - 12.0) < 4.0);
    let most = round.position[0].iter().copied().fold(0.0, f32::max);
    let ratios = [false, true].map(|is_late: bool| {
        let mut frame = round.clone();
        let last = frame.position[0].iter().position(|x| *x == most);
        for (i, x) in frame.position[0].iter_mut().enumerate() {
            *x -= most + 1e-6;
            if !is_late || Some(i) != last {
                *x += scene.domain.size[0] as f32;
            }
        }
        let row = Gauge::new(&scene).measure(&frame);
        let found = row.iter().find(|(name, _)| name == "aspect_ratio");
        found.expect("a shape").1
    });
    assert!((ratios[0] - ratios[1]).abs() < 1e-3, "{ratios:?}");
}
