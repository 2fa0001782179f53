//! Settings of WCSPH.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Sph;
use crate::scene::schema::{by_preset_all, not_negative, positive};
use crate::scene::unit::{One, Speed, Time, Unlimited};

/// How density is obtained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Density {
    /// Nishio Eq. 4.
    Summation,
    /// The continuity equation with density diffusion (delta-SPH).
    Continuity {
        /// Strength delta of the density diffusion.
        #[serde(default = "Density::diffusion")]
        #[schemars(transform = not_negative)]
        diffusion: f64,
        /// Kernel sum from which it bounds the density of over-compressed liquid; "none": never.
        #[serde(default = "Density::compaction", with = "Unlimited::<One>")]
        #[schemars(extend("minimum" = 1.02, "maximum" = 2.0))]
        compaction: f64,
    },
}

impl Density {
    fn diffusion() -> f64 {
        0.1
    }
    fn compaction() -> f64 {
        1.1
    }
}

/// Treatment of negative pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Pressure {
    /// Set to zero.
    Clipped,
    /// Kept, with control of the tensile instability inside the liquid.
    Controlled,
    /// Kept.
    Signed,
    /// Kept inside; at a free surface limited to what tension can sustain, because a sheet of one
    /// or two particles cannot get thinner: it breaks when stretched.
    Tearing,
}

/// Speed of sound in the course of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SoundSpeed {
    /// Follows the largest speed (continuity density, signed pressure, dual-criteria stepping).
    Adaptive,
    /// Constant in time.
    Constant,
}

/// When single-rate steps compute the tension.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TensionIn {
    /// In each step.
    #[default]
    Each,
    /// Kept while neighbour rows are valid, up to the capillary limit.
    Held,
}

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TimeStepping {
    /// Velocity Verlet with the same step throughout.
    Fixed {
        /// The step.
        #[serde(with = "Time")]
        #[schemars(transform = positive)]
        step: f64,
    },
    /// Velocity Verlet; the step is the smallest limit times a factor.
    Adaptive {
        /// Factor on the limits.
        #[serde(default = "TimeStepping::safety")]
        #[schemars(range(min = 0.01, max = 5.0))]
        safety: f64,
        /// Tension computed in each step, or kept while neighbour rows are valid, up to the
        /// capillary limit.
        #[serde(default)]
        tension: TensionIn,
    },
    /// Dual criteria (Zhang, Rezavand & Hu 2020): advective steps with acoustic steps inside.
    Dual {
        /// Advective CFL number.
        #[serde(default = "TimeStepping::advective")]
        #[schemars(range(min = 0.01, max = 5.0))]
        advective: f64,
        /// Acoustic CFL number.
        #[serde(default = "TimeStepping::acoustic")]
        #[schemars(range(min = 0.01, max = 5.0))]
        acoustic: f64,
    },
}

impl TimeStepping {
    fn safety() -> f64 {
        1.0
    }
    fn advective() -> f64 {
        0.25
    }
    fn acoustic() -> f64 {
        0.6
    }

    /// Whether acoustic steps lie inside advective ones.
    pub fn is_dual(self) -> bool {
        matches!(self, TimeStepping::Dual { .. })
    }

    /// Whether single-rate steps keep the tension over several steps.
    pub fn holds(self) -> bool {
        let tension = TensionIn::Held;
        matches!(self, TimeStepping::Adaptive { tension: is, .. } if is == tension)
    }
}

/// The reference speed V of the speed of sound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SpeedOf {
    /// The largest that the scene suggests: impact speed, sqrt(2 g T), sqrt(8 sigma / (rho R)).
    Scene,
    /// This speed.
    #[serde(untagged)]
    Given(
        #[serde(with = "Speed")]
        #[schemars(transform = positive)]
        f64,
    ),
}

/// How walls exert pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WallPressure {
    /// Wall particles take part in every sum: of density too, if the liquid sums its own; else they
    /// have the density of rest.
    Summation,
    /// Extrapolated from the liquid (Adami, Hu & Adams 2012).
    Extrapolated,
}

/// Settings of WCSPH.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = by_preset_all)]
pub struct Wcsph {
    /// Kernel, smoothing length and particle mass.
    #[serde(flatten)]
    pub sph: Sph,
    /// "summation", or the continuity equation with density diffusion.
    pub density: Density,
    /// Negative pressure: set to zero; kept, with or without control of the tensile instability; or
    /// kept, but limited at a free surface to what tension can sustain.
    pub pressure: Pressure,
    /// Exponent chi of the equation of state (Nishio Eq. 7); 1 is linear.
    #[schemars(range(min = 1.0, max = 10.0))]
    pub exponent: f64,
    /// Speed of sound over the reference speed, c / V of Nishio Eq. 8; 10 is Mach 0.1.
    #[schemars(range(min = 2.0, max = 1000.0))]
    pub sound_speed_factor: f64,
    /// Whether the speed of sound follows the present largest speed.
    pub sound_speed: SoundSpeed,
    /// A speed, or "scene": the largest that the scene suggests.
    pub reference_speed: SpeedOf,
    /// How walls exert pressure.
    pub wall_pressure: WallPressure,
    /// Strength of particle shifting; 0 turns it off.
    #[schemars(transform = not_negative)]
    pub shifting: f64,
    /// How the time step is chosen.
    pub time_stepping: TimeStepping,
}
