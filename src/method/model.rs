//! Constants of a weakly compressible run, derived once from the scene.

use super::Phase;
use crate::scene::{
    Body, Density, Dimension, Domain, Effects, Mass, Method, Motion, Scene, Shape, Side, Wcsph,
};

/// Sound speed of the relax phase in units of its own reference speed: density then varies by 0.1 %
/// where Mach 0.1 allows 1 %, so that the packed spacing survives.
const RELAX_STIFFNESS: f64 = 31.6;

/// Derived constants, SI.
#[derive(Clone, Debug)]
pub struct Model {
    pub settings: Wcsph,
    pub dimension: Dimension,
    pub domain: Domain,
    pub effects: Effects,
    /// s0, h, m.
    pub spacing: f64,
    pub h: f64,
    /// rho0, kg/m^3.
    pub density: f64,
    /// c, m/s.
    pub sound_speed: f64,
    /// V of Nishio Eq. 8, m/s.
    pub reference_speed: f64,
    /// Damping rate, 1/s; 0 in the impact.
    pub damping: f64,
}

/// Whether the body rests on a wall and so feels gravity while it relaxes.
pub fn rests(body: &Body) -> bool {
    matches!(body.shape, Shape::Layer { .. } | Shape::Block { .. })
}

/// The box in which a body relaxes: the scene's for one that rests, else an open one around it.
pub fn resting_domain(scene: &Scene, body: &Body) -> Domain {
    let extent = match &body.shape {
        Shape::Sphere { radius, .. } => [*radius; 3],
        Shape::Ellipsoid { semi_axes, .. } => *semi_axes,
        _ => return scene.domain.clone(),
    };
    let mut size = extent.map(|r| 4.0 * r + 8.0 * scene.pack.spacing);
    let mut boundary = [[Side::Open; 2]; 3];
    if scene.dimension == Dimension::Two {
        size[1] = 0.0;
        boundary[1] = [Side::Periodic; 2];
    }
    Domain {
        size,
        boundary,
        wall_velocity: Default::default(),
    }
}

impl Model {
    pub fn new(scene: &Scene, phase: Phase, body: Option<usize>) -> Self {
        let Method::Wcsph(settings) = &scene.method;
        let mut effects = scene.effects.clone();
        let mut domain = scene.domain.clone();
        let (mut damping, mut body_speed) = (0.0, None);
        if let Phase::Relax { damping: rate } = phase {
            let body = &scene.bodies[body.expect("a body relaxes alone")];
            damping = rate;
            domain = resting_domain(scene, body);
            if !rests(body) {
                effects.gravity = None;
            }
            body_speed = Some(body_reference(scene, body, &effects));
        }
        let (reference, stiffness) = match body_speed {
            Some(speed) => (speed, RELAX_STIFFNESS),
            None => (reference_speed(scene), settings.sound_speed_factor),
        };
        Model {
            settings: settings.clone(),
            dimension: scene.dimension,
            domain,
            effects,
            spacing: scene.pack.spacing,
            h: settings.smoothing * scene.pack.spacing,
            density: scene.density,
            sound_speed: stiffness * reference,
            reference_speed: reference,
            damping,
        }
    }

    /// P(rho), Pa (Nishio Eqs. 7-8), before clipping.
    #[inline(always)]
    pub fn pressure(&self, density: f64) -> f64 {
        let e = density / self.density;
        let p = if self.settings.exponent == 1.0 {
            e - 1.0
        } else {
            (e.powi(self.settings.exponent as i32) - 1.0) / self.settings.exponent
        };
        let p = self.density * self.sound_speed * self.sound_speed * p;
        match self.settings.pressure {
            crate::scene::Pressure::Clipped => p.max(0.0),
            crate::scene::Pressure::Signed => p,
        }
    }

    /// rho(P), kg/m^3: the inverse of the unclipped equation of state.
    pub fn density_at(&self, pressure: f64) -> f64 {
        let p = pressure / (self.density * self.sound_speed * self.sound_speed);
        let chi = self.settings.exponent;
        if chi == 1.0 {
            return self.density * (1.0 + p);
        }
        self.density * (1.0 + chi * p).max(1e-6).powf(1.0 / chi)
    }

    /// Whether density follows the continuity equation, and its diffusion.
    pub fn diffusion(&self) -> Option<f64> {
        match self.settings.density {
            Density::Continuity { diffusion } => Some(diffusion),
            Density::Summation => None,
        }
    }
}

/// Mass of a particle, kg (kg/m in 2-D).
pub fn mass(scene: &Scene) -> f64 {
    let Method::Wcsph(s) = &scene.method;
    let d = scene.dimension.count();
    let s0 = scene.pack.spacing;
    let nominal = scene.density * s0.powi(d as i32);
    match s.mass {
        Mass::Nominal => nominal,
        Mass::LatticeSum => nominal / crate::kernel::lattice_sum(s.kernel, d, s0, s.smoothing * s0),
    }
}

/// Radius that sets the capillary pressure of a body, if it is round; else its height, m.
fn size(body: &Body) -> (Option<f64>, f64) {
    match &body.shape {
        Shape::Sphere { radius, .. } => (Some(*radius), 2.0 * radius),
        Shape::Ellipsoid { semi_axes: a, .. } => {
            let least = a
                .iter()
                .copied()
                .filter(|r| *r > 0.0)
                .fold(f64::INFINITY, f64::min);
            (Some(least), 2.0 * a[2])
        }
        Shape::Block { low, high } => (None, high[2] - low[2]),
        Shape::Layer { depth } => (None, *depth),
    }
}

/// sqrt(2 g T) and sqrt(2 sigma / (rho R)) of one body, m/s; never below a capillary speed of the
/// spacing, so that a body without any force still has a sound speed.
fn body_reference(scene: &Scene, body: &Body, effects: &Effects) -> f64 {
    let (radius, height) = size(body);
    let mut v: f64 = 0.0;
    if let Some(g) = effects.gravity {
        let g = g.iter().map(|g| g * g).sum::<f64>().sqrt();
        v = v.max((2.0 * g * height).sqrt());
    }
    if let Some(sigma) = effects.tension {
        let r = radius.unwrap_or(height);
        v = v.max((2.0 * sigma / (scene.density * r)).sqrt());
    }
    if v == 0.0 { 0.1 } else { v }
}

/// V of Nishio Eq. 8 for the impact, m/s.
pub fn reference_speed(scene: &Scene) -> f64 {
    let Method::Wcsph(s) = &scene.method;
    if let Some(speed) = s.reference_speed {
        return speed;
    }
    let mut v: f64 = 0.0;
    for body in &scene.bodies {
        v = v.max(motion_speed(body));
        v = v.max(body_reference(scene, body, &scene.effects));
    }
    v
}

/// Largest speed that a body's motion gives, m/s.
fn motion_speed(body: &Body) -> f64 {
    match body.motion {
        Motion::Uniform(v) => v.iter().map(|v| v * v).sum::<f64>().sqrt(),
        Motion::TaylorGreen { speed } => speed,
        Motion::Stretch { rate } => {
            let (radius, height) = size(body);
            rate.abs() * radius.unwrap_or(0.5 * height)
        }
    }
}
