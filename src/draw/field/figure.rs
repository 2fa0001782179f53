//! The figure of a field: colours of pressure, arrows of velocity, axes in mm.

use super::{Bin, Field};
use crate::draw::canvas::{Anchor, Canvas, Colour, INK, WHITE};
use crate::draw::scale::{Plain, Scale, round_number, tick};
use crate::draw::sheet::{POINT, Sheet, Text, Weight};
use crate::scene::FigureStyle;

/// Margins, ems.
const LEFT: f64 = 5.2;
const RIGHT: f64 = 6.6;
const TOP: f64 = 2.6;
const BOTTOM: f64 = 3.4;

/// Distance of arrows, points.
const ARROWS: f64 = 13.0;

/// Colour of arrows.
const DARK: Colour = [24, 26, 30];

/// Scales of all fields of a run, so that they can be compared.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Of pressure, Pa.
    pub pressure: Scale,
    /// Speed of an arrow as long as the distance of arrows, m/s.
    pub speed: f64,
}

impl Scales {
    /// Reach from the lowest to nearly the highest value of all.
    pub fn of(fields: &[Field]) -> Scales {
        let bins = || fields.iter().flat_map(|field| field.bins.iter().flatten());
        let pressures = sorted(bins().map(|bin| bin.pressure));
        let speeds = sorted(bins().map(|bin| bin.velocity[0].hypot(bin.velocity[1])));
        let range = [part(&pressures, 0.005), part(&pressures, 0.995)];
        Scales {
            pressure: Scale::new(range, Plain::Pale),
            speed: round_number(part(&speeds, 0.97).max(1e-6)),
        }
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The value below which a part of all are; 0 of none.
fn part(sorted: &[f64], part: f64) -> f64 {
    let place = (part * sorted.len().saturating_sub(1) as f64) as usize;
    sorted.get(place).copied().unwrap_or(0.0)
}

/// What a figure shows besides the field.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Highest liquid, m.
    pub top: f64,
    /// Height of z = 0, m.
    pub level: f64,
    /// Scales of all figures.
    pub scales: Scales,
}

impl Field {
    /// Draws the field, mirrored about the axis.
    pub fn draw(&self, bounds: &Bounds, style: &FigureStyle) -> Sheet {
        let em = style.font_size;
        let reach = self.count[0] as f64 * self.edge;
        let width = style.width * POINT;
        let scale = (width - (LEFT + RIGHT) * em).max(10.0 * em) / (2.0 * reach);
        // Not higher than three times its width.
        let rows = (bounds.top / self.edge).ceil() as usize + 2;
        let rows = rows.clamp(1, 6 * self.count[0].max(1));
        let height = rows as f64 * self.edge * scale;
        let mut drawing = Drawing {
            sheet: Sheet::new([width, height + (TOP + BOTTOM) * em]),
            em,
            scale,
            reach,
            base: TOP * em + height,
        };
        let (low, high) = (drawing.place(-reach, 0.0), drawing.place(reach, 0.0));
        let picture = self.picture(rows, &bounds.scales.pressure);
        drawing
            .sheet
            .image([low[0], TOP * em], [high[0], drawing.base], picture);
        self.draw_arrows(&mut drawing, bounds.scales.speed);
        drawing.draw_axes(bounds.level, height / scale);
        drawing.draw_bar(&bounds.scales.pressure);
        drawing.draw_key(
            bounds.scales.speed,
            self.arrow_stride(scale) * self.edge * scale,
        );
        let mut title = Text::new([LEFT * em, 1.7 * em], 1.1 * em, &self.label, Anchor::Left);
        title.weight = Weight::Bold;
        drawing.sheet.text(title);
        drawing.sheet
    }

    /// One pixel a bin.
    fn picture(&self, rows: usize, scale: &Scale) -> Canvas {
        let half = self.count[0];
        let mut picture = Canvas::new(2 * half, rows, WHITE);
        for y in 0..rows {
            for x in 0..2 * half {
                let r = if x < half { half - 1 - x } else { x - half };
                if let Some(bin) = self.bin(r, rows - 1 - y) {
                    picture.set(x, y, scale.colour(bin.pressure));
                }
            }
        }
        picture
    }

    /// Bins between arrows.
    fn arrow_stride(&self, scale: f64) -> f64 {
        (ARROWS / (self.edge * scale)).round().max(1.0)
    }

