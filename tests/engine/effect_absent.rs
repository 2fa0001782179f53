//! An absent effect holds no memory and reaches no farther.

use super::method_scene::{drop_scene, solver};

const VISCOSITY: &str = "[effects.viscosity]\ndynamic = '20 mPa s'\n";
const TENSION: &str = "[effects.tension]\ncoefficient = '67 mN/m'\n";
const GRAVITY: &str = "[effects.gravity]\nacceleration = '9.81 m/s^2'\n";

/// Bytes a particle, rows left out, once all scratch has been asked for; scalars of the state.
fn held(method: &str, effects: &str) -> (f64, Vec<String>) {
    let mut solver = solver(&drop_scene(method, 3, effects), 0.0);
    (0..2).for_each(|_| solver.advance(&mut |_| ()).unwrap());
    let state = solver.state();
    let names = state.scalars.iter().map(|(name, _)| name.clone());
    (solver.memory().0, names.collect())
}

#[test]
fn absent_tension_holds_nothing() {
    for method in [
        "wcsph modern",
        "wcsph corrected",
        "isph modern",
        "mps modern",
    ] {
        // What shifting holds, which the tension of `modern` does without, is left out.
        let shifts = match method {
            "wcsph modern" => "[method.wcsph]\nshifting = 0\n",
            _ => "",
        };
        let (without, scalars) = held(method, &format!("{VISCOSITY}{shifts}"));
        let (with, _) = held(method, &format!("{VISCOSITY}{TENSION}"));
        // Normals, stresses and their scratch: 40 bytes at least.
        assert!(with > without + 40.0, "{method}: {with} {without}");
        let named = scalars.iter().find(|name| name.contains("tension"));
        assert_eq!(named, None, "{method}");
    }
}

/// Gravity and viscosity are a constant and a type: present or not, they hold nothing.
#[test]
fn gravity_and_viscosity_hold_nothing() {
    for method in ["wcsph modern", "isph modern", "mps modern"] {
        let (bare, _) = held(method, "");
        let (with, _) = held(method, &format!("{VISCOSITY}{GRAVITY}"));
        assert!((with - bare).abs() < 0.02 * bare, "{method}: {with} {bare}");
    }
}
