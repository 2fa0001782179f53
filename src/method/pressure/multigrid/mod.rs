//! Multigrid on cells: particles, then a regular grid of nodes, then grids of half its density.
//!
//! (1) The pair energy SUM w_ab (p_a - p_b)^2 / 2 of a smooth p is SUM m_a |grad p|^2, with the
//! share m_a = SUM w_ab r^2 / (2 d) of particle a. So the matrix on the nodes, with linear shape
//! functions N_i in each axis, is that of finite elements with particles as quadrature points,
//! A_ij = SUM m_a grad N_i . grad N_j + s_a N_i N_j,
//! which costs 36 products a particle and knows free surfaces (s_a) and walls (no particles, no
//! flux). Grids of half the density nest, so Galerkin products on them are exact.
//!
//! One V-cycle from zero: smooth, restrict, solve, prolong, smooth. On the particles Jacobi with
//! the diagonal: the spectrum of the couplings, (1 - q/2)^3 for Wendland C2, is positive, so that
//! the eigenvalues of D^-1 A of wave lengths below 2 h lie near 1 and one sweep removes them. On
//! the nodes Jacobi with the absolute row sums (Baker, Falgout, Kolev & Yang 2011), which cannot
//! diverge however few particles a cell holds. The last grid is solved by Cholesky.
//! Symmetric, so that conjugate gradients may use it (Osaki, Morikawa & Asai 2023 precondition
//! ISPH with cells, too; algebraic aggregation: Demidov 2021).

mod element;
mod level;

use super::Equation;
use crate::method::model::Case;
use crate::space::parallel::each_mut;
use element::Elements;
pub use element::{Domain, WIDEST};
use level::Level;

/// Nodes that are few enough to be solved directly.
const FEW: usize = 120;

/// Most grids.
const MOST: usize = 12;

/// Wanted distance of the nodes of the first grid, m.
pub fn pitch(case: &Case) -> f64 {
    2.0 * case.h
}

/// The grids with their memory.
#[derive(Default)]
pub struct Multigrid {
    elements: Elements,
    levels: Vec<Level>,
    /// How many of `levels` are in use.
    depth: usize,
    /// Lower triangle of the last matrix, row by row, factorised.
    factor: Vec<f64>,
    residual: Vec<f64>,
}

impl Multigrid {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let levels: usize = self.levels.iter().map(Level::memory).sum();
        levels + self.elements.memory() + 8 * (self.factor.capacity() + self.residual.capacity())
    }

    /// Nodes of each grid in use, finest first.
    pub fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        self.levels[..self.depth].iter().map(Level::len)
    }

    /// Makes the grids for `equation`; `enclosed`: constants are in its null space.
    pub fn prepare(&mut self, equation: &Equation, domain: &Domain, enclosed: bool) {
        self.residual.resize(equation.columns(), 0.0);
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        self.elements.lay(equation, domain, &mut self.levels[0]);
        self.depth = 1;
        while self.depth < MOST && self.levels[self.depth - 1].len() > FEW {
            if !self.levels[self.depth - 1].halve() {
                break;
            }
            if self.levels.len() == self.depth {
                self.levels.push(Level::default());
            }
            let (fine, coarse) = self.levels.split_at_mut(self.depth);
            coarse[0].galerkin(&fine[self.depth - 1]);
            self.depth += 1;
        }
        self.levels[self.depth - 1].factorise(&mut self.factor, enclosed);
    }

    /// z = one V-cycle on A z = r.
    pub fn apply(&mut self, equation: &Equation, r: &[f64], z: &mut [f64]) {
        let n = equation.len();
        each_mut(&mut z[..n], |i, z| *z = r[i] / equation.diagonal[i]);
        equation.each_row(z, &mut self.residual[..n], |i, z, residual| {
            *residual = r[i] - equation.row(i, z)
        });
        equation.fill(&mut self.residual);
        let level = &mut self.levels[0];
        self.elements.restrict(&self.residual, level);
        self.elements.join(equation, level.count, &mut level.b);
        self.cycle();
        self.elements.prolong(&self.levels[0], &mut z[..n]);
        equation.each_row(z, &mut self.residual[..n], |i, z, residual| {
            *residual = (r[i] - equation.row(i, z)) / equation.diagonal[i]
        });
        let change = &self.residual;
        each_mut(&mut z[..n], |i, z| *z += change[i]);
    }

    /// One V-cycle from zero over the grids.
    fn cycle(&mut self) {
        for k in 0..self.depth - 1 {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            fine[k].smooth(true);
            fine[k].restrict(&mut coarse[0]);
        }
        self.levels[self.depth - 1].solve(&self.factor);
        for k in (0..self.depth - 1).rev() {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            fine[k].prolong(&coarse[0]);
            fine[k].smooth(false);
        }
    }
}
