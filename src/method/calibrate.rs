//! Strength of the tension from the virial identity: no dynamics, one evaluation a body.
//!
//! (1) sigma = SUM -(W_t / (d - 1) - W_n) / A(z), W_t and W_n the parts of a particle's share of
//! the pair virial along and across the surface (Kirkwood & Buff 1949), A(z) the area of the
//! parallel surface through the particle, at depth z: an isotropic pressure does not enter, and
//! pairs need no origin, so it holds for a closed drop and for a periodic layer. The liquid is
//! one-sided, so the stress acts below the surface; with the area of the body itself a drop of
//! R = 20 s0 would come out with 16 % too much tension. Normals are those of the shape.
//! (2) sigma = R / (d - 1) SUM m a_n / A(z), a_n the acceleration inwards, for a round body whose
//! tension is carried to the surface ([`crate::effect::tension::level`]): the pressure of Young and
//! Laplace that the forces leave inside. Drops from R = 8 s0 on and flat surfaces then agree on
//! alpha within 1.5 %.
//! That of [`crate::effect::tension`]'s counted forms acts on one layer, which is taken to be what
//! lies within a spacing of the surface; where that is flat they need no alpha.
//! A tension that is the derivative of an energy needs no body: [`energy::CARRIED`].
//! A block has edges, where neither holds: its alpha is that of a flat continuous liquid.
//! (1) is read off the packed bodies: a stress that acts below the surface crushes it as it
//! relaxes, and alpha would grow with what it had done (WCSPH `corrected`: 11 to 25 at R = 2.5 to
//! 8 s0, 5.2 to 5.8 on the packing). (2) is read off the relaxed ones.
//! Test: tests/validation/drop.rs.

use super::model::Case;
use super::{MethodError, Phase};
use crate::effect::depth;
use crate::effect::tension::energy;
use crate::particle::{Particles, wall};
use crate::scene::{Body, Dimension, Problem, Shape, Side, TensionLevel};
use std::f64::consts::PI;

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// alpha.
    pub strength: f64,
    /// Per body: name, area (length in 2-D) of its free surface, and sigma_eff / sigma at
    /// alpha = 1.
    pub bodies: Vec<(String, f64, f64)>,
}

/// Whether the calibration reads the bodies as they are packed, and not as they relaxed.
pub fn is_of_packing(problem: &Problem) -> bool {
    let inside = TensionLevel::Inside;
    problem
        .effects
        .tension
        .is_some_and(|tension| tension.level == inside)
}

/// Calibrates on packed or relaxed `bodies`, as the pack stage leaves them: weighted by area.
/// `problems`: of each body, [`Problem::calm`].
pub fn calibrate(problems: &[Problem], bodies: &[Particles]) -> Result<Calibration, MethodError> {
    let mut measured = Vec::new();
    let (mut area, mut pull) = (0.0, 0.0);
    for (problem, particles) in problems.iter().zip(bodies) {
        let body = &problem.bodies[0];
        let a = free_area(problem, body, 0.0);
        if a <= 0.0 {
            continue;
        }
        let ratio = ratio_of(problem, particles)?;
        measured.push((body.name.clone(), a, ratio));
        area += a;
        pull += ratio * a;
    }
    if pull <= 0.0 {
        let body = problems.first().map(|problem| &problem.bodies[0]);
        let body = body.map_or(String::new(), |body| body.name.clone());
        return Err(MethodError::NoSurface { body });
    }
    Ok(Calibration {
        strength: area / pull,
        bodies: measured,
    })
}

/// Deeper than this part of the radius nothing is summed as from there: areas shrink to nothing.
const DEEPEST: f64 = 0.75;

/// (1) or (2) over sigma at alpha = 1.
fn ratio_of(problem: &Problem, particles: &Particles) -> Result<f64, MethodError> {
    let case = Case::new(problem, Phase::Relax { damping: 0.0 });
    if case.follows_energy() {
        return Ok(energy::CARRIED);
    }
    let walls = wall::build(problem);
    let state = super::start::resting(problem, particles);
    let mut flow = super::flow_of(&case, state.particles, walls)?;
    flow.sort();
    flow.find();
    let sigma = case.effects.sigma().unwrap_or(1.0);
    let Some(mut tension) = super::tension_of(&case, 1.0, false) else {
        return Ok(0.0);
    };
    let body = &problem.bodies[0];
    if tension.lifted && matches!(body.shape, Shape::Block { .. }) {
        return Ok(depth::flat(tension.kernel, tension.dimension));
    }
    let counted = tension.form.is_counted();
    if counted && !radius(body).is_finite() {
        return Ok(1.0);
    }
    let sources = flow.sources();
    let surface = super::surface_of(&flow, &sources);
    let origin = super::start::centre(&body.shape);
    let round = radius(body);
    let home = |i: usize| {
        let x = flow.position(i);
        [0, 1, 2].map(|a| x[a] - origin[a])
    };
    // Every particle may be at the surface: a stress needs no flags for one evaluation.
    let top = |i: usize| !counted || depth(problem, body, home(i)) < problem.spacing;
    tension.update(&surface, top);
    let place = |i: usize| {
        let (z, normal) = under(problem, body, home(i));
        let area = free_area(problem, body, z.min(DEEPEST * round));
        (normal, if area > 0.0 { 1.0 / area } else { 0.0 })
    };
    let sum = if (tension.lifted || counted) && round.is_finite() {
        let mut a = vec![[0.0; 3]; flow.liquid()];
        tension.add(&mut a);
        let pull = |i: usize| {
            let (normal, weight) = place(i);
            let inward: f64 = (0..3).map(|k| -normal[k] * a[i][k] as f64).sum();
            flow.particles.mass * inward * weight
        };
        round / (tension.dimension as f64 - 1.0) * (0..a.len()).map(pull).sum::<f64>()
    } else {
        tension.virial(&surface, place)
    };
    Ok(sum / sigma)
}

