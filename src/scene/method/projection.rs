//! Settings that the projection methods, ISPH and MPS, share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::scene::schema::{not_negative, positive};
use crate::scene::unit::{Time, Unlimited};

/// Condition in the pressure equation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PoissonSource {
    /// Density rho0 at the predicted positions (Kuri Eq. 8).
    Density,
    /// Zero divergence.
    Divergence {
        /// Part of the deviation of density that a step at the scene's speed removes.
        #[serde(default = "PoissonSource::density")]
        #[schemars(range(min = 0.0, max = 0.2))]
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
    /// Plain conjugate gradients.
    None,
    /// Division by the diagonal (Jacobi).
    Diagonal,
    /// Symmetric successive over-relaxation.
    Ssor,
    /// Geometric multigrid.
    Multigrid,
}

/// Settings of both methods.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Projection {
    /// Condition for the pressure: density rho0 at once, or zero divergence.
    pub source: PoissonSource,
    /// Preconditioner of the conjugate gradients.
    pub preconditioner: Preconditioner,
    /// Residual over right-hand side at which the pressure solution is accepted.
    #[schemars(range(min = 1e-14, max = 0.1))]
    pub tolerance: f64,
    /// Largest number of iterations of one solution.
    #[schemars(range(min = 1))]
    pub iterations: usize,
    /// Strength of particle shifting; 0 turns it off.
    #[schemars(transform = not_negative)]
    pub shifting: f64,
    /// Part of a step after which the flow is divergence-free (theta method); 1: implicit Euler.
    #[schemars(range(min = 0.55, max = 1.0))]
    pub theta: f64,
    /// Spacings that the fastest particle crosses in a step.
    #[schemars(range(min = 0.001, max = 5.0))]
    pub courant: f64,
    /// Shortest step for speeds and forces; the limits of effects can be shorter.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub shortest: f64,
    /// Longest time step, or "none".
    #[serde(with = "Unlimited::<Time>")]
    #[schemars(transform = positive)]
    pub longest: f64,
    /// Largest tension at a free surface, in (d - 1) sigma / h.
    #[schemars(transform = not_negative)]
    pub cohesion: f64,
}
