//! The report: one self-contained page, without other files or a network.

use base64::Engine;
use std::fmt::Write;

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
    /// Whether the run has the half-plane beside an axis.
    pub is_axial: bool,
    /// PNG file that opens the page.
    pub picture: Option<Vec<u8>>,
    /// SVG texts.
    pub plots: Vec<String>,
    /// Caption and PNG files, one row of pictures each.
    pub panels: Vec<(String, Vec<Vec<u8>>)>,
    /// Caption and SVG text.
    pub fields: Vec<(String, String)>,
    /// Names and values: keys, versions, settings.
    pub provenance: Vec<(String, String)>,
}

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1d232b;--soft:#5c6672;--page:#f5f6f8;--card:#fff;
--line:#dfe3e8}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--soft:#9aa5b1;--page:#15181c;--card:#1f2429;
--line:#343b43}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);
font:16px/1.5 system-ui,'Segoe UI','DejaVu Sans',Helvetica,Arial,sans-serif}
main{max-width:1180px;margin:0 auto;padding:28px 20px 60px}
h1{font-size:1.75rem;line-height:1.25;margin:.2em 0 .1em}
h2{font-size:1.2rem;margin:2.2em 0 .7em;padding-bottom:.25em;border-bottom:1px solid var(--line)}
h3{font-size:.95rem;margin:0 0 .4em;color:var(--soft);font-weight:600}
p{margin:.4em 0}.soft{color:var(--soft)}
.grid{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr))}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:14px 16px;
overflow-x:auto}
figure{margin:0;background:#fff;border:1px solid var(--line);border-radius:8px;padding:8px;
overflow:hidden}
figure svg,figure img{display:block;width:100%;height:auto}
figcaption{color:#333a43;font-size:.9rem;padding:2px 4px 6px}
.row{display:grid;gap:8px;grid-template-columns:repeat(auto-fit,minmax(min(100%,430px),1fr));
align-items:end}
table{border-collapse:collapse;width:100%;font-size:.93rem}
td,th{text-align:left;padding:3px 12px 3px 0;vertical-align:top}
th{color:var(--soft);font-weight:600}td.n{white-space:nowrap;font-variant-numeric:tabular-nums}
tr+tr td{border-top:1px solid var(--line)}
code{font:.86em ui-monospace,'DejaVu Sans Mono',monospace;overflow-wrap:anywhere;
white-space:pre-wrap}
";

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
        if let Some(png) = &self.picture {
            page.push_str("<figure>");
            put_image(&mut page, png, &self.title);
            page.push_str("</figure>\n");
        }
        self.put_results(&mut page);
        self.put_plots(&mut page);
        self.put_pictures(&mut page);
        self.put_numbers(&mut page);
        self.put_look(&mut page);
        self.put_provenance(&mut page);
        page.push_str("</main></body></html>\n");
        page
    }

    fn put_results(&self, page: &mut String) {
        page.push_str("<h2>Results</h2>\n<div class=\"grid\"><div class=\"card\"><table>\n");
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
                format_args!("<p class=\"soft\">{}</p>\n", escape(note)),
            );
        }
    }

    fn put_plots(&self, page: &mut String) {
        page.push_str("<h2>Measures against time</h2>\n<div class=\"grid\">\n");
        for svg in &self.plots {
            put(page, format_args!("<figure>{svg}</figure>\n"));
        }
        page.push_str(
            "</div>\n<p class=\"soft\">The numbers are in <code>measures.csv</code> beside this \
             page, the figures as SVG, PDF and PNG in <code>plots</code> and \
             <code>fields</code>.</p>\n",
        );
    }

    fn put_pictures(&self, page: &mut String) {
        if !self.panels.is_empty() {
            page.push_str("<h2>Snapshots</h2>\n");
            let section = match self.is_axial {
                true => "Section through the axis",
                false => "Section of 1 mm through the axis",
            };
            put(
                page,
                format_args!("<p class=\"soft\">{section}, and bird's-eye view.</p>\n"),
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
    page.push_str("<img loading=\"lazy\" src=\"data:image/png;base64,");
    base64::engine::general_purpose::STANDARD.encode_string(png, page);
    put(page, format_args!("\" alt=\"{}\">", escape(caption)));
}

fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}
