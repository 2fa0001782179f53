//! Shape, spread, front and surface area against known bodies; which scene gets which.

use coronet::measure::gauge::Gauge;
use coronet::measure::kind::{Kind, contact, contact_time, strikes_wall};
use coronet::measure::lamella::Lamella;
use coronet::measure::raster::Raster;
use coronet::measure::series::Row;
use coronet::scene::*;

use crate::measure_splash::{lattice, pool_scene};

fn value(row: &Row, name: &str) -> f64 {
    let found = row.iter().find(|(n, _)| n == name);
    found.unwrap_or_else(|| panic!("no column {name}")).1
}

fn without_pool(dimension: Dimension, spacing: f64) -> Scene {
    let mut scene = pool_scene(dimension, spacing);
    scene.bodies.remove(0);
    scene
}

#[test]
fn an_ellipsoid_has_its_aspect_ratio_and_amplitude() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let mut scene = without_pool(dimension, 0.25);
        scene.domain.boundary[2][0] = Side::Open;
        scene.effects.gravity = None;
        let y = if dimension == Dimension::Two {
            0.0
        } else {
            12.0
        };
        let frame = lattice(&scene, |x, b, z| {
            let r = ((x - 12.0).hypot(b - y)) / 4.0;
            r.hypot((z - 12.0) / 5.0) < 1.0
        });
        let row = Gauge::new(&scene).measure(&frame);
        assert!((value(&row, "aspect_ratio") - 1.25).abs() < 0.01, "{row:?}");
        let amplitude = if dimension == Dimension::Two {
            1.0 / 9.0
        } else {
            2.0 / 13.0
        };
        assert!(
            (value(&row, "amplitude") - amplitude).abs() < 0.005,
            "{row:?}"
        );
        assert!((value(&row, "centre_z_m") - 12e-3).abs() < 1e-6);
    }
}

#[test]
fn a_drop_across_periodic_sides_is_measured_in_one_piece() {
    for dimension in [Dimension::Two, Dimension::Three] {
        for on_wall in [true, false] {
            let mut scene = without_pool(dimension, 0.4);
            if !on_wall {
                scene.domain.boundary[2][0] = Side::Open;
                scene.effects.gravity = None;
            }
            let rows = [12.0, 23.2].map(|middle: f64| {
                scene.bodies[0].shape = match scene.bodies[0].shape {
                    Shape::Sphere { radius, centre } => Shape::Sphere {
                        radius,
                        centre: [middle * 1e-3, centre[1], centre[2]],
                    },
                    _ => unreachable!("a drop"),
                };
                let frame = lattice(&scene, |x, y, z| {
                    let across = ((x - middle + 36.0) % 24.0 - 12.0).abs();
                    let y = if dimension == Dimension::Two { 12.0 } else { y };
                    (across / 4.0).hypot((y - 12.0) / 4.0).hypot(z / 3.0 - 1.0) < 1.0
                });
                Gauge::new(&scene).measure(&frame)
            });
            let names: &[&str] = match on_wall {
                true => &[
                    "spread_factor",
                    "max_diameter_factor",
                    "apex_height_m",
                    "dry_part",
                ],
                false => &["aspect_ratio", "amplitude", "centre_z_m"],
            };
            for name in names {
                let [middle, side] = rows.each_ref().map(|row| value(row, name));
                assert!((side - middle).abs() < 1e-5, "{name}: {side} for {middle}");
            }
            if !on_wall {
                let centres = rows.each_ref().map(|row| value(row, "centre_x_m"));
                assert!((centres[0] - 12.0e-3).abs() < 1e-6, "{centres:?}");
                assert!((centres[1] - 23.2e-3).abs() < 1e-6, "{centres:?}");
            }
        }
    }
}

#[test]
fn the_pressure_in_the_core_is_that_within_0_6_radii() {
    let mut scene = without_pool(Dimension::Three, 0.25);
    scene.domain.boundary[2][0] = Side::Open;
    scene.effects.gravity = None;
    let apart = |x: f64, y: f64, z: f64| (x - 12.0).hypot(y - 12.0).hypot(z - 12.0);
    let mut frame = lattice(&scene, |x, y, z| apart(x, y, z) < 2.0);
    let at = |frame: &coronet::particle::Frame, i: usize, a: usize| frame.position[a][i] as f64;
    for i in 0..frame.id.len() {
        let [x, y, z] = [0, 1, 2].map(|a| 1e3 * at(&frame, i, a));
        frame.pressure[i] = if apart(x, y, z) < 1.21 { 30.0 } else { -500.0 };
    }
    scene.effects.tension = Some(crate::pack_scene::tension(0.067));
    let row = Gauge::new(&scene).measure(&frame);
    assert!((value(&row, "core_pressure_Pa") - 30.0).abs() < 1e-9);
    scene.effects.tension = None;
    let row = Gauge::new(&scene).measure(&frame);
    assert!(row.iter().all(|(name, _)| name != "core_pressure_Pa"));
}

