//! Figures of shapes and texts in real coordinates, and their files: SVG, PDF and PNG.
//!
//! Lengths are points of 1/72 inch, y down from the upper edge. SVG has its letters as outlines, so
//! that it looks the same where the font is not installed; PDF embeds the letters that it uses, and
//! its texts can be searched.

pub mod font;
mod pdf;
mod png;
mod recorder;
mod svg;

pub use font::Weight;
pub use recorder::{Recorder, UNIT};

use super::canvas::{Anchor, Canvas, Colour};
use crate::scene::FigureStyle;

/// Points per metre.
pub const POINT: f64 = 72.0 / 0.0254;

/// Corners of a circle where it is a polygon.
const CORNERS: usize = 48;

/// A figure.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Width and height.
    pub size: [f64; 2],
    shapes: Vec<Shape>,
}

/// A text on one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Its point on the base line.
    pub at: [f64; 2],
    /// Size of the letters: an em.
    pub size: f64,
    /// What is written.
    pub text: String,
    /// Alignment at the point.
    pub anchor: Anchor,
    /// Regular or bold.
    pub weight: Weight,
    /// Whether it runs upwards.
    pub is_upright: bool,
    /// Its colour.
    pub colour: Colour,
}

/// What a figure consists of, in the order in which it is drawn.
#[derive(Clone, Debug)]
enum Shape {
    /// Lines through points.
    Lines {
        lines: Vec<Vec<[f64; 2]>>,
        width: f64,
        colour: Colour,
    },
    /// A filled polygon.
    Area {
        points: Vec<[f64; 2]>,
        colour: Colour,
    },
    /// A circle, filled if it has no width.
    Circle {
        at: [f64; 2],
        radius: f64,
        width: Option<f64>,
        colour: Colour,
    },
    Text(Text),
    /// Pixels that fill a rectangle.
    Image {
        low: [f64; 2],
        high: [f64; 2],
        picture: Canvas,
    },
}

impl Sheet {
    /// A white figure.
    pub fn new(size: [f64; 2]) -> Sheet {
        Sheet {
            size,
            shapes: Vec::new(),
        }
    }

    /// A line through points.
    pub fn line(&mut self, points: Vec<[f64; 2]>, width: f64, colour: Colour) {
        self.lines(vec![points], width, colour);
    }

    /// Several lines of one width and colour.
    pub fn lines(&mut self, lines: Vec<Vec<[f64; 2]>>, width: f64, colour: Colour) {
        self.shapes.push(Shape::Lines {
            lines,
            width,
            colour,
        });
    }

    /// A filled polygon.
    pub fn area(&mut self, points: Vec<[f64; 2]>, colour: Colour) {
        self.shapes.push(Shape::Area { points, colour });
    }

    /// A filled circle, or with `width` a ring.
    pub fn circle(&mut self, at: [f64; 2], radius: f64, width: Option<f64>, colour: Colour) {
        self.shapes.push(Shape::Circle {
            at,
            radius,
            width,
            colour,
        });
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, low: [f64; 2], high: [f64; 2], colour: Colour) {
        let corners = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
        self.area(corners, colour);
    }

    /// A text.
    pub fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// A picture in the rectangle between two corners; its pixels keep sharp edges.
    pub fn image(&mut self, low: [f64; 2], high: [f64; 2], picture: Canvas) {
        self.shapes.push(Shape::Image { low, high, picture });
    }

    /// All texts, in the order in which they are drawn.
    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.shapes.iter().filter_map(|shape| match shape {
            Shape::Text(text) => Some(text),
            _ => None,
        })
    }

    /// The figure as SVG.
    pub fn svg(&self) -> String {
        svg::text(self)
    }

    /// The figure as PDF.
    pub fn pdf(&self) -> Vec<u8> {
        pdf::bytes(self)
    }

    /// The figure as pixels; `dpi`: of them per inch.
    pub fn canvas(&self, dpi: f64) -> Canvas {
        png::canvas(self, dpi / 72.0)
    }
}

impl Text {
    /// A regular text.
    pub fn new(at: [f64; 2], size: f64, text: &str, anchor: Anchor) -> Text {
        Text {
            at,
            size,
            text: text.to_owned(),
            anchor,
            weight: Weight::Regular,
            is_upright: false,
            colour: super::canvas::INK,
        }
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        self.size * self.weight.length(&self.text)
    }

    /// Distance of its begin before its point.
    fn before(&self) -> f64 {
        match self.anchor {
            Anchor::Left => 0.0,
            Anchor::Middle => 0.5 * self.length(),
            Anchor::Right => self.length(),
        }
    }

    /// Where it begins on the base line.
    fn start(&self) -> [f64; 2] {
        match self.is_upright {
            true => [self.at[0], self.at[1] + self.before()],
            false => [self.at[0] - self.before(), self.at[1]],
        }
    }
}

/// A circle as a polygon whose last point is the first.
fn round(at: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let (sine, cosine) = (k as f64 * std::f64::consts::TAU / CORNERS as f64).sin_cos();
        [at[0] + radius * cosine, at[1] + radius * sine]
    };
    (0..=CORNERS).map(corner).collect()
}

/// Width and height of a plot of this style.
pub fn plot_size(style: &FigureStyle) -> [f64; 2] {
    [style.width * POINT, style.height * POINT]
}
