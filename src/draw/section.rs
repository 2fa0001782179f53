//! A thin slice through the axis, particles coloured by body.

use super::canvas::{Anchor, Canvas, Colour, FAINT, INK, WHITE};
use super::scale::round_number;
use crate::particle::Frame;
use crate::scene::quantity::{Unit, legible};
use crate::scene::{Dimension, Scene, Side};

/// Largest thickness of the slice, m, and over the depth of the box; at least one spacing.
const THICKNESS: f64 = 1e-3;
const PART: f64 = 0.05;
/// Pixels above the liquid, for the label and the scale bar, and below z = 0.
const STRIP: f64 = 48.0;
const FLOOR: f64 = 8.0;
/// Most pixels of a section downward, and fewest across.
const HIGHEST: f64 = 1400.0;
const NARROWEST: f64 = 200.0;

/// Width of sections and views, pixels, even; smaller for coarse scenes.
pub fn width(scene: &Scene) -> usize {
    let particles = scene.domain.size[0] / scene.spacing;
    ((8.0 * particles) as usize * 2).clamp(520, 880)
}

/// What slice and view show, a sentence.
pub fn words(scene: &Scene) -> String {
    match (scene.dimension, scene.domain.is_axial()) {
        (_, true) => "Section through the axis, and bird's-eye view.".into(),
        (Dimension::Two, _) => "All particles of the plane.".into(),
        (Dimension::Three, _) => {
            let thickness = legible(thickness(scene), Unit::Length);
            format!("Section of {thickness} through the axis, and bird's-eye view.")
        }
    }
}

/// m.
fn thickness(scene: &Scene) -> f64 {
    let depth = PART * scene.domain.size[1];
    THICKNESS.min(depth).max(scene.spacing)
}

/// The particles of the slice at one instant.
pub struct Section {
    /// Label of the picture.
    pub label: String,
    /// x, z in m, body; the farthest first.
    points: Vec<([f32; 2], u8)>,
}

impl Section {
    /// `at`: lateral y of the axis, m.
    pub fn new(scene: &Scene, frame: &Frame, at: f64, label: String) -> Section {
        let half = 0.5 * thickness(scene);
        let flat = scene.dimension == Dimension::Two;
        let [x, y, z] = &frame.position;
        let near = |&i: &usize| flat || (f64::from(y[i]) - at).abs() <= half;
        let mut chosen: Vec<usize> = (0..frame.id.len()).filter(near).collect();
        chosen.sort_by(|&a, &b| y[b].total_cmp(&y[a]));
        let points = chosen
            .into_iter()
            .map(|i| ([x[i], z[i]], frame.body[i]))
            .collect();
        Section { label, points }
    }

    /// Height that contains all but the highest thousandth of the particles, m.
    pub fn top(&self) -> f64 {
        let mut heights: Vec<f32> = self.points.iter().map(|(p, _)| p[1]).collect();
        heights.sort_by(f32::total_cmp);
        let place = heights.len().saturating_sub(1 + heights.len() / 1000);
        heights.get(place).map_or(0.0, |z| f64::from(*z))
    }

    /// Draws the slice from the floor to `top`, m, over the whole width of the box, which is at the
    /// left of a picture that must be wider. Label and scale bar are above the liquid.
    pub fn draw(&self, scene: &Scene, top: f64) -> Canvas {
        let size = scene.domain.size;
        let spacing = scene.spacing;
        let top = top + 3.0 * spacing;
        let scale = (width(scene) as f64 / size[0]).min((HIGHEST - FLOOR - STRIP) / top);
        let width = (scale * size[0]).round().max(NARROWEST) as usize;
        let height = (top * scale + FLOOR + STRIP).max(120.0).round() as usize;
        let mut canvas = Canvas::new(width, height, WHITE);
        let base = height as f64 - FLOOR;
        let radius = (0.55 * spacing * scale) as f32;
        for ([x, z], body) in &self.points {
            let at = [f64::from(*x) * scale, base - f64::from(*z) * scale].map(|c| c as f32);
            canvas.ball(at, radius, body_colour(scene, *body));
        }
        if scene.domain.boundary[2][0] == Side::Wall {
            canvas.rectangle([0.0, base as f32], [width as f32, height as f32], FAINT);
        }
        // Mist that is higher than `top`.
        canvas.rectangle([0.0, 0.0], [width as f32, STRIP as f32], WHITE);
        canvas.text([14.0, 30.0], 22.0, &self.label, Anchor::Left, INK);
        draw_scale(&mut canvas, size[0], scale);
        canvas
    }
}

/// A bar of a round length in the upper right corner.
fn draw_scale(canvas: &mut Canvas, width: f64, scale: f64) {
    let mut length = round_number(0.16 * width);
    if length > 0.16 * width {
        length = round_number(0.5 * length);
    }
    let right = canvas.width as f32 - 16.0;
    let left = right - (length * scale) as f32;
    canvas.line([left, 38.0], [right, 38.0], 3.0, INK);
    let middle = 0.5 * (left + right);
    canvas.text(
        [middle, 28.0],
        18.0,
        &legible(length, Unit::Length),
        Anchor::Middle,
        INK,
    );
}

/// Colour of a body, or the default of the papers' figures in place of black.
pub fn body_colour(scene: &Scene, body: u8) -> Colour {
    let default = [
        [222, 96, 44],
        [64, 132, 196],
        [60, 160, 110],
        [150, 110, 190],
    ];
    match scene.bodies.get(usize::from(body)).map(|b| b.colour) {
        Some(colour) if colour != [0; 3] => colour,
        _ => default[usize::from(body) % default.len()],
    }
}