#[test]
fn a_cap_on_a_wall_has_its_spread_and_apex() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let scene = without_pool(dimension, 0.2);
        assert!(matches!(Kind::new(&scene), Kind::Wall(_)));
        let y = if dimension == Dimension::Two {
            0.0
        } else {
            12.0
        };
        let frame = lattice(&scene, |x, b, z| {
            (x - 12.0).hypot(b - y).hypot(z + 1.5) < 5.0
        });
        let row = Gauge::new(&scene).measure(&frame);
        let base = 2.0 * (25.0f64 - 1.5 * 1.5).sqrt() / 4.0;
        assert!(
            (value(&row, "spread_factor") - base).abs() < 0.06,
            "{row:?}"
        );
        assert!(
            (value(&row, "max_diameter_factor") - base).abs() < 0.06,
            "{row:?}"
        );
        assert!(
            (value(&row, "apex_height_m") - 3.5e-3).abs() < 1.2e-4,
            "{row:?}"
        );
    }
}

/// A film between two circles, open on one side or not, and liquid of its own in the middle.
#[test]
fn a_hole_in_a_film_counts_as_spread() {
    let scene = without_pool(Dimension::Three, 0.2);
    let film = |gap: f64| {
        let frame = lattice(&scene, |x, y, z| {
            let r = (x - 12.0).hypot(y - 12.0);
            let in_gap = x > 12.0 && (y - 12.0).abs() < gap;
            z < 0.8 && (r < 1.0 || r > 3.0 && r < 5.0 && !in_gap)
        });
        let row = Gauge::new(&scene).measure(&frame);
        ["spread_factor", "dry_part", "max_diameter_factor"].map(|name| value(&row, name))
    };
    let [wetted, dry, largest] = film(0.0);
    assert!((wetted - 2.5).abs() < 0.06, "{wetted}");
    assert!((dry - 9.0 / 25.0).abs() < 0.02, "{dry}");
    assert!((largest - 2.5).abs() < 0.06, "{largest}");
    let [wetted, dry, _] = film(0.6);
    assert!((wetted - 2.0).abs() < 0.1, "{wetted}");
    assert_eq!(dry, 0.0);
}

#[test]
fn a_column_has_its_front_and_height() {
    let mut scene = without_pool(Dimension::Two, 0.25);
    scene.domain.boundary[0] = [Side::Wall; 2];
    scene.bodies[0].shape = Shape::Block {
        low: [0.0; 3],
        high: [5e-3, 0.0, 8e-3],
    };
    assert!(matches!(Kind::new(&scene), Kind::Front));
    let frame = lattice(&scene, |x, _, z| {
        let puddle = x < 15.0 && z < 2.0;
        let spray = (x - 20.0).hypot(z - 3.0) < 0.6;
        puddle || spray || (x < 5.0 && z < 8.0)
    });
    let row = Gauge::new(&scene).measure(&frame);
    assert!((value(&row, "front_m") - 15e-3).abs() < 3e-5, "{row:?}");
    assert!(
        (value(&row, "column_height_m") - 8e-3).abs() < 3e-5,
        "{row:?}"
    );
}

#[test]
fn the_surface_area_is_that_of_the_body() {
    let mut scene = pool_scene(Dimension::Three, 0.4);
    let area = |scene: &Scene, holds: &dyn Fn(f64, f64, f64) -> bool| {
        let frame = lattice(scene, holds);
        Raster::new(scene, &frame).surface_area() * 1e6
    };
    let flat = area(&scene, &|_, _, z| z < 10.0);
    assert!((flat / 576.0 - 1.0).abs() < 0.02, "flat pool: {flat} mm²");
    scene.domain.boundary[2][0] = Side::Open;
    let ball = |x: f64, y: f64, z: f64| (x - 12.0).hypot(y - 12.0).hypot(z - 12.0) < 7.0;
    let sphere = area(&scene, &ball);
    let exact = 4.0 * std::f64::consts::PI * 49.0;
    assert!(
        (sphere / exact - 1.0).abs() < 0.03,
        "sphere: {sphere} mm², exactly {exact}"
    );
}

