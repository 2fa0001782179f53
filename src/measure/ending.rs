//! What ends a run before its end: the conditions of `impact.stop_when`, in the measures of frames.
//!
//! With z the level on the axis, its lowest value so far the deepest point of the crater, and s0
//! the particle spacing:
//!
//! * `crater-deepest`: z is above the lowest by [`RISEN`] of that depth, and by s0.
//! * `level-crossed`: z >= 0, the initial level.
//! * `rebound`: the spread factor is 0 and was not.
//! * `rest`: the kinetic energy is below [`CALM`] of its largest value so far.
//!
//! A crater is one from [`CRATER`] s0 on: in front of a drop the level of a pool is uncertain by a
//! part of s0. Spray and drops that come later cross the axis for a frame or two, so that the first
//! three have to hold in [`FRAMES`] frames one after the other. A drop that swings is slow at each
//! turn, with less than a hundredth of its energy for a sixteenth of the time (asin(0.1) / (pi/2)):
//! [`STILL`] frames are more than that as long as there are fewer than 160 in half a period.
//!
//! Test: tests/engine/measure_ending.rs, tests/pipeline/stop.rs.

use super::series::Row;
use crate::scene::StopWhen;

/// Part of the largest depth by which the floor of a crater has to rise.
const RISEN: f64 = 0.1;
/// Least depth of a crater, in particle spacings.
const CRATER: f64 = 2.0;
/// Part of the largest kinetic energy below which liquid is at rest: a tenth of the speed.
const CALM: f64 = 0.01;
/// Number of frames in which a condition has to hold.
const FRAMES: f64 = 3.0;
/// The same for rest.
const STILL: f64 = 10.0;

/// Watches the measures of frames for the conditions.
#[derive(Clone, Debug)]
pub struct Ending {
    conditions: Vec<StopWhen>,
    /// Particle spacing, m.
    spacing: f64,
    memory: Memory,
}

/// What is known of the frames so far; all numbers, so that a checkpoint can keep it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Memory {
    /// Lowest level on the axis, m; NaN: none yet, as the next two.
    lowest: f64,
    /// Largest spread factor.
    widest: f64,
    /// Largest kinetic energy, J.
    liveliest: f64,
    /// Number of frames for which each of [`StopWhen::ALL`] has held.
    held: [f64; 4],
    /// Place in [`StopWhen::ALL`] of the condition that is met; NaN: none yet.
    met: f64,
    /// Time of that frame, s.
    time: f64,
}

/// The condition that has ended a run, and the time of its frame, s.
pub type Met = (StopWhen, f64);

impl Default for Memory {
    fn default() -> Self {
        let none = f64::NAN;
        Memory {
            lowest: none,
            widest: none,
            liveliest: none,
            held: [0.0; 4],
            met: none,
            time: none,
        }
    }
}

impl Memory {
    /// Its numbers by name.
    pub fn numbers(&self) -> [(&'static str, f64); 9] {
        let [crater, level, rebound, rest] = self.held;
        [
            ("lowest", self.lowest),
            ("widest", self.widest),
            ("liveliest", self.liveliest),
            ("held/crater-deepest", crater),
            ("held/level-crossed", level),
            ("held/rebound", rebound),
            ("held/rest", rest),
            ("met", self.met),
            ("time", self.time),
        ]
    }

    /// From the numbers of these names; `None` if one is missing.
    pub fn of(number: impl Fn(&str) -> Option<f64>) -> Option<Memory> {
        let names = Memory::default().numbers().map(|(name, _)| number(name));
        let mut values = [f64::NAN; 9];
        for (value, found) in values.iter_mut().zip(names) {
            *value = found?;
        }
        let [
            lowest,
            widest,
            liveliest,
            crater,
            level,
            rebound,
            rest,
            met,
            time,
        ] = values;
        Some(Memory {
            lowest,
            widest,
            liveliest,
            held: [crater, level, rebound, rest],
            met,
            time,
        })
    }
}

impl Ending {
    /// For frames that follow those in `memory`; `spacing`: of the particles, m.
    pub fn new(conditions: &[StopWhen], spacing: f64, memory: Memory) -> Ending {
        Ending {
            conditions: conditions.to_vec(),
            spacing,
            memory,
        }
    }

    /// Whether a frame can meet any.
    pub fn has_conditions(&self) -> bool {
        !self.conditions.is_empty()
    }

    /// What it knows of the frames so far.
    pub fn memory(&self) -> Memory {
        self.memory
    }

    /// The first condition that was met.
    pub fn met(&self) -> Option<Met> {
        // NaN is no place.
        let is_it = |place: &usize| *place as f64 == self.memory.met;
        let place = (0..StopWhen::ALL.len()).find(is_it)?;
        Some((StopWhen::ALL[place], self.memory.time))
    }

    /// Looks at the measures of the next frame. After a condition is met nothing changes any more.
    pub fn look(&mut self, row: &Row) {
        if self.met().is_some() {
            return;
        }
        let value = |name: &str| {
            let found = row.iter().find(|(known, _)| known == name);
            found.map_or(f64::NAN, |(_, value)| *value)
        };
        let [level, spread] = ["axis_level_m", "spread_factor"].map(value);
        let kinetic = value("kinetic_energy_J");
        let memory = &mut self.memory;
        // Of NaN and a number, both are the number.
        memory.lowest = memory.lowest.min(level);
        memory.widest = memory.widest.max(spread);
        memory.liveliest = memory.liveliest.max(kinetic);
        let depth = -memory.lowest;
        let is_crater = depth >= CRATER * self.spacing;
        let rise = (RISEN * depth).max(self.spacing);
        for (place, condition) in StopWhen::ALL.into_iter().enumerate() {
            let (holds, frames) = match condition {
                StopWhen::CraterDeepest => (is_crater && level + depth >= rise, FRAMES),
                StopWhen::LevelCrossed => (is_crater && level >= 0.0, FRAMES),
                StopWhen::Rebound => (memory.widest > 0.0 && spread == 0.0, FRAMES),
                StopWhen::Rest => (kinetic < CALM * memory.liveliest, STILL),
            };
            let held = &mut memory.held[place];
            *held = if holds { *held + 1.0 } else { 0.0 };
            let is_met = *held >= frames && self.conditions.contains(&condition);
            if is_met && memory.met.is_nan() {
                (memory.met, memory.time) = (place as f64, value("time_s"));
            }
        }
    }
}
