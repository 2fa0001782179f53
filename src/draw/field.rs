//! Pressure and velocity averaged about the axis, as in Figs. 8 and 9 of Nishio et al. 2010.
//!
//! Particles are distributed to bins of one spacing by their distance from the axis and height
//! (2-D: by |x|, left and right mirrored onto each other), each linearly to the four nearest bins,
//! so that rows of particles leave no gaps. A bin is liquid if it contains two fifths of the
//! particles that would fill it.

use super::canvas::{Anchor, Canvas, Colour, FAINT, INK, WHITE};
use crate::measure::pool::Axis;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene, Side};

/// Means over one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// Number of particles.
    pub count: f64,
    /// Pa.
    pub pressure: f64,
    /// Radial (outward) and vertical, m/s.
    pub velocity: [f64; 2],
}

/// The four bins nearest to a position in bins, and their weights; axis and floor reflect.
fn shares(place: [f64; 2]) -> [([usize; 2], f64); 4] {
    let low = place.map(|x| (x - 0.5).floor());
    std::array::from_fn(|k| {
        let upper = [k & 1, k >> 1];
        let axis = |a: usize| {
            let part = (place[a] - 0.5) - low[a];
            let at = low[a] + upper[a] as f64;
            (at.max(0.0) as usize, [1.0 - part, part][upper[a]])
        };
        let ((r, a), (z, b)) = (axis(0), axis(1));
        ([r, z], a * b)
    })
}

/// A field of bins, r fastest.
pub struct Field {
    /// Caption.
    pub label: String,
    /// Bins along r and z.
    pub count: [usize; 2],
    /// Edge of a bin, m.
    pub edge: f64,
    bins: Vec<Option<Bin>>,
}

impl Field {
    /// Averages `frame` over the azimuth about `axis` (2-D: over both sides).
    pub fn new(scene: &Scene, frame: &Frame, axis: &Axis, label: String) -> Field {
        let edge = scene.spacing;
        let flat = scene.dimension == Dimension::Two;
        let size = scene.domain.size;
        let reach = 0.5 * if flat { size[0] } else { size[0].min(size[1]) };
        let finite = frame.position[2].iter().copied().filter(|z| z.is_finite());
        let top = f64::from(finite.fold(0.0, f32::max));
        let count = [(reach / edge) as usize, (top / edge) as usize + 1];
        let mut bins = vec![Bin::default(); count[0] * count[1]];
        for i in 0..frame.id.len() {
            let d = offset(scene, axis, frame, i);
            let r = d[0].hypot(d[1]);
            let place = [r / edge, f64::from(frame.position[2][i]) / edge];
            if !(place[0].is_finite() && place[1] >= 0.0) {
                continue;
            }
            let v = [0, 1, 2].map(|a| f64::from(frame.velocity[a][i]));
            let outward = if r > 0.0 {
                (d[0] * v[0] + d[1] * v[1]) / r
            } else {
                0.0
            };
            for ([r, z], share) in shares(place) {
                if r >= count[0] || z >= count[1] {
                    continue;
                }
                let bin = &mut bins[z * count[0] + r];
                bin.count += share;
                bin.pressure += share * f64::from(frame.pressure[i]);
                bin.velocity[0] += share * outward;
                bin.velocity[1] += share * v[2];
            }
        }
        let full = |i: usize| {
            let ring = std::f64::consts::PI * (2 * i + 1) as f64;
            if flat { 2.0 } else { ring }
        };
        let mean = |(place, bin): (usize, &Bin)| {
            let enough = bin.count >= 0.4 * full(place % count[0]);
            enough.then(|| Bin {
                count: bin.count,
                pressure: bin.pressure / bin.count,
                velocity: bin.velocity.map(|v| v / bin.count),
            })
        };
        let bins = bins.iter().enumerate().map(mean).collect();
        Field {
            label,
            count,
            edge,
            bins,
        }
    }

    /// Means of a bin, `None` in gas and outside.
    pub fn bin(&self, r: usize, z: usize) -> Option<Bin> {
        let inside = r < self.count[0] && z < self.count[1];
        if inside {
            self.bins[z * self.count[0] + r]
        } else {
            None
        }
    }

    /// Height that contains all but a thousandth of the liquid bins, m.
    pub fn top(&self) -> f64 {
        let rows = |z: usize| {
            (0..self.count[0])
                .filter(|&r| self.bin(r, z).is_some())
                .count()
        };
        let counts: Vec<usize> = (0..self.count[1]).map(rows).collect();
        let spare = counts.iter().sum::<usize>() / 1000;
        let mut above = 0;
        let last = (0..counts.len()).rev().find(|&z| {
            above += counts[z];
            above > spare
        });
        last.map_or(0.0, |z| (z + 1) as f64 * self.edge)
    }

