//! Bird's-eye view: the particles as a lit surface.
//!
//! Every particle is a ball in a depth buffer; depth and colour are then smoothed over a spacing or
//! two without crossing edges (bilateral filter), so that the balls form a liquid surface, and lit
//! from the smoothed depth (screen-space fluid, van der Laan, Green & Sainz 2009).

use rayon::prelude::*;

use super::canvas::{Canvas, Colour};
use super::render::trace::{Tracer, V};
use super::section::body_colour;
use super::surface::Field;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene};

/// Position and direction of the view.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Point at the centre of the view, m.
    pub target: [f64; 3],
    /// Distance of the eye, m.
    pub distance: f64,
    /// Angle above the horizon, rad.
    pub elevation: f64,
    /// Angle about the vertical, rad.
    pub azimuth: f64,
    /// Width and height of the picture, pixels.
    pub size: [usize; 2],
    /// Width of the picture in units of the distance.
    pub aperture: f64,
}

/// A pixel that shows nothing.
const NOTHING: f32 = f32::INFINITY;

struct Buffer {
    width: usize,
    height: usize,
    /// Distance along the view, m.
    depth: Vec<f32>,
    colour: Vec<[f32; 3]>,
    /// Metres that a pixel covers at unit distance.
    pixel: f32,
}

impl Camera {
    /// View of the whole box, from the front and above; `level`: of the pool, m.
    pub fn whole(scene: &Scene, level: f64, size: [usize; 2]) -> Camera {
        let lateral = scene.domain.size;
        // A pool as deep as wide must fit.
        let across = lateral[0].max(lateral[1]).max(2.0 * level);
        Camera {
            target: [
                0.5 * lateral[0],
                0.5 * lateral[1],
                0.8 * level + 0.04 * across,
            ],
            distance: 3.2 * across,
            elevation: 0.56,
            azimuth: 0.42,
            size,
            aperture: 0.49,
        }
    }

    /// Unit vectors to the right, up and away.
    fn frame(&self) -> [[f64; 3]; 3] {
        let (se, ce) = self.elevation.sin_cos();
        let (sa, ca) = self.azimuth.sin_cos();
        [
            [ca, sa, 0.0],
            [-sa * se, ca * se, ce],
            [-sa * ce, ca * ce, -se],
        ]
    }
}

/// Draws a frame. In 2-D there is no such view: the caller shows the section alone.
pub fn draw(scene: &Scene, frame: &Frame, camera: &Camera) -> Canvas {
    debug_assert!(scene.dimension == Dimension::Three);
    let mut buffer = splat(scene, frame, camera);
    let spacing = scene.spacing as f32;
    for pass in 0..6 {
        // From wide and sparse to narrow and dense: the last passes remove the pattern of the
        // first.
        let part = [1.0, 0.5, 0.25][pass / 2];
        buffer = buffer.smoothed(spacing, part, pass % 2 == 0);
    }
    buffer.lit(spacing)
}

/// Draws the body of revolution of a frame of an axial scene: its surface, by a ray for each pixel.
pub fn draw_revolved(part: &Scene, frame: &Frame, camera: &Camera) -> Canvas {
    let colours = |body: &u8| body_colour(part, *body).map(f32::from);
    let colours: Vec<[f32; 3]> = frame.body.iter().map(colours).collect();
    let mut buffer = Buffer::empty(camera);
    if let Some(field) = Field::revolved(part, frame, &colours) {
        buffer.trace(&Tracer::new(&field), camera);
    }
    buffer.lit(part.spacing as f32)
}

fn splat(scene: &Scene, frame: &Frame, camera: &Camera) -> Buffer {
    let [width, height] = camera.size;
    let [right, up, away] = camera.frame();
    let pixel = camera.aperture / width as f64;
    let mut buffer = Buffer::empty(camera);
    let colours: Vec<[f32; 3]> = (0..=255)
        .map(|b| body_colour(scene, b).map(f32::from))
        .collect();
    let radius = 0.72 * scene.spacing;
    for i in 0..frame.id.len() {
        let d = [0, 1, 2].map(|a| f64::from(frame.position[a][i]) - camera.target[a]);
        let along = |v: [f64; 3]| d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
        let depth = camera.distance + along(away);
        if depth <= 2.0 * radius || !depth.is_finite() {
            continue;
        }
        let x = 0.5 * width as f64 + along(right) / (depth * pixel);
        let y = 0.5 * height as f64 - along(up) / (depth * pixel);
        let ball = [x, y, radius / (depth * pixel)].map(|c| c as f32);
        let colour = colours[usize::from(frame.body[i])];
        buffer.put(ball, depth as f32, radius as f32, colour);
    }
    buffer
}

impl Buffer {
    fn empty(camera: &Camera) -> Buffer {
        let [width, height] = camera.size;
        Buffer {
            width,
            height,
            depth: vec![NOTHING; width * height],
            colour: vec![[0.0; 3]; width * height],
            pixel: (camera.aperture / width as f64) as f32,
        }
    }

