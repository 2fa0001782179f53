//! A figure as a PDF page of its size. The letters that it uses are embedded as fonts (ISO 32000-1,
//! 9.7, "Composite fonts").

use std::collections::BTreeMap;

use ab_glyph::Font;
use pdf_writer::types::{CidFontType, FontFlags, LineCapStyle, LineJoinStyle};
use pdf_writer::types::{SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::GlyphRemapper;

use super::{Shape, Sheet, Text, Weight, round};
use crate::draw::canvas::{Canvas, Colour};

/// Of the numbers of letters in a font.
const IDENTITY: SystemInfo = SystemInfo {
    registry: Str(b"Adobe"),
    ordering: Str(b"Identity"),
    supplement: 0,
};

/// Where the objects of the file have their numbers from.
const FONTS: i32 = 10;
const FONT_OBJECTS: i32 = 5;
const IMAGES: i32 = 30;

/// The letters of a font that the figure uses, in new numbers.
#[derive(Default)]
struct Used {
    numbers: GlyphRemapper,
    /// By new number: the letter, and its width in thousandths of an em.
    letters: BTreeMap<u16, (char, f32)>,
}

pub fn bytes(sheet: &Sheet) -> Vec<u8> {
    let [catalog, pages, page_id, content_id] = [1, 2, 3, 4].map(Ref::new);
    let mut fonts: BTreeMap<Weight, Used> = BTreeMap::new();
    let (content, images) = draw(sheet, &mut fonts);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page_id]).count(1);
    let mut page = pdf.page(page_id);
    let [width, height] = sheet.size.map(|length| length as f32);
    page.media_box(Rect::new(0.0, 0.0, width, height));
    page.parent(pages).contents(content_id);
    let mut resources = page.resources();
    let mut list = resources.fonts();
    for weight in fonts.keys() {
        list.pair(name(*weight), font_id(*weight, 0));
    }
    list.finish();
    let mut list = resources.x_objects();
    for number in 0..images.len() {
        list.pair(Name(image_name(number).as_bytes()), image_id(number));
    }
    list.finish();
    resources.finish();
    page.finish();
    pdf.stream(content_id, &content.finish());
    for (weight, used) in &fonts {
        write_font(&mut pdf, *weight, used);
    }
    for (number, picture) in images.into_iter().enumerate() {
        let pixels = picture.pixels().as_flattened();
        let mut image = pdf.image_xobject(image_id(number), pixels);
        image
            .width(picture.width as i32)
            .height(picture.height as i32);
        image.color_space().device_rgb();
        image.bits_per_component(8);
    }
    pdf.finish()
}

/// The page's content, and its pictures.
fn draw<'a>(sheet: &'a Sheet, fonts: &mut BTreeMap<Weight, Used>) -> (Content, Vec<&'a Canvas>) {
    let mut content = Content::new();
    let mut images = Vec::new();
    content.set_line_join(LineJoinStyle::RoundJoin);
    content.set_line_cap(LineCapStyle::ButtCap);
    let height = sheet.size[1];
    let place = |p: &[f64; 2]| [p[0] as f32, (height - p[1]) as f32];
    for shape in &sheet.shapes {
        match shape {
            Shape::Lines {
                lines,
                width,
                colour,
            } => {
                let [r, g, b] = part(*colour);
                content
                    .set_stroke_rgb(r, g, b)
                    .set_line_width(*width as f32);
                lines
                    .iter()
                    .for_each(|line| trace(&mut content, line, &place));
                content.stroke();
            }
            Shape::Area { points, colour } => {
                let [r, g, b] = part(*colour);
                content.set_fill_rgb(r, g, b);
                trace(&mut content, points, &place);
                content.close_path().fill_even_odd();
            }
            Shape::Circle {
                at,
                radius,
                width,
                colour,
            } => {
                let [r, g, b] = part(*colour);
                content.set_stroke_rgb(r, g, b).set_fill_rgb(r, g, b);
                content.set_line_width(width.unwrap_or(0.0) as f32);
                trace(&mut content, &round(*at, *radius), &place);
                match width {
                    Some(_) => content.close_and_stroke(),
                    None => content.close_path().fill_even_odd(),
                };
            }
            Shape::Text(text) => {
                let used = fonts.entry(text.weight).or_default();
                write_text(&mut content, text, place(&text.start()), used);
            }
            Shape::Image { low, high, picture } => {
                let ([left, top], [right, bottom]) = (place(low), place(high));
                content.save_state();
                content.transform([right - left, 0.0, 0.0, top - bottom, left, bottom]);
                content.x_object(Name(image_name(images.len()).as_bytes()));
                content.restore_state();
                images.push(picture);
            }
        }
    }
    (content, images)
}

