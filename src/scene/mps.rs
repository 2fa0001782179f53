//! Settings of MPS.

use super::{Pressure, Projection, Sph};

/// How the pressure of MPS ends at a free surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MpsClosure {
    /// p = 0 where n < beta n0.
    Threshold,
    /// By what the support lacks, without flags.
    Completed,
}

/// Form of the pressure gradient of MPS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MpsGradient {
    /// Eq. 5 with the least pressure about for the own one (Koshizuka, Nobe & Oka 1998).
    Minimum,
    /// With the sum of both pressures: keeps momentum (Tanaka & Masunaga 2010).
    Symmetric,
    /// With a matrix that makes it exact for linear pressure, but near a surface.
    Corrected,
    /// The same, near a surface with the gradient of the smooth kernel.
    Blended,
}

impl MpsGradient {
    /// Whether it is exact for a linear pressure, and keeps no momentum by itself.
    pub fn is_corrected(self) -> bool {
        matches!(self, MpsGradient::Corrected | MpsGradient::Blended)
    }
}

/// Every setting of MPS, after the preset and the overrides.
#[derive(Clone, Debug, PartialEq)]
pub struct Mps {
    /// Kernel of the tension and of the free surface; h is half the largest radius.
    pub sph: Sph,
    pub projection: Projection,
    /// Radius r_e / l0 of number density and gradient, and of the Laplacian.
    pub radius: f64,
    pub laplacian_radius: f64,
    /// Distance over l0 below which the weight of gradients stays what it is there.
    pub core: f64,
    /// n / n0 below which a particle is at the surface.
    pub beta: f64,
    pub closure: MpsClosure,
    pub gradient: MpsGradient,
    /// What a pressure below zero becomes.
    pub pressure: Pressure,
}

impl Mps {
    /// The same with h = half the largest radius, so that the support 2 h covers both.
    pub fn with_length(mut self) -> Self {
        self.sph.smoothing = 0.5 * self.radius.max(self.laplacian_radius);
        self
    }
}
