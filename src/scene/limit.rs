//! Limits of a time step, s: lengths in m, the rest in SI units.

use std::f64::consts::TAU;

/// 0.25 h / (c + u) (Monaghan 1992).
pub fn acoustic(h: f64, sound_speed: f64, speed: f64) -> f64 {
    0.25 * h / (sound_speed + speed)
}

/// 0.25 sqrt(h / |a|) (Monaghan 1992).
pub fn force(h: f64, acceleration: f64) -> f64 {
    0.25 * (h / acceleration.max(1e-30)).sqrt()
}

/// 0.125 h^2 / nu (Morris, Fox & Zhu 1997), from the dynamic viscosity.
pub fn viscous(h: f64, density: f64, viscosity: f64) -> f64 {
    0.125 * h * h * density / viscosity
}

/// 0.25 sqrt(rho h^3 / (2 pi sigma)) (Morris 2000).
pub fn capillary(h: f64, density: f64, tension: f64) -> f64 {
    0.25 * (density * h.powi(3) / (TAU * tension)).sqrt()
}
