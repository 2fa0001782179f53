//! Evaluation: from the frames of a run, in their order, to measures, pictures and the report.
//!
//! Writes `measures.csv`, `picture.png`, `plots/*` and `fields/*` as SVG, PDF and PNG,
//! `panels/*.png` and `report.html`.

mod draw;
mod instants;
mod notes;

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use self::instants::Instants;
use super::canvas::Canvas;
use super::field::Field;
use super::player::{Player, Shot};
use super::report::Report;
use super::section::{self, Section};
use crate::measure::answer;
use crate::measure::gauge::{Gauge, Start};
use crate::measure::kind::{Kind, contact, contact_within};
use crate::measure::loss;
use crate::measure::norm::{Norm, compare};
use crate::measure::pool::{self, Axis};
use crate::measure::series::{Reference, Row, Series, SeriesError};
use crate::measure::summary;
use crate::measure::whole::Unfold;
use crate::particle::Frame;
use crate::scene::sanity::{self, Warning};
use crate::scene::{Clock, Dimension, Scene, numbers};

/// An evaluation that failed.
#[derive(Debug, thiserror::Error)]
pub enum PostError {
    /// The measures cannot be written, or a reference cannot be read.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// The file `path` cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The plot or picture `what` cannot be drawn.
    #[error("cannot draw {what}: {problem}")]
    Draw {
        /// The plot or picture.
        what: String,
        /// Why.
        problem: String,
    },
    /// Times do not increase; both in s.
    #[error("frame at {now} s comes after the one at {before} s; give frames in their order")]
    Order {
        /// Time of the frame before, s.
        before: f64,
        /// Time of this frame, s.
        now: f64,
    },
    /// There is no frame.
    #[error("no frame to measure; the log is empty")]
    Empty,
}

/// Results of an evaluation.
#[derive(Debug)]
pub struct PostReport {
    /// Measures of all frames.
    pub series: Series,
    /// Key results, as in the report.
    pub results: Vec<(String, String)>,
    /// Deviations from the reference curves.
    pub norms: Vec<Norm>,
    /// Sentences about panels and fields later than the last frame.
    pub missed: Vec<String>,
    /// Liquid that is missing at the end.
    pub losses: Vec<Warning>,
    /// Files, relative to the folder; `measures.csv` first, `report.html` last.
    pub files: Vec<PathBuf>,
}

/// Takes frames, then reports. Where mirrors cut the scene, it evaluates the whole.
pub struct Post {
    /// The whole scene, and the part that was simulated.
    scene: Scene,
    part: Scene,
    unfold: Unfold,
    out: PathBuf,
    gauge: Gauge,
    series: Series,
    /// Time of the last frame, s.
    last: Option<f64>,
    references: Vec<(String, Reference)>,
    /// Labels of those that count from a contact that there is not.
    unmet: Vec<String>,
    axis: Axis,
    /// Time of contact, s.
    shift: f64,
    panels: Instants,
    fields: Instants,
    player: Player,
    shots: Vec<Shot>,
    sections: Vec<(Section, Option<Canvas>)>,
    /// Largest height of the crown so far, with its frame of the part: for the title picture.
    best: Option<(f64, Frame)>,
    averages: Vec<Field>,
    files: Vec<PathBuf>,
    remarks: Vec<String>,
    warnings: Vec<String>,
}

/// What a frame needs besides its measures.
struct Asked {
    panel: bool,
    field: bool,
    shot: bool,
}

/// Results of a frame: its row, the start values, its pictures.
struct Look {
    measured: (Row, Start),
    panel: Option<Section>,
    field: Option<Field>,
    shot: Option<Shot>,
}

