//! A full box in which the pressure alternates.

use super::{Warning, is_full};
use crate::scene::quantity::{Unit, legible};
use crate::scene::{Method, Pressure, Scene, Side};

/// Liquid without a surface that a vibration presses and pulls: WCSPH lets particles go where the
/// pressure is negative, unless the tensile instability is controlled. A box of 4 mm at 100 Hz and
/// 0.1 mm: 2.4 m/s in place of rest; controlled 6 mm/s.
pub fn alternating(scene: &Scene) -> Option<Warning> {
    let vibration = scene.effects.vibration?;
    let Method::Wcsph(settings) = &scene.method else {
        return None;
    };
    let walls = |axis: &usize| scene.domain.boundary[*axis] == [Side::Wall; 2];
    let along = |axis: &&usize| vibration.amplitude[**axis] != 0.0;
    let is_pulled = scene.dimension.axes().iter().filter(along).any(walls);
    let is_free = matches!(settings.pressure, Pressure::Tearing | Pressure::Signed);
    if !is_pulled || !is_free || !is_full(scene) {
        return None;
    }
    let value = legible(vibration.frequency, Unit::Rate);
    let why = "it presses and pulls a liquid without a surface; particles leave each other where \
               the pressure is negative";
    let remedy = "set `method.wcsph.pressure = \"controlled\"`, or take ISPH";
    Some(Warning::new(
        "effects.vibration.frequency",
        value,
        why,
        remedy,
    ))
}
