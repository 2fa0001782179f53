//! Optimisation: drives the density of every particle to rho0 with the least displacement.
//!
//! Model. With completion outside the free surface, particle i has the density
//!
//! rho_i / rho0 = mu SUM_j W_ij + gamma_i,                                                (1)
//!
//! j over itself, liquid and wall, mu = m / (rho0 s0^d), W in units of the spacing. Kuri et al.
//! place the particles of drop and pool so that the standard deviation of rho from rho0 is at most
//! 0.1 kg/m^3. To minimise SUM (rho_i - rho0)^2 directly makes pairs: where the density is too low,
//! neighbours attract each other until they coincide. But there are d unknowns for every equation,
//! so that the shortest of the steps that cancel the residual r to first order can be chosen
//! (Gauss-Newton, minimum norm):
//!
//! J dx = -r,  dx = J^T lambda,  J J^T lambda = -r,                                       (2)
//! (J dx)_i = mu SUM_j grad W_ij . (dx_i - dx_j) + grad gamma_i . dx_i,                   (3)
//! (J^T lambda)_i = mu SUM_j grad W_ij (lambda_i + lambda_j) + grad gamma_i lambda_i,     (4)
//!
//! with dx = 0 and lambda = 0 at the wall. In addition, a push p separates pairs closer than 0.82
//! spacings; the step nearest to it that still cancels the residual is
//!
//! dx = p + J^T lambda,  J J^T lambda = -(r + J p).                                       (5)
//!
//! From a disordered arrangement (glass) some hundredths of a spacing suffice, so that neighbours
//! stay the same. (5) is solved by conjugate gradients; (3) and (4) are gathering sums.
//! Lengths are in units of the spacing. Tests: tests/engine/pack_poisson.rs.

use super::completion::Completion;
use super::crowd::Crowd;
use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::Real;
use crate::space::parallel::{self, each_mut};
use crate::space::ranks::span::Span;
use crate::space::sweep::{Pair, Pass};
use std::marker::PhantomData;

/// Longest step of a particle in one iteration.
const CAP: f32 = 0.1;
/// Distance below which pairs are separated.
const PART: f64 = 0.82;
/// Relative residual at which the solution of (5) is accepted.
const FORCING: f64 = 0.1;
/// Largest number of conjugate-gradient steps in one iteration.
const SWEEPS: usize = 60;

/// Parameters of (1).
#[derive(Clone, Copy, Debug)]
pub struct Measure<K> {
    /// Number of space dimensions d.
    pub dimension: usize,
    /// Smoothing length.
    pub h: f64,
    /// m / (rho0 s0^d).
    pub mass: f64,
    /// The kernel W.
    pub kernel: PhantomData<K>,
}

impl<K: Kernel> Measure<K> {
    /// mu times the norm of W.
    fn scale(&self) -> f64 {
        self.mass * K::norm(self.dimension) / self.h.powi(self.dimension as i32)
    }
}

/// Density of one particle and its gradient with respect to that particle's own position.
#[derive(Clone, Copy, Debug, Default)]
pub struct Local {
    /// mu SUM W: without completion.
    pub summed: f32,
    /// gamma.
    pub missing: f32,
    /// Gradient of `summed` and, once added, of `missing`.
    pub gradient: [f32; 3],
}

impl Local {
    /// rho / rho0 - 1 - `level`, with the liquid beyond the surface also at 1 + `level`.
    pub fn residual(&self, level: f64) -> f64 {
        self.summed as f64 + (1.0 + level) * (self.missing as f64 - 1.0)
    }
}

/// (1) and its gradient.
struct Sum<K>(Measure<K>);

impl<K: Kernel> Pass<4> for Sum<K> {
    type Payload = ();
    type Out = Local;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::both_lanes(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 4]) {
        let [w, slope] = pair.weight;
        sum[3] += w;
        for k in 0..3 {
            sum[k] = slope.mul_add(pair.d[k], sum[k]);
        }
    }
    fn finish(&self, _target: usize, sum: [f32; 4], out: &mut Local) {
        let scale = self.0.scale();
        out.summed = (scale * (sum[3] as f64 + K::w(0.0))) as f32;
        out.gradient = [0, 1, 2].map(|k| (scale / self.0.h) as f32 * sum[k]);
    }
}

