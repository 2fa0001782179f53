//! Plots of measures against time.

use std::convert::Infallible;

use plotters::prelude::*;

use super::sheet::{Recorder, Sheet, UNIT, Weight, plot_size};
use crate::scene::FigureStyle;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Without gaps.
    Solid,
    /// With gaps.
    Dashed,
}

/// A labelled curve; `NaN` interrupts it.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend.
    pub label: String,
    /// x and y of each point.
    pub points: Vec<[f64; 2]>,
    /// Line style.
    pub line: Line,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// A plot with its curves.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Names the file too: `crater depth` becomes `crater-depth`.
    pub title: String,
    /// Label of the x axis.
    pub x: String,
    /// Label of the y axis.
    pub y: String,
    /// Curves, drawn in this order.
    pub curves: Vec<Curve>,
    /// Whether the axes show zero.
    pub from_zero: bool,
}

/// Colours that are distinguishable for the colour-blind (Okabe & Ito 2008), for runs.
pub const PALETTE: [[u8; 3]; 6] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [86, 180, 233],
    [120, 94, 40],
];
/// Muted colours for reference curves.
pub const REFERENCE: [[u8; 3]; 6] = [
    [40, 40, 40],
    [130, 130, 130],
    [90, 110, 130],
    [150, 110, 80],
    [110, 140, 100],
    [170, 150, 180],
];

pub(super) const TEXT: RGBColor = RGBColor(45, 50, 58);
/// Of axes and their marks.
pub(super) const AXIS: RGBColor = RGBColor(120, 126, 134);
/// Of lines behind the curves.
pub(super) const GRID: RGBColor = RGBColor(226, 229, 233);

pub(super) type Area<'a> = DrawingArea<Recorder<'a>, plotters::coord::Shift>;

/// A plot that cannot be drawn.
pub type Failure = DrawingAreaErrorKind<Infallible>;

/// The letters of a plot.
#[derive(Clone, Copy)]
pub(super) struct Letters {
    /// An em, points.
    pub em: f64,
}

impl Letters {
    /// Letters of the usual size.
    pub fn plain(self) -> TextStyle<'static> {
        // The library's name of a font is not used.
        ("sans-serif", self.em * UNIT).into_font().color(&TEXT)
    }

    /// Draws a title, larger and bold, as large as there is room for.
    pub fn title(self, root: &Area, title: &str) -> Result<(), Failure> {
        let at = (self.ems(0.9), self.ems(0.7));
        let room = root.dim_in_pixel().0 as i32 - 2 * at.0;
        let wide = 1.2 * self.em * UNIT * Weight::Bold.length(title);
        let fit = (f64::from(room) / wide).min(1.0);
        let font = ("sans-serif", 1.2 * fit * self.em * UNIT).into_font();
        let style = font.style(FontStyle::Bold).color(&TEXT);
        root.draw(&Text::new(title.to_string(), at, style))
    }

    /// A length in ems, in units of the library.
    pub fn ems(self, count: f64) -> i32 {
        (count * self.em * UNIT).round() as i32
    }
}

/// A length in points, in units of the library.
pub(super) fn points(length: f64) -> u32 {
    (length * UNIT).round() as u32
}

/// Where a plot has its axes.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    /// Values at the left and the right end, at the lower and the upper end.
    pub values: [[f64; 2]; 2],
    /// Where these are in the sheet, points.
    pub places: [[f64; 2]; 2],
}

impl Plot {
    /// Name of the files without folder and ending.
    pub fn file_name(&self) -> String {
        let title = self.title.to_lowercase();
        let words = title.split(|c: char| !(c.is_alphanumeric() || c == '.'));
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        words.join("-")
    }

    /// Whether there is a point to draw.
    pub fn has_points(&self) -> bool {
        self.known().next().is_some()
    }

    fn known(&self) -> impl Iterator<Item = [f64; 2]> {
        let all = self.curves.iter().flat_map(|c| c.points.iter().copied());
        all.filter(|p| p[0].is_finite() && p[1].is_finite())
    }

    fn ranges(&self) -> [[f64; 2]; 2] {
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for p in self.known() {
            for (r, v) in range.iter_mut().zip(p) {
                *r = [r[0].min(v), r[1].max(v)];
            }
        }
        if self.from_zero {
            range = range.map(|[low, high]| [low.min(0.0), high.max(0.0)]);
        }
        let mut widen = |axis: usize, part: f64| {
            let [low, high] = range[axis];
            let flat = 0.05 * low.abs().max(high.abs()).max(1e-12);
            let pad = (part * (high - low)).max(if high > low { 0.0 } else { flat });
            let keep = axis == 1 && self.from_zero && low == 0.0;
            range[axis] = [if keep { 0.0 } else { low - pad }, high + pad];
        };
        widen(0, 0.0);
        widen(1, 0.06);
        range
    }

    /// Draws the plot.
    ///
    /// # Errors
    /// If the drawing library fails.
    pub fn sheet(&self, style: &FigureStyle) -> Result<Sheet, Failure> {
        Ok(self.drawn(style)?.0)
    }

