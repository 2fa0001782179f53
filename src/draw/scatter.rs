//! Error against time, both on logarithmic axes.

use plotters::prelude::*;

use super::plot::{AXIS, Area, Failure, GRID, Letters, legend, points};
use super::sheet::{Recorder, Sheet, Weight, plot_size};
use crate::scene::FigureStyle;

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
    fn sample<'a, C: Clone + 'static>(&self, at: C) -> DynElement<'static, Recorder<'a>, C> {
        let [r, g, b] = self.colour;
        let colour = RGBColor(r, g, b);
        let line = colour.stroke_width(points(1.2));
        let size = points(3.0);
        match self.mark {
            Mark::Disc => Circle::new(at, size, colour.filled()).into_dyn(),
            Mark::Ring => Circle::new(at, size, line).into_dyn(),
            Mark::Triangle => TriangleMarker::new(at, points(4.2), colour.filled()).into_dyn(),
            Mark::Cross => plotters::element::Cross::new(at, size, line).into_dyn(),
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

    /// Draws the plot; `None` without points.
    ///
    /// # Errors
    /// If the drawing library fails.
    pub fn sheet(&self, style: &FigureStyle) -> Result<Option<Sheet>, Failure> {
        if self.clouds.iter().all(|c| c.points.is_empty()) {
            return Ok(None);
        }
        let letters = Letters {
            em: style.font_size,
        };
        let mut sheet = Sheet::new(plot_size(style));
        let root = Recorder { sheet: &mut sheet }.into_drawing_area();
        letters.title(&root, &self.title)?;
        let below = self.draw_legend(&root, letters)?;
        let axis = |axis: usize| {
            let range = self.range(axis);
            let ticks = ticks(&range);
            range.log_scale().with_key_points(ticks)
        };
        let mut chart = ChartBuilder::on(&root)
            .margin_top(below)
            .margin_right(letters.ems(1.6))
            .margin_bottom(letters.ems(0.5))
            .margin_left(letters.ems(0.5))
            .x_label_area_size(letters.ems(2.9))
            .y_label_area_size(letters.ems(4.4))
            .build_cartesian_2d(axis(0), axis(1))?;
        chart
            .configure_mesh()
            .x_desc(self.x.clone())
            .y_desc(self.y.clone())
            .x_label_formatter(&|v| plain(*v))
            .y_label_formatter(&|v| plain(*v))
            .label_style(letters.plain())
            .axis_desc_style(letters.plain())
            .set_all_tick_mark_size(points(3.0))
            .axis_style(AXIS.stroke_width(points(0.6)))
            .bold_line_style(GRID.stroke_width(points(0.5)))
            .light_line_style(RGBColor(250, 251, 252).stroke_width(points(0.5)))
            .draw()?;
        let front = self.front.iter().map(|p| (p[0], p[1]));
        chart.draw_series(LineSeries::new(front, GRID.stroke_width(points(4.5))))?;
        for cloud in &self.clouds {
            let [r, g, b] = cloud.colour;
            let thin = RGBColor(r, g, b).stroke_width(points(0.7));
            let line = cloud.points.iter().map(|(p, _)| (p[0], p[1]));
            chart.draw_series(LineSeries::new(line, thin))?;
            let small = cloud.repeats.iter().map(|p| (p[0], p[1]));
            chart.draw_series(small.map(|p| Circle::new(p, points(1.8), thin)))?;
            chart.draw_series(cloud.points.iter().map(|(p, _)| cloud.sample((p[0], p[1]))))?;
        }
        let places = |p: &[f64; 2]| chart.backend_coord(&(p[0], p[1]));
        self.draw_labels(&root, letters, &places)?;
        root.present()?;
        drop(chart);
        drop(root);
        Ok(Some(sheet))
    }

    /// Writes the labels of the points; `place`: of a point.
    fn draw_labels(
        &self,
        root: &Area,
        letters: Letters,
        place: &dyn Fn(&[f64; 2]) -> (i32, i32),
    ) -> Result<(), Failure> {
        let letters = Letters {
            em: LABELS * letters.em,
        };
        let half = points(3.6) as i32;
        let points = self.clouds.iter().flat_map(|cloud| &cloud.points);
        let about = |(x, y): (i32, i32)| [x - half, y - half, x + half, y + half];
        let mut taken: Vec<[i32; 4]> = points.map(|(p, _)| about(place(p))).collect();
        // Beyond the edges there is no room.
        let (wide, high) = root.dim_in_pixel();
        let (wide, high) = (wide as i32, high as i32);
        taken.push([wide, 0, 2 * wide, high]);
        taken.push([-wide, 0, 0, high]);
        for cloud in self.clouds.iter().filter(|c| c.mark == Mark::Disc) {
            let [r, g, b] = cloud.colour;
            let colour = RGBColor(r, g, b);
            let font = letters.plain().color(&colour);
            for (p, label) in &cloud.points {
                let at = room(label, letters, place(p), &mut taken);
                root.draw(&Text::new(label.clone(), at, font.clone()))?;
            }
        }
        Ok(())
    }

    /// Draws the legend; returns its lower end.
    fn draw_legend(&self, root: &Area, letters: Letters) -> Result<i32, Failure> {
        let shown = |c: &&Cloud| !c.points.is_empty();
        let clouds: Vec<&Cloud> = self.clouds.iter().filter(shown).collect();
        let labels = clouds.iter().map(|c| c.label.as_str());
        if clouds.iter().all(|cloud| cloud.label.is_empty()) {
            return Ok(letters.ems(3.1));
        }
        legend(root, letters, 1.0, labels, |k, at| {
            root.draw(&clouds[k].sample(at))
        })
    }
}

/// Size of the labels of points, over that of other letters.
const LABELS: f64 = 0.87;

/// Position of a label at a point where it covers least of `taken` (left, top, right, bottom), to
/// which it is added.
fn room(
    label: &str,
    letters: Letters,
    (x, y): (i32, i32),
    taken: &mut Vec<[i32; 4]>,
) -> (i32, i32) {
    let (wide, high) = (letters.ems(Weight::Regular.length(label)), letters.ems(1.0));
    let gap = points(5.0) as i32;
    let (right, left, above, below) = (x + gap, x - gap - wide, y - high, y + high / 12);
    let places = [
        (right, above),
        (right, below),
        (left, below),
        (left, above),
        (x - wide / 2, y - gap - high),
        (x - wide / 2, y + gap),
        (right, y - 2 * high),
        (left, y - 2 * high),
        (right, y + high),
        (left, y + high),
        (x - wide / 2, y - gap - 2 * high),
        (x - wide / 2, y + gap + high),
    ];
    let about = |(x, y): (i32, i32)| [x, y, x + wide, y + high];
    let covered = |place: &(i32, i32)| -> i64 {
        let a = about(*place);
        let side = |b: &[i32; 4], k: usize| (a[k + 2].min(b[k + 2]) - a[k].max(b[k])).max(0);
        taken
            .iter()
            .map(|b| i64::from(side(b, 0)) * i64::from(side(b, 1)))
            .sum()
    };
    let place = places
        .into_iter()
        .min_by_key(covered)
        .unwrap_or((right, above));
    taken.push(about(place));
    place
}

/// 1, 2 and 5 of every decade in a range; of a narrow one, closer numbers.
fn ticks(range: &std::ops::Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10() as i32;
    let of = |digits: &[f64]| -> Vec<f64> {
        let all = decades
            .clone()
            .flat_map(|k| digits.iter().map(move |digit| digit * 10f64.powi(k)));
        all.filter(|tick| range.contains(tick)).collect()
    };
    let steps = |count: u32| (count..10 * count).map(move |k| f64::from(k) / f64::from(count));
    let each = |count: u32| of(&steps(count).collect::<Vec<_>>());
    let coarse = [of(&[1.0, 2.0, 5.0]), each(1), each(2), each(10)];
    let mut enough = coarse.into_iter().filter(|ticks| ticks.len() >= ENOUGH);
    enough.next().unwrap_or_else(|| each(20))
}

/// Least number of ticks.
const ENOUGH: usize = 3;

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