payload! {
    /// lambda of (4).
    struct Multiplier<F> { lambda: F }
}

/// The neighbours' part of (4).
struct Transposed<K>(Measure<K>);

impl<K: Kernel> Pass<3> for Transposed<K> {
    type Payload = Multiplier;
    type Out = [f32; 3];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Multiplier>, sum: &mut [F; 3]) {
        let slope = pair.weight[0] * pair.other.lambda;
        for k in 0..3 {
            sum[k] = slope.mul_add(pair.d[k], sum[k]);
        }
    }
    fn finish(&self, _target: usize, sum: [f32; 3], out: &mut [f32; 3]) {
        *out = sum.map(|s| s * (self.0.scale() / self.0.h) as f32);
    }
}

payload! {
    /// dx of (3).
    struct Step<F> { dx: [F; 3] }
}

/// The neighbours' part of (3).
struct Direct<K>(Measure<K>);

impl<K: Kernel> Pass<1> for Direct<K> {
    type Payload = Step;
    type Out = f32;
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        K::slope_alone(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Step>, sum: &mut [F; 1]) {
        let slope = pair.weight[0];
        let dx = pair.other.dx;
        let mut dot = pair.d[0] * dx[0];
        dot = pair.d[1].mul_add(dx[1], dot);
        dot = pair.d[2].mul_add(dx[2], dot);
        sum[0] = slope.mul_add(dot, sum[0]);
    }
    fn finish(&self, _target: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0] * (self.0.scale() / self.0.h) as f32;
    }
}

/// Densities of all particles, in the present order of `crowd`.
pub fn densities<K: Kernel>(
    crowd: &Crowd,
    completion: &Completion,
    measure: Measure<K>,
    local: &mut Vec<Local>,
) {
    local.resize(crowd.len(), Local::default());
    crowd.sum(measure.h, &Sum(measure), local);
    each_mut(&mut local[..crowd.len()], |i, local| {
        let (gamma, slope) = completion.at(crowd.at(i));
        local.missing = gamma as f32;
        for k in 0..3 {
            local.gradient[k] += slope[k] as f32;
        }
    });
}

/// The level 1 + l of rho / rho0 at which the residuals cancel on average. `span`: the particles.
pub fn level(span: Span, local: &[Local]) -> f64 {
    let [summed, inside] = parallel::sum(span, |i| {
        [local[i].summed as f64, 1.0 - local[i].missing as f64]
    });
    summed / inside - 1.0
}

/// Root mean square of the residuals.
pub fn spread(span: Span, local: &[Local], level: f64) -> f64 {
    let count = span.total().max(1) as f64;
    let [sum] = parallel::sum(span, |i| [local[i].residual(level).powi(2)]);
    (sum / count).sqrt()
}

/// The arrays of (5), kept between iterations.
#[derive(Debug, Default)]
pub struct Work {
    multiplier: Vec<f32>,
    residual: Vec<f32>,
    direction: Vec<f32>,
    image: Vec<f32>,
    step: Vec<[f32; 3]>,
    push: Vec<[f32; 3]>,
}

