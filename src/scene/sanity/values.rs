//! Values that no liquid and no experiment has: mostly a missing or a wrong unit.

use super::Warning;
use crate::scene::quantity::{Unit, legible};
use crate::scene::{Motion, Scene};

/// Densities of liquids, kg/m^3: hydrogen at 20 K has 71, osmium at 3300 K 20,000 (Lide, CRC
/// Handbook of Chemistry and Physics).
const DENSITIES: [f64; 2] = [60.0, 22_000.0];
/// Surface tensions of liquids, N/m: helium at 2 K has 0.0003, tungsten at 3700 K 2.5 (the same).
const TENSIONS: [f64; 2] = [1e-4, 3.0];
/// Viscosities of liquids, Pa s: helium at 4 K 3e-6, pitch 2e8 (Edgeworth, Dalton & Parnell 1984).
const VISCOSITIES: [f64; 2] = [1e-6, 1e9];
/// Speed of a body that is told, m/s: two thirds of that of sound in water.
const FAST: f64 = 1000.0;
/// Gravity that is told, m/s^2; ultracentrifuges reach a million times that of the earth.
const HEAVY: f64 = 1e7;

/// All warnings about values.
pub(super) fn all(scene: &Scene) -> Vec<Warning> {
    let mut all = liquid(scene);
    all.extend(extreme(scene));
    all
}

/// Properties far from those of any liquid: mostly a missing unit.
fn liquid(scene: &Scene) -> Vec<Warning> {
    let properties = [
        (
            "liquid.density",
            Some(scene.density),
            Unit::Density,
            DENSITIES,
        ),
        (
            "effects.tension.coefficient",
            scene.effects.sigma(),
            Unit::Tension,
            TENSIONS,
        ),
        (
            "effects.viscosity.dynamic",
            scene.effects.mu(),
            Unit::Viscosity,
            VISCOSITIES,
        ),
    ];
    let far = properties
        .into_iter()
        .filter_map(|(key, value, unit, [least, most])| {
            let value = value.filter(|value| !(least..=most).contains(value))?;
            let [least, most] = [least, most].map(|bound| legible(bound, unit));
            let why = format!("no liquid has such a value: they have {least} to {most}");
            let remedy = format!(
                "a bare number is in SI units: write the unit, as in {}",
                unit.example()
            );
            Some(Warning::new(key, legible(value, unit), &why, &remedy))
        });
    far.collect()
}

/// Speeds and accelerations that no experiment with liquids has: mostly a wrong unit.
fn extreme(scene: &Scene) -> Vec<Warning> {
    let size = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let fast = scene.bodies.iter().filter_map(|body| match body.motion {
        Motion::Uniform(v) if size(v) > FAST => {
            let key = format!("body.{}.velocity", body.name);
            let why = "liquid is compressible at such a speed, which no method here computes: \
                       sound in water has 1500 m/s";
            let remedy = "write the unit, as in \"3 m/s\"";
            Some(Warning::new(
                &key,
                legible(size(v), Unit::Speed),
                why,
                remedy,
            ))
        }
        _ => None,
    });
    let gravity = scene.effects.gravity.map(size).filter(|g| *g > HEAVY);
    let heavy = gravity.map(|g| {
        let why = "it is more than a million times that of the earth";
        let remedy = "write the unit, as in \"9.81 m/s^2\"";
        let value = legible(g, Unit::Acceleration);
        Warning::new("effects.gravity.acceleration", value, why, remedy)
    });
    fast.chain(heavy).collect()
}
