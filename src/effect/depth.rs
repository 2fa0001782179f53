//! Where the stress of a flat surface acts, and how strong it is: of sums over a continuous liquid.

use crate::scene::KernelName;

/// Depths in H: z_s, the first moment of the tension of a flat surface, each pair of (5) in
/// [`super::tension`] counted at its middle; and b of (1) of
/// [`super::tension::level`], from the pressure in balls of R = 32 and 64 H.
/// Both by quadrature of the sums over a continuous liquid, `tests/engine/effect_level.rs`.
pub fn depths(kernel: KernelName, dimension: usize) -> [f64; 2] {
    match (kernel, dimension) {
        (KernelName::WendlandC2, 2) => [0.4657, 0.3513],
        (KernelName::WendlandC2, _) => [0.4592, 0.4074],
        (KernelName::CubicSpline, 2) => [0.5023, 0.3811],
        (KernelName::CubicSpline, _) => [0.4894, 0.4355],
    }
}

/// sigma_eff / sigma of a flat surface at alpha = 1, by the same quadrature.
pub fn flat(kernel: KernelName, dimension: usize) -> f64 {
    match (kernel, dimension) {
        (KernelName::WendlandC2, 2) => 0.1812,
        (KernelName::WendlandC2, _) => 0.1848,
        (KernelName::CubicSpline, 2) => 0.1691,
        (KernelName::CubicSpline, _) => 0.1737,
    }
}
