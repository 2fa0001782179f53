//! The report: one self-contained page, without other files or a network.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use super::canvas::Colour;
use super::player::{Kind, Shot};
use super::plot::{Axes, Plot};

/// A plot that answers to the pointer.
pub struct Chart {
    /// SVG text.
    pub svg: String,
    /// Where its axes are.
    pub axes: Axes,
    /// What it shows.
    pub plot: Plot,
}

/// The liquid at some instants.
pub struct Film {
    /// What the shots are.
    pub kind: Kind,
    /// Edges of the box, m.
    pub size: [f64; 3],
    /// Particle spacing, m.
    pub spacing: f64,
    /// What plots count time from, s.
    pub shift: f64,
    /// Colours of the bodies.
    pub tints: Vec<Colour>,
    /// In the order of time.
    pub shots: Vec<Shot>,
}

/// What the page shows.
#[derive(Default)]
pub struct Report {
    /// Title of the page.
    pub title: String,
    /// Name of the scene.
    pub scene: String,
    /// Groups of derived numbers: title, then name, value, definition.
    pub numbers: Vec<(String, Vec<[String; 3]>)>,
    /// Key results: name and value.
    pub results: Vec<(String, String)>,
    /// Reference, column, L2, maximum, span.
    pub norms: Vec<[String; 5]>,
    /// Notes about what the page cannot show.
    pub notes: Vec<String>,
    /// What panels show, a sentence.
    pub shown: String,
    /// What a reader should know before the results are believed.
    pub warnings: Vec<String>,
    /// Caption and PNG file of the picture that opens the page.
    pub picture: Option<(String, Vec<u8>)>,
    /// Measures against time.
    pub plots: Vec<Chart>,
    /// What the player shows; without a shot there is none.
    pub player: Option<Film>,
    /// Caption and PNG files, one row of pictures each.
    pub panels: Vec<(String, Vec<Vec<u8>>)>,
    /// Caption and SVG text.
    pub fields: Vec<(String, String)>,
    /// Names and values: keys, versions, settings.
    pub provenance: Vec<(String, String)>,
}

/// How it looks, and what answers to a reader.
const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

impl Report {
    /// The page as HTML.
    pub fn html(&self) -> String {
        let mut page = String::new();
        page.push_str("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n");
        page.push_str("<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n");
        let title = escape(&self.title);
        put(
            &mut page,
            format_args!("<title>{title}</title>\n<style>{STYLE}</style></head>\n"),
        );
        put(&mut page, format_args!("<body><main>\n<h1>{title}</h1>\n"));
        put(
            &mut page,
            format_args!(
                "<p class=\"soft\">Scene <code>{}</code></p>\n",
                escape(&self.scene)
            ),
        );
        if let Some((caption, png)) = &self.picture {
            page.push_str("<figure>");
            put_image(&mut page, png, &self.title);
            let caption = escape(caption);
            put(
                &mut page,
                format_args!("<figcaption>{caption}</figcaption></figure>\n"),
            );
        }
        self.put_player(&mut page);
        self.put_results(&mut page);
        self.put_plots(&mut page);
        self.put_pictures(&mut page);
        self.put_numbers(&mut page);
        self.put_look(&mut page);
        self.put_provenance(&mut page);
        // In JSON a `<` is only in strings; in a page it could end the script or hide its end.
        let data = self.data().to_string().replace('<', "\\u003c");
        put(
            &mut page,
            format_args!(
                "<script type=\"application/json\" id=\"data\">{data}</script>\n\
                 <script>\n{SCRIPT}</script>\n"
            ),
        );
        page.push_str("</main></body></html>\n");
        page
    }

    /// What the script reads.
    fn data(&self) -> Value {
        let short = |v: f64| match v.is_finite() {
            true => json!(format!("{v:.5e}").parse::<f64>().unwrap_or(v)),
            false => Value::Null,
        };
        let charts = self.plots.iter().map(|chart| {
            let curves = chart.plot.curves.iter().map(|curve| {
                let points = curve.points.iter().map(|p| p.map(short));
                json!({ "label": curve.label, "points": points.collect::<Vec<_>>() })
            });
            json!({
                "x": chart.plot.x,
                "y": chart.plot.y,
                "values": chart.axes.values,
                "places": chart.axes.places,
                "curves": curves.collect::<Vec<_>>(),
            })
        });
        let film = self.player.as_ref().map(|film| {
            let shots = film.shots.iter().map(|shot| {
                json!({
                    "ms": short(1e3 * (shot.time - film.shift)),
                    "low": shot.low,
                    "size": shot.size,
                    "points": shot.points,
                    "faces": shot.faces,
                    "data": STANDARD.encode(&shot.bytes),
                })
            });
            json!({
                "kind": film.kind.name(),
                "size": film.size,
                "spacing": film.spacing,
                "tints": film.tints,
                "shots": shots.collect::<Vec<_>>(),
            })
        });
        json!({ "charts": charts.collect::<Vec<_>>(), "film": film })
    }

    /// Hidden until the script finds that it can draw.
    fn put_player(&self, page: &mut String) {
        let Some(film) = self.player.as_ref().filter(|film| !film.shots.is_empty()) else {
            return;
        };
        let player = include_str!("player.html");
        match film.kind {
            Kind::Points => page.push_str(&player.replace("Drag to turn, pinch", "Pinch")),
            _ => page.push_str(player),
        }
    }

