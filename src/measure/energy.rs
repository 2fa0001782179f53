//! Energy and mass of a frame.

use super::series::Row;
use crate::particle::Frame;
use crate::scene::Scene;

/// Adds the solver's scalars, or values from the particles where it provides none.
pub(super) fn put(scene: &Scene, frame: &Frame, area: Option<f64>, row: &mut Row) {
    let mut put = |name: &str, value: f64| row.push((name.to_owned(), value));
    let given = |name: &str| frame.scalars.iter().any(|(n, _)| n == name);
    let spacing = scene.spacing;
    let count = frame.id.len();
    let nominal = scene.density * spacing.powi(scene.dimension.count() as i32);
    let mass = frame
        .scalars
        .iter()
        .find(|(name, _)| name == "mass_kg")
        .map_or(nominal, |(_, total)| total / count.max(1) as f64);
    for (name, value) in &frame.scalars {
        put(name, *value);
    }
    if !given("kinetic_energy_J") {
        let square = (0..count).fold(0.0, |sum, i| sum + f64::from(speed_squared(frame, i)));
        put("kinetic_energy_J", 0.5 * mass * square);
    }
    if let Some(g) = scene.effects.gravity
        && !given("potential_energy_J")
    {
        let height = (0..count).fold(0.0, |sum, i| {
            (0..3).fold(sum, |s, a| s - g[a] * f64::from(frame.position[a][i]))
        });
        put("potential_energy_J", mass * height);
    }
    if let (Some(sigma), Some(area)) = (scene.effects.sigma(), area) {
        put("surface_area_m2", area);
        if !given("surface_energy_J") {
            put("surface_energy_J", sigma * area);
        }
    }
    if !given("mass_kg") {
        put("mass_kg", mass * count as f64);
    }
}

/// m^2/s^2, of particle `i`.
pub(super) fn speed_squared(frame: &Frame, i: usize) -> f32 {
    let [u, v, w] = &frame.velocity;
    u[i] * u[i] + v[i] * v[i] + w[i] * w[i]
}

/// The energies of a row less the known work, J; `None` if no energy is known.
pub(super) fn explained(row: &Row) -> Option<f64> {
    let is_work = |name: &str| name.ends_with("_work_J");
    let is_energy = |name: &str| name.ends_with("_energy_J");
    row.iter().find(|(name, _)| is_work(name))?;
    let signed = row.iter().map(|(name, value)| match name {
        name if is_work(name) => -value,
        name if is_energy(name) => *value,
        _ => 0.0,
    });
    Some(signed.sum())
}
