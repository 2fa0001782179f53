//! What a packing tells while it is made, and of itself.

use super::quality::Nearest;

/// Progress of packing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackProgress {
    /// `sample`, `repel` or `optimise`.
    pub task: &'static str,
    /// Steps of this task done.
    pub done: usize,
    /// Largest number of steps.
    pub of: usize,
    /// Root mean square of rho - rho0, kg/m^3, once it is known (`optimise`).
    pub spread: Option<f64>,
}

/// Quality of the packing, and the work done.
#[derive(Clone, Debug, PartialEq)]
pub struct PackReport {
    /// Number of particles.
    pub count: usize,
    /// Those that this rank has packed.
    pub own: usize,
    /// Their total mass, kg (kg/m in 2-D); of rings that of the body of revolution, before they are
    /// given the wanted one.
    pub mass: f64,
    /// Mass of the body's volume at rho0, kg (kg/m in 2-D).
    pub wanted_mass: f64,
    /// Unit of both.
    pub unit: &'static str,
    /// Standard deviation of the density from rho0 over all particles, kg/m^3, with completion
    /// outside the free surface. In a body without a free surface, number and volume determine the
    /// mean density, and Wendland's kernel overestimates the density of disordered particles
    /// (Dehnen & Aly 2012): there the deviation is from the mean, 1 + l in
    /// [`super::optimise::level`].
    pub spread: f64,
    /// Mean density less rho0, kg/m^3.
    pub offset: f64,
    /// Number of particles whose kernel reaches no free surface.
    pub supported: usize,
    /// Standard deviation of their summed density without completion, kg/m^3.
    pub supported_spread: f64,
    /// Distances to the nearest particle.
    pub nearest: Nearest,
    /// Gauss-Newton iterations.
    pub iterations: usize,
    /// Conjugate-gradient steps in all of them.
    pub sweeps: usize,
    /// Wall time, s.
    pub seconds: f64,
}

impl std::fmt::Display for PackReport {
    /// One line for the stamp; without wall time, so that it is reproducible.
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "{} particles; density {:+.3} kg/m^3 from rho0, spread {:.3} kg/m^3 \
             ({:.3} over {} with full support); nearest neighbours {:.3} s0 on average, \
             {:.3} s0 at least; {} iterations",
            self.count,
            self.offset,
            self.spread,
            self.supported_spread,
            self.supported,
            self.nearest.mean,
            self.nearest.least,
            self.iterations
        )
    }
}