    fn put_results(&self, page: &mut String) {
        page.push_str(
            "<h2>Results <button type=\"button\" id=\"copy\" hidden>Copy</button></h2>\n\
             ",
        );
        for warning in &self.warnings {
            let warning = prose(warning);
            put(
                page,
                format_args!("<p class=\"warning\"><b>Warning:</b> {warning}</p>\n"),
            );
        }
        page.push_str("<div class=\"grid\"><div class=\"card\"><table id=\"results\">\n");
        for (name, value) in &self.results {
            let (name, value) = (escape(name), escape(value));
            put(
                page,
                format_args!("<tr><td>{name}</td><td class=\"n\">{value}</td></tr>\n"),
            );
        }
        page.push_str("</table></div>\n");
        if !self.norms.is_empty() {
            page.push_str(
                "<div class=\"card\"><h3>Distance from the reference curves</h3><table>\n",
            );
            page.push_str(
                "<tr><th>reference</th><th>measure</th><th>L2</th><th>max</th><th>over</th></tr>\n",
            );
            for [label, column, l2, max, span] in &self.norms {
                let (label, column) = (escape(label), escape(column));
                put(
                    page,
                    format_args!(
                        "<tr><td>{label}</td><td><code>{column}</code></td>\
                         <td class=\"n\">{l2}</td><td class=\"n\">{max}</td>\
                         <td class=\"n\">{span}</td></tr>\n"
                    ),
                );
            }
            page.push_str(
                "</table><p class=\"soft\">L2: root of the sum of squared differences over that of \
                 the reference. max: largest difference over the reference's largest value.</p>\
                 </div>\n",
            );
        }
        page.push_str("</div>\n");
        for note in &self.notes {
            put(
                page,
                format_args!("<p class=\"soft\">{}</p>\n", prose(note)),
            );
        }
    }

    fn put_plots(&self, page: &mut String) {
        page.push_str("<h2>Measures against time</h2>\n<div class=\"grid\">\n");
        for Chart { svg, .. } in &self.plots {
            let under = "<p class=\"read\" aria-live=\"polite\"></p>";
            put(
                page,
                format_args!("<figure class=\"chart\">{svg}{under}</figure>\n"),
            );
        }
        let folders = match self.fields.is_empty() {
            true => "<code>plots</code>",
            false => "<code>plots</code> and <code>fields</code>",
        };
        put(
            page,
            format_args!(
                "</div>\n<p class=\"soft\">The numbers are in <code>measures.csv</code> beside \
                 this page, the figures as SVG, PDF and PNG in {folders}.</p>\n"
            ),
        );
    }

    fn put_pictures(&self, page: &mut String) {
        if !self.panels.is_empty() {
            let shown = escape(&self.shown);
            put(
                page,
                format_args!("<h2>Snapshots</h2>\n<p class=\"soft\">{shown}</p>\n"),
            );
        }
        for (caption, pictures) in &self.panels {
            put(
                page,
                format_args!(
                    "<figure style=\"margin-bottom:14px\"><figcaption>{}</figcaption>",
                    escape(caption)
                ),
            );
            page.push_str("<div class=\"row\">");
            for png in pictures {
                put_image(page, png, caption);
            }
            page.push_str("</div></figure>\n");
        }
        if !self.fields.is_empty() {
            page.push_str(
                "<h2>Pressure and velocity, averaged about the axis</h2>\n<div class=\"grid\">\n",
            );
        }
        for (_, svg) in &self.fields {
            put(page, format_args!("<figure>{svg}</figure>\n"));
        }
        if !self.fields.is_empty() {
            page.push_str("</div>\n");
        }
    }

    fn put_numbers(&self, page: &mut String) {
        page.push_str("<h2>The scene in numbers</h2>\n<div class=\"grid\">\n");
        for (title, rows) in &self.numbers {
            put(
                page,
                format_args!("<div class=\"card\"><h3>{}</h3><table>\n", escape(title)),
            );
            for [name, value, meaning] in rows.iter().map(|row| row.each_ref().map(|t| escape(t))) {
                put(
                    page,
                    format_args!(
                        "<tr><td class=\"n\">{name}</td><td class=\"n\">{value}</td>\
                         <td class=\"soft\">{meaning}</td></tr>\n"
                    ),
                );
            }
            page.push_str("</table></div>\n");
        }
        page.push_str("</div>\n");
    }

    fn put_look(&self, page: &mut String) {
        page.push_str(
            "<h2>Playing it back in 3-D</h2>\n<div class=\"card\"><p>The run's MCAP log holds \
             every frame. Open it in <a href=\"https://lichtblick-suite.github.io/lichtblick/\">\
             Lichtblick</a> or <a href=\"https://foxglove.dev/download\">Foxglove</a> (<em>Open \
             local file</em>, then import the layout file that lies beside the log), or with \
             <code>rerun</code> and the \
             log's name as the argument. Colour the points by any field: speed, pressure, density, \
             body.</p></div>\n",
        );
    }

    fn put_provenance(&self, page: &mut String) {
        page.push_str("<h2>Provenance</h2>\n<div class=\"card\"><table>\n");
        for (name, value) in &self.provenance {
            let (name, value) = (escape(name), escape(value));
            put(
                page,
                format_args!("<tr><td class=\"n\">{name}</td><td><code>{value}</code></td></tr>\n"),
            );
        }
        page.push_str("</table></div>\n");
    }
}

fn put(page: &mut String, text: std::fmt::Arguments) {
    page.write_fmt(text)
        .expect("writing to a string does not fail");
}

fn put_image(page: &mut String, png: &[u8], caption: &str) {
    page.push_str("<img src=\"data:image/png;base64,");
    STANDARD.encode_string(png, page);
    put(page, format_args!("\" alt=\"{}\">", escape(caption)));
}

/// Text where what is between backticks is code.
fn prose(text: &str) -> String {
    let parts = escape(text);
    let parts = parts.split('`').enumerate();
    let code = parts.map(|(k, part)| match k % 2 {
        0 => part.to_string(),
        _ => format!("<code>{part}</code>"),
    });
    code.collect()
}

fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
