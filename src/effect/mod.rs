//! Physical effects, one a file. An absent effect is the type `()` or is not built at all.
//!
//! Each is an [`Effect`]: what it adds, limits, keeps, and how it enters the budget of energy. A
//! solver holds them as [`active::ActiveEffects`]; [`select`] makes them from a scene.

pub mod active;
pub mod band;
pub mod depth;
pub mod gravity;
pub mod normal;
pub mod select;
pub mod surface;
pub mod tension;
pub mod vibration;
pub mod viscosity;
pub mod wetting;

use crate::particle::Particles;
use surface::Surface;
use wetting::friction::Hold;

/// A physical effect. What it does not have it leaves out.
pub trait Effect: Send + Sync {
    /// Name and longest stable step, s, at a smoothing length, m, and a density, kg/m^3.
    fn limit(&self, _length: f64, _density: f64) -> Option<(&'static str, f64)> {
        None
    }

    /// Acceleration of all particles alike at `time` s, m/s^2.
    fn uniform(&self, _time: f64) -> Option<Uniform> {
        None
    }

    /// Finds what it does to particles, where `is_surface` says which are at the free surface.
    fn update(&mut self, _liquid: &Surface, _is_surface: &(dyn Fn(usize) -> bool + Sync)) {}

    /// Adds the accelerations of the last update, m/s^2, by liquid particle.
    fn add(&self, _into: &mut [[f32; 3]]) {}

    /// Fills `into`, by liquid particle, with the friction of the last update; velocity in m/s.
    fn friction(&mut self, _liquid: &Surface, _velocity: &[Vec<f64>; 3], _into: &mut Vec<Hold>) {}

    /// Its energy as of the last update, at the present velocities.
    fn account(&mut self, _particles: &Particles) -> Option<Account> {
        None
    }

    /// [`Account::lines`] at the velocities of `particles`, which are in the same order.
    fn lines(&mut self, _particles: &Particles) -> f64 {
        0.0
    }

    /// A number that a restart needs, with its name in checkpoints.
    fn kept(&self) -> Option<(&'static str, f64)> {
        None
    }

    /// Bytes held.
    fn memory(&self) -> usize {
        0
    }
}

/// An acceleration of all particles alike, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Uniform {
    /// Always the same: its work is that of an energy of height.
    Constant([f64; 3]),
    /// Changes with time: its work is given to the liquid by the walls, which move.
    Driven([f64; 3]),
}

/// What an effect with an energy adds to the budget, J and W (J/m and W/m in 2-D).
#[derive(Clone, Copy, Debug)]
pub struct Account {
    /// The energy.
    pub energy: f64,
    /// Its rate: minus the power of the force, `lines` left out.
    pub rate: f64,
    /// Power of what contact lines pull because their angle is not the mean one.
    pub lines: f64,
}