    /// Draws the field, mirrored about the axis, up to `top`; z counts from `level`, m.
    pub fn draw(&self, top: f64, level: f64) -> Canvas {
        let reach = self.count[0] as f64 * self.edge;
        let scale = PLOT / (2.0 * reach);
        let height = ((top + 2.0 * self.edge) * scale).clamp(140.0, 1200.0);
        let width = (LEFT + PLOT + RIGHT) as usize;
        let full = (TOP + height + BOTTOM) as usize;
        let mut sheet = Sheet {
            canvas: Canvas::new(width, full, WHITE),
            scale,
            reach,
            base: TOP + height,
        };
        let range = self.pressure_range();
        self.paint(&mut sheet, range);
        let speed = self.draw_arrows(&mut sheet);
        sheet.draw_axes(level, height / scale);
        sheet.draw_bar(range);
        sheet.draw_key(speed, self.arrow_stride(scale) as f64 * self.edge * scale);
        let at = [LEFT as f32 + 12.0, 26.0];
        sheet.canvas.text(at, 17.0, &self.label, Anchor::Left, INK);
        sheet.canvas
    }

    /// From the lowest (at most zero) to nearly the highest pressure, Pa.
    fn pressure_range(&self) -> [f64; 2] {
        let mut all: Vec<f64> = self.bins.iter().flatten().map(|b| b.pressure).collect();
        all.sort_by(f64::total_cmp);
        let at = |part: f64| {
            let place = (part * all.len().saturating_sub(1) as f64) as usize;
            all.get(place).copied().unwrap_or(0.0)
        };
        let low = at(0.005).min(0.0);
        [low, at(0.995).max(low + 1.0)]
    }

    fn paint(&self, sheet: &mut Sheet, range: [f64; 2]) {
        let [left, right] = [-sheet.reach, sheet.reach].map(|r| sheet.place(r, 0.0)[0] as i64);
        for y in TOP as i64..sheet.base as i64 {
            for x in left..right {
                let z = (sheet.base - y as f64 - 0.5) / sheet.scale;
                let r = ((x as f64 + 0.5 - LEFT) / sheet.scale - sheet.reach).abs();
                let bin = self.bin((r / self.edge) as usize, (z / self.edge) as usize);
                if let Some(bin) = bin {
                    let part = (bin.pressure - range[0]) / (range[1] - range[0]);
                    sheet.canvas.blend(x, y, map(part), 1.0);
                }
            }
        }
    }

    /// Bins between arrows.
    fn arrow_stride(&self, scale: f64) -> usize {
        (25.0 / (self.edge * scale)).round().max(1.0) as usize
    }

    /// Returns the speed whose arrow is as long as the distance of arrows.
    fn draw_arrows(&self, sheet: &mut Sheet) -> f64 {
        let stride = self.arrow_stride(sheet.scale);
        let mut arrows = Vec::new();
        for z in (0..self.count[1]).step_by(stride) {
            for r in (0..self.count[0]).step_by(stride) {
                let cells = (0..stride * stride).map(|n| (r + n % stride, z + n / stride));
                let bins: Vec<Bin> = cells.filter_map(|(r, z)| self.bin(r, z)).collect();
                if 2 * bins.len() < stride * stride {
                    continue;
                }
                let mean = |a: usize| {
                    bins.iter().fold(0.0, |sum, b| sum + b.velocity[a]) / bins.len() as f64
                };
                let middle = |n: usize| (n as f64 + 0.5 * stride as f64) * self.edge;
                arrows.push(([middle(r), middle(z)], [mean(0), mean(1)]));
            }
        }
        let mut speeds: Vec<f64> = arrows.iter().map(|(_, v)| v[0].hypot(v[1])).collect();
        speeds.sort_by(f64::total_cmp);
        let high = speeds.get(speeds.len() * 97 / 100).copied().unwrap_or(0.0);
        let unit = round_number(high.max(1e-6));
        let length = stride as f64 * self.edge * sheet.scale / unit;
        for ([r, z], v) in arrows {
            for side in [-1.0, 1.0] {
                let from = sheet.place(side * r, z).map(|c| c as f32);
                let limit = (2.5 * unit / v[0].hypot(v[1]).max(1e-12)).min(1.0) * length;
                let d = [side * v[0] * limit, -v[1] * limit].map(|c| c as f32);
                let to = [from[0] + d[0], from[1] + d[1]];
                sheet.canvas.arrow(from, to, 1.3, [24, 26, 30]);
            }
        }
        unit
    }
}

const LEFT: f64 = 70.0;
const RIGHT: f64 = 130.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 60.0;
const PLOT: f64 = 720.0;

/// Placement of a field: pixels per metre, half width in m, row of z = 0.
struct Sheet {
    canvas: Canvas,
    scale: f64,
    reach: f64,
    base: f64,
}

impl Sheet {
    fn place(&self, r: f64, z: f64) -> [f64; 2] {
        [
            LEFT + (r + self.reach) * self.scale,
            self.base - z * self.scale,
        ]
    }

