//! What a ray sees.

use super::Material;
use super::optics::{INDEX, reflect, refract};
use super::studio::{Light, Studio};
use super::trace::{Hit, Tracer, V};

/// Surfaces that a ray may meet.
const DEEPEST: usize = 7;
/// Weight below which a ray is not followed.
const FAINTEST: f32 = 0.02;

pub struct Shader<'a> {
    pub tracer: &'a Tracer<'a>,
    pub studio: &'a Studio,
    pub material: Material,
}

/// A ray to be followed.
struct Ray {
    from: V,
    along: V,
    weight: Light,
    is_inside: bool,
    depth: usize,
}

impl Shader<'_> {
    /// Light along a ray of the camera.
    pub fn seen(&self, from: &V, along: &V, sample: u32) -> Light {
        match self.material.absorption() {
            Some(absorption) => self.clear(from, along, absorption),
            None => self.opaque(from, along, sample),
        }
    }

    fn clear(&self, from: &V, along: &V, absorption: V) -> Light {
        let mut light = Light::zeros();
        let mut rays = vec![Ray {
            from: *from,
            along: *along,
            weight: Light::repeat(1.0),
            is_inside: false,
            depth: 0,
        }];
        while let Some(mut ray) = rays.pop() {
            if ray.weight.max() < FAINTEST || ray.depth > DEEPEST {
                // What is left is as bright as the sky above.
                light += self.studio.sky(&V::z()).component_mul(&ray.weight) * 0.6;
                continue;
            }
            let Some(hit) = self.tracer.hit(&ray.from, &ray.along, ray.is_inside) else {
                light += self.beyond(&ray).component_mul(&ray.weight);
                continue;
            };
            if ray.is_inside {
                let part = (-absorption * hit.distance).map(f32::exp);
                ray.weight.component_mul_assign(&part);
                if self.is_floor(&hit) {
                    let lit = self.studio.floor_light(&hit.at, &ray.along);
                    light += lit.component_mul(&ray.weight);
                    continue;
                }
            }
            self.split(&ray, &hit, &mut rays);
        }
        light
    }

    fn is_floor(&self, hit: &Hit) -> bool {
        let above = self.studio.floor.map(|floor| hit.at.z - floor);
        hit.is_side && above.is_some_and(|above| above < self.tracer.offset())
    }

    /// The reflected and the refracted ray.
    fn split(&self, ray: &Ray, hit: &Hit, rays: &mut Vec<Ray>) {
        let (mut normal, ratio) = match ray.is_inside {
            true => (-hit.normal, INDEX),
            false => (hit.normal, 1.0 / INDEX),
        };
        // A smooth normal may point away from a ray that grazes the surface.
        let facing = ray.along.dot(&normal);
        if facing > -0.02 {
            normal = (normal - ray.along * (facing + 0.02)).normalize();
        }
        let next = |along: V, part: f32, is_inside: bool| Ray {
            from: hit.at,
            along,
            weight: ray.weight * part,
            is_inside,
            depth: ray.depth + 1,
        };
        let mirrored = reflect(&ray.along, &normal);
        match refract(&ray.along, &normal, ratio) {
            Some((along, part)) => {
                rays.push(next(mirrored, part, ray.is_inside));
                rays.push(next(along, 1.0 - part, !ray.is_inside));
            }
            None => rays.push(next(mirrored, 1.0, ray.is_inside)),
        }
    }

    /// What is behind the liquid.
    fn beyond(&self, ray: &Ray) -> Light {
        if let Some(floor) = self.studio.floor.filter(|_| ray.along.z < 0.0) {
            let distance = (floor - ray.from.z) / ray.along.z;
            if distance > 0.0 {
                return self
                    .studio
                    .floor_light(&(ray.from + ray.along * distance), &ray.along);
            }
        }
        match ray.depth {
            0 => self.studio.backdrop(&ray.along),
            _ => self.studio.sky(&ray.along),
        }
    }

    fn opaque(&self, from: &V, along: &V, sample: u32) -> Light {
        let ray = Ray {
            from: *from,
            along: *along,
            weight: Light::repeat(1.0),
            is_inside: false,
            depth: 0,
        };
        let Some(hit) = self.tracer.hit(from, along, false) else {
            return self.beyond(&ray);
        };
        let normal = hit.normal;
        let is_milk = self.material == Material::Milk;
        let facing = self.facing(&normal);
        let start = hit.at + normal * (4.0 * self.tracer.offset());
        // What faces away from the lamp has none of its light in any case.
        let lamp = self.studio.lamp(sample);
        let is_dark = facing > 0.0 && self.tracer.is_hit(&start, &lamp);
        let lit = match is_dark {
            true if is_milk => 0.25,
            true => 0.0,
            false => 1.0,
        };
        let diffuse = self.matte(&hit, lit, self.openness(&hit.at, &normal));
        let cos = (-along.dot(&normal)).clamp(0.0, 1.0);
        let part = 0.02 + 0.98 * (1.0 - cos).powi(5);
        let mirrored = reflect(along, &normal);
        let seen = match self.tracer.hit(&start, &mirrored, false) {
            Some(other) => self.matte(&other, 1.0, 1.0),
            None => {
                let away = Ray {
                    from: start,
                    along: mirrored,
                    weight: ray.weight,
                    is_inside: false,
                    depth: 1,
                };
                self.beyond(&away)
            }
        };
        diffuse * (1.0 - part) + seen * part
    }

    /// How far a surface with this normal faces the lamp.
    fn facing(&self, normal: &V) -> f32 {
        let wrap = match self.material {
            Material::Milk => 0.35,
            _ => 0.1,
        };
        ((normal.dot(&self.studio.key) + wrap) / (1.0 + wrap)).max(0.0)
    }

    /// Light of an opaque surface without what it mirrors; `lit`, `open`: parts of the light of
    /// the lamp and of the surroundings that reach it.
    fn matte(&self, hit: &Hit, lit: f32, open: f32) -> Light {
        let albedo = match self.material {
            Material::Milk => Light::new(0.93, 0.91, 0.87),
            _ => Light::from(self.tracer.colour(&hit.at)),
        };
        let ambient = 0.36 + 0.10 * hit.normal.z;
        albedo * (0.72 * self.facing(&hit.normal) * lit + ambient * open)
    }

    /// Part of the surroundings that is not hidden by liquid: from the field along the normal.
    fn openness(&self, at: &V, normal: &V) -> f32 {
        let mut hidden = 0.0;
        let reach = 20.0 * self.tracer.offset();
        for n in 1..=6 {
            let d = reach * 1.6f32.powi(n);
            let p = at + normal * d;
            if self.tracer.is_within(&p) {
                hidden += self.tracer.value(&p).min(1.0) * 0.6f32.powi(n);
            }
        }
        (1.0 - 0.9 * hidden).max(0.15)
    }
}
