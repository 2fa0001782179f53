//! `post`: the log of frames -> measures, plots, pictures and the report.

use std::path::Path;

use coronet::draw::post;
use coronet::measure::series::Reference;
use coronet::particle::Frame;
use coronet::pipeline::{Context, Identity, Input, Output, Progress, Stage, StageError, Work};
use coronet::record::log;
use coronet::scene::input::{Curve, PostInput};

use crate::journal::FRAMES;
use crate::print::counted;
use crate::relax::UNREST;
use crate::settings::Forecast;
use crate::stop::STOPPED;

/// The table of measures, as [`post::Post`] names it.
pub const MEASURES: &str = "measures.csv";
/// Start of a note about what the report lacks: an instant without a frame, a strange reference.
pub const MISSED: &str = "not drawn";
/// The page of the report.
pub const REPORT: &str = "report.html";

/// Largest number of frames measured in parallel, and of their particles.
const AT_ONCE: usize = 8;
const PARTICLES: usize = 1_000_000;

pub struct Post<'a> {
    pub input: PostInput,
    /// Folder and text of the scene file.
    pub folder: &'a Path,
    pub text: &'a str,
    /// Job that wrote the log.
    pub impact: usize,
    /// Jobs that brought the bodies to rest.
    pub relaxed: Vec<usize>,
    pub forecast: Forecast<'a>,
    pub identity: Identity,
}

impl Post<'_> {
    /// The tables of the curves, of the bytes that the key knows.
    fn references(&self) -> Result<Vec<(String, Reference)>, StageError> {
        let curves = self.input.post.references.iter();
        let table = |curve: &Curve| {
            let path = self.folder.join(&curve.path);
            let table = Reference::parse(&path, &curve.bytes, curve.clock);
            Ok((curve.label.clone(), table.map_err(StageError::failed)?))
        };
        curves.map(table).collect()
    }
}

impl Stage for Post<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn inputs(&self) -> Vec<usize> {
        [&[self.impact], &self.relaxed[..]].concat()
    }

    fn work(&self) -> Option<Work> {
        (self.forecast)()
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let path = context.verified(0, FRAMES)?;
        let scene = &self.input.scene();
        let out = context.output();
        let mut post = post::Post::new(scene, self.references()?, &out);
        for text in unrest(context) {
            post.warn(format!("{text}."));
            context.note(text);
        }
        for text in ends(context) {
            post.remark(format!("The run {text}."));
        }
        let mut frames = log::read_frames(&path).map_err(StageError::failed)?;
        let mut batch = next(&mut frames)?;
        while let Some(last) = batch.last() {
            if context.stopped() {
                return Err(StageError::Interrupted);
            }
            context.progress(Progress {
                fraction: (last.time / scene.impact.end).clamp(0.0, 1.0),
                speed: 0.0,
                unit: "",
                text: format!("frame at {:.2} ms", 1e3 * last.time),
            });
            // The next frames are read while these are measured.
            let (coming, done) = rayon::join(|| next(&mut frames), || post.frames(&batch));
            done.map_err(StageError::failed)?;
            batch = coming?;
        }
        let report = post
            .finish(&self.provenance(context))
            .map_err(StageError::failed)?;
        for norm in &report.norms {
            context.note(format!(
                "{} against {}: L2 {:.1} %, max {:.1} %",
                norm.column,
                norm.label,
                100.0 * norm.l2,
                100.0 * norm.max
            ));
        }
        for loss in &report.losses {
            context.note(loss.to_string());
        }
        for sentence in report.missed {
            context.note(format!("{MISSED}: {sentence}"));
        }
        let files = report
            .files
            .iter()
            .map(|file| file.to_string_lossy().replace('\\', "/"));
        // The page contains time and machine of the run; the other files follow from the frames.
        Ok(files
            .map(|file| match file.as_str() {
                REPORT => Output::shown(file),
                _ => Output::counted(file),
            })
            .collect())
    }
}

/// Notes of the relaxations about bodies that did not come to rest.
fn unrest(context: &Context) -> Vec<String> {
    let mut texts = Vec::new();
    for Input { stamp, .. } in &context.inputs[1..] {
        let restless = stamp.notes.iter().filter(|note| note.starts_with(UNREST));
        let body = &stamp.body;
        texts.extend(restless.map(|note| format!("body `{body}` begins the impact {note}")));
    }
    texts
}

/// Notes of the impact about conditions that have ended it.
fn ends(context: &Context) -> Vec<String> {
    let notes = context.inputs[0].stamp.notes.iter();
    let ends = notes.filter(|note| note.starts_with(STOPPED));
    ends.cloned().collect()
}

/// Number of frames measured in parallel; fewer if they are large.
fn next(frames: &mut log::Frames) -> Result<Vec<Frame>, StageError> {
    let (mut batch, mut particles) = (Vec::new(), 0);
    while batch.len() < AT_ONCE && particles < PARTICLES {
        let Some(frame) = frames.next() else {
            break;
        };
        let frame = frame.map_err(StageError::failed)?;
        particles += frame.id.len();
        batch.push(frame);
    }
    Ok(batch)
}

impl Post<'_> {
    /// The provenance of the numbers in the report.
    fn provenance(&self, context: &Context) -> Vec<(String, String)> {
        let command: Vec<String> = std::env::args_os()
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        let mut lines = vec![
            ("program".to_string(), crate::PROGRAM.to_string()),
            ("command".to_string(), command.join(" ")),
            ("key of this report".to_string(), context.key().to_string()),
        ];
        for input in &context.inputs[..1] {
            let stamp = &input.stamp;
            let mut add = |name: &str, value: String| {
                lines.push((format!("{}: {name}", stamp.label()), value));
            };
            add("key", stamp.key.to_string());
            add("digest", stamp.digest.to_string());
            add("frames", input.folder.join(FRAMES).display().to_string());
            add("started", stamp.started.clone());
            let (wall, cpu) = (stamp.wall_seconds, stamp.cpu_seconds);
            add(
                "time",
                format!(
                    "{wall:.1} s, {cpu:.1} s of CPU, {}",
                    counted(stamp.threads, "thread")
                ),
            );
            for note in &stamp.notes {
                add("note", note.clone());
            }
            for from in &stamp.inputs {
                let name = format!("{} {}", from.stage, from.body);
                lines.push((
                    format!("{}: digest", name.trim_end()),
                    from.digest.to_string(),
                ));
            }
        }
        lines.push(("scene file".to_string(), self.text.to_string()));
        lines
    }
}