    /// What rays through the middle of the pixels meet.
    fn trace(&mut self, tracer: &Tracer, camera: &Camera) {
        let [right, up, away] = camera.frame().map(|v| V::from(v.map(|c| c as f32)));
        let target = V::from(camera.target.map(|c| c as f32));
        let eye = target - away * camera.distance as f32;
        let [width, height] = [self.width, self.height].map(|n| 0.5 * n as f32);
        let pixel = self.pixel;
        let depths = self.depth.par_chunks_mut(self.width);
        let rows = depths.zip(self.colour.par_chunks_mut(self.width));
        rows.enumerate().for_each(|(row, (depths, colours))| {
            for (column, place) in depths.iter_mut().zip(colours).enumerate() {
                let x = (column as f32 + 0.5 - width) * pixel;
                let y = (height - row as f32 - 0.5) * pixel;
                let along = (away + right * x + up * y).normalize();
                if let Some(hit) = tracer.hit(&eye, &along, false) {
                    *place.0 = hit.distance * along.dot(&away);
                    *place.1 = tracer.colour(&hit.at);
                }
            }
        });
    }

    /// A ball: centre and radius in pixels, distance and radius in m.
    fn put(&mut self, ball: [f32; 3], depth: f32, radius: f32, colour: [f32; 3]) {
        let [x, y, r] = ball;
        let columns = (x - r).max(0.0) as usize..((x + r).max(-1.0) + 1.0) as usize;
        for row in (y - r).max(0.0) as usize..(((y + r).max(-1.0) + 1.0) as usize).min(self.height)
        {
            for column in columns.start..columns.end.min(self.width) {
                let dx = (column as f32 + 0.5 - x) / r;
                let dy = (row as f32 + 0.5 - y) / r;
                let q = dx * dx + dy * dy;
                let place = row * self.width + column;
                let front = depth - radius * (1.0 - q.min(1.0)).sqrt();
                if q < 1.0 && front < self.depth[place] {
                    self.depth[place] = front;
                    self.colour[place] = colour;
                }
            }
        }
    }

    /// Bilateral means of depth and colour along rows or columns.
    fn smoothed(&self, spacing: f32, part: f32, along_row: bool) -> Buffer {
        let (width, height) = (self.width, self.height);
        let step = if along_row { 1 } else { width };
        let near = self.depth.iter().copied().fold(NOTHING, f32::min);
        let full = ((2.2 * spacing) / (near * self.pixel)).min(32.0);
        let reach = (part * full).max(8.0f32.min(full)).max(1.0);
        // Eight samples to each side, however wide the mean.
        let skip = (reach / 8.0).ceil() as usize;
        let samples = (reach / skip as f32).ceil() as usize;
        let weights: Vec<f32> = (0..=samples)
            .map(|n| 1.0 - (n as f32 / (samples as f32 + 1.0)).powi(2))
            .collect();
        let mut out = Buffer {
            depth: vec![NOTHING; width * height],
            colour: vec![[0.0; 3]; width * height],
            ..*self
        };
        let depths = out.depth.par_chunks_mut(width);
        let lines = depths.zip(out.colour.par_chunks_mut(width)).enumerate();
        lines.for_each(|(row, (depths, colours))| {
            for (column, pixel) in depths.iter_mut().zip(colours).enumerate() {
                let (at, end) = if along_row {
                    (column, width)
                } else {
                    (row, height)
                };
                let line = (at / skip, (end - 1 - at) / skip, step * skip);
                (*pixel.0, *pixel.1) = self.mean(row * width + column, line, spacing, &weights);
            }
        });
        out
    }

    /// Mean over a line of pixels: the numbers of samples before and after, and their distance.
    fn mean(
        &self,
        here: usize,
        (before, after, step): (usize, usize, usize),
        spacing: f32,
        weights: &[f32],
    ) -> (f32, [f32; 3]) {
        let centre = self.depth[here];
        if centre == NOTHING {
            return (NOTHING, [0.0; 3]);
        }
        let most = weights.len() - 1;
        let (mut weight, mut depth, mut colour) = (0.0, 0.0, [0.0; 3]);
        let (first, last) = (before.min(most), after.min(most));
        let scale = 1.0 / (3.0 * spacing);
        for n in 0..=first + last {
            let place = here + n * step - first * step;
            let away = (self.depth[place] - centre) * scale;
            let near = 1.0 - away * away;
            if near > 0.0 {
                let w = weights[n.abs_diff(first)] * near * near;
                weight += w;
                depth += w * self.depth[place];
                for (sum, c) in colour.iter_mut().zip(self.colour[place]) {
                    *sum += w * c;
                }
            }
        }
        (depth / weight, colour.map(|c| c / weight))
    }

