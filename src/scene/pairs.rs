//! How pairs are found and summed.

/// Of the pair sums: positions, separations, kernels and sums.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// f32 throughout.
    Single,
    /// Separations from exact differences of positions, the rest in f32.
    #[default]
    Mixed,
    /// f64; what enters and leaves a sum is f32.
    Double,
}

/// How pairs are found and summed, whatever the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairs {
    pub precision: Precision,
    /// Extra reach of neighbour rows, as a fraction of the support.
    pub slack: f64,
}

impl Default for Pairs {
    fn default() -> Self {
        Pairs {
            precision: Precision::Mixed,
            slack: 0.1,
        }
    }
}
