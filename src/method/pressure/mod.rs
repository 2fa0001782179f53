//! The pressure equation of the projection methods and its solution.
//!
//! (1) A p = b,  (A p)_a = SUM w_ab (p_a - p_b) + s_a p_a,  w_ab = w_ba > 0, s_a >= 0
//! is symmetric and positive definite as soon as one s_a > 0 (a free surface) is coupled to all;
//! with none (a liquid that fills its box) constants are its null space, and b and p are kept free
//! of them.
//!
//! Conjugate gradients (Hestenes & Stiefel 1952) with a choice of preconditioner: [`precondition`],
//! [`multigrid`]. Every sum is taken in a fixed order, so results do not depend on the number of
//! threads. Failure to converge is an [`Outcome`] that the caller must handle.
//! Tests: tests/engine/pressure_*.rs.

pub mod multigrid;
pub mod precondition;
pub mod shared;

use crate::scene::Preconditioner;
use crate::space::parallel::{each_mut, sum_in, sum_mut};
use crate::space::ranks::span::Span;
use crate::space::sparse::Sparse;
use multigrid::{Domain, Multigrid};
use shared::Shared;
use std::ops::Range;

/// (1), with where its unknowns are.
#[derive(Default)]
pub struct Equation {
    /// w_ab.
    pub coupling: Sparse,
    /// SUM w_ab + s_a.
    pub diagonal: Vec<f64>,
    /// s_a.
    pub surface: Vec<f64>,
    /// b.
    pub right: Vec<f64>,
    /// Position of every unknown, m.
    pub place: [Vec<f64>; 3],
    /// SUM w r^2 / (2 d) of every unknown, m^2: its share in the energy of a unit gradient.
    pub share: Vec<f64>,
    /// The other ranks that have rows, if there are any.
    pub shared: Option<Shared>,
}

impl Equation {
    /// Unknowns.
    pub fn len(&self) -> usize {
        self.diagonal.len()
    }

    /// Whether there is no unknown.
    pub fn is_empty(&self) -> bool {
        self.diagonal.is_empty()
    }

    /// (A x)_i.
    #[inline(always)]
    pub fn row(&self, i: usize, x: &[f64]) -> f64 {
        self.diagonal[i] * x[i] - self.coupling.dot(i, x)
    }

    /// Unknowns with those of other ranks in the rows.
    pub fn columns(&self) -> usize {
        self.shared.as_ref().map_or(self.len(), Shared::columns)
    }

    /// Whether constants are in the null space.
    pub fn is_enclosed(&self) -> bool {
        match &self.shared {
            Some(shared) => shared.is_enclosed,
            None => self.surface.iter().all(|s| *s == 0.0),
        }
    }

    /// Gives unknowns of other ranks their values.
    pub fn fill(&self, x: &mut [f64]) {
        if let Some(shared) = &self.shared {
            shared.fill(x, |_| ());
        }
    }

    /// Calls `f` with every row, `x` and what of `out` belongs to it, once unknowns of other ranks
    /// have their values in `x`. They are on their way while rows that need none are at work.
    pub fn each_row(
        &self,
        x: &mut [f64],
        out: &mut [f64],
        f: impl Fn(usize, &[f64], &mut f64) + Sync,
    ) {
        let Some(shared) = &self.shared else {
            return each_mut(out, |i, out| f(i, x, out));
        };
        let part = |rows: Range<usize>, x: &[f64], out: &mut [f64]| {
            let first = rows.start;
            each_mut(&mut out[rows], |i, out| f(first + i, x, out));
        };
        let (inner, rows) = (shared.inner(), out.len());
        shared.fill(x, |x| part(inner.clone(), x, out));
        part(0..inner.start, x, out);
        part(inner.end..rows, x, out);
    }

    /// The first `count` unknowns, for a sum over those of all ranks; `walls`: whether those of
    /// walls are among them.
    fn span(&self, count: usize, walls: bool) -> Span {
        let shared = self.shared.as_ref();
        shared.map_or(count.into(), |shared| shared.span(walls))
    }

