//! `impact`: relaxed bodies -> the state at the end, and the log of frames.
//!
//! The run ends at the first restartable instant at or after `impact.end`, or after the frame that
//! meets a condition of `impact.stop_when`; a later `impact.end` does not continue that. Frame k is
//! taken at k x `frames.interval`, where a step ends (of fixed steps, after the first one that ends
//! at or after it); a result contains every frame up to its last instant. So the frames of a
//! shorter run are exactly the first frames of a longer one, with any interruptions.

use coronet::file;
use coronet::measure::series::Row;
use coronet::measure::{kind, loss};
use coronet::method::frame::Schedule;
use coronet::method::{self, Phase, Solver};
use coronet::particle::wall;
use coronet::pipeline::{Context, Identity, Output, Relative, Stage, StageError, Work};
use coronet::record::atomic::write_file;
use coronet::record::checkpoint::{self, CheckpointError};
use coronet::record::layout::Layout;
use coronet::record::log::{LogSetup, LogWriter};
use coronet::scene::input::ImpactInput;
use coronet::scene::quantity::{self, Unit};

use crate::body::read_body;
use crate::calibrate;
use crate::flight::{self, Flight};
use crate::journal::{
    FRAMES, Frames, Start, Trouble, adopt, first_cause, merge, next_segment, start,
};
use crate::live::Viewers;
use crate::pace::Pace;
use crate::ranks::{self, Part};
use crate::settings::Forecast;
use crate::stop::Stop;

/// State at the end.
pub const STATE: &str = "state.checkpoint";
/// Layout for viewers that shows the whole log.
pub const LAYOUT: &str = "layout.json";

/// Number of parts of the run between kept checkpoints, from which shorter runs can start.
const PARTS: f64 = 4.0;

pub struct Impact<'a> {
    pub input: ImpactInput,
    /// Wall-clock seconds between checkpoints.
    pub checkpoint_every: f64,
    /// Text of the scene file, for the log.
    pub text: &'a str,
    /// Jobs of the bodies, in the order of the scene.
    pub bodies: Vec<usize>,
    pub calibration: Option<usize>,
    /// Who looks on.
    pub viewers: Option<Viewers>,
    pub forecast: Forecast<'a>,
    pub identity: Identity,
}

impl Stage for Impact<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn inputs(&self) -> Vec<usize> {
        self.bodies
            .iter()
            .copied()
            .chain(self.calibration)
            .collect()
    }

    fn extends(&self) -> Option<&str> {
        Some("impact.end")
    }

    fn begins_from(&self, relatives: &[Relative]) -> Option<usize> {
        let instants = self.instants(relatives, f64::NEG_INFINITY).ok()?;
        instants.first().map(|(_, index, _)| *index)
    }

    fn work(&self) -> Option<Work> {
        (self.forecast)()
    }

    fn remark(&self, name: &str) -> Option<&str> {
        name.starts_with("frames.")
            .then_some("a finished run cannot provide frames of the past")
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        match self.fly(context) {
            Err(Trouble::FramesLost(what)) => {
                context.warn(&format!("{what}; starting from the beginning"));
                flight::clear(context)?;
                self.fly(context).map_err(StageError::from)
            }
            other => other.map_err(StageError::from),
        }
    }
}

