//! Crater, crown and jet against splashes of known size.

use coronet::measure::gauge::Gauge;
use coronet::measure::kind::Kind;
use coronet::measure::series::Row;
use coronet::particle::Frame;
use coronet::scene::{Dimension, Motion, Rings, Scene, Shape};
use std::f64::consts::PI;

use crate::measure_splash::{DEPTH, SIDE, Splash, lattice, pool_scene, push, splash};

/// Level fixed by a flat pool first, then the frame; lengths in mm.
fn measure(scene: &Scene, frame: &Frame) -> Row {
    let mut gauge = Gauge::new(scene);
    gauge.measure(&splash(scene, &Splash::default()));
    gauge.measure(frame)
}

fn mm(row: &Row, name: &str) -> f64 {
    let found = row.iter().find(|(n, _)| n == name);
    found.unwrap_or_else(|| panic!("no column {name}")).1 * 1e3
}

fn near(row: &Row, name: &str, expected: f64, tolerance: f64) {
    let found = mm(row, name);
    assert!(
        (found - expected).abs() < tolerance,
        "{name}: {found} mm, expected {expected} mm"
    );
}

const BOTH: [Dimension; 2] = [Dimension::Two, Dimension::Three];

#[test]
fn a_flat_pool_has_neither_crater_nor_crown() {
    for dimension in BOTH {
        let scene = pool_scene(dimension, 0.4);
        let mut gauge = Gauge::new(&scene);
        let row = gauge.measure(&splash(&scene, &Splash::default()));
        assert!(
            (gauge.start.level.unwrap() * 1e3 - 10.0).abs() < 0.02,
            "level {:?}",
            gauge.start.level
        );
        assert!(mm(&row, "crater_diameter_m").is_nan());
        near(&row, "axis_level_m", 0.0, 0.02);
        near(&row, "crown_height_m", 0.0, 0.02);
    }
}

/// Mean errors of depth and diameter over several radii, mm.
fn crater_errors(dimension: Dimension, spacing: f64) -> [f64; 2] {
    let scene = pool_scene(dimension, spacing);
    let radii = [5.0, 5.37, 5.71, 6.13, 6.52];
    let mut sum = [0.0; 2];
    for radius in radii {
        let crown = [radius, radius + 1.6, 2.0];
        let shape = Splash {
            crater: radius,
            crown,
            ..Splash::default()
        };
        let frame = splash(&scene, &shape);
        let row = measure(&scene, &frame);
        near(&row, "crater_depth_m", radius, 0.6 * spacing);
        near(&row, "crater_depth_mean_m", radius, 0.6 * spacing);
        near(&row, "crater_diameter_m", 2.0 * radius, spacing);
        sum[0] += (mm(&row, "crater_depth_m") - radius).abs();
        sum[1] += (mm(&row, "crater_diameter_m") - 2.0 * radius).abs();
    }
    sum.map(|s| s / radii.len() as f64)
}

#[test]
fn a_hemispherical_crater_is_found_and_converges() {
    for dimension in BOTH {
        let coarse = crater_errors(dimension, 1.0);
        let fine = crater_errors(
            dimension,
            if dimension == Dimension::Two {
                0.1
            } else {
                0.25
            },
        );
        for (coarse, fine) in coarse.into_iter().zip(fine) {
            assert!(fine < 0.15, "{dimension:?}: mean error {fine} mm");
            assert!(
                fine < 0.6 * coarse,
                "{dimension:?}: {coarse} then {fine} mm"
            );
        }
    }
}

#[test]
fn the_crown_is_the_highest_connected_liquid_off_the_axis() {
    for dimension in BOTH {
        for spacing in [0.4, 0.25] {
            let scene = pool_scene(dimension, spacing);
            let shape = Splash {
                crater: 5.5,
                crown: [5.5, 7.1, 4.0],
                mist: [0.9, 7.0],
                ..Splash::default()
            };
            let row = measure(&scene, &splash(&scene, &shape));
            near(&row, "crown_height_m", 4.0, 0.5 * spacing);
            near(&row, "highest_particle_m", 7.9, 0.8 * spacing);
            near(&row, "crater_depth_m", 5.5, 0.6 * spacing);
            near(&row, "crater_diameter_m", 11.0, spacing);
        }
    }
}

