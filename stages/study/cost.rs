//! The cost of a point of a study.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::study::trial::Outcome;
use crate::watch::duration;

/// Cost of the impact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Cost {
    /// CPU seconds of all threads.
    #[default]
    Cpu,
    /// Wall time, s.
    Wall,
    /// Peak memory of the process, MB.
    Memory,
}

impl Cost {
    /// The cost of a point; NaN if unknown.
    pub fn of(self, outcome: &Outcome) -> f64 {
        let Outcome::Done {
            cpu_seconds,
            wall_seconds,
            memory_bytes,
            ..
        } = outcome
        else {
            return f64::NAN;
        };
        match self {
            Cost::Cpu => *cpu_seconds,
            Cost::Wall => *wall_seconds,
            Cost::Memory => memory_bytes.map_or(f64::NAN, |bytes| bytes as f64 * 1e-6),
        }
    }

    /// Name, as in "time ~ N^1.1".
    pub fn word(self) -> &'static str {
        match self {
            Cost::Memory => "memory",
            _ => "time",
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Cost::Cpu => "CPU time",
            Cost::Wall => "wall time",
            Cost::Memory => "memory",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Cost::Memory => "MB",
            _ => "s",
        }
    }

    /// For a table, to two digits or whole units: "76 s".
    pub fn short(self, value: f64) -> String {
        let after = (1.0 - value.log10().floor()).clamp(0.0, 4.0) as usize;
        format!("{value:.after$} {}", self.unit())
    }

    /// For a sentence: "2 min of CPU".
    pub fn long(self, value: f64) -> String {
        match self {
            Cost::Cpu => format!("{} of CPU", duration(value)),
            Cost::Wall => format!("{} by the clock", duration(value)),
            Cost::Memory => format!("{} of memory", self.short(value)),
        }
    }
}
