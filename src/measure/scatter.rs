//! Error against time, both on logarithmic axes, as SVG.

use super::plot::{FONT, Failure, SIZE, TEXT};
use plotters::prelude::*;

/// Runs of one colour.
#[derive(Clone, Debug)]
pub struct Cloud {
    pub label: String,
    pub colour: [u8; 3],
    /// x, y and what stands beside the point; all above zero.
    pub points: Vec<([f64; 2], String)>,
}

/// A plot with its clouds, each joined by a line, and beneath a broad grey one through the points
/// that nothing beats.
#[derive(Clone, Debug)]
pub struct Scatter {
    pub title: String,
    pub x: String,
    pub y: String,
    pub clouds: Vec<Cloud>,
    pub front: Vec<[f64; 2]>,
}

impl Scatter {
    /// The range of an axis, widened on both sides by a factor of 1.5 or more.
    fn range(&self, axis: usize) -> std::ops::Range<f64> {
        let points = self.clouds.iter().flat_map(|c| c.points.iter());
        let (low, high) = points.fold((f64::INFINITY, 0.0f64), |(low, high), (p, _)| {
            (low.min(p[axis]), high.max(p[axis]))
        });
        let room = (high / low).powf(0.12).max(1.5);
        low / room..high * room
    }

    /// The picture as a text of SVG; `None` without points.
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
            let mut chart = ChartBuilder::on(&root)
                .margin_top(66)
                .margin_right(24)
                .margin_bottom(8)
                .margin_left(8)
                .x_label_area_size(44)
                .y_label_area_size(66)
                .build_cartesian_2d(self.range(0).log_scale(), self.range(1).log_scale())?;
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
            let mut x = 18;
            for (k, cloud) in self.clouds.iter().enumerate() {
                if cloud.points.is_empty() {
                    continue;
                }
                let [r, g, b] = cloud.colour;
                let colour = RGBColor(r, g, b);
                let line = cloud.points.iter().map(|(p, _)| (p[0], p[1]));
                chart.draw_series(LineSeries::new(line, colour))?;
                // Beside each other's, where two clouds meet.
                let place = (8, 11 * k as i32 - 12);
                chart.draw_series(cloud.points.iter().map(|(p, label)| {
                    EmptyElement::at((p[0], p[1]))
                        + Circle::new((0, 0), 5, colour.filled())
                        + Text::new(label.clone(), place, (FONT, 13).into_font().color(&colour))
                }))?;
                root.draw(&Circle::new((x, 50), 5, colour.filled()))?;
                root.draw(&Text::new(cloud.label.clone(), (x + 12, 42), font.clone()))?;
                x += 34 + (7.8 * cloud.label.chars().count() as f64) as i32;
            }
            root.present()?;
        }
        Ok(Some(text))
    }
}

/// At most three digits, no exponent where people write none; nothing but for 1, 2 and 5, so that
/// labels do not run into each other.
fn plain(value: f64) -> String {
    let first = value / 10f64.powf((value.log10() + 1e-9).floor());
    if ![1.0, 2.0, 5.0]
        .iter()
        .any(|digit| (first / digit - 1.0).abs() < 1e-6)
    {
        return String::new();
    }
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 4.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        let text = text.trim_end_matches('0').trim_end_matches('.');
        return text.to_owned();
    }
    text
}