#[test]
fn the_jet_is_the_highest_connected_liquid_on_the_axis() {
    for dimension in BOTH {
        let scene = pool_scene(dimension, 0.25);
        let shape = Splash {
            jet: [1.5, 6.0],
            ..Splash::default()
        };
        let row = measure(&scene, &splash(&scene, &shape));
        near(&row, "jet_height_m", 6.0, 0.125);
        near(&row, "axis_level_m", 6.0, 0.125);
        near(&row, "crown_height_m", 0.0, 0.02);
        assert!(mm(&row, "crater_depth_m").is_nan());
        assert!(mm(&row, "crater_diameter_m").is_nan());
    }
}

#[test]
fn a_jet_inside_a_crater_does_not_shrink_its_diameter() {
    for dimension in BOTH {
        let scene = pool_scene(dimension, 0.25);
        let shape = Splash {
            crater: 6.0,
            crown: [6.0, 7.1, 2.0],
            jet: [1.5, 3.0],
            ..Splash::default()
        };
        let row = measure(&scene, &splash(&scene, &shape));
        near(&row, "crater_diameter_m", 12.0, 0.3);
        near(&row, "jet_height_m", 3.0, 0.125);
    }
}

#[test]
fn an_entrapped_bubble_is_not_the_crater() {
    let scene = pool_scene(Dimension::Three, 0.4);
    let shape = Splash {
        crater: 4.0,
        bubble: [1.2, 7.5],
        ..Splash::default()
    };
    let row = measure(&scene, &splash(&scene, &shape));
    near(&row, "crater_depth_m", 4.0, 0.24);
}

#[test]
fn a_crater_across_a_periodic_side_measures_the_same() {
    let mut scene = pool_scene(Dimension::Three, 0.4);
    let shape = Splash {
        crater: 6.0,
        crown: [6.0, 7.0, 3.0],
        ..Splash::default()
    };
    let mut frame = splash(&scene, &shape);
    let there = measure(&scene, &frame);
    for axis in 0..2 {
        for x in &mut frame.position[axis] {
            *x = (*x + 0.5e-3 * SIDE as f32) % (1e-3 * SIDE as f32);
        }
        if let coronet::scene::Shape::Sphere { centre, .. } = &mut scene.bodies[1].shape {
            centre[axis] = 0.0;
        }
    }
    let here = measure(&scene, &frame);
    for name in [
        "crater_depth_m",
        "crown_height_m",
        "axis_level_m",
        "far_level_m",
    ] {
        near(&here, name, mm(&there, name), 1e-3);
    }
    near(
        &here,
        "crater_diameter_m",
        mm(&there, "crater_diameter_m"),
        1e-6,
    );
}

#[test]
fn measures_do_not_depend_on_the_number_of_threads() {
    let scene = pool_scene(Dimension::Three, 0.5);
    let shape = Splash {
        crater: 5.2,
        crown: [5.2, 6.3, 2.0],
        ..Splash::default()
    };
    let frame = splash(&scene, &shape);
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let row = pool.install(|| measure(&scene, &frame));
        row.into_iter()
            .map(|(name, value)| (name, value.to_bits()))
            .collect::<Vec<_>>()
    });
    assert_eq!(one, three);
}

#[test]
fn a_second_drop_is_no_crown() {
    let mut scene = pool_scene(Dimension::Three, 0.4);
    // Beside the first, joined to the pool by a bridge as drops are just before contact.
    let mut second = scene.bodies[1].clone();
    let place = [19e-3, 12e-3, 12.3e-3];
    if let coronet::scene::Shape::Sphere { centre, .. } = &mut second.shape {
        *centre = place;
    }
    scene.bodies.push(second);
    let frame = lattice(&scene, |x, y, z| {
        let apart = (x - 19.0).hypot(y - 12.0);
        z < 10.0 || apart.hypot(z - 12.3) < 2.0 || (apart < 1.0 && z < 12.3)
    });
    let row = measure(&scene, &frame);
    near(&row, "crown_height_m", 0.0, 0.1);
    scene.bodies.pop();
    let row = measure(&scene, &frame);
    near(&row, "crown_height_m", 4.3, 0.4);
}