#[test]
fn the_scene_decides_what_is_measured() {
    let pool = pool_scene(Dimension::Three, 0.5);
    assert!(matches!(Kind::new(&pool), Kind::Pool(_)));
    // As it falls freely: v t + g t^2 / 2 is the gap.
    let time = contact(&pool).unwrap();
    let gap = 3.13 * time + 0.5 * 9.81 * time * time;
    assert!((gap / 0.313e-3 - 1.0).abs() < 1e-9, "{time}");
    assert_eq!(Clock::after_contact(0.5 * time, contact(&pool)), None);
    assert_eq!(
        Clock::after_contact(1.5 * time, contact(&pool)),
        Some(1.5 * time - time)
    );
    // Clocks count from it if the run gets there.
    let mut long = pool.clone();
    assert_eq!(contact_time(&long), 0.0);
    long.impact.end = 2.0 * time;
    assert_eq!(contact_time(&long), time);
    // A drop that lies on the pool touches it from the start, without falling.
    let mut lying = pool.clone();
    lying.bodies[1].motion = Motion::Uniform([0.0; 3]);
    if let Shape::Sphere { centre, .. } = &mut lying.bodies[1].shape {
        centre[2] -= 0.313e-3 + 1e-9;
    }
    assert_eq!(contact(&lying), Some(0.0));
    // A drop that falls on one that lies there meets that, not what is below.
    let mut stacked = without_pool(Dimension::Three, 0.5);
    let mut lying = stacked.bodies[0].clone();
    lying.name = "lying".into();
    lying.motion = Motion::Uniform([0.0; 3]);
    let at = |z: f64, body: &mut Body| {
        if let Shape::Sphere { centre, radius } = &mut body.shape {
            (centre[2], *radius) = (z, 2e-3);
        }
    };
    at(2e-3, &mut lying);
    at(6.3e-3, &mut stacked.bodies[0]);
    stacked.bodies.push(lying);
    let time = contact(&stacked).unwrap();
    let gap = 3.13 * time + 0.5 * 9.81 * time * time;
    assert!((gap / 0.3e-3 - 1.0).abs() < 1e-9, "{time}");
    let mut rest = pool.clone();
    rest.bodies.pop();
    assert!(matches!(Kind::new(&rest), Kind::Level));
    assert_eq!((contact_time(&rest), contact(&rest)), (0.0, None));
    assert_eq!(Clock::after_contact(1.0, contact(&rest)), None);
    let mut floating = without_pool(Dimension::Three, 0.5);
    floating.effects.gravity = None;
    floating.bodies[0].motion = Motion::Uniform([0.0; 3]);
    assert!(matches!(Kind::new(&floating), Kind::Shape));
    let mut vortex = without_pool(Dimension::Two, 0.5);
    vortex.effects.gravity = None;
    let high = vortex.domain.size;
    vortex.bodies[0].shape = Shape::Block {
        low: [0.0; 3],
        high,
    };
    assert!(matches!(Kind::new(&vortex), Kind::Bulk));
}

#[test]
fn energies_that_the_solver_does_not_give_follow_from_the_particles() {
    let mut scene = without_pool(Dimension::Two, 0.5);
    scene.effects.tension = Some(crate::pack_scene::tension(0.067));
    let mut frame = lattice(&scene, |x, _, z| (x - 12.0).hypot(z - 12.0) < 5.0);
    frame.velocity[2].fill(-2.0);
    let row = Gauge::new(&scene).measure(&frame);
    let mass = 1100.0 * 0.5e-3f64.powi(2) * frame.id.len() as f64;
    let close = |name: &str, expected: f64, part: f64| {
        let found = value(&row, name);
        assert!(
            (found / expected - 1.0).abs() < part,
            "{name}: {found}, expected {expected}"
        );
    };
    close("mass_kg", mass, 1e-9);
    close("kinetic_energy_J", 0.5 * mass * 4.0, 1e-9);
    close("potential_energy_J", mass * 9.81 * 12e-3, 1e-5);
    close(
        "surface_energy_J",
        0.067 * 2.0 * std::f64::consts::PI * 5e-3,
        0.03,
    );
    frame.scalars = vec![("kinetic_energy_J".into(), 42.0)];
    assert_eq!(
        value(&Gauge::new(&scene).measure(&frame), "kinetic_energy_J"),
        42.0
    );
}