/// Radius of curvature of a body's free surface, m: infinite if flat. Of an ellipsoid that of the
/// sphere of the same area.
fn radius(body: &Body) -> f64 {
    match &body.shape {
        Shape::Sphere { radius, .. } => *radius,
        Shape::Ellipsoid {
            semi_axes: [a, b, c],
            ..
        } if *b > 0.0 => (ellipsoid([*a, *b, *c]) / (4.0 * PI)).sqrt(),
        Shape::Ellipsoid {
            semi_axes: [a, _, c],
            ..
        } => ellipse(*a, *c) / (2.0 * PI),
        Shape::Layer { .. } | Shape::Block { .. } => f64::INFINITY,
    }
}

/// Depth below the free surface of a body, m, and the unit normal there, of `x` in packed
/// coordinates.
fn under(problem: &Problem, body: &Body, x: [f64; 3]) -> (f64, [f64; 3]) {
    let z = depth(problem, body, x);
    let step = 1e-3 * problem.spacing;
    let slope = [0, 1, 2].map(|a| {
        let mut beside = x;
        beside[a] += step;
        z - depth(problem, body, beside)
    });
    let size = slope.iter().map(|s| s * s).sum::<f64>().sqrt();
    (z, slope.map(|s| s / size.max(f64::MIN_POSITIVE)))
}

/// Depth of `x`, in packed coordinates, below the free surface of its body, m.
fn depth(problem: &Problem, body: &Body, x: [f64; 3]) -> f64 {
    match &body.shape {
        Shape::Sphere { radius, .. } => radius - x.iter().map(|x| x * x).sum::<f64>().sqrt(),
        Shape::Ellipsoid { semi_axes, .. } => {
            let axes = semi_axes.iter().zip(x).filter(|(a, _)| **a > 0.0);
            let (ratio, r) =
                axes.fold((0.0, 0.0), |s, (a, x)| (s.0 + (x / a).powi(2), s.1 + x * x));
            let ratio: f64 = ratio;
            f64::sqrt(r) * (1.0 / ratio.sqrt().max(1e-9) - 1.0)
        }
        Shape::Layer { depth } => depth - x[2],
        Shape::Block { low, high } => (0..3)
            .flat_map(|a| [(a, 0, x[a] - low[a]), (a, 1, high[a] - x[a])])
            .filter(|(a, side, _)| is_free(problem, *a, *side, [low, high][*side][*a]))
            .fold(f64::INFINITY, |least, (_, _, d)| least.min(d)),
    }
}

/// Whether the face of a block at `at` on `axis` is a free surface.
fn is_free(problem: &Problem, axis: usize, side: usize, at: f64) -> bool {
    if axis == 1 && problem.dimension == Dimension::Two {
        return false;
    }
    let edge = [0.0, problem.domain.size[axis]][side];
    let apart = (at - edge).abs() > 0.5 * problem.spacing;
    apart || problem.domain.boundary[axis][side] == Side::Open
}

/// Free surface of a body at rest, shrunk by `depth` m, m^2 (m in 2-D): without what touches walls
/// or periodic sides, and inside mirror planes.
fn free_area(problem: &Problem, body: &Body, depth: f64) -> f64 {
    let two = problem.dimension == Dimension::Two;
    let size = problem.domain.size;
    let shrunk = |x: &f64| (x - depth).max(0.0);
    let cuts = body.shape.cuts(&problem.domain);
    let part = 0.5f64.powi(cuts.iter().flatten().count() as i32);
    match &body.shape {
        Shape::Sphere { radius, .. } if two => part * 2.0 * PI * shrunk(radius),
        Shape::Sphere { radius, .. } => part * 4.0 * PI * shrunk(radius).powi(2),
        Shape::Ellipsoid {
            semi_axes: [a, _, c],
            ..
        } if two => part * ellipse(shrunk(a), shrunk(c)),
        Shape::Ellipsoid { semi_axes, .. } => part * ellipsoid(semi_axes.map(|a| shrunk(&a))),
        Shape::Layer { .. } if two => size[0],
        Shape::Layer { .. } => size[0] * size[1],
        Shape::Block { low, high } => {
            let axes = (0..3).filter(|a| !(two && *a == 1));
            let free = |a: usize| {
                let sides = [
                    is_free(problem, a, 0, low[a]),
                    is_free(problem, a, 1, high[a]),
                ];
                sides.map(f64::from)
            };
            let extent = |a: usize| high[a] - low[a] - depth * free(a).iter().sum::<f64>();
            let face = |axis: usize| -> f64 {
                let across = axes.clone().filter(|a| *a != axis);
                free(axis).iter().sum::<f64>() * across.map(extent).product::<f64>()
            };
            axes.clone().map(face).sum()
        }
    }
}

/// Knud Thomsen's approximation of an ellipsoid's area: within 1.1 %.
fn ellipsoid([a, b, c]: [f64; 3]) -> f64 {
    let p = 1.6075;
    let mean = ((a * b).powf(p) + (a * c).powf(p) + (b * c).powf(p)) / 3.0;
    4.0 * PI * mean.powf(1.0 / p)
}

/// Ramanujan's second approximation of an ellipse's circumference.
fn ellipse(a: f64, b: f64) -> f64 {
    let h = ((a - b) / (a + b)).powi(2);
    PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()))
}
