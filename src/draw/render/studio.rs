//! The surroundings: a floor, a sky with soft lights, and the light that the floor receives.

use super::floor::Lit;
use super::trace::{Tracer, V};
use super::{Look, linear};
use crate::draw::smooth_step;

/// Linear red, green, blue.
pub type Light = V;

/// Lights, floor and background.
pub struct Studio {
    /// Unit vector to the key light.
    pub key: V,
    /// Colour of the background behind everything, linear.
    pub background: Light,
    /// Height of the floor, m, if there is one.
    pub floor: Option<f32>,
    /// Centre of the scene and its half width, m.
    centre: V,
    radius: f32,
    /// The key light on the floor.
    lit: Option<Lit>,
}

impl Studio {
    /// The studio about a liquid.
    pub fn new(tracer: &Tracer, look: &Look) -> Studio {
        let [low, high] = tracer.corners();
        let centre = 0.5 * (low + high);
        let radius = 0.5 * (high.x - low.x).max(high.y - low.y).max(high.z - low.z);
        let mut studio = Studio {
            key: V::new(-0.50, 0.42, 1.30).normalize(),
            background: linear(look.background),
            floor: look.floor,
            centre,
            radius,
            lit: None,
        };
        let floor = look.floor.filter(|_| look.has_shadows);
        studio.lit = floor.map(|floor| Lit::new(tracer, studio.key, floor, &look.material));
        studio
    }

    /// Unit vector to one of the points of the key light: a disc seen under some ten degrees.
    pub fn lamp(&self, sample: u32) -> V {
        // The golden angle spreads points evenly over a disc.
        let angle = 2.4 * sample as f32;
        let radius = 0.09 * ((sample % 9) as f32 / 9.0).sqrt();
        let turn = V::z().cross(&self.key).normalize();
        let over = self.key.cross(&turn);
        (self.key + turn * (radius * angle.cos()) + over * (radius * angle.sin())).normalize()
    }

    /// What a ray sees that meets neither liquid nor floor, as a mirror of the liquid shows it.
    pub fn sky(&self, along: &V) -> Light {
        let up = along.z;
        let low = Light::new(0.16, 0.20, 0.26);
        let high = Light::new(0.60, 0.70, 0.84);
        let mut light = low + (high - low) * smooth_step(-0.1, 0.9, up);
        // A soft box along the key light, a strip on the other side, and a weak one in front.
        let turn = V::z().cross(&self.key).normalize();
        let over = self.key.cross(&turn);
        let across = along.dot(&turn) / along.dot(&self.key).max(1e-3);
        let along_box = along.dot(&over) / along.dot(&self.key).max(1e-3);
        if along.dot(&self.key) > 0.0 {
            let inside =
                smooth_step(0.42, 0.30, across.abs()) * smooth_step(0.34, 0.24, along_box.abs());
            light += Light::repeat(5.0) * inside;
        }
        let strip = V::new(0.85, 0.15, 0.42).normalize();
        let near = along.dot(&strip);
        light += Light::new(1.5, 1.6, 1.75) * smooth_step(0.90, 0.97, near);
        light
    }

    /// What the camera sees behind everything, for a ray that goes up or meets the far floor.
    pub fn backdrop(&self, along: &V) -> Light {
        let shade = 1.0 - 0.35 * smooth_step(0.0, 0.7, along.z.abs());
        self.background * shade
    }

    /// Light from a point of the floor: it fades into the backdrop.
    pub fn floor_light(&self, at: &V, along: &V) -> Light {
        let d = ((at.x - self.centre.x).powi(2) + (at.y - self.centre.y).powi(2)).sqrt();
        let near = (-(d / (3.6 * self.radius)).powi(2)).exp();
        let back = self.backdrop(&V::new(along.x, along.y, 0.0));
        let received = self.lit.as_ref().map_or(1.0, |lit| lit.at(at));
        let lit = self.background * ((0.30 + 0.78 * received) * (0.87 + 0.13 * near));
        back + (lit - back) * smooth_step(0.02, 0.5, near)
    }
}