    /// [`sheet`](Self::sheet), and where its axes are.
    ///
    /// # Errors
    /// If the drawing library fails.
    pub fn drawn(&self, style: &FigureStyle) -> Result<(Sheet, Axes), Failure> {
        let letters = Letters {
            em: style.font_size,
        };
        let size = plot_size(style);
        let mut sheet = Sheet::new(size);
        let recorder = Recorder { sheet: &mut sheet };
        let root = recorder.into_drawing_area();
        letters.title(&root, &self.title)?;
        let below = self.draw_legend(&root, letters)?;
        let [x, y] = self.ranges();
        // Marks about six ems apart along x, three along y.
        let [across, up] = [(0, 6.0), (1, 3.0)].map(|(axis, ems)| {
            let count = size[axis] / (ems * letters.em);
            (count.round() as usize).clamp(3, 9)
        });
        let (dx, dy) = (digits(x, across), digits(y, up));
        let widths = y.map(|end| Weight::Regular.length(&number(end, dy)));
        let mut chart = ChartBuilder::on(&root)
            .margin_top(below)
            .margin_right(letters.ems(1.6))
            .margin_bottom(letters.ems(0.5))
            .margin_left(letters.ems(0.5))
            .x_label_area_size(letters.ems(2.9))
            .y_label_area_size(letters.ems(2.2 + widths[0].max(widths[1])))
            .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
        chart
            .configure_mesh()
            .x_desc(self.x.clone())
            .y_desc(self.y.clone())
            .x_labels(across)
            .y_labels(up)
            .x_label_formatter(&|v| number(*v, dx))
            .y_label_formatter(&|v| number(*v, dy))
            .label_style(letters.plain())
            .axis_desc_style(letters.plain())
            .set_all_tick_mark_size(points(3.0))
            .axis_style(AXIS.stroke_width(points(0.6)))
            .bold_line_style(GRID.stroke_width(points(0.5)))
            .light_line_style(TRANSPARENT)
            .draw()?;
        for curve in &self.curves {
            for piece in pieces(&curve.points) {
                let style = stroke(curve);
                if let [only] = piece[..] {
                    // A value between blanks.
                    let dot = Circle::new(only, points(1.5), style.filled());
                    chart.draw_series([dot])?;
                } else if curve.line == Line::Dashed {
                    let (dash, gap) = (points(5.0), points(3.0));
                    chart.draw_series(DashedLineSeries::new(piece, dash, gap, style))?;
                } else {
                    chart.draw_series(LineSeries::new(piece, style))?;
                }
            }
        }
        root.present()?;
        let (across, down) = chart.plotting_area().get_pixel_range();
        let places = [[across.start, across.end], [down.end, down.start]];
        let axes = Axes {
            values: [x, y],
            places: places.map(|ends| ends.map(|unit| f64::from(unit) / UNIT)),
        };
        drop(chart);
        drop(root);
        Ok((sheet, axes))
    }

    /// Draws rows of samples with labels under the title; returns their lower end.
    fn draw_legend(&self, root: &Area, letters: Letters) -> Result<i32, Failure> {
        let shown = |c: &&Curve| !pieces(&c.points).is_empty();
        let curves: Vec<&Curve> = self.curves.iter().filter(shown).collect();
        let labels = curves.iter().map(|c| c.label.as_str());
        legend(root, letters, 2.2, labels, |k, (x, y)| {
            let dashes: &[(f64, f64)] = match curves[k].line {
                Line::Solid => &[(0.0, 1.8)],
                Line::Dashed => &[(0.0, 0.5), (0.75, 1.25), (1.5, 1.8)],
            };
            for (from, to) in dashes {
                let sample = vec![(x + letters.ems(*from), y), (x + letters.ems(*to), y)];
                root.draw(&PathElement::new(sample, stroke(curves[k])))?;
            }
            Ok(())
        })
    }
}

/// Draws labels in rows under the title, each to the right of a sample of `width` ems that `draw`
/// draws, given its number and left end; returns the lower end of the rows.
pub(super) fn legend<'a>(
    root: &Area,
    letters: Letters,
    width: f64,
    labels: impl Iterator<Item = &'a str>,
    mut draw: impl FnMut(usize, (i32, i32)) -> Result<(), Failure>,
) -> Result<i32, Failure> {
    let left = letters.ems(1.2);
    let (mut x, mut y) = (left, letters.ems(3.1));
    let right = root.dim_in_pixel().0 as i32 - letters.ems(1.0);
    for (k, label) in labels.enumerate() {
        let end = x + letters.ems(width + Weight::Regular.length(label));
        if x > left && end > right {
            (x, y) = (left, y + letters.ems(1.35));
        }
        draw(k, (x, y))?;
        let at = (x + letters.ems(width), y - letters.ems(0.38));
        root.draw(&Text::new(label, at, letters.plain()))?;
        x += letters.ems(width + 1.4 + Weight::Regular.length(label));
    }
    Ok(y + letters.ems(1.1))
}

fn stroke(curve: &Curve) -> ShapeStyle {
    let [r, g, b] = curve.colour;
    RGBColor(r, g, b).stroke_width(points(1.3))
}

/// Digits after the point of `count` marks in a range: of their step, the least of 1, 2, 5 times a
/// power of ten that gives so many.
fn digits(range: [f64; 2], count: usize) -> usize {
    let least = (range[1] - range[0]) / (count as f64 + 1.0);
    let power = least.log10().floor();
    let is_above = least > 5.0 * 10f64.powf(power) * (1.0 + 1e-9);
    (-power - f64::from(is_above)).clamp(0.0, 9.0) as usize
}

/// Runs of points without blanks.
fn pieces(points: &[[f64; 2]]) -> Vec<Vec<(f64, f64)>> {
    points
        .split(|p| !(p[0].is_finite() && p[1].is_finite()))
        .filter(|piece| !piece.is_empty())
        .map(|piece| piece.iter().map(|p| (p[0], p[1])).collect())
        .collect()
}

fn number(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    // No "-0".
    if text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.')
    {
        text.trim_start_matches('-').to_owned()
    } else {
        text.replace('-', "\u{2212}")
    }
}
