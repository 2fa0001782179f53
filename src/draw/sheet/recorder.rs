//! The drawing library's view of a figure. Its coordinates are whole numbers, so they are
//! hundredths of a point here.

use std::convert::Infallible;

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle};
use plotters_backend::{DrawingBackend, DrawingErrorKind, FontStyle, FontTransform};

use super::{Sheet, Text, Weight};
use crate::draw::canvas::{Anchor, Colour};

/// Units of the library in a point.
pub const UNIT: f64 = 100.0;

/// Adds what is drawn to a figure.
pub struct Recorder<'a> {
    /// The figure.
    pub sheet: &'a mut Sheet,
}

/// Nothing here can fail but a font of the library, which is not used.
type Done = Result<(), DrawingErrorKind<Infallible>>;

fn place((x, y): BackendCoord) -> [f64; 2] {
    [x, y].map(|c| f64::from(c) / UNIT)
}

fn colour(colour: BackendColor) -> Option<Colour> {
    let (r, g, b) = colour.rgb;
    (colour.alpha > 0.0).then_some([r, g, b])
}

fn width<S: BackendStyle>(style: &S) -> f64 {
    f64::from(style.stroke_width()) / UNIT
}

impl DrawingBackend for Recorder<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        let [width, height] = self.sheet.size.map(|length| (length * UNIT).round() as u32);
        (width, height)
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, colour: BackendColor) -> Done {
        let low = place(point);
        if let Some(colour) = self::colour(colour) {
            self.sheet
                .rectangle(low, low.map(|c| c + 1.0 / UNIT), colour);
        }
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S) -> Done {
        self.draw_path([a, b], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        a: BackendCoord,
        b: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Done {
        match fill {
            true => self.fill_polygon([a, (b.0, a.1), b, (a.0, b.1)], style),
            false => self.draw_path([a, (b.0, a.1), b, (a.0, b.1), a], style),
        }
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        if let Some(colour) = colour(style.color()) {
            let points = path.into_iter().map(place).collect();
            self.sheet.line(points, width(style), colour);
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Done {
        if let Some(colour) = colour(style.color()) {
            let width = (!fill).then(|| width(style));
            let radius = f64::from(radius) / UNIT;
            self.sheet.circle(place(center), radius, width, colour);
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Done {
        if let Some(colour) = colour(style.color()) {
            self.sheet
                .area(vert.into_iter().map(place).collect(), colour);
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, at: BackendCoord) -> Done {
        let Some(colour) = colour(style.color()) else {
            return Ok(());
        };
        let (size, anchor) = (style.size() / UNIT, style.anchor());
        // Heights of capitals, of their middle, and of tails.
        let down = size
            * match anchor.v_pos {
                VPos::Top => 0.76,
                VPos::Center => 0.36,
                VPos::Bottom => -0.24,
            };
        let is_upright = matches!(style.transform(), FontTransform::Rotate270);
        let [x, y] = place(at);
        self.sheet.text(Text {
            at: if is_upright {
                [x + down, y]
            } else {
                [x, y + down]
            },
            size,
            text: text.to_owned(),
            anchor: match anchor.h_pos {
                HPos::Left => Anchor::Left,
                HPos::Center => Anchor::Middle,
                HPos::Right => Anchor::Right,
            },
            weight: weight(style),
            is_upright,
            colour,
        });
        Ok(())
    }

    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let length = style.size() * weight(style).length(text);
        Ok((length.ceil() as u32, style.size().ceil() as u32))
    }
}

fn weight<S: BackendTextStyle>(style: &S) -> Weight {
    match style.style() {
        FontStyle::Bold => Weight::Bold,
        _ => Weight::Regular,
    }
}
