//! What stands over a picture: clock, scale bar, caption, the bar of a colour map.

use crate::draw::canvas::{Anchor, Canvas, Colour, INK};
use crate::draw::scale::Scale;
use crate::draw::sheet::font::Weight;
use crate::measure::moment::moment;

/// Texts on a dark background.
const PALE: Colour = [240, 242, 245];
/// Lengths of scale bars, over a power of ten.
const STEPS: [f64; 3] = [1.0, 2.0, 5.0];

/// Part of the background in the plate behind a text, and its room around the text, in heights of
/// letters.
const PLATE: f32 = 0.75;
const ROOM: f32 = 0.3;

/// Part of the width that a text in the middle may have beside the scale bar.
const BESIDE: f32 = 0.45;

/// A picture to write on.
pub struct Overlay<'a> {
    canvas: &'a mut Canvas,
    background: Colour,
    ink: Colour,
    /// Height of letters, pixels.
    size: f32,
}

impl<'a> Overlay<'a> {
    /// Over a picture with this background.
    pub fn new(canvas: &'a mut Canvas, background: Colour) -> Overlay<'a> {
        let [r, g, b] = background.map(u32::from);
        let is_dark = 2 * r + 5 * g + b < 8 * 110;
        let size = (canvas.height as f32 / 26.0).clamp(11.0, 64.0);
        let ink = if is_dark { PALE } else { INK };
        Overlay {
            canvas,
            background,
            ink,
            size,
        }
    }

    /// A text, which can be read over liquid too.
    fn write(&mut self, [x, y]: [f32; 2], size: f32, text: &str, anchor: Anchor) {
        let length = size * Weight::Regular.length(text) as f32;
        let left = match anchor {
            Anchor::Left => x,
            Anchor::Middle => x - 0.5 * length,
            Anchor::Right => x - length,
        };
        let room = ROOM * size;
        self.plate(
            [left - room, y - 0.8 * size - room],
            [left + length + room, y + 0.25 * size + room],
        );
        self.canvas.text([x, y], size, text, anchor, self.ink);
    }

    fn plate(&mut self, low: [f32; 2], high: [f32; 2]) {
        let [low, high] = [low, high].map(|corner| corner.map(|c| c.round() as i64));
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                self.canvas.blend(x, y, self.background, PLATE);
            }
        }
    }

    /// The instant, in the upper left corner; `time` and the `end` of the run in s.
    pub fn clock(&mut self, time: f64, end: f64) {
        let text = moment(time, end, 1);
        let at = [self.size, 1.6 * self.size];
        self.write(at, self.size, &text, Anchor::Left);
    }

    /// A text in the middle of the lower edge, in smaller letters if it is long; above the scale
    /// bar if it would meet that.
    pub fn caption(&mut self, text: &str) {
        let [width, height] = [self.canvas.width, self.canvas.height].map(|size| size as f32);
        let ems = Weight::Regular.length(text) as f32;
        let size = self.size.min(0.94 * width / ems);
        let row = match size * ems > BESIDE * width {
            true => 3.0,
            false => 1.0,
        };
        let at = [0.5 * width, height - row * self.size];
        self.write(at, size, text, Anchor::Middle);
    }

    /// A bar of a round length in the lower left corner; `pixel`: metres.
    pub fn scale(&mut self, pixel: f64) {
        let most = 0.2 * self.canvas.width as f64 * pixel;
        let power = 10f64.powi(most.log10().floor() as i32);
        let steps = STEPS.iter().rev().map(|step| step * power);
        let length = steps
            .into_iter()
            .find(|length| *length <= most)
            .unwrap_or(power);
        let text = match length {
            l if l < 0.999e-3 => format!("{:.0} µm", 1e6 * l),
            l if l < 0.999 => format!("{:.0} mm", 1e3 * l),
            l => format!("{l:.0} m"),
        };
        let (left, y) = (self.size, self.canvas.height as f32 - self.size);
        let right = left + (length / pixel) as f32;
        let at = [0.5 * (left + right), y - 0.4 * self.size];
        self.write(at, self.size, &text, Anchor::Middle);
        let room = ROOM * self.size;
        self.plate(
            [left - room, y - 0.12 * self.size],
            [right + room, y + room],
        );
        self.canvas
            .line([left, y], [right, y], 0.16 * self.size, self.ink);
    }

    /// The bar of a colour map, along the right edge; `unit`: of the values over `factor`.
    pub fn colours(&mut self, scale: &Scale, factor: f64, unit: &str) {
        let (width, height) = (self.canvas.width as f32, self.canvas.height as f32);
        let (top, bottom) = (0.25 * height, 0.75 * height);
        let [left, right] = [width - 1.6 * self.size, width - self.size];
        let [low, high] = scale.range;
        let row_of = |value: f64| bottom - ((value - low) / (high - low)) as f32 * (bottom - top);
        for row in top as usize..bottom as usize {
            let part = f64::from((bottom - row as f32) / (bottom - top));
            let at = [left, row as f32];
            let colour = scale.colour(low + part * (high - low));
            self.canvas.rectangle(at, [right, row as f32 + 1.0], colour);
        }
        let size = 0.8 * self.size;
        let text = |value: f64| match value / factor {
            v if v.abs() >= 100.0 => format!("{v:.0} {unit}"),
            0.0 => format!("0 {unit}"),
            v => format!("{v:.2} {unit}").replace('-', "\u{2212}"),
        };
        let mut write = |value, at| self.write(at, size, &text(value), Anchor::Right);
        write(high, [right, top - 0.5 * size]);
        write(low, [right, bottom + 1.2 * size]);
        if low < 0.0 {
            write(0.0, [left - 0.4 * size, row_of(0.0) + 0.36 * size]);
        }
    }
}
