//! Plots, panels and fields: their files, and their part of the report.

use super::{Post, PostError, draw_error};
use crate::draw::canvas::{Canvas, WHITE};
use crate::draw::field::{Bounds, Field, Scales};
use crate::draw::figure::Figures;
use crate::draw::player;
use crate::draw::render::Material;
use crate::draw::render::artist::{Artist, Style, Survey};
use crate::draw::render::camera::View;
use crate::draw::report::{Chart, Film, Report};
use crate::draw::section;
use crate::draw::sheet::Sheet;
use crate::particle::Frame;
use crate::scene::Dimension;

/// Of the views of panels, above the horizon, rad.
const ELEVATION: f32 = 0.56;

impl Post {
    /// Bird's-eye view of a frame of the part: the surface in the colours of its bodies; there is
    /// none in 2-D.
    pub(super) fn view(&self, part: &Frame) -> Option<Canvas> {
        if self.part.solid().dimension == Dimension::Two {
            return None;
        }
        let width = section::width(&self.scene);
        let style = Style {
            material: Material::Body,
            size: [width, width / 4 * 3],
            view: View {
                elevation: ELEVATION,
                ..View::default()
            },
            ..Style::default()
        };
        let survey = Survey::of_box(&self.part);
        Some(Artist::new(&self.part, &survey, style).picture(part))
    }

    /// The title picture: the surface of the liquid.
    pub(super) fn draw_title(&mut self, report: &mut Report) -> Result<(), PostError> {
        let Some((_, frame)) = self.best.take() else {
            return Ok(());
        };
        let mut survey = Survey::default();
        survey.add(&self.part, &frame);
        let picture = Artist::new(&self.part, &survey, Style::default()).picture(&frame);
        let png = picture.png().map_err(|e| draw_error("picture", &e))?;
        self.write("picture.png", &png)?;
        report.picture = Some((format!("t = {}", self.moment(frame.time, 2)), png));
        Ok(())
    }

    /// The liquid at many instants.
    pub(super) fn draw_player(&mut self, report: &mut Report) {
        report.player = Some(Film {
            kind: self.player.kind(),
            size: self.player.size(),
            spacing: self.scene.spacing,
            shift: self.shift,
            tints: (0..self.scene.bodies.len() as u8)
                .map(|body| section::body_colour(&self.scene, body))
                .collect(),
            shots: player::thinned(std::mem::take(&mut self.shots)),
        });
    }

    pub(super) fn draw_plots(&mut self, report: &mut Report) -> Result<(), PostError> {
        let plots = Figures {
            scene: &self.scene,
            kind: self.gauge.kind,
            series: &self.series,
            references: &self.references,
            shift: self.shift,
        }
        .plots();
        for plot in plots {
            let drawn = plot.drawn(&self.scene.post.figures);
            let (sheet, axes) = drawn.map_err(|e| draw_error(&plot.title, &e))?;
            let svg = self.write_figure(&sheet, &format!("plots/{}", plot.file_name()))?;
            report.plots.push(Chart { svg, axes, plot });
        }
        Ok(())
    }

    /// All sections have the height of the highest one.
    pub(super) fn draw_panels(&mut self, report: &mut Report) -> Result<(), PostError> {
        let sections = std::mem::take(&mut self.sections);
        let top = sections.iter().map(|(s, _)| s.top()).fold(0.0, f64::max);
        let mut sheet = Vec::new();
        for (n, (section, view)) in sections.into_iter().enumerate() {
            let mut pictures = vec![(section.draw(&self.scene, top), "section")];
            if let Some(view) = view {
                pictures.push((view, "view"));
            }
            let mut files = Vec::new();
            for (picture, what) in &pictures {
                let png = encode(picture, what)?;
                self.write(&format!("panels/{:02}-{what}.png", n + 1), &png)?;
                files.push(png);
            }
            report.panels.push((section.label.clone(), files));
            sheet.push(pictures.into_iter().map(|(picture, _)| picture).collect());
        }
        if let Some(sheet) = contact_sheet(&sheet) {
            let png = encode(&sheet, "sheet")?;
            self.write("panels/sheet.png", &png)?;
        }
        Ok(())
    }

    pub(super) fn draw_fields(&mut self, report: &mut Report) -> Result<(), PostError> {
        let fields = std::mem::take(&mut self.averages);
        let top = fields.iter().map(Field::top).fold(0.0, f64::max);
        let level = self.gauge.start.level.unwrap_or(0.0);
        let bounds = Bounds {
            top,
            level,
            scales: Scales::of(&fields),
        };
        for (n, field) in fields.iter().enumerate() {
            let sheet = field.draw(&bounds, &self.scene.post.figures);
            let svg = self.write_figure(&sheet, &format!("fields/{:02}", n + 1))?;
            report.fields.push((field.label.clone(), svg));
        }
        Ok(())
    }

    /// Writes a figure in all its formats; returns it as SVG. `name`: without ending.
    fn write_figure(&mut self, sheet: &Sheet, name: &str) -> Result<String, PostError> {
        let svg = sheet.svg();
        self.write(&format!("{name}.svg"), svg.as_bytes())?;
        self.write(&format!("{name}.pdf"), &sheet.pdf())?;
        let png = encode(&sheet.canvas(self.scene.post.figures.dpi), name)?;
        self.write(&format!("{name}.png"), &png)?;
        Ok(svg)
    }
}

fn encode(picture: &Canvas, what: &str) -> Result<Vec<u8>, PostError> {
    picture.png().map_err(|e| draw_error(what, &e))
}

/// Rows of pictures in one, half size.
fn contact_sheet(rows: &[Vec<Canvas>]) -> Option<Canvas> {
    let gap = 12;
    let halves: Vec<Vec<Canvas>> = rows
        .iter()
        .map(|row| row.iter().map(Canvas::halved).collect())
        .collect();
    let length = |row: &Vec<Canvas>| row.iter().map(|c| c.width + gap).sum::<usize>();
    let tall = |row: &Vec<Canvas>| row.iter().map(|c| c.height).max().unwrap_or(0);
    let width = halves.iter().map(length).max()? + gap;
    let height = halves.iter().map(|row| tall(row) + gap).sum::<usize>() + gap;
    let mut sheet = Canvas::new(width, height, WHITE);
    let mut y = gap;
    for row in &halves {
        let mut x = gap;
        for picture in row {
            sheet.paste(x, y + tall(row) - picture.height, picture);
            x += picture.width + gap;
        }
        y += tall(row) + gap;
    }
    Some(sheet)
}
