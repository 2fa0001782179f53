//! What can go wrong when a body is packed.

use crate::space::grid::TooSmall;

/// Least permitted distance of two particles, in spacings: closer ones would be a pair.
pub(super) const PAIRED: f64 = 0.7;

/// A body that cannot be packed.
#[derive(Clone, Debug, thiserror::Error)]
pub enum PackError {
    /// The spacing is too large; `count` is below 2^d.
    #[error(
        "body `{body}`: pack.spacing = {spacing:.4e} m leaves it {count} particles; \
         make the spacing smaller than the body's least extent / 4"
    )]
    TooFew {
        /// Name of the body.
        body: String,
        /// Spacing of the particles, m.
        spacing: f64,
        /// Particles that the body would have.
        count: usize,
    },
    /// The spacing is too small; `count` is above half the 32-bit numbers.
    #[error(
        "body `{body}`: pack.spacing = {spacing:.4e} m gives {count} particles, more than {}; \
         make the spacing larger or the body smaller",
        u32::MAX
    )]
    TooMany {
        /// Name of the body.
        body: String,
        /// Spacing of the particles, m.
        spacing: f64,
        /// Particles that the body would have.
        count: usize,
    },
    /// The cells of the neighbour search do not fit into a periodic side.
    #[error("body `{body}`: {source}")]
    Box {
        /// Name of the body.
        body: String,
        /// Which side is too small.
        source: TooSmall,
    },
    /// The optimisation did not converge.
    #[error(
        "body `{body}`: after pack.iterations = {iterations} density deviates by {spread:.3e} \
         kg/m^3 from rho0 and the closest particles are {closest:.3} spacings apart; required: \
         at most pack.tolerance = {tolerance} kg/m^3 and at least {PAIRED}: allow more iterations \
         or a larger tolerance, or change pack.seed"
    )]
    NotReached {
        /// Name of the body.
        body: String,
        /// Standard deviation of the density from rho0, kg/m^3.
        spread: f64,
        /// Least distance of two particles, in spacings.
        closest: f64,
        /// Iterations done.
        iterations: usize,
        /// Largest permitted `spread`, kg/m^3.
        tolerance: f64,
    },
    /// The watcher stopped it.
    #[error("body `{body}`: packing was stopped")]
    Stopped {
        /// Name of the body.
        body: String,
    },
}
