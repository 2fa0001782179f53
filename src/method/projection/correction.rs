//! Symmetric 3 x 3 tensors: xx, xy, xz, yy, yz, zz.

use nalgebra::{Matrix3, SymmetricEigen};

/// A symmetric tensor: components in the order of [`AXES`].
pub type Tensor = [f32; 6];

/// Axes of the six entries.
pub const AXES: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/// The unit tensor.
pub const IDENTITY: Tensor = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0];

/// Least eigenvalue that is inverted: that of the moment of a few neighbours on one side is near
/// zero, and its inverse would be noise (0.2 to 0.3 is common practice, after Bonet & Lok 1999).
const LEAST: f64 = 0.3;

fn matrix(t: &Tensor) -> Matrix3<f64> {
    let [a, b, c, d, e, f] = t.map(f64::from);
    Matrix3::new(a, b, c, b, d, e, c, e, f)
}

/// Smallest eigenvalue.
pub fn least_eigenvalue(t: &Tensor) -> f64 {
    SymmetricEigen::new(matrix(t)).eigenvalues.min()
}

/// Inverse with eigenvalues below [`LEAST`] taken as that.
pub fn inverse(t: &Tensor) -> Tensor {
    let m = matrix(t);
    // Gershgorin: all eigenvalues are far enough from zero, and the inverse is regular.
    let row = |i: usize| {
        m[(i, i)]
            - (0..3)
                .filter(|j| *j != i)
                .map(|j| m[(i, j)].abs())
                .sum::<f64>()
    };
    let inverse = if (0..3).all(|i| row(i) >= LEAST) {
        m.try_inverse().unwrap_or_else(Matrix3::identity)
    } else {
        let eigen = SymmetricEigen::new(m);
        let part = eigen.eigenvalues.map(|e| 1.0 / e.max(LEAST));
        eigen.eigenvectors * Matrix3::from_diagonal(&part) * eigen.eigenvectors.transpose()
    };
    let at = |i: usize, j: usize| inverse[(i, j)] as f32;
    [at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)]
}

/// T v.
#[inline(always)]
pub fn times(t: &Tensor, v: [f64; 3]) -> [f64; 3] {
    let [a, b, c, d, e, f] = t.map(f64::from);
    [
        a * v[0] + b * v[1] + c * v[2],
        b * v[0] + d * v[1] + e * v[2],
        c * v[0] + e * v[1] + f * v[2],
    ]
}
