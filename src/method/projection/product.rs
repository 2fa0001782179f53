//! The matrix of (3) of [`super::transposed`], and what walls are in it.
//!
//! Walls have no equation of their own. To ask for D v = 0 at each of them would stop a drop that
//! spreads, for a dry wall particle sees liquid on one side only, coming nearer. Their pressure
//! follows from their rows of A alone, in which n . grad p is that of [`super::walls`]:
//! (1) p_w = f_w (SUM w_wa p_a / SUM w_wa + o_w), a: liquid; in short p = E p_liquid + f o
//! f_w: how wet the wall is, f of (1) of [`crate::method::wet`]; the row of a wall that is not wet
//! leaves beta diag (f - 1) (p_w / f), of which the liquid gets f.
//! What the row of a wall particle has goes to the liquid by the transpose of E: E^T M E is as
//! symmetric as the matrix M with walls, and G p does the work of volumes as before.
//! Test: tests/engine/projection_wall.rs.

use super::transposed::share;
use super::{Projection, Scheme};
use crate::method::pressure::{Equation, Matrix};
use crate::space::parallel::each_mut;

/// How much of 1 / diag A is added to the preconditioner of A, B = A^-1. On a lattice the matrix of
/// (3) is between 0.1 and 1 times A, least where values alternate. With the addition the
/// eigenvalues of B (3) are within a factor of 2.8 in two dimensions and 2.9 in three (ISPH,
/// h = 1.5 s0, theta = 0.6), and of 2.5 and 2.3 (MPS, theta = 0.7).
const ROUGHNESS: f64 = 4.0;

impl<S: Scheme> Projection<S> {
    /// Adds to the liquid E^T of the entries of walls, which are over the diagonal already.
    pub(super) fn share_out(&mut self, right: &mut [f64]) {
        let n = self.liquid.len();
        let mut wide = std::mem::take(&mut self.transposed.wide);
        wide.clear();
        wide.resize(n, 0.0);
        wide.extend_from_slice(&right[n..]);
        wide.resize(self.equation.columns(), 0.0);
        self.equation.fill(&mut wide);
        let coupling = &self.equation.coupling;
        each_mut(&mut right[..n], |i, right| {
            *right += coupling.dot(i, &wide);
        });
        right[n..].fill(0.0);
        self.transposed.wide = wide;
    }
}

/// The matrix of (3) over the unit of the rows.
pub(super) struct Product<'a, S: Scheme>(pub &'a mut Projection<S>);

impl<S: Scheme> Matrix for Product<'_, S> {
    fn varying(&self, _: usize) -> usize {
        self.0.liquid.len()
    }

    fn has_walls(&self) -> bool {
        false
    }

    fn roughness(&self) -> f64 {
        ROUGHNESS
    }

    fn clear_given(&self, v: &mut [f64]) {
        let given = &self.0.transposed.given;
        each_mut(v, |i, v| {
            if given.get(i).copied().unwrap_or(true) {
                *v = 0.0
            }
        });
    }

    fn apply(&mut self, equation: &Equation, x: &mut [f64], out: &mut [f64]) {
        let this = &mut *self.0;
        let (n, count) = (this.liquid.len(), equation.len());
        let mut wide = std::mem::take(&mut this.transposed.wide);
        wide.clear();
        wide.extend_from_slice(x);
        equation.fill(&mut wide);
        let mut walls = std::mem::take(&mut this.transposed.at_groups);
        walls.resize(count - n, 0.0);
        extend(equation, &this.walls.share, (n, &wide), &mut walls);
        wide[n..count].copy_from_slice(&walls);
        this.transposed.at_groups = walls;
        match this.liquid.flow.is_axial() {
            true => this.multiply_rings(&wide, out),
            false => {
                this.press(&wide, false);
                this.find_divergence(false, out);
            }
        }
        let beta = share(this.settings.theta);
        let scale = (1.0 - beta) / S::unit(this);
        let (liquid, walls) = wide[..count].split_at_mut(n);
        each_mut(liquid, |_, x| *x *= beta);
        let (flux, share_of) = (&out[n..], &this.walls.share);
        each_mut(walls, |g, x| {
            let f = share_of[g];
            *x = beta * (2.0 - f) * *x - f * scale * flux[g] / equation.diagonal[n + g];
        });
        equation.each_row(&mut wide, &mut out[..n], |i, wide, out| {
            *out = scale * *out + equation.row(i, wide)
        });
        out[n..].fill(0.0);
        this.transposed.wide = wide;
    }
}

/// Gives `walls` the pressure E of (1) of the liquid in `x`, `n` particles; `share`: f.
pub(super) fn extend(
    equation: &Equation,
    share: &[f64],
    (n, x): (usize, &[f64]),
    walls: &mut [f64],
) {
    each_mut(walls, |g, p| {
        *p = share[g] * equation.coupling.dot(n + g, x) / equation.diagonal[n + g];
    });
}
