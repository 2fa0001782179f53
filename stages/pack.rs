//! `pack`: the shape of a body -> its particles, about the body's own origin.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use coronet::particle::pack::{PackError, PackProgress, PackReport};
use coronet::pipeline::{Context, Identity, Output, Progress, Stage, StageError, Work};
use coronet::record::{Checkpoint, checkpoint};
use coronet::scene::Arrangement;
use coronet::scene::input::PackInput;

use crate::body::BODY;
use crate::ranks;
use crate::settings::Forecast;

/// Part of the mass of a body that a lattice may have too much or too little of without a word.
const EXCESS: f64 = 0.05;

/// Time between two reports.
const BETWEEN: Duration = Duration::from_millis(200);

pub struct Pack<'a> {
    pub input: PackInput,
    /// Which body of the scene.
    pub body: usize,
    pub forecast: Forecast<'a>,
    pub identity: Identity,
}

impl Stage for Pack<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn work(&self) -> Option<Work> {
        (self.forecast)()
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let started = Instant::now();
        let mut shown = started;
        let mut watch = |progress: &PackProgress| {
            if shown.elapsed() >= BETWEEN {
                shown = Instant::now();
                report(context, progress, started);
            }
            match context.stopped() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let packed = ranks::pack(self.body, &self.input, &mut watch);
        let (body, report) = packed.map_err(|error| match error {
            PackError::Stopped { .. } => StageError::Interrupted,
            error => StageError::failed(error),
        })?;
        let path = context.output().join(BODY);
        Checkpoint::from(body)
            .write(&path, checkpoint::LEVEL)
            .map_err(StageError::failed)?;
        note(context, &report);
        self.check_mass(context, &report);
        Ok(vec![Output::counted(BODY)])
    }
}

impl Pack<'_> {
    /// Warns if whole layers of a lattice hold more or less than the shape.
    fn check_mass(&self, context: &mut Context, report: &PackReport) {
        let excess = report.mass / report.wanted_mass - 1.0;
        let is_lattice = self.input.packing.arrangement == Arrangement::Lattice;
        if excess.abs() <= EXCESS || !is_lattice || self.input.domain.is_revolved() {
            return;
        }
        let text = format!(
            "body `{}` has {:+.1} % of mass beside its shape, because a lattice has whole layers; \
             make its lengths multiples of pack.spacing, or set pack.arrangement = \"poisson\"",
            self.input.name,
            100.0 * excess
        );
        context.warn(&text);
        context.note(text);
    }
}

fn report(context: &Context, progress: &PackProgress, started: Instant) {
    let PackProgress {
        task,
        done,
        of,
        spread,
    } = *progress;
    let spread = spread.map_or(String::new(), |spread| format!(", {spread:.3} kg/m^3"));
    context.progress(Progress {
        fraction: done as f64 / of.max(1) as f64,
        speed: done as f64 / started.elapsed().as_secs_f64(),
        unit: "iterations/s",
        text: format!("{task} {done} of at most {of}{spread}"),
    });
}

fn note(context: &mut Context, report: &PackReport) {
    context.note(format!(
        "{} particles of {:.6e} {unit}, {:.6e} {unit} required",
        report.count,
        report.mass,
        report.wanted_mass,
        unit = report.unit
    ));
    context.note(format!(
        "standard deviation of density {:.4} kg/m^3 (plain sums of {} particles without a surface: \
         {:.4} kg/m^3), mean {:+.4} kg/m^3",
        report.spread, report.supported, report.supported_spread, report.offset
    ));
    let [least, _, median, _, most] = report.nearest.quantiles;
    context.note(format!(
        "nearest neighbour at {:.3} s0 at least, {:.3} s0 on average (1 %: {least:.3}, median \
         {median:.3}, 99 %: {most:.3})",
        report.nearest.least, report.nearest.mean
    ));
}
