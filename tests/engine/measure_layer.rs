//! Extents do not depend on where between the nodes of the raster the liquid lies.

use coronet::measure::gauge::Gauge;
use coronet::measure::raster::Raster;
use coronet::particle::Frame;
use coronet::scene::*;

use crate::measure_splash::{Splash, lattice, pool_scene, push, splash};

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

/// No centre is beyond the side, but the surface is: half a spacing beyond the centres.
#[test]
fn a_drop_that_touches_a_periodic_side_from_one_side_keeps_its_spread() {
    for (dimension, y) in [(Dimension::Two, 0.0), (Dimension::Three, 12.0)] {
        let mut scene = pool_scene(dimension, 0.4);
        scene.bodies.remove(0);
        let puddle = |x: f64, b: f64, z: f64| (x - 12.0).hypot(b - y) < 5.0 && z < 3.0;
        let drop = lattice(&scene, puddle);
        let extent = drop.position[0].iter().copied();
        let [least, most] = extent.fold([f32::MAX, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
        let near = 0.02e-3;
        let places = [0.0, near - least, scene.domain.size[0] as f32 - near - most];
        let [middle, low, high] = places.map(|along| {
            let mut moved = drop.clone();
            moved.position[0].iter_mut().for_each(|x| *x += along);
            let row = Gauge::new(&scene).measure(&moved);
            ["spread_factor", "max_diameter_factor"].map(|name| {
                let found = row.iter().find(|(found, _)| found == name);
                found.expect("a column").1
            })
        });
        for side in [low, high] {
            for k in 0..2 {
                let off = (side[k] - middle[k]).abs();
                assert!(off < 0.02, "{dimension:?}: {side:?} for {middle:?}");
            }
        }
    }
}

/// A ball of shells a spacing apart, in disorder but for the outermost one, which is dense and
/// farther from the others; lengths in spacings.
fn shells(dimension: Dimension, radius: f64) -> Vec<[f64; 3]> {
    let (mut points, mut r, mut density) = (Vec::new(), radius - 0.5, 1.15);
    let noise = |n: f64| (43758.5453 * (12.9898 * n + 1.0).sin()).fract();
    while r > 0.3 {
        let tau = std::f64::consts::TAU;
        let count = match dimension {
            Dimension::Two => tau * r * density,
            Dimension::Three => 2.0 * tau * r * r * density,
        };
        let count = count.round().max(1.0);
        for k in 0..count as usize {
            // Fibonacci's spiral on a sphere.
            let part = (k as f64 + 0.5) / count;
            let (z, turn) = match dimension {
                Dimension::Two => (0.0, part),
                Dimension::Three => (1.0 - 2.0 * part, 0.381_966 * k as f64),
            };
            let across = r * (1.0 - z * z).sqrt();
            let mut at = [
                across * (tau * turn).cos(),
                across * (tau * turn).sin(),
                r * z,
            ];
            if dimension == Dimension::Two {
                at.swap(1, 2);
            }
            for axis in dimension.axes().iter().filter(|_| density == 1.0) {
                at[*axis] += 0.4 * noise((3 * points.len() + axis) as f64);
            }
            points.push(at);
        }
        r -= if density > 1.0 { 1.25 } else { 1.0 };
        density = 1.0;
    }
    points
}

#[test]
fn the_surface_area_does_not_depend_on_what_is_behind_the_surface() {
    let cases = [
        (Dimension::Two, false, 0.3),
        (Dimension::Two, true, 0.3),
        (Dimension::Three, false, 0.5),
    ];
    for (dimension, is_revolved, spacing) in cases {
        let mut scene = pool_scene(dimension, spacing);
        scene.bodies.remove(0);
        (scene.domain.boundary[2][0], scene.effects.gravity) = (Side::Open, None);
        scene.domain.revolved = is_revolved.then(Rings::default);
        let mut frame = Frame::default();
        for mut at in shells(dimension, 6.0 / spacing) {
            let axes = dimension.axes();
            axes.iter().for_each(|a| at[*a] += 12.0 / spacing);
            push(&mut frame, at.map(|x| (1e-3 * spacing * x) as f32));
        }
        let raster = Raster::new(&scene, &frame);
        let radius = 6e-3;
        let exact = match dimension == Dimension::Three || is_revolved {
            true => 4.0 * std::f64::consts::PI * radius * radius,
            false => std::f64::consts::TAU * radius,
        };
        let off = raster.surface_area() / exact - 1.0;
        assert!(off.abs() < 0.015, "{dimension:?}, {is_revolved}: {off}");
    }
}
