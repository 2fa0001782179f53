//! Settings of ISPH.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Projection, Sph};
use crate::scene::schema::by_preset_all;

/// How the pressure equation ends at a free surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Closure {
    /// Particles that Marrone et al. (2010) detect: each neighbour mirrored in air (Kuri Eq. 11).
    Mirrored,
    /// From the missing part of the kernel support, without flags.
    Completed,
}

/// Form of the pressure gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Gradient {
    /// Kuri Eq. 9: conserves momentum.
    Symmetric,
    /// Difference of pressures, corrected kernel gradient: exact for linear pressure.
    Corrected,
    /// The transpose of the divergence, in the pressure equation too: pressure feeds in no energy.
    Transposed,
}

/// Settings of ISPH.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = by_preset_all)]
pub struct Isph {
    /// Kernel, smoothing length and particle mass.
    #[serde(flatten)]
    pub sph: Sph,
    /// Time step and pressure solver.
    #[serde(flatten)]
    pub projection: Projection,
    /// How the pressure ends at a free surface: at flagged particles, or without flags.
    pub closure: Closure,
    /// Pressure gradient: conserves momentum, or is exact for linear pressure.
    pub gradient: Gradient,
}
