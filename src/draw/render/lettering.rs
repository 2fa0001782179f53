//! Texts in pictures: any letters of the font Ubuntu, antialiased.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use epaint_default_fonts::UBUNTU_LIGHT;

use crate::draw::canvas::{Anchor, Canvas, Colour};

/// Writes `text` with its base line at `at`, pixels; `size`: from the lowest to the highest letter.
/// Letters that the font lacks are drawn as boxes.
pub fn write(canvas: &mut Canvas, at: [f32; 2], size: f32, text: &str, look: (Anchor, Colour)) {
    let Ok(font) = FontRef::try_from_slice(UBUNTU_LIGHT) else {
        return;
    };
    let (anchor, colour) = look;
    let scaled = font.as_scaled(PxScale::from(size));
    let mut glyphs: Vec<Glyph> = Vec::new();
    let mut x = 0.0;
    for letter in text.chars() {
        let id = scaled.glyph_id(letter);
        if let Some(before) = glyphs.last() {
            x += scaled.kern(before.id, id);
        }
        glyphs.push(id.with_scale_and_position(PxScale::from(size), point(x, 0.0)));
        x += scaled.h_advance(id);
    }
    let left = match anchor {
        Anchor::Left => at[0],
        Anchor::Middle => at[0] - 0.5 * x,
        Anchor::Right => at[0] - x,
    };
    for mut glyph in glyphs {
        glyph.position.x += left;
        glyph.position.y += at[1];
        let Some(outline) = font.outline_glyph(glyph) else {
            continue;
        };
        let corner = outline.px_bounds().min;
        outline.draw(|x, y, part| {
            let [x, y] =
                [(corner.x as i64, x), (corner.y as i64, y)].map(|(c, d)| c + i64::from(d));
            // A light font on a busy picture: a little stronger.
            canvas.blend(x, y, colour, (1.35 * part).min(1.0));
        });
    }
}