/// A drop on a dry wall, falling.
fn falling() -> Scene {
    let mut scene = without_pool(Dimension::Three, 0.5);
    scene.effects.wetting = Some(Wetting::of(90.0));
    scene.effects.tension = Some(crate::pack_scene::tension(0.07));
    let form = ViscosityForm::Morris;
    let dynamic = 1e-3;
    scene.effects.viscosity = Some(Viscosity { dynamic, form });
    scene
}

#[test]
fn a_lamella_and_a_rebound_need_a_drop_that_falls_on_a_wall() {
    let scene = falling();
    assert!(strikes_wall(&scene) && Lamella::of(&scene).is_some());
    // Rings are a sphere.
    let mut rings = scene.clone();
    rings.dimension = Dimension::Two;
    let disc = Lamella::of(&rings);
    rings.domain.revolved = Some(Rings::default());
    assert_ne!(Lamella::of(&rings), disc);
    assert_eq!(Lamella::of(&rings), Lamella::of(&scene));
    let no = |change: &dyn Fn(&mut Scene)| {
        let mut scene = falling();
        change(&mut scene);
        assert!(!strikes_wall(&scene), "{scene:?}");
        assert_eq!(Lamella::of(&scene), None);
    };
    no(&|scene| scene.domain.boundary[2][0] = Side::Open);
    no(&|scene| scene.bodies = pool_scene(Dimension::Three, 0.5).problem.bodies);
    no(&|scene| {
        let first = scene.bodies[0].clone();
        scene.bodies.push(first);
    });
    // At rest on the wall.
    no(&|scene| {
        scene.bodies[0].motion = Motion::Uniform([0.0; 3]);
        scene.bodies[0].shape = Shape::Sphere {
            centre: [12e-3, 12e-3, 2e-3],
            radius: 2e-3,
        };
    });
    // Upwards, without gravity.
    no(&|scene| {
        scene.bodies[0].motion = Motion::Uniform([0.0, 0.0, 1.0]);
        scene.effects.gravity = None;
    });
    // From rest above the wall it falls.
    let mut scene = falling();
    scene.bodies[0].motion = Motion::Uniform([0.0; 3]);
    assert!(strikes_wall(&scene));
    let height = 10.313e-3;
    let contact = contact(&scene).unwrap();
    assert!(
        (contact / (2.0 * height / 9.81f64).sqrt() - 1.0).abs() < 1e-9,
        "{contact}"
    );
}

#[test]
fn liquid_off_the_main_body_counts_where_there_is_one() {
    let scene = falling();
    let frame = lattice(&scene, |x, y, z| (x - 12.0).hypot(y - 12.0).hypot(z) < 4.0);
    let row = Gauge::new(&scene).measure(&frame);
    assert_eq!(value(&row, "detached_part"), 0.0);
    // A ball beside it, 3 mm off.
    let apart = |x: f64, y: f64| (x - 12.0).hypot(y - 12.0);
    let off = lattice(&scene, |x, y, z| {
        apart(x, y).hypot(z) < 4.0 || apart(x, y).hypot(z - 10.0) < 3.0
    });
    let row = Gauge::new(&scene).measure(&off);
    let part = 1.0 - frame.id.len() as f64 / off.id.len() as f64;
    assert!(
        (value(&row, "detached_part") - part).abs() < 1e-9,
        "{row:?}"
    );
    let mut two = scene.clone();
    two.bodies.push(scene.bodies[0].clone());
    let row = Gauge::new(&two).measure(&frame);
    assert!(
        row.iter().all(|(name, _)| name != "detached_part"),
        "{row:?}"
    );
}

/// Before its first step a projection has no pressure: a blank is no zero in a mean.
#[test]
fn a_projection_has_no_pressure_at_the_start() {
    let mut scene = without_pool(Dimension::Two, 0.4);
    (scene.domain.boundary[2][0], scene.effects.gravity) = (Side::Open, None);
    scene.effects.tension = Some(crate::pack_scene::tension(0.067));
    let mut frame = lattice(&scene, |x, _, z| (x - 12.0).hypot(z - 12.0) < 4.0);
    frame.scalars = vec![("steps".into(), 0.0), ("pressure_iterations".into(), 0.0)];
    let mut gauge = Gauge::new(&scene);
    assert!(value(&gauge.measure(&frame), "core_pressure_Pa").is_nan());
    frame.scalars[0].1 = 1.0;
    assert!(value(&gauge.measure(&frame), "core_pressure_Pa").is_finite());
}
