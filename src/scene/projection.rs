//! Settings of the projection methods, ISPH and MPS.

/// What the pressure equation asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PoissonSource {
    /// Density rho0 at the predicted positions (Kuri Eq. 8).
    Density,
    /// No divergence, and this part of the deviation of density gone in a step at the scene's
    /// speed.
    Divergence { density: f64 },
}

/// What conjugate gradients are preconditioned with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preconditioner {
    None,
    Diagonal,
    Ssor,
    Multigrid,
}

/// What both methods have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    pub source: PoissonSource,
    pub preconditioner: Preconditioner,
    /// Residual over right-hand side at which the pressure is found.
    pub tolerance: f64,
    /// Most iterations of one solution.
    pub iterations: usize,
    /// Strength of particle shifting (0 is off).
    pub shifting: f64,
    /// Where in a step the pressure keeps the flow free of divergence: 1 at its end.
    pub theta: f64,
    /// Spacings that the fastest particle crosses in a step.
    pub courant: f64,
    /// Shortest step, s.
    pub shortest: f64,
    /// Longest step, s; infinite for none.
    pub longest: f64,
    /// What a free surface holds before it tears, in (d - 1) sigma / h.
    pub cohesion: f64,
}