    /// Lambert light from the upper left, a soft highlight, and darker hollows.
    fn lit(&self, spacing: f32) -> Canvas {
        let (width, height) = (self.width, self.height);
        let rows: Vec<Vec<Colour>> = (0..height)
            .into_par_iter()
            .map(|row| {
                let pixel = |column: usize| match self.depth[row * width + column] {
                    NOTHING => sky(row as f32 / height as f32),
                    _ => self.shaded(column, row, spacing),
                };
                (0..width).map(pixel).collect()
            })
            .collect();
        let mut canvas = Canvas::new(width, height, [0; 3]);
        for (row, colours) in rows.iter().enumerate() {
            for (column, colour) in colours.iter().enumerate() {
                canvas.set(column, row, *colour);
            }
        }
        canvas
    }

    fn shaded(&self, column: usize, row: usize, spacing: f32) -> Colour {
        let place = row * self.width + column;
        let depth = self.depth[place];
        let metre = depth * self.pixel;
        // The smaller of the two one-sided slopes: edges keep the slope of their own side.
        let slope = |before: Option<usize>, after: Option<usize>| {
            let one = |other: Option<usize>, sign: f32| {
                let there = other.map(|p| self.depth[p]).filter(|d| *d < NOTHING);
                there.map(|d| sign * (d - depth) / metre)
            };
            match (one(before, -1.0), one(after, 1.0)) {
                (Some(a), Some(b)) if a.abs() < b.abs() => a,
                (_, Some(b)) => b,
                (Some(a), None) => a,
                (None, None) => 0.0,
            }
        };
        let left = (column > 0).then(|| place - 1);
        let right = (column + 1 < self.width).then_some(place + 1);
        let above = (row > 0).then(|| place - self.width);
        let below = (row + 1 < self.height).then_some(place + self.width);
        let normal = unit([slope(left, right), slope(above, below), 1.0]);
        // To the viewer is +z, right is +x, down is +y; depth grows away from the viewer.
        let light = unit([-0.45, -0.75, 0.62]);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let lambert = dot(normal, light).max(0.0);
        let half = unit([light[0], light[1], light[2] + 1.0]);
        let gloss = dot(normal, half).max(0.0).powi(40);
        let rim = (1.0 - normal[2]).powi(3);
        let hollow = self.hollow(column, row, spacing);
        let colour = self.colour[place];
        let bright = (0.40 + 0.66 * lambert) * hollow;
        std::array::from_fn(|c| {
            let lit = colour[c] * bright + 52.0 * gloss + 34.0 * rim * hollow;
            lit.clamp(0.0, 255.0) as u8
        })
    }

    /// 1 on an open surface, less where the surroundings are nearer to the eye. Opposite neighbours
    /// count together, so that a slope is not a hollow.
    fn hollow(&self, column: usize, row: usize, spacing: f32) -> f32 {
        const RAYS: [(f32, f32); 4] = [(1.0, 0.0), (0.71, 0.71), (0.0, 1.0), (-0.71, 0.71)];
        let here = self.depth[row * self.width + column];
        let look = |dx: f32, dy: f32| {
            let (x, y) = (column as f32 + dx, row as f32 + dy);
            let inside = x >= 0.0 && y >= 0.0;
            let (x, y) = (x as usize, y as usize);
            let seen = inside && x < self.width && y < self.height;
            seen.then(|| self.depth[y * self.width + x] - here)
        };
        let limit = 10.0 * spacing;
        let mut dark = 0.0;
        for step in 1..=3 {
            let reach = 2.0 * step as f32 * spacing / (here * self.pixel);
            for (dx, dy) in RAYS {
                let pair = look(reach * dx, reach * dy).zip(look(-reach * dx, -reach * dy));
                if let Some((a, b)) = pair {
                    let mean = 0.5 * (a.clamp(-limit, limit) + b.clamp(-limit, limit));
                    dark += (-mean / limit).max(0.0) / step as f32;
                }
            }
        }
        (1.0 - 0.18 * dark).max(0.45)
    }
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c / length)
}

/// Background, from the top down.
fn sky(part: f32) -> Colour {
    let (top, bottom) = ([226.0, 233.0, 241.0], [250.0, 251.0, 253.0]);
    std::array::from_fn(|c| (top[c] + part * (bottom[c] - top[c])) as u8)
}

/// Rows of pixels in which any of the pictures shows more than background, with a margin.
pub fn rows_used(pictures: &[&Canvas]) -> std::ops::Range<usize> {
    let Some(first) = pictures.first() else {
        return 0..0;
    };
    let plain = |row: usize| {
        pictures
            .iter()
            .all(|p| (1..p.width).all(|x| p.get(x, row) == p.get(0, row)))
    };
    let used = |row: &usize| !plain(*row);
    let low = (0..first.height).find(used).unwrap_or(0);
    let high = (0..first.height)
        .rev()
        .find(used)
        .map_or(first.height, |row| row + 1);
    low.saturating_sub(16)..(high + 16).min(first.height)
}
