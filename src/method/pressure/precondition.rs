//! Preconditioners that need no more than the matrix: z = M^-1 r, M symmetric and positive
//! definite.

use super::Equation;
use crate::space::parallel::{Parts, each_mut, each_part};

/// Rows that one sweep of [`ssor`] takes together; fixed, so that nothing depends on threads.
const BLOCK: usize = 1024;

/// M = D (Jacobi).
pub fn diagonal(equation: &Equation, r: &[f64], z: &mut [f64]) {
    each_mut(&mut z[..r.len()], |i, z| *z = r[i] / equation.diagonal[i]);
}

/// M = (D + L) D^-1 (D + L^T), symmetric Gauss-Seidel, within blocks of rows: couplings between
/// blocks are left out, so that blocks run in parallel and their order does not matter.
pub fn ssor(equation: &Equation, r: &[f64], z: &mut [f64]) {
    each_part(Parts::of(z, BLOCK), |block, z| {
        let first = block * BLOCK;
        let inside = |i: usize, z: &[f64], range: std::ops::Range<usize>| {
            let mut sum = 0.0;
            for (j, w) in equation.coupling.row(i) {
                let j = j.wrapping_sub(first);
                if range.contains(&j) {
                    sum += w as f64 * z[j];
                }
            }
            sum
        };
        for k in 0..z.len() {
            let i = first + k;
            z[k] = (r[i] + inside(i, z, 0..k)) / equation.diagonal[i];
        }
        for k in (0..z.len()).rev() {
            let i = first + k;
            z[k] += inside(i, z, k + 1..z.len()) / equation.diagonal[i];
        }
    });
}
