//! Derived numbers against values worked out by hand.

use crate::scene_file::small;
use coronet::scene::{driven, numbers};

/// The relative distance of a derived number from what it should be.
fn off(sets: &[&str], name: &str, value: f64) -> f64 {
    let scene = small(sets).scene;
    let found = numbers::of(&scene)
        .get(name)
        .unwrap_or_else(|| panic!("no {name}"));
    (found / value - 1.0).abs()
}

#[test]
fn dimensionless_numbers_of_the_published_case() {
    // Nishio et al. 2010, Table 1, whose numbers belong to d = 4.0 mm.
    let sets = [
        "box.size=[\"40 mm\", \"40 mm\", \"30 mm\"]",
        "pack.spacing=0.5 mm",
        "body.pool.layer.depth=10 mm",
        "body.drop.sphere.diameter=4.0 mm",
        "body.drop.velocity=3.13 m/s",
    ];
    for (name, value) in [
        ("We", 643.0),
        ("Re", 3935.0),
        ("Oh", 6.45e-3),
        ("T/d", 2.5),
        ("d/s0", 8.0),
    ] {
        assert!(off(&sets, name, value) < 2e-3, "{name}");
    }
    assert!(off(&sets, "Fr", 249.7) < 1e-3);
    assert!(off(&sets, "Bo", 0.6442) < 1e-3);
    // c = 31.3 m/s, h = 0.75 mm, V = 3.13 m/s.
    assert!(off(&sets, "acoustic", 0.25 * 0.75e-3 / 34.43) < 1e-12);
    assert!(off(&sets, "advective", 0.25 * 0.5e-3 / 3.13) < 1e-12);
    assert!(
        off(
            &sets,
            "viscous",
            0.125 * 0.75e-3 * 0.75e-3 / (3.5e-3 / 1100.0)
        ) < 1e-12
    );
    assert!(off(&sets, "capillary", 2.6248e-4) < 1e-4);
    assert!(off(&sets, "force", 0.25 * (0.75e-3_f64 / 9.81).sqrt()) < 1e-12);
}

#[test]
fn numbers_of_absent_effects_are_absent() {
    let bare = crate::scene_file::SMALL
        .replace("[effects.gravity]\nacceleration = \"9.81 m/s^2\"\n", "")
        .replace("[effects.viscosity]\ndynamic = \"3.5 mPa s\"\n", "")
        .replace("[effects.tension]\ncoefficient = \"67 mN/m\"\n", "");
    let path = std::path::Path::new("bare.toml");
    let scene = coronet::scene::file::read(&bare, path, &[]).unwrap().scene;
    let numbers = numbers::of(&scene);
    for name in [
        "We",
        "Re",
        "Oh",
        "Fr",
        "Bo",
        "viscous",
        "capillary",
        "force",
    ] {
        assert_eq!(numbers.get(name), None, "{name}");
    }
    assert!(numbers.get("acoustic").is_some());
}

#[test]
fn the_reference_speed_is_the_largest_that_the_scene_suggests() {
    let speed = |sets: &[&str]| numbers::reference_speed(&small(sets).scene);
    assert_eq!(speed(&[]), 1.5);
    // At rest: the top of the drop stands 4.4 mm above the floor, sqrt(2 g z) = 0.2938 m/s; the
    // drop's sqrt(8 sigma / (rho R)) = 0.6980 m/s is larger.
    let capillary = (8.0_f64 * 0.067 / (1100.0 * 0.001)).sqrt();
    assert!((speed(&["body.drop.velocity=0 m/s"]) - capillary).abs() < 1e-15);
    let fall = (2.0_f64 * 9.81 * 4.4e-3).sqrt();
    let weak = [
        "body.drop.velocity=0 m/s",
        "effects.tension.coefficient=1 uN/m",
    ];
    assert!((speed(&weak) - fall).abs() < 1e-12);
    assert_eq!(speed(&["method.wcsph.reference_speed=7 m/s"]), 7.0);
}

#[test]
fn relaxation_does_not_hear_the_impact_speed() {
    let slow = small(&["body.drop.velocity=1 m/s"]).scene;
    let fast = small(&["body.drop.velocity=4 m/s"]).scene;
    for body in 0..2 {
        let speeds = [&slow, &fast].map(|scene| numbers::rest_sound_speed(&scene.resting(body)));
        assert_eq!(speeds[0], speeds[1]);
    }
    assert!(numbers::sound_speed(&slow) < numbers::sound_speed(&fast));
}