impl Impact<'_> {
    fn fly(&self, context: &mut Context) -> Result<Vec<Output>, Trouble> {
        let strength = match self.calibration {
            Some(_) => Some(calibrate::read(context, self.bodies.len())?),
            None => None,
        };
        let start = self.start(context)?;
        if start.resumed {
            context.resumed();
        }
        let resumed_from = start.resumed.then_some(start.state.time);
        let built = ranks::build(
            Part::Impact,
            &self.input.problem,
            start.state,
            Phase::Impact,
            strength,
        );
        let mut solver = built.map_err(StageError::failed)?;
        solver.meet(self.input.frames.interval);
        let mut frames = Frames {
            log: self.open_log(context, resumed_from)?,
            due: Schedule {
                interval: self.input.frames.interval,
                next: start.next,
            },
            taken: start.taken,
            error: None,
            watch: loss::Watch::default(),
            stop: Stop::new(&self.input, start.past),
            warning: None,
        };
        frames.step(solver.as_ref());
        if let Err(error) = self.advance(context, solver.as_mut(), &mut frames) {
            return Err(Trouble::Stage(first_cause(error, frames.log)));
        }
        if frames.stop.has_conditions() {
            let note = frames.stop.note(solver.time(), self.input.impact.end);
            context.note(note);
        }
        let (end, more) = frames.checkpoint(solver.as_ref());
        let taken = frames.taken;
        frames.log.finish().map_err(StageError::failed)?;
        let path = context.output().join(STATE);
        let written = end.write_with(more.as_deref(), &path, checkpoint::LEVEL);
        written.map_err(StageError::failed)?;
        drop(more);
        merge(context, taken)?;
        self.write_layout(context, solver.as_ref())?;
        let mut outputs = vec![Output::counted(STATE), Output::counted(FRAMES)];
        outputs.push(Output::shown(LAYOUT));
        outputs.extend(flight::keep(context)?);
        Ok(outputs)
    }

    /// Steps to the end, with checkpoints.
    fn advance(
        &self,
        context: &Context,
        solver: &mut dyn Solver,
        frames: &mut Frames,
    ) -> Result<(), StageError> {
        let impact = &self.input.impact;
        let mut flight = Flight::new(context, self.checkpoint_every)?;
        let mut pace = Pace::new(solver);
        let mut part = (solver.time() / impact.end * PARTS).floor();
        while solver.time() < impact.end && !frames.is_stopped() {
            let advanced = solver.advance(&mut |solver| frames.step(solver));
            if let Err(diverged) = advanced {
                flight.land(context)?;
                context.report_kept();
                return Err(StageError::failed(diverged));
            }
            frames.check()?;
            if let Some(text) = frames.warning.take() {
                context.warn(&text);
            }
            let progress = (solver.time() / impact.end * PARTS).floor();
            let goes_on = solver.time() < impact.end && !frames.is_stopped();
            let kept = progress > part && goes_on;
            part = progress;
            let stopped = context.stopped() && goes_on;
            if kept || stopped || flight.is_due() {
                let flush = frames
                    .log
                    .flush(solver.time())
                    .map_err(StageError::failed)?;
                flight.save(context, frames.checkpoint(solver), Some(flush), kept)?;
            }
            if stopped {
                flight.land(context)?;
                return Err(StageError::Interrupted);
            }
            flight.collect(context)?;
            pace.report(context, solver, impact.end, "");
        }
        flight.land(context)
    }

    /// The latest known instant: of an unfinished run, of a finished relative, or t = 0.
    fn start(&self, context: &mut Context) -> Result<Start, StageError> {
        let flying = flight::newest(context)?.and_then(start);
        let since = flying
            .as_ref()
            .map_or(f64::NEG_INFINITY, |start| start.state.time);
        if let Some(start) = self.relative(context, since)? {
            return Ok(start);
        }
        if let Some(start) = flying {
            return Ok(start);
        }
        flight::clear(context)?;
        let bodies: Result<Vec<_>, _> = (0..self.bodies.len())
            .map(|body| read_body(context, body, body))
            .collect();
        let scene = &self.input.problem;
        let state = method::initial(&self.input, &bodies?);
        if let Some((body, other, count)) = method::intruders(scene, &state) {
            let name = |body: usize| &scene.bodies[body].name;
            context.warn(&format!(
                "{count} particles of body `{}` start inside body `{}`, where relaxation has \
                 brought them; shorten relax.time, raise relax.damping, or move the bodies apart",
                name(body),
                name(other)
            ));
        }
        Ok(Start {
            state,
            next: 0,
            taken: 0,
            past: None,
            resumed: false,
        })
    }

    /// Instants after `since` of finished runs with another end from which this one can start, the
    /// latest first: time, index of the run, file.
    fn instants<'a>(
        &self,
        relatives: &'a [Relative],
        since: f64,
    ) -> Result<Vec<(f64, usize, &'a str)>, StageError> {
        let end = self.input.impact.end;
        let mut candidates = Vec::new();
        for (index, relative) in relatives.iter().enumerate() {
            for output in &relative.stamp.outputs {
                let path = relative.folder.join(&output.file);
                let is_state = output.file == STATE || output.file.starts_with(flight::KEPT);
                // A folder in place of a file is damage, from which nothing can start.
                if !is_state || file::is_folder(&path)? {
                    continue;
                }
                let peek = match checkpoint::peek(&path) {
                    Ok(peek) => peek,
                    Err(CheckpointError::Io(error)) if !error.is_not_found() => {
                        return Err(error.into());
                    }
                    Err(_) => continue,
                };
                // The final instant of a run with an earlier end may be the first one at or after
                // this end; of other instants only those before this end are useful.
                let shorter = output.file == STATE && run_end(relative).is_some_and(|e| e <= end);
                if peek.time > since && (peek.time < end || shorter) {
                    candidates.push((peek.time, index, output.file.as_str()));
                }
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
        Ok(candidates)
    }

    /// The latest usable instant after `since` of a finished run with another end.
    fn relative(&self, context: &mut Context, since: f64) -> Result<Option<Start>, StageError> {
        let relatives = context.relatives.clone();
        for (time, index, file) in self.instants(&relatives, since)? {
            let relative = &relatives[index];
            match adopt(context, relative, file)? {
                Ok(start) => {
                    let last = checkpoint::peek(&relative.folder.join(STATE));
                    let whole = last.map_or(time, |last| last.time);
                    let past = since.max(0.0);
                    context.goes_on_from(&relative.stamp, (time - past) / whole);
                    return Ok(Some(start));
                }
                Err(what) => {
                    let folder = relative.folder.display();
                    context.warn(&format!("{folder} cannot be continued: {what}"));
                }
            }
        }
        Ok(None)
    }

    fn write_layout(&self, context: &Context, solver: &dyn Solver) -> Result<(), StageError> {
        let scene = &self.input.problem;
        let frame = solver.frame();
        let figures = Stop::new(&self.input, None).look(&frame);
        let names = |row: Row| row.into_iter().map(|(name, _)| name).collect();
        let layout = Layout {
            bodies: scene.bodies.iter().map(|body| body.name.clone()).collect(),
            size: scene.domain.size,
            is_axial: scene.domain.is_axial(),
            figures: names(figures),
            scalars: names(frame.scalars),
        };
        Ok(write_file(
            &context.output().join(LAYOUT),
            layout.json().as_bytes(),
        )?)
    }

    fn open_log(&self, context: &Context, from: Option<f64>) -> Result<LogWriter, StageError> {
        let mut provenance = vec![
            ("program".to_string(), crate::PROGRAM.to_string()),
            ("key".to_string(), context.key().to_string()),
        ];
        for input in &context.inputs {
            provenance.push((input.stamp.label(), input.stamp.digest.to_string()));
        }
        let ImpactInput {
            problem, frames, ..
        } = &self.input;
        let (wall, text) = (wall::build(problem), self.text.to_string());
        let setup = LogSetup {
            contact: kind::contact(&self.input.scene().whole()),
            ..LogSetup::new(problem, frames, &wall, text, provenance)
        };
        let segment = next_segment(context)?;
        let tap = self.viewers.as_ref().map(|viewers| viewers());
        LogWriter::tapped(context.work(), segment, from, &setup, tap).map_err(StageError::failed)
    }
}

/// `impact.end` of a finished run, s.
fn run_end(relative: &Relative) -> Option<f64> {
    quantity::parse(relative.setting("impact.end")?, Unit::Time).ok()
}