    /// Of a matrix: unknowns that vectors are summed over.
    fn summed(&self, matrix: &impl Matrix) -> usize {
        match &self.shared {
            Some(_) => matrix.varying(self.len()),
            None => self.len(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.coupling.memory() + 8 * 7 * self.diagonal.capacity()
    }
}

/// How a solution went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Iterations taken.
    pub iterations: usize,
    /// |b - A p| / |b|.
    pub residual: f64,
    /// Whether the residual is below the tolerance.
    pub converged: bool,
}

/// What (1) has on its left.
pub trait Matrix {
    /// `out` = A x; columns of other ranks in x may get their values.
    fn apply(&mut self, equation: &Equation, x: &mut [f64], out: &mut [f64]);
    /// How many of `all` unknowns it has, the first ones; those behind follow from them.
    fn varying(&self, all: usize) -> usize {
        all
    }
    /// Whether those of walls are among them.
    fn has_walls(&self) -> bool {
        true
    }
    /// Makes zero what belongs to unknowns whose value is given.
    fn clear_given(&self, _: &mut [f64]) {}
    /// What to add to the preconditioner, times the inverse of the diagonal: of a matrix that has
    /// less of the finest modes than the equation, which the preconditioner is made for.
    fn roughness(&self) -> f64 {
        0.0
    }
}

/// The rows of the equation.
pub struct Rows;

impl Matrix for Rows {
    fn apply(&mut self, equation: &Equation, x: &mut [f64], out: &mut [f64]) {
        equation.each_row(x, out, |i, x, out| *out = equation.row(i, x));
    }
}

/// Conjugate gradients with their memory.
#[derive(Default)]
pub struct Solver {
    multigrid: Multigrid,
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    better: Vec<f64>,
    one: Vec<[f64; 1]>,
}

impl Solver {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        8 * 4 * self.residual.capacity() + self.multigrid.memory()
    }

    /// Makes multigrid ready for `equation`, whatever its b. `domain`: where it lays its grids.
    pub fn prepare(&mut self, equation: &Equation, domain: &Domain) {
        self.multigrid
            .prepare(equation, domain, equation.is_enclosed());
    }

    /// Solves A x = b for `x`, which comes with a first guess. b and preconditioners are those of
    /// `equation`, for which [`Solver::prepare`] must have been called if multigrid is to serve.
    pub fn solve(
        &mut self,
        equation: &mut Equation,
        matrix: &mut impl Matrix,
        preconditioner: Preconditioner,
        (tolerance, most): (f64, usize),
        x: &mut [f64],
    ) -> Outcome {
        let n = equation.columns();
        assert!(x.len() == n && equation.coupling.len() == equation.len());
        let enclosed = equation.is_enclosed();
        let varying = matrix.varying(equation.len());
        if enclosed {
            let mut right = std::mem::take(&mut equation.right);
            self.centre(equation, &mut right[..varying], matrix.has_walls());
            equation.right = right;
        }
        for v in [
            &mut self.residual,
            &mut self.direction,
            &mut self.image,
            &mut self.better,
        ] {
            v.resize(n, 0.0);
        }
        self.residual.fill(0.0);
        let outcome = self.iterate(equation, matrix, preconditioner, (tolerance, most), x);
        if enclosed {
            self.centre(equation, &mut x[..varying], matrix.has_walls());
        }
        outcome
    }