#[test]
fn lattices_are_counted_exactly() {
    // Points of the square and cubic lattice within 3 of the origin: 29 and 123.
    let sphere = [
        "pack.arrangement=lattice",
        "body.drop.sphere.diameter=2.4 mm",
    ];
    assert_eq!(numbers::count(&small(&sphere).scene, 1), 123);
    assert_eq!(
        numbers::count(&small(&["pack.arrangement=lattice"]).scene, 0),
        20 * 20 * 5
    );
    // 4/3 pi 1 mm^3 over 0.064 mm^3.
    assert_eq!(numbers::count(&small(&[]).scene, 1), 65);
}

/// A channel of 2 mm that is periodic along x, with gravity along it.
const CHANNEL: &str = "dimension = 2\n[box]\nsize = ['4 mm', '2 mm']\nx = 'periodic'\n\
                       z = 'wall'\n[liquid]\ndensity = '1000 kg/m^3'\n\
                       [effects.gravity]\nacceleration = '200 m/s^2'\ndirection = [1, 0]\n\
                       [effects.viscosity]\ndynamic = '0.1 Pa s'\n\
                       [body.water]\nlayer = { depth = '2 mm' }\n[pack]\nspacing = '0.1 mm'\n\
                       [impact]\nend = '1 ms'\n[frames]\ninterval = '0.1 ms'\n";

fn channel(sets: &[&str]) -> coronet::scene::Scene {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    let path = std::path::Path::new("channel.toml");
    let loaded = coronet::scene::file::read(CHANNEL, path, &sets);
    loaded.unwrap_or_else(|error| panic!("{error}")).scene
}

#[test]
fn what_is_driven_along_a_periodic_axis_has_a_speed_of_sound_for_it() {
    let near = |found: f64, value: f64| assert!((found / value - 1.0).abs() < 1e-9, "{found}");
    let speeds = |sets: &[&str]| {
        let scene = channel(sets);
        let [_, most] = numbers::sound_speeds(&scene);
        [numbers::reference_speed(&scene), most]
    };
    // g L^2 / (8 nu) = 1 m/s, a film of half the height as much; sqrt(2 g T) = 1.265 m/s.
    let [speed, most] = speeds(&[]);
    near(speed, 1.0);
    near(most, 10.0);
    near(speeds(&["body.water.layer.depth='1 mm'"])[0], 1.0);
    // With less viscosity once through the box, but the speed of sound may follow further.
    let [speed, most] = speeds(&["effects.viscosity.dynamic='20 mPa s'"]);
    near(speed, 1.6f64.sqrt());
    near(most, 50.0);
    let [speed, most] = speeds(&["effects.viscosity.dynamic='1e-6 Pa s'"]);
    near(speed, 1.6f64.sqrt());
    near(most, 100.0 * 1.6f64.sqrt());
    let shaken = "effects.vibration={amplitude='1 mm',frequency='500 Hz',direction=[1,0]}";
    let [speed, _] = speeds(&[shaken]);
    near(speed, 1.0 + 2.0 * std::f64::consts::TAU * 0.5);
    assert_eq!(driven::speed(&channel(&["box.x='wall'"])), 0.0);
}

/// Far below its steady speed the liquid starts with the speed of sound of now.
#[test]
fn a_channel_that_is_far_from_steady_accelerates_freely() {
    let scene = channel(&["effects.viscosity.dynamic='1 mPa s'", "impact.end='1.4 ms'"]);
    let mut fastest = 0.0f64;
    let mut run = coronet::simulate::Simulation::new(&scene).unwrap();
    run.run(|frame, _| {
        let speeds = frame.velocity[0].iter().zip(&frame.velocity[2]);
        let speed = |(x, z): (&f32, &f32)| f64::from(x.hypot(*z));
        fastest = speeds.map(speed).fold(0.0, f64::max);
    })
    .unwrap();
    // g t = 0.28 m/s.
    assert!((fastest / 0.28 - 1.0).abs() < 0.05, "{fastest}");
}

#[test]
fn a_flat_ellipse_on_a_lattice_is_counted() {
    let drop = "body.water={ellipse={semi_axes=['1 mm','0.5 mm'], centre=['2 mm', '1 mm']}}";
    let scene = channel(&[drop, "pack.arrangement='lattice'"]);
    let area = std::f64::consts::PI * 50.0;
    let count = numbers::count(&scene, 0) as f64;
    assert!((count / area - 1.0).abs() < 0.05, "{count} for {area}");
}

#[test]
fn a_box_of_too_many_spacings_is_refused() {
    let path = std::path::Path::new("long.toml");
    let sets = ["box.size=['8 km', '2 mm']".to_string()];
    let error = coronet::scene::file::read(CHANNEL, path, &sets).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("box.size") && text.contains("spacings"),
        "{text}"
    );
}
