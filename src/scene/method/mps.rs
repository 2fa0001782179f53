//! Settings of MPS.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{KernelName, Mass, Projection, Sph};
use crate::scene::schema::by_preset_all;

/// How the pressure of MPS ends at a free surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MpsClosure {
    /// p = 0 where n < beta n0.
    Threshold,
    /// From the missing part of the kernel support, without flags.
    Completed,
}

/// Form of the pressure gradient of MPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MpsGradient {
    /// Eq. 5 with the least pressure nearby in place of the own one (Koshizuka, Nobe & Oka 1998).
    Minimum,
    /// With the sum of both pressures: conserves momentum (Tanaka & Masunaga 2010).
    Symmetric,
    /// With a matrix that makes it exact for linear pressure, except near a surface.
    Corrected,
    /// Corrected, near a surface with the gradient of the smooth kernel.
    Blended,
    /// The transpose of the divergence, in the pressure equation too: pressure feeds in no energy.
    Transposed,
}

impl MpsGradient {
    /// Whether it is exact for a linear pressure, and does not conserve momentum.
    pub fn is_corrected(self) -> bool {
        matches!(self, MpsGradient::Corrected | MpsGradient::Blended)
    }
}

/// Treatment of negative pressure in MPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MpsPressure {
    /// Set to zero.
    Clipped,
    /// Kept.
    Signed,
}

/// Settings of MPS.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(transform = by_preset_all)]
pub struct Mps {
    /// Radius r_e / l0 of number density and gradient.
    #[schemars(range(min = 1.5, max = 5.0))]
    pub radius: f64,
    /// Radius r_e / l0 of the Laplacian.
    #[schemars(range(min = 2.0, max = 5.0))]
    pub laplacian_radius: f64,
    /// Distance over l0 below which the weight of gradients is constant.
    #[schemars(range(min = 0.0, max = 0.9))]
    pub core: f64,
    /// Number density over n0 below which a particle is at the free surface.
    #[schemars(range(min = 0.5, max = 1.0))]
    pub beta: f64,
    /// How the pressure ends at a free surface: zero below `beta`, or without flags.
    pub closure: MpsClosure,
    /// Pressure gradient: from the least pressure nearby, conserving momentum, exact for linear
    /// pressure, or exact with a smooth weight near free surfaces.
    pub gradient: MpsGradient,
    /// Treatment of negative pressure.
    pub pressure: MpsPressure,
    /// Time step and pressure solver.
    #[serde(flatten)]
    pub projection: Projection,
}

impl Mps {
    /// The kernel of the tension and of the free surface; h is half the largest radius, so that the
    /// support 2 h covers both.
    pub fn sph(&self) -> Sph {
        Sph {
            kernel: KernelName::WendlandC2,
            smoothing: 0.5 * self.radius.max(self.laplacian_radius),
            mass: Mass::Nominal,
        }
    }
}
