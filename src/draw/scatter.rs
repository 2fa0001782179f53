//! Error against time, both on logarithmic axes, as SVG.

use super::plot::{Area, FONT, Failure, SIZE, TEXT, legend};
use plotters::prelude::*;

/// Symbol of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Filled circle.
    Disc,
    /// Open circle.
    Ring,
    /// Filled triangle.
    Triangle,
    /// Two crossed lines.
    Cross,
}

impl Mark {
    /// All marks.
    pub const ALL: [Mark; 4] = [Mark::Disc, Mark::Ring, Mark::Triangle, Mark::Cross];
}

/// Runs of one colour and mark.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// Name in the legend.
    pub label: String,
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// Mark of each point.
    pub mark: Mark,
    /// x and y, above zero, and the label of the point. A line joins the points.
    pub points: Vec<([f64; 2], String)>,
    /// Repeated runs, drawn small and not joined.
    pub repeats: Vec<[f64; 2]>,
}

impl Cloud {
    /// Its mark at a point.
    fn sample<'a, C: Clone + 'static>(&self, at: C) -> DynElement<'static, SVGBackend<'a>, C> {
        let [r, g, b] = self.colour;
        let colour = RGBColor(r, g, b);
        let line = colour.stroke_width(2);
        match self.mark {
            Mark::Disc => Circle::new(at, 5, colour.filled()).into_dyn(),
            Mark::Ring => Circle::new(at, 5, line).into_dyn(),
            Mark::Triangle => TriangleMarker::new(at, 7, colour.filled()).into_dyn(),
            Mark::Cross => plotters::element::Cross::new(at, 5, line).into_dyn(),
        }
    }
}

/// A plot with its clouds, over a broad grey line through the Pareto front.
#[derive(Clone, Debug)]
pub struct Scatter {
    /// Title above the plot.
    pub title: String,
    /// Label of the x axis.
    pub x: String,
    /// Label of the y axis.
    pub y: String,
    /// Points in groups.
    pub clouds: Vec<Cloud>,
    /// Points of the grey line, in order of x.
    pub front: Vec<[f64; 2]>,
}

impl Scatter {
    /// The range of an axis, widened on both sides by a factor of 1.5 or more.
    fn range(&self, axis: usize) -> std::ops::Range<f64> {
        let all = |c: &'_ Cloud| -> Vec<f64> {
            let points = c.points.iter().map(|(p, _)| p[axis]);
            points.chain(c.repeats.iter().map(|p| p[axis])).collect()
        };
        let (low, high) = self
            .clouds
            .iter()
            .flat_map(all)
            .fold((f64::INFINITY, 0.0f64), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        let room = (high / low).powf(0.12).max(1.5);
        low / room..high * room
    }

