//! The letters of all figures and pictures: DejaVu Sans, of which the program has a copy.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, PxScale, point};

use crate::draw::canvas::{Anchor, Canvas, Colour};

/// Thickness of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Weight {
    /// For nearly everything.
    Regular,
    /// For titles.
    Bold,
}

static FACES: LazyLock<[FontRef<'static>; 2]> = LazyLock::new(|| {
    [Weight::Regular, Weight::Bold]
        .map(|weight| FontRef::try_from_slice(weight.data()).expect("the program's own font"))
});

/// A letter of a text.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Number of its shape in the font.
    pub id: GlyphId,
    /// The letter.
    pub letter: char,
    /// Distance from the begin of the text, em.
    pub at: f64,
}

impl Weight {
    /// The font file.
    pub fn data(self) -> &'static [u8] {
        match self {
            Weight::Regular => dejavu::sans::regular(),
            Weight::Bold => dejavu::sans::bold(),
        }
    }

    /// The font.
    pub fn face(self) -> &'static FontRef<'static> {
        &FACES[self as usize]
    }

    /// Units of the font in an em.
    pub fn units(self) -> f64 {
        f64::from(self.face().units_per_em().expect("a font with a scale"))
    }

    /// The letters of a text with their places, and its length, em.
    pub fn set(self, text: &str) -> (Vec<Placed>, f64) {
        let (face, units) = (self.face(), self.units());
        let mut letters: Vec<Placed> = Vec::new();
        let mut at = 0.0;
        for letter in text.chars() {
            let id = face.glyph_id(letter);
            if let Some(before) = letters.last() {
                at += f64::from(face.kern_unscaled(before.id, id)) / units;
            }
            letters.push(Placed { id, letter, at });
            at += f64::from(face.h_advance_unscaled(id)) / units;
        }
        (letters, at)
    }

    /// Length of a text, em.
    pub fn length(self, text: &str) -> f64 {
        self.set(text).1
    }

    /// Whether the font has the letter.
    pub fn has(self, letter: char) -> bool {
        self.face().glyph_id(letter).0 != 0
    }
}

/// How a text is written into a picture.
#[derive(Clone, Copy)]
pub struct Look {
    /// Size of the letters: an em, pixels.
    pub size: f64,
    /// Alignment at its point.
    pub anchor: Anchor,
    /// Thickness of the letters.
    pub weight: Weight,
    /// Whether the text runs upwards.
    pub is_upright: bool,
    /// Colour of the letters.
    pub colour: Colour,
}

impl Look {
    /// Regular letters from left to right.
    pub fn new(size: f64, anchor: Anchor, colour: Colour) -> Look {
        Look {
            size,
            anchor,
            weight: Weight::Regular,
            is_upright: false,
            colour,
        }
    }
}

/// Writes `text` with its base line at `at`, pixels. Letters that the font lacks are boxes.
pub fn write(canvas: &mut Canvas, at: [f64; 2], text: &str, look: Look) {
    let face = look.weight.face();
    let (letters, length) = look.weight.set(text);
    let before = match look.anchor {
        Anchor::Left => 0.0,
        Anchor::Middle => 0.5 * length,
        Anchor::Right => length,
    };
    // The library's size is from the lowest to the highest line of the font.
    let scale = look.size * f64::from(face.height_unscaled()) / look.weight.units();
    let [whole, part] = [at.map(f64::floor), at.map(|c| c - c.floor())];
    let place = |x: i64, y: i64| match look.is_upright {
        true => [whole[0] as i64 + y, whole[1] as i64 - x],
        false => [whole[0] as i64 + x, whole[1] as i64 + y],
    };
    for letter in letters {
        let x = look.size * (letter.at - before);
        let [x, y] = match look.is_upright {
            true => [x - part[1], part[0]],
            false => [x + part[0], part[1]],
        };
        let scale = PxScale::from(scale as f32);
        let glyph = letter
            .id
            .with_scale_and_position(scale, point(x as f32, y as f32));
        let Some(outline) = face.outline_glyph(glyph) else {
            continue;
        };
        let corner = outline.px_bounds().min;
        outline.draw(|x, y, cover| {
            let [x, y] = [
                corner.x as i64 + i64::from(x),
                corner.y as i64 + i64::from(y),
            ];
            let [x, y] = place(x, y);
            canvas.blend(x, y, look.colour, cover);
        });
    }
}