fn trace(content: &mut Content, line: &[[f64; 2]], place: &impl Fn(&[f64; 2]) -> [f32; 2]) {
    for (n, [x, y]) in line.iter().map(place).enumerate() {
        match n {
            0 => content.move_to(x, y),
            _ => content.line_to(x, y),
        };
    }
}

fn write_text(content: &mut Content, text: &Text, [x, y]: [f32; 2], used: &mut Used) {
    let [r, g, b] = part(text.colour);
    content.begin_text().set_fill_rgb(r, g, b);
    content.set_font(name(text.weight), text.size as f32);
    content.set_text_matrix(match text.is_upright {
        true => [0.0, 1.0, -1.0, 0.0, x, y],
        false => [1.0, 0.0, 0.0, 1.0, x, y],
    });
    let (face, units) = (text.weight.face(), text.weight.units());
    let mut shown = content.show_positioned();
    let mut items = shown.items();
    let mut next = 0.0;
    for letter in text.weight.set(&text.text).0 {
        let width = f64::from(face.h_advance_unscaled(letter.id)) / units;
        let number = used.numbers.remap(letter.id.0);
        let known = (letter.letter, 1e3 * width as f32);
        used.letters.entry(number).or_insert(known);
        if (letter.at - next).abs() > 1e-9 {
            items.adjust((1e3 * (next - letter.at)) as f32);
        }
        items.show(Str(&number.to_be_bytes()));
        next = letter.at + width;
    }
    items.finish();
    shown.finish();
    content.end_text();
}

fn write_font(pdf: &mut Pdf, weight: Weight, used: &Used) {
    let [font, cid, descriptor, file, unicode] = [0, 1, 2, 3, 4].map(|n| font_id(weight, n));
    // Six letters mark a font that is not complete.
    let base = match weight {
        Weight::Regular => Name(b"CORONE+DejaVuSans"),
        Weight::Bold => Name(b"CORONE+DejaVuSans-Bold"),
    };
    let identity = Name(b"Identity-H");
    let mut dictionary = pdf.type0_font(font);
    dictionary.base_font(base).encoding_predefined(identity);
    dictionary.descendant_font(cid).to_unicode(unicode);
    dictionary.finish();
    let mut dictionary = pdf.cid_font(cid);
    dictionary.subtype(CidFontType::Type2).base_font(base);
    dictionary.system_info(IDENTITY).font_descriptor(descriptor);
    dictionary.cid_to_gid_map_predefined(Name(b"Identity"));
    let mut widths = dictionary.widths();
    for (number, (_, width)) in &used.letters {
        widths.consecutive(*number, [*width]);
    }
    widths.finish();
    dictionary.finish();
    let (face, units) = (weight.face(), weight.units());
    let thousandths = |length: f32| 1e3 * length / units as f32;
    let mut dictionary = pdf.font_descriptor(descriptor);
    dictionary.name(base).flags(FontFlags::SYMBOLIC);
    // All letters of both fonts are inside.
    dictionary.bbox(Rect::new(-1100.0, -500.0, 2000.0, 1250.0));
    dictionary.italic_angle(0.0).cap_height(729.0);
    dictionary.ascent(thousandths(face.ascent_unscaled()));
    dictionary.descent(thousandths(face.descent_unscaled()));
    dictionary.stem_v(if weight == Weight::Bold { 180.0 } else { 92.0 });
    dictionary.font_file2(file);
    dictionary.finish();
    // It is the program's own font.
    let subset = subsetter::subset(weight.data(), 0, &used.numbers);
    pdf.stream(file, &subset.expect("a complete TrueType font"));
    let mut map = UnicodeCmap::<u16>::new(Name(b"Coronet"), IDENTITY);
    for (number, (letter, _)) in &used.letters {
        map.pair(*number, *letter);
    }
    pdf.stream(unicode, &map.finish());
}

fn name(weight: Weight) -> Name<'static> {
    match weight {
        Weight::Regular => Name(b"R"),
        Weight::Bold => Name(b"B"),
    }
}

fn font_id(weight: Weight, object: i32) -> Ref {
    Ref::new(FONTS + FONT_OBJECTS * weight as i32 + object)
}

fn image_name(number: usize) -> String {
    format!("I{number}")
}

fn image_id(number: usize) -> Ref {
    Ref::new(IMAGES + number as i32)
}

fn part(colour: Colour) -> [f32; 3] {
    colour.map(|c| f32::from(c) / 255.0)
}
