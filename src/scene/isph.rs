//! Settings of ISPH.

use super::Sph;

/// What the pressure equation asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoissonSource {
    /// Density rho0 at the predicted positions (Kuri Eq. 8).
    Density,
    /// No divergence, and this part of the deviation of density gone in a step.
    Divergence { density: f64 },
}

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

/// What conjugate gradients are preconditioned with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preconditioner {
    None,
    Diagonal,
    Ssor,
    Multigrid,
}

/// Every setting of ISPH, after the preset and the overrides.
#[derive(Clone, Debug, PartialEq)]
pub struct Isph {
    pub sph: Sph,
    pub source: PoissonSource,
    pub closure: Closure,
    pub gradient: Gradient,
    pub preconditioner: Preconditioner,
    /// Residual over right-hand side at which the pressure is found.
    pub tolerance: f64,
    /// Most iterations of one solution.
    pub iterations: usize,
    /// Strength of particle shifting (0 is off).
    pub shifting: f64,
    /// Spacings that the fastest particle crosses in a step.
    pub courant: f64,
    /// Shortest step, s.
    pub shortest: f64,
    /// Longest step, s; infinite for none.
    pub longest: f64,
}
