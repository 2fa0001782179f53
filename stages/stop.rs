//! Watches the frames of a running impact for the conditions of `impact.stop_when`.
//!
//! Only frames decide, so that a run ends at the same instant through any interruption: a
//! checkpoint keeps what is known of the frames before it.

use coronet::measure::ending::{Ending, Memory};
use coronet::measure::gauge::{Gauge, Start};
use coronet::measure::whole::Unfold;
use coronet::particle::Frame;
use coronet::record::Checkpoint;
use coronet::scene::input::ImpactInput;
use coronet::scene::quantity::{Unit, human};

/// Start of the note of a run that a condition has ended.
pub const STOPPED: &str = "stopped at ";

/// In the note of each run that had conditions.
pub const CONDITIONS: &str = "impact.stop_when";

/// Start of the names of its scalars in a checkpoint.
const STOP: &str = "stop/";
/// Initial level of the pool above the floor, m; NaN: there is none.
const LEVEL: &str = "stop/level";

/// Measures frames as the evaluation does.
pub struct Stop {
    unfold: Unfold,
    gauge: Gauge,
    ending: Ending,
}

/// What a checkpoint keeps.
pub struct Past {
    level: f64,
    memory: Memory,
}

impl Past {
    /// `None` if the run had no conditions.
    pub fn read(checkpoint: &Checkpoint) -> Option<Past> {
        Some(Past {
            level: checkpoint.scalar(LEVEL)?,
            memory: Memory::of(|name| checkpoint.scalar(&format!("{STOP}{name}")))?,
        })
    }
}

impl Stop {
    /// `None` without conditions; `past`: of the frames so far.
    pub fn new(input: &ImpactInput, past: Option<Past>) -> Option<Stop> {
        let conditions = &input.impact.stop_when;
        if conditions.is_empty() {
            return None;
        }
        let scene = input.scene();
        let mut gauge = Gauge::new(&scene.whole());
        let level = past.as_ref().map(|past| past.level);
        gauge.start = Start {
            level: level.filter(|level| !level.is_nan()),
            ..Start::default()
        };
        let memory = past.map_or(Memory::default(), |past| past.memory);
        Some(Stop {
            unfold: Unfold::new(&scene),
            gauge,
            ending: Ending::new(conditions, scene.spacing, memory),
        })
    }

    /// Looks at the next frame.
    pub fn look(&mut self, frame: &Frame) {
        if self.is_met() {
            return;
        }
        let row = self.gauge.measure(&self.unfold.whole(frame));
        self.ending.look(&row);
    }

    /// Whether the run ends.
    pub fn is_met(&self) -> bool {
        self.ending.met().is_some()
    }

    /// Adds to a checkpoint what [`Past::read`] finds there.
    pub fn keep(&self, checkpoint: &mut Checkpoint) {
        let level = self.gauge.start.level.unwrap_or(f64::NAN);
        checkpoint.scalars.push((LEVEL.into(), level));
        let numbers = self.ending.memory().numbers().into_iter();
        let named = numbers.map(|(name, number)| (format!("{STOP}{name}"), number));
        checkpoint.scalars.extend(named);
    }

    /// How the run has ended, at `time` of at most `end`, s.
    pub fn note(&self, time: f64, end: f64) -> String {
        let end_text = human(end, Unit::Time);
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
