//! Settings of every method: kernel, smoothing length and mass.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Smoothing kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum KernelName {
    /// Cubic spline.
    CubicSpline,
    /// Wendland's C2 kernel.
    WendlandC2,
}

/// Mass of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mass {
    /// rho0 s0^d.
    Nominal,
    /// rho0 / SUM W over the lattice, so that the lattice's summed density is rho0.
    LatticeSum,
}

/// Kernel, smoothing length and mass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sph {
    /// Smoothing kernel.
    pub kernel: KernelName,
    /// Smoothing length h / s0.
    #[schemars(range(min = 1.0, max = 2.5))]
    pub smoothing: f64,
    /// rho0 s0^d, or rho0 / lattice sum.
    pub mass: Mass,
}
