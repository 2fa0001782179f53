//! A picture: pixels, antialiased strokes, lettering, PNG.

use std::io::Write;

use super::sheet::font::{self, Look};
use crate::record::mark::MARK;

/// Red, green, blue.
pub type Colour = [u8; 3];

/// Background.
pub const WHITE: Colour = [255, 255, 255];
/// Text and lines.
pub const INK: Colour = [38, 44, 52];
/// Secondary lines.
pub const FAINT: Colour = [196, 202, 210];

/// Rows of pixels from the top.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    pixels: Vec<Colour>,
}

/// Alignment of a text at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It starts at the point.
    Left,
    /// It is centred on the point.
    Middle,
    /// It ends at the point.
    Right,
}

impl Canvas {
    /// A picture of one colour.
    pub fn new(width: usize, height: usize, colour: Colour) -> Canvas {
        Canvas {
            width,
            height,
            pixels: vec![colour; width * height],
        }
    }

    /// A picture of rows of equal length.
    pub fn from_rows(rows: &[Vec<Colour>]) -> Canvas {
        Canvas {
            width: rows.first().map_or(0, Vec::len),
            height: rows.len(),
            pixels: rows.concat(),
        }
    }

    /// Colours of all pixels, row by row from the top.
    pub fn pixels(&self) -> &[Colour] {
        &self.pixels
    }

    /// Colour of a pixel; `x < width`, `y < height`.
    pub fn get(&self, x: usize, y: usize) -> Colour {
        self.pixels[y * self.width + x]
    }

    /// Sets the colour of a pixel; `x < width`, `y < height`.
    pub fn set(&mut self, x: usize, y: usize, colour: Colour) {
        self.pixels[y * self.width + x] = colour;
    }

    /// Mixes a colour into a pixel; has no effect outside the picture.
    pub fn blend(&mut self, x: i64, y: i64, colour: Colour, part: f32) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 || part <= 0.0 {
            return;
        }
        let pixel = &mut self.pixels[y as usize * self.width + x as usize];
        for (old, new) in pixel.iter_mut().zip(colour) {
            let mixed = f32::from(*old) + part.min(1.0) * (f32::from(new) - f32::from(*old));
            *old = mixed.round() as u8;
        }
    }

    /// Fills a rectangle with its corners at `low` and `high`, pixels.
    pub fn rectangle(&mut self, low: [f32; 2], high: [f32; 2], colour: Colour) {
        for y in low[1].round() as i64..high[1].round() as i64 {
            for x in low[0].round() as i64..high[0].round() as i64 {
                self.blend(x, y, colour, 1.0);
            }
        }
    }

    /// A ball lit from the upper left.
    pub fn ball(&mut self, at: [f32; 2], radius: f32, colour: Colour) {
        let reach = radius + 1.0;
        for y in (at[1] - reach).floor() as i64..=(at[1] + reach).ceil() as i64 {
            for x in (at[0] - reach).floor() as i64..=(at[0] + reach).ceil() as i64 {
                let (dx, dy) = (x as f32 + 0.5 - at[0], y as f32 + 0.5 - at[1]);
                let distance = dx.hypot(dy);
                let part = (radius + 0.5 - distance).clamp(0.0, 1.0);
                if part > 0.0 {
                    let q = (distance / radius).min(1.0);
                    let up = (1.0 - q * q).sqrt();
                    let light = 0.66 + 0.34 * up - 0.1 * (dx + dy) / radius;
                    self.blend(x, y, shade(colour, light), part);
                }
            }
        }
    }

    /// Straight line from `a` to `b`, `width` pixels wide.
    pub fn line(&mut self, a: [f32; 2], b: [f32; 2], width: f32, colour: Colour) {
        let reach = 0.5 * width + 1.0;
        let low = [0, 1].map(|i| (a[i].min(b[i]) - reach).floor() as i64);
        let high = [0, 1].map(|i| (a[i].max(b[i]) + reach).ceil() as i64);
        let d = [b[0] - a[0], b[1] - a[1]];
        let square = d[0] * d[0] + d[1] * d[1];
        for y in low[1]..=high[1] {
            for x in low[0]..=high[0] {
                let p = [x as f32 + 0.5 - a[0], y as f32 + 0.5 - a[1]];
                let along = if square > 0.0 {
                    ((p[0] * d[0] + p[1] * d[1]) / square).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let distance = (p[0] - along * d[0]).hypot(p[1] - along * d[1]);
                self.blend(x, y, colour, (0.5 + 0.5 * width - distance).clamp(0.0, 1.0));
            }
        }
    }

    /// Writes `text` in letters of `size` pixels; `at` is on the base line.
    pub fn text(&mut self, at: [f32; 2], size: f32, text: &str, anchor: Anchor, colour: Colour) {
        let look = Look::new(f64::from(size), anchor, colour);
        font::write(self, at.map(f64::from), text, look);
    }

    /// Copies another picture into this one, its upper left corner at (x, y); clipped.
    pub fn paste(&mut self, x: usize, y: usize, other: &Canvas) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            for column in 0..other.width.min(self.width.saturating_sub(x)) {
                self.set(x + column, y + row, other.get(column, row));
            }
        }
    }

    /// Each pixel as a block of so many columns and rows.
    pub fn enlarged(&self, [columns, rows]: [usize; 2]) -> Canvas {
        let mut large = Canvas::new(columns * self.width, rows * self.height, WHITE);
        for y in 0..large.height {
            for x in 0..large.width {
                large.set(x, y, self.get(x / columns, y / rows));
            }
        }
        large
    }

    /// Half the size, each pixel the mean of four.
    pub fn halved(&self) -> Canvas {
        let mut half = Canvas::new(self.width / 2, self.height / 2, WHITE);
        for y in 0..half.height {
            for x in 0..half.width {
                let mut sum = [0u16; 3];
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let pixel = self.get(2 * x + dx, 2 * y + dy);
                    for (total, value) in sum.iter_mut().zip(pixel) {
                        *total += u16::from(value);
                    }
                }
                half.set(x, y, sum.map(|s| ((s + 2) / 4) as u8));
            }
        }
        half
    }

    /// The picture as a PNG file.
    ///
    /// # Errors
    /// If the PNG encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.add_text_chunk("Software".to_string(), MARK.to_string())?;
        let mut writer = encoder.write_header()?;
        let mut stream = writer.stream_writer()?;
        stream.write_all(self.pixels.as_flattened())?;
        stream.finish()?;
        writer.finish()?;
        Ok(bytes)
    }
}

/// A colour times a brightness.
pub fn shade(colour: Colour, light: f32) -> Colour {
    colour.map(|c| (f32::from(c) * light).clamp(0.0, 255.0) as u8)
}