impl Post {
    /// `references`: name and table of each; `out` must exist.
    pub fn new(scene: &Scene, references: Vec<(String, Reference)>, out: &Path) -> Post {
        let (part, scene) = (scene.clone(), &scene.whole());
        let gauge = Gauge::new(scene);
        let axis = match gauge.kind {
            Kind::Pool(axis) | Kind::Wall(axis) => axis,
            _ => Axis {
                at: [0.5 * scene.domain.size[0], 0.5 * scene.domain.size[1]],
                diameter: 0.0,
            },
        };
        let interval = scene.frames.interval;
        let contact = contact_within(scene);
        let is_unmet =
            |reference: &Reference| contact.is_none() && reference.clock == Clock::Contact;
        let (fields, has_axis) = (&scene.post.fields[..], sanity::fields(&part).is_none());
        let (unmet, references) = references
            .into_iter()
            .partition::<Vec<_>, _>(|(_, reference)| is_unmet(reference));
        Post {
            scene: scene.clone(),
            unfold: Unfold::new(&part),
            out: out.to_owned(),
            gauge,
            series: Series::default(),
            last: None,
            references,
            unmet: unmet.into_iter().map(|(label, _)| label).collect(),
            axis,
            shift: contact.unwrap_or(0.0),
            panels: Instants::new(&scene.post.panels, interval),
            fields: Instants::new(if has_axis { fields } else { &[] }, interval),
            player: Player::new(&part),
            shots: Vec::new(),
            sections: Vec::new(),
            best: None,
            averages: Vec::new(),
            files: vec![PathBuf::from("measures.csv")],
            remarks: match has_axis {
                true => Vec::new(),
                false => vec!["No field is drawn: there is no axis to average about.".into()],
            },
            warnings: Vec::new(),
            part,
        }
    }

    /// Adds a sentence about the run to the report.
    pub fn remark(&mut self, text: String) {
        self.remarks.push(text);
    }

    /// Adds a sentence about what makes the figures doubtful.
    pub fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    /// Measures a frame and draws its panel and field.
    pub fn frame(&mut self, frame: &Frame) -> Result<(), PostError> {
        self.frames(std::slice::from_ref(frame))
    }

    /// Measures several frames in parallel.
    pub fn frames(&mut self, parts: &[Frame]) -> Result<(), PostError> {
        // The first frame defines the level that the others are measured from.
        let alone = usize::from(self.last.is_none() && !parts.is_empty());
        let wholes: Vec<Frame>;
        let frames = match self.unfold.is_plain() {
            true => parts,
            false => {
                wholes = parts.par_iter().map(|f| self.unfold.frame(f)).collect();
                &wholes
            }
        };
        let (first, rest) = frames.split_at(alone);
        let (first_part, rest_part) = parts.split_at(alone);
        self.measure(first, first_part)?;
        self.measure(rest, rest_part)
    }

    /// `parts`: the same frames of the part that was simulated.
    fn measure(&mut self, frames: &[Frame], parts: &[Frame]) -> Result<(), PostError> {
        let count = self.series.len() as u64;
        let numbered = frames.iter().zip(count..);
        let asked: Result<Vec<Asked>, PostError> = numbered.map(|(f, n)| self.ask(f, n)).collect();
        let looks: Vec<Look> = frames
            .par_iter()
            .zip(parts)
            .zip(asked?)
            .enumerate()
            .map(|(k, ((frame, part), asked))| {
                let before = k.checked_sub(1).map(|k| &frames[k]);
                self.look((frame, before), part, asked)
            })
            .collect();
        for (part, look) in parts.iter().zip(looks) {
            let (row, start) = look.measured;
            self.gauge.start = start;
            self.series.push(&row);
            if let Some(section) = look.panel {
                // One after the other: each takes much memory, and all threads.
                let view = self.view(part);
                self.sections.push((section, view));
                self.keep_best(part, &row);
            }
            self.averages.extend(look.field);
            self.shots.extend(look.shot);
            self.player.limit(&mut self.shots);
        }
        Ok(())
    }

    /// `number`: of the frame, from 0.
    fn ask(&mut self, frame: &Frame, number: u64) -> Result<Asked, PostError> {
        let now = frame.time;
        if let Some(before) = self.last.replace(now).filter(|before| now <= *before) {
            return Err(PostError::Order { before, now });
        }
        Ok(Asked {
            panel: self.panels.take(now),
            field: self.fields.take(now),
            shot: self.player.shows(number),
        })
    }