    fn draw_axes(&mut self, level: f64, top: f64) {
        let [left, base] = self.place(-self.reach, 0.0).map(|c| c as f32);
        let right = self.place(self.reach, 0.0)[0] as f32;
        self.canvas.line([left, base], [right, base], 1.4, INK);
        self.canvas.line([left, base], [left, TOP as f32], 1.4, INK);
        let step = round_number(2e3 * self.reach / 6.0);
        for n in -20i32..=20 {
            let r = 1e-3 * step * f64::from(n);
            if r.abs() <= self.reach * 1.0001 {
                let x = self.place(r, 0.0)[0] as f32;
                self.canvas.line([x, base], [x, base + 5.0], 1.4, INK);
                let text = tick(step * f64::from(n), step);
                self.canvas
                    .text([x, base + 21.0], 12.0, &text, Anchor::Middle, INK);
            }
            let z = level + 1e-3 * step * f64::from(n);
            if z >= 0.0 && z <= top {
                let y = self.place(0.0, z)[1] as f32;
                self.canvas.line([left - 5.0, y], [left, y], 1.4, INK);
                let text = tick(step * f64::from(n), step);
                self.canvas
                    .text([left - 9.0, y + 6.0], 12.0, &text, Anchor::Right, INK);
            }
        }
        let middle = 0.5 * (left + right);
        self.canvas
            .text([middle, base + 46.0], 13.0, "r (mm)", Anchor::Middle, INK);
        self.canvas
            .text([6.0, TOP as f32 - 12.0], 13.0, "z (mm)", Anchor::Left, INK);
    }

    /// Colour bar on the right.
    fn draw_bar(&mut self, range: [f64; 2]) {
        let left = (LEFT + PLOT + 28.0) as f32;
        let (top, base) = (TOP as f32 + 34.0, self.base as f32);
        let rows = (base - top) as i64;
        for row in 0..rows {
            let colour = map(1.0 - row as f64 / rows as f64);
            let y = top + row as f32;
            self.canvas
                .rectangle([left, y], [left + 16.0, y + 1.0], colour);
        }
        let (factor, unit) = if range[1] >= 2000.0 {
            (1e-3, "kPa")
        } else {
            (1.0, "Pa")
        };
        let [low, high] = range.map(|p| p * factor);
        let step = round_number((high - low) / 5.0);
        let first = (low / step).ceil() as i64;
        for n in first..=(high / step).floor() as i64 {
            let value = n as f64 * step;
            let y = base - ((value - low) / (high - low)) as f32 * rows as f32;
            self.canvas
                .line([left + 16.0, y], [left + 21.0, y], 1.4, INK);
            let text = tick(value, step);
            self.canvas
                .text([left + 26.0, y + 6.0], 12.0, &text, Anchor::Left, INK);
        }
        self.canvas.text(
            [left, top - 12.0],
            13.0,
            &format!("p ({unit})"),
            Anchor::Left,
            INK,
        );
    }

    fn draw_key(&mut self, speed: f64, length: f64) {
        let right = (LEFT + PLOT) as f32;
        let from = [right - 110.0 - length as f32, 20.0];
        self.canvas.arrow(from, [right - 110.0, 20.0], 1.6, INK);
        let text = format!("{} m/s", tick(speed, speed));
        self.canvas
            .text([right - 100.0, 26.0], 13.0, &text, Anchor::Left, INK);
        self.canvas
            .line([LEFT as f32, 38.0], [right, 38.0], 1.0, FAINT);
    }
}

fn offset(scene: &Scene, axis: &Axis, frame: &Frame, i: usize) -> [f64; 2] {
    [0, 1].map(|a| {
        if a == 1 && scene.dimension == Dimension::Two {
            return 0.0;
        }
        let d = f64::from(frame.position[a][i]) - axis.at[a];
        let length = scene.domain.size[a];
        match scene.domain.boundary[a][0] {
            Side::Periodic => d - length * (d / length).round(),
            _ => d,
        }
    })
}

/// The nearest of 1, 2, 5 times a power of ten.
fn round_number(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let part = value / power;
    power
        * if part < 1.5 {
            1.0
        } else if part < 3.5 {
            2.0
        } else if part < 7.5 {
            5.0
        } else {
            10.0
        }
}

fn tick(value: f64, step: f64) -> String {
    let digits = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    if value == 0.0 {
        text.replace('-', "")
    } else {
        text
    }
}

/// Dark blue over green to yellow, with even steps of lightness; light enough for dark arrows.
fn map(part: f64) -> Colour {
    const STOPS: [[f64; 3]; 6] = [
        [70.0, 92.0, 160.0],
        [62.0, 134.0, 178.0],
        [72.0, 176.0, 166.0],
        [132.0, 206.0, 130.0],
        [208.0, 226.0, 104.0],
        [254.0, 240.0, 150.0],
    ];
    let place = part.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let low = (place as usize).min(STOPS.len() - 2);
    let t = place - low as f64;
    std::array::from_fn(|c| (STOPS[low][c] + t * (STOPS[low + 1][c] - STOPS[low][c])) as u8)
}
