//! The budget of energy closes: what no part explains is small, although every part has taken some.

use super::method_scene::disturbed;
use coronet::measure::gauge::Gauge;
use coronet::method::{self, Phase};
use coronet::scene::{Scene, file};
use std::collections::BTreeMap;
use std::path::Path;

const WATER: &str = "[effects.tension]\ncoefficient = '72.8 mN/m'\n";

/// A drop of water of 2 mm that meets a wall, or a pool, at 3 m/s; `more`: effects and bodies.
fn splash(method: &str, more: &str) -> Scene {
    let text = format!(
        "dimension = 2\n[box]\nsize = ['16 mm', '6 mm']\nx = 'periodic'\nz = ['wall', 'open']\n\
         [liquid]\ndensity = '998 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [effects.viscosity]\ndynamic = '1 mPa s'\n{more}\
         [pack]\nspacing = '0.1 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = '{method}'\n"
    );
    let loaded = file::read(&text, Path::new("splash.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

/// The last row at `end` s, and the most of what is unexplained over the energy at first.
fn run(scene: &Scene, end: f64) -> (BTreeMap<String, f64>, f64) {
    let state = disturbed(scene, 0.0);
    let mut solver = method::build(scene, state, Phase::Impact, Some(1.0)).unwrap();
    let mut gauge = Gauge::new(scene);
    let row = |gauge: &mut Gauge, frame| gauge.measure(&frame).into_iter().collect();
    let mut last: BTreeMap<String, f64> = row(&mut gauge, solver.frame());
    let of = |row: &BTreeMap<String, f64>, name: &str| row.get(name).copied().unwrap_or(0.0);
    let first = of(&last, "kinetic_energy_J") + of(&last, "surface_energy_J");
    let mut most = 0.0f64;
    while solver.time() < end {
        solver.advance(&mut |_| ()).unwrap();
        last = row(&mut gauge, solver.frame());
        most = most.max(last["energy_unexplained_J"].abs() / first);
    }
    for (name, value) in last.iter().filter(|(name, _)| name.ends_with("_J")) {
        println!(
            "{name} {value:.4e}, {:.3} % of the start",
            100.0 * value / first
        );
    }
    (last, most)
}

const POOL: &str = "[body.pool]\nlayer = { depth = '1 mm' }\n[body.drop]\n\
                    disc = { diameter = '2 mm', gap = '0.2 mm', above = 'pool' }\n\
                    velocity = '3 m/s'\n";
const DROP: &str = "[body.drop]
disc = { diameter = '2 mm', centre = ['8 mm', '1.2 mm'] }
\
                    velocity = '3 m/s'
";

#[test]
fn a_splash_takes_no_energy_from_nowhere() {
    let angle = "[effects.wetting]\nangle = '60 deg'\n";
    let hysteresis = "[effects.wetting]\nadvancing = '100 deg'\nreceding = '50 deg'\n";
    let cases = [
        ("pool", format!("{WATER}{POOL}")),
        ("pool without tension", POOL.to_string()),
        ("wall of 60 degrees", format!("{WATER}{angle}{DROP}")),
        (
            "wall of 100 to 50 degrees",
            format!("{WATER}{hysteresis}{DROP}"),
        ),
    ];
    for (name, more) in cases {
        println!("{name}:");
        let (last, most) = run(&splash("wcsph", &more), 3e-3);
        assert!(most < 0.006, "{name}: {most}");
        for part in ["viscosity", "diffusion"] {
            assert!(last[&format!("{part}_work_J")] < 0.0, "{name}: {part}");
        }
        assert!(last["wall_work_J"] != 0.0, "{name}");
        let shifts = last["shifting_work_J"] != 0.0;
        assert_eq!(shifts, name == "pool without tension");
    }
}

#[test]
fn what_the_pressure_of_a_projection_takes_is_known() {
    let wall = format!("{WATER}[effects.wetting]\nangle = '60 deg'\n{DROP}");
    let cases = [
        ("pool", format!("{WATER}{POOL}")),
        ("wall of 60 degrees", wall),
    ];
    for method in ["isph", "mps"] {
        for (name, more) in &cases {
            println!("{method}, {name}:");
            let (last, most) = run(&splash(method, more), 3e-3);
            assert!(most < 0.005, "{method}, {name}: {most}");
            assert!(last["pressure_work_J"] < 0.0, "{method}, {name}");
        }
    }
}

/// Steps are long here, and every one removes particles.
#[test]
fn what_leaves_the_box_takes_its_energy_with_it() {
    let rising = "[body.drop]\ndisc = { diameter = '2 mm', centre = ['8 mm', '4.5 mm'] }\n\
                  velocity = [0, '0.5 m/s']\n";
    for method in ["wcsph", "isph", "mps"] {
        println!("{method}:");
        let mut scene = splash(method, &format!("{WATER}{rising}"));
        scene.effects.gravity = None;
        let (last, most) = run(&scene, 5e-3);
        assert!(last["removal_work_J"] < -1e-4, "{method}");
        // With the velocities at the start of a step alone: 0.004, 0.009 and 0.002.
        assert!(most < 0.0015, "{method}: {most}");
    }
}

/// A square that becomes a drop with a held contact line: its friction takes what it is booked for.
#[test]
fn friction_of_a_contact_line_takes_what_it_is_booked_for() {
    let hysteresis = "[effects.wetting]\nadvancing = '100 deg'\nreceding = '40 deg'\n";
    let square = "[body.drop]\nrectangle = { low = ['7 mm', '0 mm'], high = ['9 mm', '1 mm'] }\n";
    for method in ["wcsph", "isph", "mps"] {
        println!("{method}:");
        let scene = splash(method, &format!("{WATER}{hysteresis}{square}"));
        let (last, most) = run(&scene, 10e-3);
        assert!(last["wall_work_J"] < 0.0, "{method}");
        assert!(most < 6e-4, "{method}: {most}");
    }
}
