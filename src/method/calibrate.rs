//! Strength of the tension from the virial identity: no dynamics, one evaluation a body.
//!
//! (1) sigma A_s = -(W_t / (d - 1) - W_n), W_t and W_n the tangential and normal parts of the pair
//! virial (Kirkwood & Buff 1949): an isotropic pressure does not enter, and pairs need no origin,
//! so it holds for a closed drop and for a periodic layer.
//!
//! The liquid is one-sided, so the stress acts at a mean depth z_s below its surface (about
//! 0.65 H), and A_s is the area of that surface of tension (Gibbs): the area of the body shrunk by
//! (2) z_s = SUM w_a depth_a / SUM w_a, w_a the share of particle a in (1).
//! With the area of the body itself a drop of R = 20 s0 comes out with 16 % too much tension, and
//! a curved and a flat surface with different alpha. What is left is a Tolman length: the pressure
//! in a drop is off by O(z_s / R). Test: tests/validation/drop.rs.

use super::model::Case;
use super::{MethodError, Phase};
use crate::particle::{Particles, wall};
use crate::scene::{Body, Dimension, Scene, Shape, Side};
use std::f64::consts::PI;

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// alpha.
    pub strength: f64,
    /// Per body: name, area (length in 2-D) of its surface of tension, and sigma_eff / sigma at
    /// alpha = 1.
    pub bodies: Vec<(String, f64, f64)>,
}

/// Calibrates on packed or relaxed `bodies`, as the pack stage leaves them: weighted by area.
pub fn calibrate(scene: &Scene, bodies: &[Particles]) -> Result<Calibration, MethodError> {
    let mut measured = Vec::new();
    let (mut area, mut virial) = (0.0, 0.0);
    for particles in bodies {
        let index = particles.body.first().copied().ok_or(MethodError::Empty)? as usize;
        let body = &scene.bodies[index];
        if free_area(scene, body, 0.0) <= 0.0 {
            continue;
        }
        let (v, depth) = virial_of(scene, index, particles)?;
        let a = free_area(scene, body, depth);
        measured.push((body.name.clone(), a, v / a));
        area += a;
        virial += v;
    }
    if virial <= 0.0 {
        let body = scene
            .bodies
            .first()
            .map_or(String::new(), |b| b.name.clone());
        return Err(MethodError::NoSurface { body });
    }
    Ok(Calibration {
        strength: area / virial,
        bodies: measured,
    })
}

/// (1) over sigma at alpha = 1, and (2), m.
fn virial_of(
    scene: &Scene,
    index: usize,
    particles: &Particles,
) -> Result<(f64, f64), MethodError> {
    let case = Case::new(scene, Phase::Relax { damping: 0.0 }, Some(index));
    let rests = super::model::rests(&scene.bodies[index]);
    let walls = if rests {
        wall::build(scene)
    } else {
        Default::default()
    };
    let state = super::start::resting(scene, particles);
    let mut flow = super::flow_of(&case, state.particles, walls)?;
    flow.sort();
    flow.find();
    let sigma = case.effects.tension.unwrap_or(1.0);
    let tension = super::tension_of(&case, 1.0);
    let Some(mut tension) = tension else {
        return Ok((0.0, 0.0));
    };
    let sources = flow.sources();
    let surface = super::surface_of(&flow, &sources);
    // Every particle may be at the surface: no flags are needed for one evaluation.
    tension.update(&surface, |_| true);
    let origin = super::start::home(scene, index);
    let body = &scene.bodies[index];
    let depth = |i: usize| {
        let x = flow.position(i);
        depth(scene, body, [0, 1, 2].map(|a| x[a] - origin[a]))
    };
    let whole = tension.virial(&surface);
    let moment = tension.virial_moment(&surface, depth);
    let mean = if whole == 0.0 { 0.0 } else { moment / whole };
    Ok((whole / sigma, mean))
}

/// Depth of `x`, in packed coordinates, below the free surface of its body, m.
fn depth(scene: &Scene, body: &Body, x: [f64; 3]) -> f64 {
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
            .filter(|(a, side, _)| is_free(scene, *a, *side, [low, high][*side][*a]))
            .fold(f64::INFINITY, |least, (_, _, d)| least.min(d)),
    }
}

/// Whether the face of a block at `at` on `axis` is a free surface.
fn is_free(scene: &Scene, axis: usize, side: usize, at: f64) -> bool {
    if axis == 1 && scene.dimension == Dimension::Two {
        return false;
    }
    let edge = [0.0, scene.domain.size[axis]][side];
    let apart = (at - edge).abs() > 0.5 * scene.pack.spacing;
    apart || scene.domain.boundary[axis][side] == Side::Open
}

/// Free surface of a body at rest, shrunk by `depth` m, m^2 (m in 2-D): without what touches walls
/// or periodic sides.
fn free_area(scene: &Scene, body: &Body, depth: f64) -> f64 {
    let two = scene.dimension == Dimension::Two;
    let size = scene.domain.size;
    let shrunk = |x: &f64| (x - depth).max(0.0);
    match &body.shape {
        Shape::Sphere { radius, .. } if two => 2.0 * PI * shrunk(radius),
        Shape::Sphere { radius, .. } => 4.0 * PI * shrunk(radius).powi(2),
        Shape::Ellipsoid {
            semi_axes: [a, _, c],
            ..
        } if two => ellipse(shrunk(a), shrunk(c)),
        Shape::Ellipsoid { semi_axes, .. } => {
            let [a, b, c] = semi_axes.map(|a| shrunk(&a));
            // Knud Thomsen's approximation: within 1.1 %.
            let p = 1.6075;
            let mean = ((a * b).powf(p) + (a * c).powf(p) + (b * c).powf(p)) / 3.0;
            4.0 * PI * mean.powf(1.0 / p)
        }
        Shape::Layer { .. } if two => size[0],
        Shape::Layer { .. } => size[0] * size[1],
        Shape::Block { low, high } => {
            let axes = (0..3).filter(|a| !(two && *a == 1));
            let free = |a: usize| {
                let sides = [is_free(scene, a, 0, low[a]), is_free(scene, a, 1, high[a])];
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

/// Ramanujan's second approximation of an ellipse's circumference.
fn ellipse(a: f64, b: f64) -> f64 {
    let h = ((a - b) / (a + b)).powi(2);
    PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()))
}