    /// `before`: the frame before, if it is one of the same lot.
    fn look(&self, (frame, before): (&Frame, Option<&Frame>), part: &Frame, asked: Asked) -> Look {
        let label = format!("t = {}", self.moment(frame.time, 1));
        let section = || Section::new(&self.scene, frame, self.axis.at[1], label.clone());
        let field = || Field::new(&self.scene, frame, &self.axis, label.clone());
        Look {
            measured: self.gauge.look(frame, before),
            field: asked.field.then(field),
            shot: asked.shot.then(|| self.player.shot(part)).flatten(),
            panel: asked.panel.then(section),
        }
    }

    /// The title picture is that of the panel with the highest crown (without a pool: the last).
    fn keep_best(&mut self, frame: &Frame, row: &Row) {
        if self.part.solid().dimension == Dimension::Two {
            return;
        }
        let crown = row.iter().find(|(name, _)| name == "crown_height_m");
        let height = crown.map_or(frame.time, |(_, z)| *z);
        let is_better = |(best, _): &(f64, _)| best.is_nan() || height > *best;
        if self.best.as_ref().is_none_or(is_better) {
            self.best = Some((height, frame.clone()));
        }
    }

    /// Writes everything. `provenance`: name and value, shown as given.
    pub fn finish(mut self, provenance: &[(String, String)]) -> Result<PostReport, PostError> {
        if self.series.is_empty() {
            return Err(PostError::Empty);
        }
        pool::blank_early_jet(&mut self.series, self.shift);
        self.series.write(&self.out.join("measures.csv"))?;
        let mut report = Report {
            title: match self.scene.title.as_str() {
                "" => self.scene.name.clone(),
                title => title.to_owned(),
            },
            scene: self.scene.name.clone(),
            provenance: provenance.to_vec(),
            shown: section::words(&self.part),
            ..Report::default()
        };
        self.draw_title(&mut report)?;
        self.draw_player(&mut report);
        self.draw_plots(&mut report)?;
        self.draw_panels(&mut report)?;
        self.draw_fields(&mut report)?;
        let norms = self.norms();
        report.norms = norms.iter().map(|norm| self.norm_cells(norm)).collect();
        let (scene, kind, series) = (&self.scene, self.gauge.kind, &self.series);
        let answers = answer::of(scene, kind, series, self.shift);
        report.results = answer::lines(&answers, self.shift);
        report
            .results
            .extend(summary::of(scene, kind, series, self.shift));
        report.numbers = numbers::of(&self.part)
            .groups
            .into_iter()
            .map(|(title, rows)| {
                (
                    title,
                    rows.into_iter()
                        .map(|r| [r.name, r.text, r.definition])
                        .collect(),
                )
            })
            .collect();
        let losses = loss::warnings(&self.scene, &self.series, contact(&self.scene));
        report.notes = self.notes();
        let missed = self.missed();
        let told = losses.iter().map(|loss| format!("{loss}."));
        let settings = sanity::warnings(&self.part);
        let doubtful = settings.iter().map(|warning| format!("{warning}."));
        report.warnings = self.warnings.clone();
        report
            .warnings
            .extend(doubtful.chain(missed.iter().cloned()).chain(told));
        self.write("report.html", report.html().as_bytes())?;
        let (series, files) = (self.series, self.files);
        Ok(PostReport {
            series,
            results: report.results,
            norms,
            missed,
            losses,
            files,
        })
    }

    fn norms(&self) -> Vec<Norm> {
        let one = |(label, reference): &(String, Reference)| {
            let shift = reference.shift(self.shift);
            compare(&self.series, &reference.table, label, shift)
        };
        self.references.iter().flat_map(one).collect()
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), PostError> {
        let path = self.out.join(name);
        let fail = |source| PostError::Write {
            path: path.clone(),
            source,
        };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(fail)?;
        }
        std::fs::write(&path, bytes).map_err(fail)?;
        self.files.push(PathBuf::from(name));
        Ok(())
    }
}

fn draw_error(what: &str, error: &dyn std::error::Error) -> PostError {
    PostError::Draw {
        what: what.to_owned(),
        problem: error.to_string(),
    }
}
