//! Strength of the tension from the virial identity: no dynamics, one evaluation a body.
//!
//! sigma A = -(W_t / (d - 1) - W_n), W_t and W_n the tangential and normal parts of the pair virial
//! (Kirkwood & Buff 1949): an isotropic pressure does not enter, and pairs need no origin, so it
//! holds for a closed drop and for a periodic layer.

use super::model::Model;
use super::{MethodError, Phase};
use crate::effect::select;
use crate::particle::{Particles, wall};
use crate::scene::{Body, Dimension, Scene, Shape, Side};
use std::f64::consts::PI;

/// Result of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// alpha.
    pub strength: f64,
    /// Per body: name, area (length in 2-D), and sigma_eff / sigma at alpha = 1.
    pub bodies: Vec<(String, f64, f64)>,
}

/// Calibrates on packed or relaxed `bodies`, as the pack stage leaves them: weighted by area.
pub fn calibrate(scene: &Scene, bodies: &[Particles]) -> Result<Calibration, MethodError> {
    let mut measured = Vec::new();
    let (mut area, mut virial) = (0.0, 0.0);
    for particles in bodies {
        let index = particles.body.first().copied().ok_or(MethodError::Empty)? as usize;
        let body = &scene.bodies[index];
        let a = free_area(scene, body);
        if a <= 0.0 {
            continue;
        }
        let v = virial_of(scene, index, particles)?;
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

/// sigma_eff A / sigma at alpha = 1.
fn virial_of(scene: &Scene, index: usize, particles: &Particles) -> Result<f64, MethodError> {
    let model = Model::new(scene, Phase::Relax { damping: 0.0 }, Some(index));
    let rests = super::model::rests(&scene.bodies[index]);
    let walls = if rests {
        wall::build(scene)
    } else {
        Default::default()
    };
    let state = super::start::resting(scene, particles);
    let mut flow = super::flow_of(&model, state.particles, walls)?;
    flow.sort();
    flow.find();
    let d = model.dimension.count();
    let sigma = model.effects.tension.unwrap_or(1.0);
    let tension = select::tension(
        &model.effects,
        &model.settings,
        d,
        model.h,
        model.density,
        1.0,
    );
    let Some(mut tension) = tension else {
        return Ok(0.0);
    };
    let mut records = std::mem::take(&mut flow.records);
    // Every particle may be at the surface: no flags are needed for one evaluation.
    tension.update(&super::surface_of(&flow), &mut records, &|_| true);
    Ok(tension.virial(&super::surface_of(&flow), &records) / sigma)
}

/// Free surface of a body at rest, m^2 (m in 2-D): without what touches walls or periodic sides.
fn free_area(scene: &Scene, body: &Body) -> f64 {
    let two = scene.dimension == Dimension::Two;
    let size = scene.domain.size;
    match &body.shape {
        Shape::Sphere { radius, .. } if two => 2.0 * PI * radius,
        Shape::Sphere { radius, .. } => 4.0 * PI * radius * radius,
        Shape::Ellipsoid { semi_axes, .. } if two => ellipse(semi_axes[0], semi_axes[2]),
        Shape::Ellipsoid {
            semi_axes: [a, b, c],
            ..
        } => {
            // Knud Thomsen's approximation: within 1.1 %.
            let p = 1.6075;
            let mean = ((a * b).powf(p) + (a * c).powf(p) + (b * c).powf(p)) / 3.0;
            4.0 * PI * mean.powf(1.0 / p)
        }
        Shape::Layer { .. } if two => size[0],
        Shape::Layer { .. } => size[0] * size[1],
        Shape::Block { low, high } => {
            let extent: [f64; 3] = std::array::from_fn(|a| high[a] - low[a]);
            let mut area = 0.0;
            for axis in (0..3).filter(|a| !(two && *a == 1)) {
                let face: f64 = (0..3)
                    .filter(|a| *a != axis && !(two && *a == 1))
                    .map(|a| extent[a])
                    .product();
                let sides = scene.domain.boundary[axis];
                let tolerance = 0.5 * scene.pack.spacing;
                let free = |at: f64, edge: f64, side: Side| {
                    (at - edge).abs() > tolerance || side == Side::Open
                };
                area += face * f64::from(free(low[axis], 0.0, sides[0]));
                area += face * f64::from(free(high[axis], size[axis], sides[1]));
            }
            area
        }
    }
}

/// Ramanujan's second approximation of an ellipse's circumference.
fn ellipse(a: f64, b: f64) -> f64 {
    let h = ((a - b) / (a + b)).powi(2);
    PI * (a + b) * (1.0 + 3.0 * h / (10.0 + (4.0 - 3.0 * h).sqrt()))
}
