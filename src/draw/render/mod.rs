//! Pictures of the liquid surface: rays of light through the field of [`super::surface`].

pub mod artist;
pub mod camera;
mod flat;
mod floor;
mod optics;
mod overlay;
mod shade;
mod studio;
pub mod trace;
mod walk;

use rayon::prelude::*;

use self::camera::Camera;
use self::shade::Shader;
use self::studio::Studio;
use self::trace::{Tracer, V};
use super::canvas::{Canvas, Colour};
use super::surface::Field;

/// What the liquid is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Clear: Fresnel, refraction, and absorption that leaves the blue.
    Water,
    /// White and opaque, with a gloss.
    Milk,
    /// Opaque, with the colours of the bodies.
    Body,
    /// Opaque, coloured by speed.
    Speed,
    /// Opaque, coloured by pressure.
    Pressure,
}

impl Material {
    /// Absorption of red, green and blue, 1/m, times the size of the scene; `None`: opaque.
    pub(crate) fn absorption(&self) -> Option<V> {
        (*self == Material::Water).then(|| V::new(75.0, 27.0, 11.0))
    }
}

/// Look of a picture.
#[derive(Clone, Debug)]
pub struct Look {
    /// Of the liquid.
    pub material: Material,
    /// Behind it, and of the floor.
    pub background: Colour,
    /// Rays a pixel along each side.
    pub samples: usize,
    /// Height of the floor, m, if there is one.
    pub floor: Option<f32>,
    /// Whether light and shadow fall on the floor.
    pub has_shadows: bool,
}

/// Linear light of an sRGB colour.
pub fn linear(colour: Colour) -> V {
    V::from(colour.map(|c| (f32::from(c) / 255.0).powf(2.2)))
}

/// The sRGB colour of linear light; brighter than white is compressed.
pub fn encoded(light: &V) -> Colour {
    let shoulder = |x: f32| {
        if x < 0.7 {
            x
        } else {
            1.0 - 0.3 * (-(x - 0.7) / 0.3).exp()
        }
    };
    let byte = |c: f32| (255.0 * shoulder(c.max(0.0)).powf(1.0 / 2.2) + 0.5) as u8;
    [byte(light.x), byte(light.y), byte(light.z)]
}

/// Draws the surface; without one, the surroundings.
pub fn draw(field: Option<&Field>, camera: &Camera, look: &Look) -> Canvas {
    let empty = Field::nothing();
    let tracer = Tracer::new(field.unwrap_or(&empty));
    let studio = Studio::new(&tracer, look);
    let shader = Shader {
        tracer: &tracer,
        studio: &studio,
        material: look.material,
    };
    let [width, height] = camera.size;
    let rows: Vec<Vec<Colour>> = (0..height)
        .into_par_iter()
        .map(|row| {
            let light = |column: usize| pixel(&shader, camera, look.samples, [column, row]);
            (0..width).map(|column| encoded(&light(column))).collect()
        })
        .collect();
    Canvas::from_rows(&rows)
}

fn pixel(shader: &Shader, camera: &Camera, samples: usize, at: [usize; 2]) -> V {
    let mut sum = V::zeros();
    for i in 0..samples {
        for j in 0..samples {
            // Rows of samples are displaced against each other.
            let x = (i as f32 + (j as f32 + 0.5) / samples as f32) / samples as f32;
            let y = (j as f32 + (i as f32 + 0.5) / samples as f32) / samples as f32;
            let place = [at[0] as f32 + x, at[1] as f32 + y];
            let (from, along) = camera.ray(place);
            // A single glint must not outshine its pixel.
            sum += shader
                .seen(&from, &along, (i * samples + j) as u32)
                .map(|c| c.min(3.0));
        }
    }
    sum / (samples * samples) as f32
}
