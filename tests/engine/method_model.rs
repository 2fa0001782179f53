//! What a solver derives from a scene: the same numbers that the user is told.

use super::method_scene::{EFFECTS, GRAVITY, disturbed, drop_scene, splash_scene};
use coronet::method::model::Model;
use coronet::method::{self, Phase};
use coronet::particle::pack::{mass, pack};
use coronet::scene::{Scene, SpeedOf, numbers};
use std::ops::ControlFlow::Continue;

/// Speed of sound of the solver that is built, m/s.
fn sound_speed(scene: &Scene, phase: Phase) -> f64 {
    let resting = scene.resting(0);
    let (problem, state) = match phase {
        Phase::Impact => (&scene.problem, disturbed(scene, 0.0)),
        Phase::Relax { .. } => {
            let body = pack(&scene.pack_input(0), &mut |_| Continue(())).unwrap().0;
            (&resting, method::resting(&resting, &body))
        }
    };
    let state = method::build(problem, state, phase, Some(3.0))
        .unwrap()
        .state();
    let found = state.scalars.iter().find(|s| s.0 == "sound_speed_m_s");
    found.unwrap().1
}

const REST: Phase = Phase::Relax { damping: 1.0 };

#[test]
fn sound_is_as_fast_as_the_plan_says() {
    for preset in ["paper", "modern"] {
        for effects in ["", EFFECTS, GRAVITY] {
            let splash = splash_scene(preset, 3, effects);
            let drop = drop_scene(preset, 2, effects);
            for scene in [splash, drop] {
                let impact = sound_speed(&scene, Phase::Impact);
                assert_eq!(impact, numbers::sound_speed(&scene));
                assert_eq!(
                    sound_speed(&scene, REST),
                    numbers::rest_sound_speed(&scene.resting(0))
                );
                // A later end continues an earlier one: nothing of the motion may depend on it.
                let mut longer = scene.clone();
                longer.impact.end *= 3.0;
                assert_eq!(sound_speed(&longer, Phase::Impact), impact);
            }
        }
    }
}

#[test]
fn a_relaxation_does_not_read_what_sets_the_impact() {
    let scene = splash_scene("modern", 3, &format!("{GRAVITY}{EFFECTS}"));
    let rest = sound_speed(&scene, REST);
    let mut other = scene.clone();
    let settings = match &mut other.method {
        coronet::scene::Method::Wcsph(settings) => settings,
        method => panic!("{}", method.name()),
    };
    settings.reference_speed = SpeedOf::Given(9.0);
    settings.sound_speed_factor = 20.0;
    assert_eq!(sound_speed(&other, REST), rest);
    assert_eq!(sound_speed(&other, Phase::Impact), 180.0);
}

#[test]
fn particles_keep_the_mass_of_their_packing() {
    for preset in ["paper", "corrected", "modern"] {
        let scene = splash_scene(preset, 3, "");
        let body = pack(&scene.pack_input(0), &mut |_| Continue(())).unwrap().0;
        let sph = scene.method.sph();
        let wanted = mass(scene.space(), scene.density, scene.spacing, sph);
        assert_eq!(body.mass, wanted, "{preset}");
        let resting = method::resting(&scene.resting(0), &body);
        assert_eq!(resting.particles.mass, wanted);
        let start = method::initial(&scene.impact_input(), &[body]);
        assert_eq!(start.particles.mass, wanted);
    }
}

#[test]
fn particles_that_rose_into_another_body_are_counted() {
    let scene = splash_scene("modern", 2, "");
    let mut state = disturbed(&scene, 0.0);
    assert_eq!(method::intruders(&scene, &state), None);
    let p = &mut state.particles;
    for (z, body) in p.position[2].iter_mut().zip(&p.body) {
        *z += if *body == 0 { 1e-3 } else { 0.0 };
    }
    // Of the highest row, 0.4 mm below the centre of the drop, who is up to 0.6 mm from its axis.
    assert_eq!(method::intruders(&scene, &state), Some((0, 1, 4)));
}

#[test]
fn the_equation_of_state_has_its_inverse_and_its_energy() {
    let scene = drop_scene("modern", 3, "");
    let coronet::scene::Method::Wcsph(mut settings) = scene.method.clone() else {
        panic!("{}", scene.method.name());
    };
    for exponent in [1.0, 1.5, 3.0, 7.0, 7.15] {
        settings.exponent = exponent;
        let model = Model::new(&scene, &settings, Phase::Impact);
        let (rho0, c) = (model.density, model.sound_speed);
        for rho in [0.99 * rho0, 1.02 * rho0] {
            let p = model.pressure(rho);
            assert!(
                (model.density_at(p) / rho - 1.0).abs() < 1e-12,
                "{exponent}"
            );
            // d e / d rho = P / rho^2, and d P / d rho = c^2 at rho0.
            let d = 1e-4 * rho0;
            let rise = model.compression(rho + d) - model.compression(rho - d);
            let slope = rise / (2.0 * d);
            assert!((slope * rho * rho / p - 1.0).abs() < 1e-4, "{exponent}");
            let stiffness = (model.pressure(rho0 + d) - model.pressure(rho0 - d)) / (2.0 * d);
            assert!((stiffness / (c * c) - 1.0).abs() < 1e-3, "{exponent}");
        }
    }
}
