//! Settings that the projection methods, ISPH and MPS, share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::schema::{not_negative, positive};
use crate::scene::unit::{Time, Unlimited};

/// What the pressure equation asks for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PoissonSource {
    /// Density rho0 at the predicted positions (Kuri Eq. 8).
    Density,
    /// No divergence.
    Divergence {
        /// Part of the deviation of density that goes in a step at the scene's speed.
        #[serde(default = "PoissonSource::density")]
        #[schemars(range(min = 0.0, max = 1.0))]
        density: f64,
    },
}

impl PoissonSource {
    fn density() -> f64 {
        0.01
    }
}

/// Preconditioner of the conjugate gradients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preconditioner {
    None,
    Diagonal,
    Ssor,
    Multigrid,
}

/// What both methods have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Projection {
    /// What the pressure makes: density rho0 at once, or no divergence.
    pub source: PoissonSource,
    /// Preconditioner of the conjugate gradients.
    pub preconditioner: Preconditioner,
    /// Residual over right-hand side at which the pressure is found.
    #[schemars(range(min = 1e-14, max = 0.1))]
    pub tolerance: f64,
    /// Most iterations of one solution.
    #[schemars(range(min = 1))]
    pub iterations: usize,
    /// Strength of particle shifting; 0 is off.
    #[schemars(transform = not_negative)]
    pub shifting: f64,
    /// Part of a step after which the flow has no divergence (theta method); 1: implicit Euler.
    #[schemars(range(min = 0.5, max = 1.0))]
    pub theta: f64,
    /// Spacings that the fastest particle crosses in a step.
    #[schemars(range(min = 0.001, max = 5.0))]
    pub courant: f64,
    /// Shortest time step.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub shortest: f64,
    /// Longest time step, or "none".
    #[serde(with = "Unlimited::<Time>")]
    #[schemars(transform = positive)]
    pub longest: f64,
    /// What a free surface holds before it tears, in (d - 1) sigma / h.
    #[schemars(transform = not_negative)]
    pub cohesion: f64,
}
