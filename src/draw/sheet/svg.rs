//! A figure as SVG 1.1. Letters are defined once as outlines and used by reference.

use std::collections::BTreeMap;
use std::fmt::Write;

use ab_glyph::{Font, GlyphId, OutlineCurve};
use base64::Engine;

use super::{Shape, Sheet, Text, Weight};
use crate::draw::canvas::{Canvas, Colour};

/// Least width and height of a picture in a figure, pixels, if that takes not too many.
const ENLARGED: usize = 320;

pub fn text(sheet: &Sheet) -> String {
    let [width, height] = sheet.size.map(short);
    let mut body = String::new();
    let mut letters = BTreeMap::new();
    for shape in &sheet.shapes {
        match shape {
            Shape::Text(text) => write_text(text, &mut body, &mut letters),
            Shape::Image { low, high, picture } => write_image(*low, *high, picture, &mut body),
            line => write_line(line, &mut body),
        }
    }
    let [across, down] = sheet.size.map(|length| short(length * 25.4 / 72.0));
    let mut all = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         width=\"{across}mm\" height=\"{down}mm\" viewBox=\"0 0 {width} {height}\">\n<defs>\n"
    );
    for (name, path) in letters {
        put(
            &mut all,
            format_args!("<path id=\"{name}\" d=\"{path}\"/>\n"),
        );
    }
    put(
        &mut all,
        format_args!(
            "</defs>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
             {body}</svg>\n"
        ),
    );
    all
}

/// Lines, areas and circles.
fn write_line(shape: &Shape, body: &mut String) {
    match shape {
        Shape::Lines {
            lines,
            width,
            colour,
        } => {
            let (path, look) = (path(lines, false), stroke(*width, *colour));
            put(
                body,
                format_args!("<path d=\"{path}\" {look} stroke-linejoin=\"round\"/>\n"),
            );
        }
        Shape::Area { points, colour } => {
            let (path, colour) = (path(std::slice::from_ref(points), true), hex(*colour));
            put(
                body,
                format_args!("<path d=\"{path}\" fill=\"{colour}\"/>\n"),
            );
        }
        Shape::Circle {
            at,
            radius,
            width,
            colour,
        } => {
            let ([x, y], radius) = (at.map(short), short(*radius));
            let look = match width {
                None => format!("fill=\"{}\"", hex(*colour)),
                Some(width) => stroke(*width, *colour),
            };
            put(
                body,
                format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {look}/>\n"),
            );
        }
        Shape::Text(_) | Shape::Image { .. } => {}
    }
}

fn stroke(width: f64, colour: Colour) -> String {
    let (width, colour) = (short(width), hex(colour));
    format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"")
}

fn write_text(text: &Text, body: &mut String, letters: &mut BTreeMap<String, String>) {
    let [x, y] = text.start().map(short);
    let turn = if text.is_upright { " rotate(-90)" } else { "" };
    let scale = text.size / text.weight.units();
    put(
        body,
        format_args!(
            "<g aria-label=\"{}\" fill=\"{}\" transform=\"translate({x} {y}){turn} \
             scale({scale:.6} -{scale:.6})\">",
            escape(&text.text),
            hex(text.colour)
        ),
    );
    let units = text.weight.units();
    for letter in text.weight.set(&text.text).0 {
        let mark = match text.weight {
            Weight::Regular => 'r',
            Weight::Bold => 'b',
        };
        let name = format!("{mark}{}", letter.id.0);
        let outline = letters
            .entry(name.clone())
            .or_insert_with(|| outline(text.weight, letter.id));
        if !outline.is_empty() {
            let x = (letter.at * units).round();
            put(
                body,
                format_args!("<use xlink:href=\"#{name}\" x=\"{x}\"/>"),
            );
        }
    }
    body.push_str("</g>\n");
}

/// The outline of a letter in units of the font.
fn outline(weight: Weight, id: GlyphId) -> String {
    let Some(outline) = weight.face().outline(id) else {
        return String::new();
    };
    let mut path = String::new();
    let mut last = None;
    for curve in outline.curves {
        let (start, points) = match curve {
            OutlineCurve::Line(a, b) => (a, vec![b]),
            OutlineCurve::Quad(a, b, c) => (a, vec![b, c]),
            OutlineCurve::Cubic(a, b, c, d) => (a, vec![b, c, d]),
        };
        if last != Some(start) {
            put(&mut path, format_args!("M{} {}", start.x, start.y));
        }
        path.push(['L', 'Q', 'C'][points.len() - 1]);
        let points: Vec<String> = points.iter().map(|p| format!("{} {}", p.x, p.y)).collect();
        path.push_str(&points.join(" "));
        last = match curve {
            OutlineCurve::Line(_, end) => Some(end),
            OutlineCurve::Quad(_, _, end) => Some(end),
            OutlineCurve::Cubic(_, _, _, end) => Some(end),
        };
    }
    path
}

fn write_image(low: [f64; 2], high: [f64; 2], picture: &Canvas, body: &mut String) {
    // Programs that ignore the style blur at most a small part of a pixel.
    let times = [picture.width, picture.height].map(|count| ENLARGED.div_ceil(count).min(16));
    // A PNG of pixels in memory does not fail.
    let Ok(png) = picture.enlarged(times).png() else {
        return;
    };
    let [x, y] = low.map(short);
    let [width, height] = [0, 1].map(|a| short(high[a] - low[a]));
    put(
        body,
        format_args!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
             xlink:href=\"data:image/png;base64,"
        ),
    );
    base64::engine::general_purpose::STANDARD.encode_string(png, body);
    body.push_str("\"/>\n");
}

fn path(lines: &[Vec<[f64; 2]>], is_closed: bool) -> String {
    let mut path = String::new();
    for line in lines {
        for (n, [x, y]) in line.iter().enumerate() {
            let step = if n == 0 { 'M' } else { 'L' };
            put(&mut path, format_args!("{step}{} {}", short(*x), short(*y)));
        }
        if is_closed {
            path.push('Z');
        }
    }
    path
}

/// Hundredths of a point.
fn short(length: f64) -> String {
    let text = format!("{length:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn put(text: &mut String, what: std::fmt::Arguments) {
    text.write_fmt(what)
        .expect("writing to a string does not fail");
}

fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