impl Work {
    /// One Gauss-Newton step (5) towards rho / rho0 = 1 + `level`; returns the conjugate-gradient
    /// steps it took.
    pub fn step<K: Kernel>(
        &mut self,
        crowd: &mut Crowd,
        measure: Measure<K>,
        local: &[Local],
        level: f64,
    ) -> usize {
        let (n, span) = (crowd.len(), crowd.span());
        let dot = |a: &[f32], b: &[f32]| {
            let [sum] = parallel::sum(span.clone(), |i| [a[i] as f64 * b[i] as f64]);
            sum
        };
        self.multiplier.clear();
        self.multiplier.resize(n, 0.0);
        self.image.resize(n, 0.0);
        self.step.resize(n, [0.0; 3]);
        let goal = (FORCING * spread(span.clone(), local, level)).powi(2) * span.total() as f64;
        part(crowd, &mut self.push);
        direct(crowd, measure, local, &self.push, &mut self.image);
        let wanted = |i: usize| -(local[i].residual(level) as f32 + self.image[i]);
        self.residual = (0..n).map(wanted).collect();
        self.direction.clone_from(&self.residual);
        let mut square = dot(&self.residual, &self.residual);
        let mut sweeps = 0;
        while square > goal && sweeps < SWEEPS {
            sweeps += 1;
            transposed(crowd, measure, local, &self.direction, &mut self.step);
            direct(crowd, measure, local, &self.step, &mut self.image);
            let along = dot(&self.direction, &self.image);
            if along <= 0.0 {
                break;
            }
            let alpha = (square / along) as f32;
            add(&mut self.multiplier, alpha, &self.direction);
            add(&mut self.residual, -alpha, &self.image);
            let next = dot(&self.residual, &self.residual);
            let beta = (next / square) as f32;
            scale_add(&mut self.direction, beta, &self.residual);
            square = next;
        }
        transposed(crowd, measure, local, &self.multiplier, &mut self.step);
        add3(&mut self.step, &self.push);
        let step = &self.step;
        let length = |i: usize| step[i].iter().map(|d| d * d).sum::<f32>().sqrt();
        let longest = parallel::max(span.clone(), |i| length(i) as f64).min(CAP as f64);
        crowd.advance(longest, |i| {
            let shorten = (CAP / length(i).max(f32::MIN_POSITIVE)).min(1.0);
            step[i].map(|d| (d * shorten) as f64)
        });
        crowd.settle(&mut Vec::<f32>::new());
        sweeps
    }
}

/// The push p of (5): each particle of a close pair moves half of the distance.
fn part(crowd: &Crowd, push: &mut Vec<[f32; 3]>) {
    push.resize(crowd.len(), [0.0; 3]);
    each_mut(&mut push[..], |i, push| {
        let mut sum = [0.0; 3];
        crowd.neighbours(i, |d| {
            let square: f64 = d.iter().map(|d| d * d).sum();
            if square < PART * PART {
                let r = square.sqrt().max(1e-6);
                for k in 0..3 {
                    sum[k] += 0.5 * (PART - r) * d[k] / r;
                }
            }
        });
        *push = sum.map(|s| s as f32);
    });
}

/// (4).
fn transposed<K: Kernel>(
    crowd: &mut Crowd,
    measure: Measure<K>,
    local: &[Local],
    lambda: &[f32],
    out: &mut [[f32; 3]],
) {
    crowd.load(|i| Multiplier { lambda: lambda[i] });
    crowd.sum(measure.h, &Transposed(measure), out);
    each_mut(&mut out[..lambda.len()], |i, out| {
        for k in 0..3 {
            out[k] += local[i].gradient[k] * lambda[i];
        }
    });
}

/// (3).
fn direct<K: Kernel>(
    crowd: &mut Crowd,
    measure: Measure<K>,
    local: &[Local],
    step: &[[f32; 3]],
    out: &mut [f32],
) {
    crowd.load(|i| Step { dx: step[i] });
    crowd.sum(measure.h, &Direct(measure), out);
    each_mut(&mut out[..step.len()], |i, out| {
        let own: f32 = (0..3).map(|k| local[i].gradient[k] * step[i][k]).sum();
        *out = own - *out;
    });
}

/// a += s b.
fn add(a: &mut [f32], s: f32, b: &[f32]) {
    each_mut(&mut a[..b.len()], |i, a| *a += s * b[i]);
}

/// a += b.
fn add3(a: &mut [[f32; 3]], b: &[[f32; 3]]) {
    each_mut(&mut a[..b.len()], |i, a| {
        for k in 0..3 {
            a[k] += b[i][k];
        }
    });
}

/// a = b + s a.
fn scale_add(a: &mut [f32], s: f32, b: &[f32]) {
    each_mut(&mut a[..b.len()], |i, a| *a = b[i] + s * *a);
}