/// Gives every particle of a section the mass of half a ring; `divides`: two of half the area in
/// place of each, but at the axis, where a ring is a disc.
fn rings(scene: &Scene, mut frame: Frame, divides: bool) -> Frame {
    let axis = 0.5 * SIDE * 1e-3;
    let aside = 0.2 * scene.spacing as f32;
    let radius = |x: f32| (f64::from(x) - axis).abs();
    let halves = |x: f32| divides && radius(x) > scene.spacing;
    for i in 0..frame.id.len() {
        let [x, y, z] = [0, 1, 2].map(|a| frame.position[a][i]);
        if halves(x) {
            frame.position[2][i] = z + aside;
            push(&mut frame, [x, y, z - aside]);
        }
    }
    let mass = |x: &f32| {
        let part = if halves(*x) { 0.5 } else { 1.0 };
        (part * PI * radius(*x) * scene.density * scene.spacing.powi(2)) as f32
    };
    frame.mass = frame.position[0].iter().map(mass).collect();
    frame
}

#[test]
fn the_surface_of_rings_is_that_of_their_areas() {
    let mut scene = pool_scene(Dimension::Two, 0.4);
    scene.domain.revolved = Some(Rings::default());
    let crater = Splash {
        crater: 5.37,
        ..Splash::default()
    };
    let found = [false, true].map(|divides| {
        let mut gauge = Gauge::new(&scene);
        gauge.measure(&rings(&scene, splash(&scene, &Splash::default()), divides));
        let row = gauge.measure(&rings(&scene, splash(&scene, &crater), divides));
        let level = gauge.start.level.unwrap() * 1e3;
        assert!((level - DEPTH).abs() < 0.02, "level {level}");
        near(&row, "crater_depth_m", crater.crater, 0.2);
        mm(&row, "crater_depth_m")
    });
    assert!((found[0] - found[1]).abs() < 0.05, "{found:?}");
}

#[test]
fn a_torus_is_one_body() {
    let mut scene = pool_scene(Dimension::Two, 0.4);
    scene.domain.revolved = Some(Rings::default());
    // More of it is in the torus, more of the section in the middle.
    let frame = lattice(&scene, |x, _, z| {
        let r = (x - 0.5 * SIDE).abs();
        r < 2.0 && z < 4.0 || r > 6.0 && r < 9.0 && z < 2.0
    });
    let row = Gauge::new(&scene).measure(&rings(&scene, frame, false));
    let detached = row
        .iter()
        .find(|(name, _)| name == "detached_part")
        .unwrap()
        .1;
    let (middle, torus) = (4.0 * 4.0, 2.0 * (81.0 - 36.0));
    let expected = middle / (middle + torus);
    assert!(
        (detached - expected).abs() < 0.02,
        "{detached}, not {expected}"
    );
}

/// The crater of an oblique impact is measured where the drop lands.
#[test]
fn the_axis_is_where_the_drop_lands() {
    let mut scene = pool_scene(Dimension::Two, 0.4);
    scene.effects.gravity = None;
    let Kind::Pool(before) = Kind::new(&scene) else {
        panic!("no pool");
    };
    scene.impact.end = 1.0;
    scene.bodies[1].motion = Motion::Uniform([2.0, 0.0, -1.0]);
    let shape = &scene.bodies[1].shape;
    let (low, _) = shape.bounds(&scene.domain, scene.dimension);
    let way = 2.0 * (low[2] - 1e-3 * DEPTH);
    let Kind::Pool(landed) = Kind::new(&scene) else {
        panic!("no pool");
    };
    assert!(way > 1e-4 && (landed.at[0] - before.at[0] - way).abs() < 1e-12);
    // Across a periodic side.
    scene.bodies[1].motion = Motion::Uniform([2e2, 0.0, -1.0]);
    let Kind::Pool(landed) = Kind::new(&scene) else {
        panic!("no pool");
    };
    let size = scene.domain.size[0];
    let expected = (before.at[0] + 100.0 * way).rem_euclid(size);
    assert!((landed.at[0] - expected).abs() < 1e-9, "{}", landed.at[0]);
}

#[test]
fn the_diameter_of_an_ellipsoid_is_that_of_equal_volume() {
    let mut flat = pool_scene(Dimension::Three, 0.5);
    let (centre, semi_axes) = ([12e-3; 3], [1e-3, 2e-3, 4e-3]);
    flat.bodies[1].shape = Shape::Ellipsoid { centre, semi_axes };
    let Kind::Pool(axis) = Kind::new(&flat) else {
        panic!("not a pool");
    };
    assert!(
        (axis.diameter / 4e-3 - 1.0).abs() < 1e-12,
        "{}",
        axis.diameter
    );
}