    fn iterate(
        &mut self,
        equation: &Equation,
        matrix: &mut impl Matrix,
        preconditioner: Preconditioner,
        (tolerance, most): (f64, usize),
        x: &mut [f64],
    ) -> Outcome {
        let (n, right) = (equation.summed(matrix), &equation.right);
        let span = equation.span(n, matrix.has_walls());
        let [scale] = sum_in(&mut self.one, span.clone(), |i| [right[i] * right[i]]);
        if scale == 0.0 {
            x.fill(0.0);
            return Outcome {
                converged: true,
                ..Outcome::default()
            };
        }
        self.product(equation, matrix, x);
        let image = &self.image;
        let residual = &mut self.residual[..n];
        let [mut rr] = sum_mut(&mut self.one, span.clone(), residual, |i, slots| {
            let r = right[i] - image[i];
            *slots = r;
            [r * r]
        });
        let mut rz = 0.0;
        for iterations in 0..=most {
            let residual = (rr / scale).sqrt();
            if residual <= tolerance || iterations == most || !residual.is_finite() {
                return Outcome {
                    iterations,
                    residual,
                    converged: residual <= tolerance,
                };
            }
            self.improve(equation, matrix, preconditioner);
            let (r, z) = (&self.residual, &self.better);
            let last = rz;
            [rz] = sum_in(&mut self.one, span.clone(), |i| [r[i] * z[i]]);
            let beta = (iterations > 0).then_some(rz / last);
            each_mut(&mut self.direction[..n], |i, p| {
                *p = z[i] + beta.map_or(0.0, |beta| beta * *p);
            });
            let mut direction = std::mem::take(&mut self.direction);
            self.product(equation, matrix, &mut direction);
            self.direction = direction;
            let (p, q) = (&self.direction, &self.image);
            let [pq] = sum_in(&mut self.one, span.clone(), |i| [p[i] * q[i]]);
            let alpha = rz / pq;
            if !(alpha > 0.0 && alpha.is_finite()) {
                return Outcome {
                    iterations,
                    residual,
                    converged: false,
                };
            }
            [rr] = sum_mut(
                &mut self.one,
                span.clone(),
                (&mut self.residual[..n], &mut x[..n]),
                |i, (r, x)| {
                    *x += alpha * p[i];
                    *r -= alpha * q[i];
                    [*r * *r]
                },
            );
        }
        unreachable!("the last iteration returns")
    }

    /// `image` = A x, free of constants where they are in the null space of the equation.
    fn product(&mut self, equation: &Equation, matrix: &mut impl Matrix, x: &mut [f64]) {
        let (mut image, n) = (std::mem::take(&mut self.image), equation.len());
        matrix.apply(equation, x, &mut image[..n]);
        matrix.clear_given(&mut image[..n]);
        if equation.is_enclosed() {
            self.centre(
                equation,
                &mut image[..matrix.varying(n)],
                matrix.has_walls(),
            );
        }
        self.image = image;
    }

    /// `better` = M^-1 `residual` for a matrix whose preconditioner M is that of the equation and
    /// what [`Matrix::roughness`] adds.
    fn improve(
        &mut self,
        equation: &Equation,
        matrix: &impl Matrix,
        preconditioner: Preconditioner,
    ) {
        let n = equation.len();
        self.precondition(equation, preconditioner);
        let mut z = std::mem::take(&mut self.better);
        let (rough, r) = (matrix.roughness(), &self.residual);
        if rough > 0.0 {
            let diagonal = &equation.diagonal;
            each_mut(&mut z[..n], |i, z| *z += rough * r[i] / diagonal[i]);
        }
        matrix.clear_given(&mut z[..n]);
        if rough > 0.0 && equation.is_enclosed() {
            self.centre(equation, &mut z[..matrix.varying(n)], matrix.has_walls());
        }
        self.better = z;
    }

    /// `better` = M^-1 `residual`.
    fn precondition(&mut self, equation: &Equation, preconditioner: Preconditioner) {
        let (n, r, z) = (equation.len(), &self.residual, &mut self.better);
        match preconditioner {
            Preconditioner::None => z.copy_from_slice(r),
            Preconditioner::Diagonal => precondition::diagonal(equation, &r[..n], &mut z[..n]),
            Preconditioner::Ssor => precondition::ssor(equation, &r[..n], &mut z[..n]),
            Preconditioner::Multigrid => self.multigrid.apply(equation, r, z),
        }
    }

    /// Takes the mean away; `walls`: as [`Equation::span`] has it.
    fn centre(&mut self, equation: &Equation, x: &mut [f64], walls: bool) {
        let (n, span) = (x.len(), equation.span(x.len(), walls));
        let all = span.total();
        let [total] = sum_in(&mut self.one, span, |i| [x[i]]);
        let mean = total / all.max(1) as f64;
        each_mut(&mut x[..n], |_, x| *x -= mean);
    }
}