    /// Arrows of mean velocities; `unit`: see [`Scales::speed`].
    fn draw_arrows(&self, drawing: &mut Drawing, unit: f64) {
        let stride = self.arrow_stride(drawing.scale) as usize;
        let length = stride as f64 * self.edge * drawing.scale / unit;
        let mut lines = Vec::new();
        for z in (0..self.count[1]).step_by(stride) {
            for r in (0..self.count[0]).step_by(stride) {
                let cells = (0..stride * stride).map(|n| (r + n % stride, z + n / stride));
                let bins: Vec<Bin> = cells.filter_map(|(r, z)| self.bin(r, z)).collect();
                if 2 * bins.len() < stride * stride {
                    continue;
                }
                let sum = |a: usize| bins.iter().map(|b| b.velocity[a]).sum::<f64>();
                let v = [0, 1].map(|a| sum(a) / bins.len() as f64);
                let middle = |n: usize| (n as f64 + 0.5 * stride as f64) * self.edge;
                let limit = (2.5 * unit / v[0].hypot(v[1]).max(1e-12)).min(1.0) * length;
                for side in [-1.0, 1.0] {
                    let from = drawing.place(side * middle(r), middle(z));
                    let to = [from[0] + side * v[0] * limit, from[1] - v[1] * limit];
                    lines.extend(arrow(from, to));
                }
            }
        }
        lines.retain(|line| line.iter().all(|p| p[1] > 0.0));
        // A light edge, for arrows on dark colours.
        drawing.sheet.lines(lines.clone(), 1.5, [235, 238, 240]);
        drawing.sheet.lines(lines, 0.65, DARK);
    }
}

/// Shaft and head of an arrow; none of one that is too short to see.
fn arrow(from: [f64; 2], to: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = d[0].hypot(d[1]);
    if length < 0.6 {
        return Vec::new();
    }
    let head = (0.36 * length).clamp(1.2, 4.0);
    let u = d.map(|c| c / length);
    let tail = |side: f64| {
        [
            to[0] - head * (u[0] + side * u[1]),
            to[1] - head * (u[1] - side * u[0]),
        ]
    };
    vec![vec![from, to], vec![tail(-0.5), to, tail(0.5)]]
}

/// Placement of a field: points per metre, half width in m, height of z = 0 on the sheet.
struct Drawing {
    sheet: Sheet,
    em: f64,
    scale: f64,
    reach: f64,
    base: f64,
}

impl Drawing {
    fn place(&self, r: f64, z: f64) -> [f64; 2] {
        let left = LEFT * self.em;
        [
            left + (r + self.reach) * self.scale,
            self.base - z * self.scale,
        ]
    }

    fn write(&mut self, at: [f64; 2], text: &str, anchor: Anchor) {
        self.sheet.text(Text::new(at, self.em, text, anchor));
    }

    fn draw_axes(&mut self, level: f64, top: f64) {
        let em = self.em;
        let [left, base] = self.place(-self.reach, 0.0);
        let right = self.place(self.reach, 0.0)[0];
        let frame = vec![[left, TOP * em], [left, base], [right, base]];
        self.sheet.line(frame, 0.7, INK);
        let step = round_number(2e3 * self.reach / 6.0);
        let mut marks = Vec::new();
        for n in -20i32..=20 {
            let text = tick(step * f64::from(n), step);
            let r = 1e-3 * step * f64::from(n);
            if r.abs() <= self.reach * 1.0001 {
                let x = self.place(r, 0.0)[0];
                marks.push(vec![[x, base], [x, base + 3.0]]);
                self.write([x, base + 3.0 + em], &text, Anchor::Middle);
            }
            let z = level + r;
            if z >= 0.0 && z <= top {
                let y = self.place(0.0, z)[1];
                marks.push(vec![[left - 3.0, y], [left, y]]);
                self.write([left - 5.0, y + 0.36 * em], &text, Anchor::Right);
            }
        }
        self.sheet.lines(marks, 0.7, INK);
        let middle = 0.5 * (left + right);
        self.write([middle, base + 2.8 * em], "r (mm)", Anchor::Middle);
        let at = [1.1 * em, 0.5 * (TOP * em + base)];
        let mut label = Text::new(at, em, "z (mm)", Anchor::Middle);
        label.is_upright = true;
        self.sheet.text(label);
    }

    /// Colour bar on the right.
    fn draw_bar(&mut self, scale: &Scale) {
        let em = self.em;
        let left = self.place(self.reach, 0.0)[0] + 1.6 * em;
        let (right, top, base) = (left + 1.1 * em, TOP * em + 1.4 * em, self.base);
        let [low, high] = scale.range;
        let rows = 128;
        let mut bar = Canvas::new(1, rows, WHITE);
        for row in 0..rows {
            let part = 1.0 - (row as f64 + 0.5) / rows as f64;
            bar.set(0, row, scale.colour(low + part * (high - low)));
        }
        self.sheet.image([left, top], [right, base], bar);
        let largest = high.max(-low);
        let (factor, unit) = match largest >= 2000.0 {
            true => (1e-3, "kPa"),
            false => (1.0, "Pa"),
        };
        let [low, high] = scale.range.map(|p| p * factor);
        // Marks of at least two lines' distance.
        let most = ((base - top) / (2.0 * em)).clamp(1.0, 5.0);
        let step = round_number((high - low) / most);
        let mut marks = Vec::new();
        for n in (low / step).ceil() as i64..=(high / step).floor() as i64 {
            let value = n as f64 * step;
            let y = base - (value - low) / (high - low) * (base - top);
            marks.push(vec![[right, y], [right + 3.0, y]]);
            let at = [right + 5.0, y + 0.36 * em];
            self.write(at, &tick(value, step), Anchor::Left);
        }
        self.sheet.lines(marks, 0.7, INK);
        let text = format!("p ({unit})");
        self.write([left, top - 0.6 * em], &text, Anchor::Left);
    }

    /// An arrow of `speed`, m/s, that is `length` points long.
    fn draw_key(&mut self, speed: f64, length: f64) {
        let em = self.em;
        let text = format!("{} m/s", tick(speed, speed));
        let right = self.place(self.reach, 0.0)[0];
        let left = right - Text::new([0.0; 2], em, &text, Anchor::Left).length();
        self.write([left, 1.7 * em], &text, Anchor::Left);
        let end = left - 0.6 * em;
        let key = arrow([end - length, 1.35 * em], [end, 1.35 * em]);
        self.sheet.lines(key, 0.8, INK);
    }
}
