//! Two dimensions: the section itself, filled.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::trace::V;
use super::{Material, encoded, linear};
use crate::draw::canvas::{Canvas, Colour};
use crate::draw::surface::{Field, LEVEL};

/// A picture of a part of the plane.
pub struct Sheet {
    /// Position of its upper left corner, x and z, m.
    pub corner: [f64; 2],
    /// Size of a pixel, m.
    pub pixel: f64,
    /// Width and height, pixels.
    pub size: [usize; 2],
}

impl Sheet {
    /// Shows a rectangle as a whole.
    pub fn fitted([low, high]: [V; 2], zoom: f32, size: [usize; 2]) -> Sheet {
        let [width, height] = size.map(|s| s as f64);
        let [x, z] = [0, 2].map(|a| f64::from(high[a] - low[a]));
        let middle = [0, 2].map(|a| 0.5 * f64::from(high[a] + low[a]));
        let pixel = 1.08 * (x / width).max(z / height) / f64::from(zoom);
        Sheet {
            corner: [
                middle[0] - 0.5 * width * pixel,
                middle[1] + 0.5 * height * pixel,
            ],
            pixel,
            size,
        }
    }

    /// Draws the liquid of a plane field, its edge antialiased and darker.
    pub fn draw(&self, field: Option<&Field>, material: Material, background: Colour) -> Canvas {
        let [width, height] = self.size;
        let rows: Vec<Vec<Colour>> = (0..height)
            .into_par_iter()
            .map(|row| {
                let at = |column: usize| {
                    let x = self.corner[0] + (column as f64 + 0.5) * self.pixel;
                    let z = self.corner[1] - (row as f64 + 0.5) * self.pixel;
                    Vector3::new(x as f32, 0.0, z as f32)
                };
                let colour = |column: usize| self.colour(field, material, background, at(column));
                (0..width).map(colour).collect()
            })
            .collect();
        Canvas::from_rows(&rows)
    }

    fn colour(
        &self,
        field: Option<&Field>,
        material: Material,
        background: Colour,
        at: V,
    ) -> Colour {
        let pixel = self.pixel as f32;
        let found = field.and_then(|field| Some((field, values(field, &at)?)));
        let Some((field, [value, right, up])) = found else {
            return background;
        };
        let slope = right.hypot(up).max(1e-9);
        // Distance to the edge, pixels, positive inside.
        let depth = (value - LEVEL) / slope / pixel;
        let own = match material {
            Material::Water => V::new(0.16, 0.42, 0.72),
            Material::Milk => V::new(0.93, 0.91, 0.87),
            _ => colour(field, &at),
        };
        let edge = (1.0 - (depth - 1.5).abs() / 1.5).clamp(0.0, 1.0);
        let part = (depth + 0.5).clamp(0.0, 1.0);
        if part == 0.0 {
            return background;
        }
        encoded(&(linear(background) * (1.0 - part) + own * (1.0 - 0.55 * edge) * part))
    }
}

/// Cell and place in it.
fn place(field: &Field, at: &V) -> Option<([usize; 2], [f32; 2])> {
    let place = [0, 2].map(|a| (at[a] - field.low[a]) / field.step[a]);
    let last = [0, 2].map(|a| (field.count[a] - 1) as f32);
    if (0..2).any(|a| !(place[a] >= 0.0 && place[a] <= last[a]) || last[a] < 1.0) {
        return None;
    }
    let cell = [0, 1].map(|a| (place[a] as usize).min(last[a] as usize - 1));
    Some((cell, [0, 1].map(|a| place[a] - cell[a] as f32)))
}

/// phi and its slopes along x and z, 1/m; `None` outside the grid.
fn values(field: &Field, at: &V) -> Option<[f32; 3]> {
    let ([i, k], [x, z]) = place(field, at)?;
    let get = |i: usize, k: usize| field.values[field.index([i, 0, k])];
    let [a, b, c, d] = [get(i, k), get(i + 1, k), get(i, k + 1), get(i + 1, k + 1)];
    let value = (a + x * (b - a)) * (1.0 - z) + (c + x * (d - c)) * z;
    let right = ((b - a) * (1.0 - z) + (d - c) * z) / field.step.x;
    let up = ((c - a) * (1.0 - x) + (d - b) * x) / field.step.z;
    Some([value, right, up])
}

/// Colour of the nearest node.
fn colour(field: &Field, at: &V) -> V {
    let Some(([i, k], [x, z])) = place(field, at) else {
        return V::repeat(0.5);
    };
    let node = [i + (x > 0.5) as usize, 0, k + (z > 0.5) as usize];
    let found = field.colours.get(field.index(node));
    V::from(found.copied().unwrap_or([0.5; 3]))
}
