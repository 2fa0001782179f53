//! Settings of ISPH.

use super::{Projection, Sph};

/// How the pressure equation ends at a free surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closure {
    /// Particles that Marrone et al. (2010) detect: each neighbour mirrored in air (Kuri Eq. 11).
    Mirrored,
    /// By what the support lacks, without flags.
    Completed,
}

/// Form of the pressure gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// Kuri Eq. 9: keeps momentum.
    Symmetric,
    /// Difference of pressures, kernel gradient corrected: exact for linear pressure.
    Corrected,
}

/// Every setting of ISPH, after the preset and the overrides.
#[derive(Clone, Debug, PartialEq)]
pub struct Isph {
    pub sph: Sph,
    pub projection: Projection,
    pub closure: Closure,
    pub gradient: Gradient,
}