    /// The plot as SVG; `None` without points.
    ///
    /// # Errors
    /// If the drawing library fails.
    pub fn svg(&self) -> Result<Option<String>, Failure> {
        if self.clouds.iter().all(|c| c.points.is_empty()) {
            return Ok(None);
        }
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
            root.fill(&WHITE)?;
            let title = (FONT, 19).into_font().style(FontStyle::Bold).color(&TEXT);
            root.draw(&Text::new(self.title.clone(), (14, 10), title))?;
            let font = (FONT, 15).into_font().color(&TEXT);
            let below = self.draw_legend(&root)?;
            let axis = |axis: usize| {
                let range = self.range(axis);
                let ticks = ticks(&range);
                range.log_scale().with_key_points(ticks)
            };
            let mut chart = ChartBuilder::on(&root)
                .margin_top(below)
                .margin_right(24)
                .margin_bottom(8)
                .margin_left(8)
                .x_label_area_size(44)
                .y_label_area_size(66)
                .build_cartesian_2d(axis(0), axis(1))?;
            chart
                .configure_mesh()
                .x_desc(self.x.clone())
                .y_desc(self.y.clone())
                .x_label_formatter(&|v| plain(*v))
                .y_label_formatter(&|v| plain(*v))
                .label_style(font.clone())
                .axis_desc_style(font.clone())
                .axis_style(RGBColor(120, 126, 134))
                .bold_line_style(RGBColor(226, 229, 233))
                .light_line_style(RGBColor(250, 251, 252))
                .draw()?;
            let front = self.front.iter().map(|p| (p[0], p[1]));
            let wide = RGBColor(226, 229, 233).stroke_width(7);
            chart.draw_series(LineSeries::new(front, wide))?;
            for cloud in &self.clouds {
                let [r, g, b] = cloud.colour;
                let colour = RGBColor(r, g, b);
                let line = cloud.points.iter().map(|(p, _)| (p[0], p[1]));
                chart.draw_series(LineSeries::new(line, colour))?;
                let small = cloud.repeats.iter().map(|p| (p[0], p[1]));
                chart.draw_series(small.map(|p| Circle::new(p, 3, colour.stroke_width(1))))?;
                chart.draw_series(cloud.points.iter().map(|(p, _)| cloud.sample((p[0], p[1]))))?;
            }
            let mut taken = Vec::new();
            for (p, _) in self.clouds.iter().flat_map(|c| &c.points) {
                let (x, y) = chart.backend_coord(&(p[0], p[1]));
                taken.push([x - 6, y - 6, x + 6, y + 6]);
            }
            for cloud in self.clouds.iter().filter(|c| c.mark == Mark::Disc) {
                let [r, g, b] = cloud.colour;
                let font = (FONT, LETTERS as f64).into_font().color(&RGBColor(r, g, b));
                for (p, label) in &cloud.points {
                    let (x, y) = chart.backend_coord(&(p[0], p[1]));
                    let (x, y) = room(label, [x, y], &mut taken);
                    root.draw(&Text::new(label.clone(), (x, y), font.clone()))?;
                }
            }
            root.present()?;
        }
        Ok(Some(text))
    }

    /// Draws the legend; returns its lower end.
    fn draw_legend(&self, root: &Area) -> Result<i32, Failure> {
        let shown = |c: &&Cloud| !c.points.is_empty();
        let clouds: Vec<&Cloud> = self.clouds.iter().filter(shown).collect();
        let labels = clouds.iter().map(|c| c.label.as_str());
        legend(root, 12, labels, |k, at| root.draw(&clouds[k].sample(at)))
    }
}

/// Height of the labels of points.
const LETTERS: i32 = 13;

/// Position of a label at a point where it covers least of `taken` (left, top, right, bottom), to
/// which it is added.
fn room(label: &str, [x, y]: [i32; 2], taken: &mut Vec<[i32; 4]>) -> (i32, i32) {
    let wide = 7 * label.chars().count() as i32;
    let (right, left, above, below) = (x + 8, x - 8 - wide, y - LETTERS, y + 1);
    let places = [
        (right, above),
        (right, below),
        (left, below),
        (left, above),
        (x - wide / 2, y - 8 - LETTERS),
        (x - wide / 2, y + 8),
        (right, y - 2 * LETTERS),
        (left, y - 2 * LETTERS),
        (right, y + LETTERS),
        (left, y + LETTERS),
        (x - wide / 2, y - 8 - 2 * LETTERS),
        (x - wide / 2, y + 8 + LETTERS),
    ];
    let about = |(x, y): (i32, i32)| [x, y, x + wide, y + LETTERS];
    let covered = |place: &(i32, i32)| -> i32 {
        let a = about(*place);
        let side = |b: &[i32; 4], k: usize| (a[k + 2].min(b[k + 2]) - a[k].max(b[k])).max(0);
        taken.iter().map(|b| side(b, 0) * side(b, 1)).sum()
    };
    let place = places
        .into_iter()
        .min_by_key(covered)
        .unwrap_or((right, above));
    taken.push(about(place));
    place
}

/// 1, 2 and 5 of every decade in a range.
fn ticks(range: &std::ops::Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10() as i32;
    let all = decades.flat_map(|k| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(k)));
    all.filter(|tick| range.contains(tick)).collect()
}

/// At most three digits, without an exponent.
fn plain(value: f64) -> String {
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 4.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        let text = text.trim_end_matches('0').trim_end_matches('.');
        return text.to_owned();
    }
    text
}
