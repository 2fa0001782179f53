//! A box that vibrates: what hangs free in it moves as it must, seen from the box, and the work of
//! the vibration is in the budget of energy.

use super::method_scene::disturbed;
use coronet::measure::gauge::Gauge;
use coronet::method::{self, Phase};
use coronet::scene::{Scene, file, key};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::Path;

/// 1/s, m.
const FREQUENCY: f64 = 50.0;
const AMPLITUDE: f64 = 0.2e-3;

/// A disc of water in an open box that vibrates along (3, 4).
fn shaken(method: &str) -> Scene {
    let text = format!(
        "dimension = 2\n[box]\nsize = ['8 mm', '8 mm']\nx = 'open'\nz = 'open'\n\
         [liquid]\ndensity = '998 kg/m^3'\n\
         [effects.vibration]\namplitude = '{} mm'\nfrequency = '{FREQUENCY} Hz'\n\
         direction = [3, 4]\n\
         [body.drop]\ndisc = {{ diameter = '2 mm', centre = ['4 mm', '4 mm'] }}\n\
         [pack]\nspacing = '0.2 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = '{method}'\n",
        1e3 * AMPLITUDE
    );
    let loaded = file::read(&text, Path::new("shaken.toml"), &[]);
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}\n{text}"));
    loaded.scene
}

#[test]
fn a_free_drop_moves_as_the_box_does_not() {
    for name in ["wcsph", "isph", "mps"] {
        let scene = shaken(name);
        let state = disturbed(&scene, 0.0);
        let mut solver = method::build(&scene, state, Phase::Impact, Some(1.0)).unwrap();
        let mut gauge = Gauge::new(&scene);
        let mut most = [0.0f64; 2];
        let mut last: BTreeMap<String, f64> = BTreeMap::new();
        while solver.time() < 0.02 {
            last = gauge.measure(&solver.frame()).into_iter().collect();
            let phase = TAU * FREQUENCY * solver.time();
            let speed = AMPLITUDE * TAU * FREQUENCY * (1.0 - phase.cos());
            for (axis, part) in [("x", 0.6), ("z", 0.8)] {
                let got = last[&format!("momentum_{axis}_kg_m_s")] / last["mass_kg"];
                let error = (got - part * speed).abs() / (AMPLITUDE * TAU * FREQUENCY);
                most[0] = most[0].max(error);
            }
            let moving = 2.0 * last["mass_kg"] * (AMPLITUDE * TAU * FREQUENCY).powi(2);
            most[1] = most[1].max(last["energy_unexplained_J"].abs() / moving);
            solver.advance(&mut |_| ()).unwrap();
        }
        println!(
            "{name}: momentum {:.2e}, energy {:.2e} off",
            most[0], most[1]
        );
        assert!(most[0] < 0.01, "{name}: {:.4} of A omega off", most[0]);
        assert!(
            most[1] < 0.01,
            "{name}: {:.4} of the energy unexplained",
            most[1]
        );
        assert!(last["wall_work_J"].is_finite());
    }
}

#[test]
fn absent_it_is_in_no_key_and_present_it_is() {
    let mut scene = shaken("wcsph");
    let names = |scene: &Scene| {
        let settings = key::settings(&scene.impact_input(), scene).unwrap();
        let mut names = settings.into_iter().map(|setting| setting.name);
        names.any(|name| name.starts_with("effects.vibration."))
    };
    assert!(names(&scene));
    assert!(
        scene.resting(0).effects.vibration.is_none(),
        "bodies relax at rest"
    );
    scene.problem.effects.vibration = None;
    assert!(!names(&scene));
}
