//! Plots of measures against time, as SVG.

use plotters::prelude::*;

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
    /// Names the file too: `crater depth` becomes `crater-depth.svg`.
    pub title: String,
    /// Label of the x axis.
    pub x: String,
    /// Label of the y axis.
    pub y: String,
    /// Curves, drawn in this order.
    pub curves: Vec<Curve>,
    /// Whether the y axis shows zero.
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
/// Greys for reference curves.
pub const REFERENCE: [[u8; 3]; 3] = [[40, 40, 40], [130, 130, 130], [90, 110, 130]];

pub(super) const SIZE: (u32, u32) = (640, 400);
pub(super) const FONT: &str = "system-ui, 'Segoe UI', 'DejaVu Sans', Helvetica, Arial, sans-serif";
pub(super) const TEXT: RGBColor = RGBColor(45, 50, 58);

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A plot that cannot be drawn.
pub type Failure = DrawingAreaErrorKind<std::io::Error>;

impl Plot {
    /// Name of the file without folder.
    pub fn file_name(&self) -> String {
        let title = self.title.to_lowercase();
        let words = title.split(|c: char| !(c.is_alphanumeric() || c == '.'));
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        format!("{}.svg", words.join("-"))
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
        range[0] = [range[0][0].min(0.0), range[0][1].max(0.0)];
        if self.from_zero {
            range[1] = [range[1][0].min(0.0), range[1][1].max(0.0)];
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

    /// The plot as SVG.
    ///
    /// # Errors
    /// If the drawing library fails.
    pub fn svg(&self) -> Result<String, Failure> {
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            root.fill(&WHITE)?;
            let title = (FONT, 19).into_font().style(FontStyle::Bold).color(&TEXT);
            root.draw(&Text::new(self.title.clone(), (14, 10), title))?;
            let below = self.draw_legend(&root)?;
            let [x, y] = self.ranges();
            let mut chart = ChartBuilder::on(&root)
                .margin_top(below)
                .margin_right(24)
                .margin_bottom(8)
                .margin_left(8)
                .x_label_area_size(44)
                .y_label_area_size(62)
                .build_cartesian_2d(x[0]..x[1], y[0]..y[1])?;
            let digits = |range: [f64; 2]| {
                let step = (range[1] - range[0]) / 8.0;
                (-step.log10().floor()).clamp(0.0, 9.0) as usize
            };
            let (dx, dy) = (digits(x), digits(y));
            chart
                .configure_mesh()
                .x_desc(self.x.clone())
                .y_desc(self.y.clone())
                .x_labels(8)
                .y_labels(8)
                .x_label_formatter(&|v| number(*v, dx))
                .y_label_formatter(&|v| number(*v, dy))
                .label_style((FONT, 15).into_font().color(&TEXT))
                .axis_desc_style((FONT, 15).into_font().color(&TEXT))
                .axis_style(RGBColor(120, 126, 134))
                .bold_line_style(RGBColor(226, 229, 233))
                .light_line_style(TRANSPARENT)
                .draw()?;
            for curve in &self.curves {
                for piece in pieces(&curve.points) {
                    let style = style(curve);
                    if curve.line == Line::Dashed {
                        let series = DashedLineSeries::new(piece, 7, 4, style);
                        chart.draw_series(series)?;
                    } else {
                        chart.draw_series(LineSeries::new(piece, style))?;
                    }
                }
            }
            root.present()?;
        }
        Ok(text)
    }

    /// Draws rows of samples with labels under the title; returns their lower end.
    fn draw_legend(&self, root: &Area) -> Result<i32, Failure> {
        let shown = |c: &&Curve| !pieces(&c.points).is_empty();
        let curves: Vec<&Curve> = self.curves.iter().filter(shown).collect();
        let labels = curves.iter().map(|c| c.label.as_str());
        legend(root, 32, labels, |k, (x, y)| {
            let dashes: &[(i32, i32)] = match curves[k].line {
                Line::Solid => &[(0, 26)],
                Line::Dashed => &[(0, 7), (11, 18), (22, 26)],
            };
            for (from, to) in dashes {
                let sample = vec![(x + from, y), (x + to, y)];
                root.draw(&PathElement::new(sample, style(curves[k])))?;
            }
            Ok(())
        })
    }
}

/// Draws labels in rows under the title, each to the right of a sample of `width` pixels that
/// `draw` draws, given its number and left end; returns the lower end of the rows.
pub(super) fn legend<'a>(
    root: &Area,
    width: i32,
    labels: impl Iterator<Item = &'a str>,
    mut draw: impl FnMut(usize, (i32, i32)) -> Result<(), Failure>,
) -> Result<i32, Failure> {
    let font = (FONT, 15).into_font().color(&TEXT);
    let (mut x, mut y) = (18, 50);
    for (k, label) in labels.enumerate() {
        let next = width + 22 + (7.8 * label.chars().count() as f64) as i32;
        if x > 18 && x + next > SIZE.0 as i32 {
            (x, y) = (18, y + 20);
        }
        draw(k, (x, y))?;
        root.draw(&Text::new(label, (x + width, y - 8), font.clone()))?;
        x += next;
    }
    Ok(y + 16)
}

fn style(curve: &Curve) -> ShapeStyle {
    let [r, g, b] = curve.colour;
    RGBColor(r, g, b).stroke_width(2)
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
