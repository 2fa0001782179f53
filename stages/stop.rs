//! Measures the frames of a running impact: figures for its log, and for the conditions of
//! `impact.stop_when`.
//!
//! Only frames decide, so that a run ends at the same instant through any interruption: a
//! checkpoint keeps what is known of the frames before it.

use coronet::measure::ending::{Ending, Memory};
use coronet::measure::gauge::Gauge;
use coronet::measure::series::Row;
use coronet::measure::whole::Unfold;
use coronet::particle::Frame;
use coronet::record::Checkpoint;
use coronet::scene::input::ImpactInput;
use coronet::scene::quantity::{Unit, legible};

/// Start of the note of a run that a condition has ended.
pub const STOPPED: &str = "stopped at ";

/// In the note of each run that had conditions.
pub const CONDITIONS: &str = "impact.stop_when";

/// Start of the names of its scalars in a checkpoint.
const STOP: &str = "stop/";
/// Initial level of the pool above the floor, m; NaN: there is none.
const LEVEL: &str = "frames/level";

/// Measures frames as the evaluation does.
pub struct Stop {
    unfold: Unfold,
    gauge: Gauge,
    ending: Ending,
}

/// What a checkpoint keeps.
pub struct Past {
    level: f64,
    /// If conditions can end the run.
    memory: Option<Memory>,
}

impl Past {
    /// `None` if the checkpoint is not one of an impact.
    pub fn read(checkpoint: &Checkpoint) -> Option<Past> {
        Some(Past {
            level: checkpoint.scalar(LEVEL)?,
            memory: Memory::of(|name| checkpoint.scalar(&format!("{STOP}{name}"))),
        })
    }
}

impl Stop {
    /// `past`: of the frames so far.
    pub fn new(input: &ImpactInput, past: Option<Past>) -> Stop {
        let scene = input.scene();
        let mut gauge = Gauge::new(&scene.whole());
        let level = past.as_ref().map(|past| past.level);
        gauge.start.level = level.filter(|level| !level.is_nan());
        let memory = past.and_then(|past| past.memory).unwrap_or_default();
        Stop {
            unfold: Unfold::new(&scene),
            gauge,
            ending: Ending::new(&input.impact.stop_when, scene.spacing, memory),
        }
    }

    /// Figures of the next frame.
    pub fn look(&mut self, frame: &Frame) -> Row {
        let figures = self.gauge.figures(&self.unfold.whole(frame));
        if self.has_conditions() && !self.is_met() {
            let time = [("time_s".to_string(), frame.time)];
            let scalars = frame.scalars.iter().chain(&time).chain(&figures);
            self.ending.look(&scalars.cloned().collect());
        }
        figures
    }

    /// Whether a frame can end the run.
    pub fn has_conditions(&self) -> bool {
        self.ending.has_conditions()
    }

    /// Whether the run ends.
    pub fn is_met(&self) -> bool {
        self.ending.met().is_some()
    }

    /// Adds to a checkpoint what [`Past::read`] finds there.
    pub fn keep(&self, checkpoint: &mut Checkpoint) {
        let level = self.gauge.start.level.unwrap_or(f64::NAN);
        checkpoint.scalars.push((LEVEL.into(), level));
        if !self.has_conditions() {
            return;
        }
        let numbers = self.ending.memory().numbers().into_iter();
        let named = numbers.map(|(name, number)| (format!("{STOP}{name}"), number));
        checkpoint.scalars.extend(named);
    }

    /// How the run has ended, at `time` of at most `end`, s.
    pub fn note(&self, time: f64, end: f64) -> String {
        let end_text = legible(end, Unit::Time);
        match self.ending.met() {
            Some((condition, at)) if time < end => format!(
                "{STOPPED}t = {:.3} ms by `{}` of {CONDITIONS}, before impact.end = {end_text}",
                1e3 * at,
                condition.word()
            ),
            _ => format!(
                "ran to impact.end = {end_text}: no condition of {CONDITIONS} was met before"
            ),
        }
    }
}
