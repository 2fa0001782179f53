//! Time-step limits, s. Sources beside each; the least one rules.

use crate::effect::Effect;
use crate::effect::active::ActiveEffects;
use crate::scene::limit;

/// What the limits depend on, SI.
#[derive(Clone, Copy)]
pub struct Limits<'a> {
    /// Smoothing length, m.
    pub h: f64,
    /// Density at rest, kg/m^3.
    pub density: f64,
    /// Speed of sound, m/s; infinite for none.
    pub sound_speed: f64,
    /// Largest speed, m/s, and acceleration, m/s^2, now.
    pub speed: f64,
    /// Largest acceleration now, m/s^2.
    pub acceleration: f64,
    /// What limits a step besides.
    pub effects: &'a ActiveEffects,
}

impl Limits<'_> {
    /// Of sound.
    pub fn acoustic(&self) -> f64 {
        limit::acoustic(self.h, self.sound_speed, self.speed)
    }

    /// Of acceleration.
    pub fn force(&self) -> f64 {
        limit::force(self.h, self.acceleration)
    }

    /// Of the effects, by name.
    fn of_effects(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.effects.limits(self.h, self.density)
    }

    /// The least of the effects.
    pub fn least_of_effects(&self) -> f64 {
        let least = |least: f64, (_, limit): (_, f64)| least.min(limit);
        self.of_effects().fold(f64::INFINITY, least)
    }

    /// The least of the effects and of [`Limits::force`].
    pub fn slow(&self) -> f64 {
        self.force().min(self.least_of_effects())
    }

    /// That of the tension; infinite without.
    pub fn capillary(&self) -> f64 {
        let tension = self.effects.tension.as_ref();
        let limit = tension.and_then(|tension| tension.limit(self.h, self.density));
        limit.map_or(f64::INFINITY, |(_, limit)| limit)
    }

    /// The largest advective step, `cfl` h / u, with the other slow limits (Zhang, Rezavand & Hu
    /// 2020).
    pub fn advective(&self, cfl: f64) -> f64 {
        let advection = cfl * self.h / self.speed.max(1e-30);
        advection.min(self.slow())
    }

    /// The least limit of a single-rate step.
    pub fn least(&self) -> f64 {
        self.acoustic().min(self.slow())
    }

    /// Every limit of a single-rate step by name, least first.
    pub fn all(&self) -> Vec<(&'static str, f64)> {
        let mut all = vec![("acoustic", self.acoustic()), ("force", self.force())];
        all.extend(self.of_effects());
        all.retain(|(_, dt)| dt.is_finite());
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all
    }
}
