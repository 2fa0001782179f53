//! A figure as pixels.

use super::font::{self, Look};
use super::{Shape, Sheet, round};
use crate::draw::canvas::{Canvas, Colour, WHITE};

/// Samples along each side of a pixel at the edge of an area.
const SAMPLES: i64 = 4;

/// `scale`: pixels of a point.
pub fn canvas(sheet: &Sheet, scale: f64) -> Canvas {
    let [width, height] = sheet
        .size
        .map(|length| (length * scale).round().max(1.0) as usize);
    let mut canvas = Canvas::new(width, height, WHITE);
    let place = |p: &[f64; 2]| p.map(|c| c * scale);
    for shape in &sheet.shapes {
        match shape {
            Shape::Lines {
                lines,
                width,
                colour,
            } => {
                let width = (width * scale) as f32;
                lines
                    .iter()
                    .for_each(|line| trace(&mut canvas, line, scale, (width, *colour)));
            }
            Shape::Circle {
                at,
                radius,
                width,
                colour,
            } => {
                let points = round(*at, *radius);
                match width {
                    Some(width) => {
                        let width = (width * scale) as f32;
                        trace(&mut canvas, &points, scale, (width, *colour));
                    }
                    None => {
                        let points: Vec<[f64; 2]> = points.iter().map(place).collect();
                        fill(&mut canvas, &points, *colour);
                    }
                }
            }
            Shape::Area { points, colour } => {
                let points: Vec<[f64; 2]> = points.iter().map(place).collect();
                fill(&mut canvas, &points, *colour);
            }
            Shape::Text(text) => {
                let look = Look {
                    size: text.size * scale,
                    anchor: text.anchor,
                    weight: text.weight,
                    is_upright: text.is_upright,
                    colour: text.colour,
                };
                font::write(&mut canvas, place(&text.at), &text.text, look);
            }
            Shape::Image { low, high, picture } => {
                stretch(&mut canvas, place(low), place(high), picture);
            }
        }
    }
    canvas
}

/// Draws a line through points; width in pixels.
fn trace(canvas: &mut Canvas, line: &[[f64; 2]], scale: f64, (width, colour): (f32, Colour)) {
    for pair in line.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|p| p.map(|c| (c * scale) as f32));
        canvas.line(a, b, width, colour);
    }
}

/// Fills a polygon; pixels at its edge by the part of their samples that is inside.
fn fill(canvas: &mut Canvas, points: &[[f64; 2]], colour: Colour) {
    let end = |axis: usize| {
        let along = points.iter().map(|p| p[axis]);
        let low = along.clone().fold(f64::INFINITY, f64::min);
        let high = along.fold(f64::NEG_INFINITY, f64::max);
        let most = [canvas.width, canvas.height][axis] as f64;
        [low.floor().max(0.0) as i64, high.ceil().min(most) as i64]
    };
    let [[left, right], [top, bottom]] = [end(0), end(1)];
    let sample = |k: i64| (k as f64 + 0.5) / SAMPLES as f64;
    for y in top..bottom {
        for x in left..right {
            let each = (0..SAMPLES * SAMPLES).filter(|k| {
                let at = [
                    x as f64 + sample(k % SAMPLES),
                    y as f64 + sample(k / SAMPLES),
                ];
                is_inside(points, at)
            });
            let part = each.count() as f32 / (SAMPLES * SAMPLES) as f32;
            canvas.blend(x, y, colour, part);
        }
    }
}

/// Even-odd rule.
fn is_inside(points: &[[f64; 2]], at: [f64; 2]) -> bool {
    let mut is_inside = false;
    for (k, b) in points.iter().enumerate() {
        let a = points[(k + points.len() - 1) % points.len()];
        let crosses = (a[1] > at[1]) != (b[1] > at[1]);
        if crosses && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            is_inside = !is_inside;
        }
    }
    is_inside
}

/// Draws a picture into the rectangle between two corners, each pixel from the nearest of its own.
fn stretch(canvas: &mut Canvas, low: [f64; 2], high: [f64; 2], picture: &Canvas) {
    let count = [picture.width, picture.height];
    let own = |pixel: usize, axis: usize| {
        let part = (pixel as f64 + 0.5 - low[axis]) / (high[axis] - low[axis]);
        (0.0..1.0)
            .contains(&part)
            .then(|| (part * count[axis] as f64) as usize)
    };
    for y in 0..canvas.height {
        let Some(row) = own(y, 1) else { continue };
        for x in 0..canvas.width {
            if let Some(column) = own(x, 0) {
                canvas.set(x, y, picture.get(column, row));
            }
        }
    }
}
