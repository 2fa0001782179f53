//! Settings of the stages: `[pack]`, `[relax]`, `[impact]`, `[frames]` and `[post]`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::schema::{not_negative, positive};
use super::unit::{Density, Length, List, Rate, SpecificEnergy, Time};

/// How a body's particles are first placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Arrangement {
    /// Poisson-disk sampling, then optimisation (Kuri et al.).
    Poisson,
    /// Simple cubic lattice (Nishio et al.).
    Lattice,
}

/// How the particles of a body are placed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pack {
    /// Particle spacing s0.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub spacing: f64,
    #[serde(flatten)]
    pub packing: Packing,
}

/// How particles of a given spacing are placed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Packing {
    /// Poisson-disk sampling and optimisation, or a simple cubic lattice.
    pub arrangement: Arrangement,
    /// Standard deviation of density at which the optimisation is done (poisson).
    #[serde(with = "Density")]
    #[schemars(transform = positive)]
    pub tolerance: f64,
    /// Seed of the sampling (poisson).
    pub seed: u64,
    /// Iterations after which the optimisation fails (poisson).
    #[schemars(range(min = 1))]
    pub iterations: usize,
}

impl Default for Packing {
    fn default() -> Self {
        Packing {
            arrangement: Arrangement::Poisson,
            tolerance: 0.1,
            seed: 1,
            iterations: 2000,
        }
    }
}

/// Run at rest before the impact; absent is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Relax {
    /// Longest simulated time.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub time: f64,
    /// Done when the kinetic energy per mass is below this ...
    #[serde(with = "SpecificEnergy")]
    #[schemars(transform = positive)]
    pub kinetic_energy: f64,
    /// ... and the standard deviation of density of supported particles below this.
    #[serde(with = "Density")]
    #[schemars(transform = positive)]
    pub density_spread: f64,
    /// Deceleration per velocity.
    #[serde(with = "Rate")]
    #[schemars(transform = not_negative)]
    pub damping: f64,
}

impl Default for Relax {
    fn default() -> Self {
        Relax {
            time: 20e-3,
            kinetic_energy: 1e-6,
            density_spread: 1.0,
            damping: 500.0,
        }
    }
}

/// The simulation proper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Impact {
    /// Simulated time to reach.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub end: f64,
    /// Wall-clock time between checkpoints in flight; in no key.
    #[serde(default = "Impact::checkpoint_every", with = "Time")]
    #[schemars(transform = positive)]
    pub checkpoint_every: f64,
}

impl Impact {
    fn checkpoint_every() -> f64 {
        30.0
    }
}

/// What the colour of a particle shows in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Colouring {
    Body,
    Speed,
    Pressure,
}

/// What is recorded for viewers and measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Frames {
    /// Simulated time between frames.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub interval: f64,
    /// Log time over simulated time; 1000 plays a millisecond in a second.
    #[serde(default = "Frames::time_scale")]
    #[schemars(transform = positive)]
    pub time_scale: f64,
    /// What the colours of the particles show.
    #[serde(default = "Frames::colour")]
    pub colour: Colouring,
}

impl Frames {
    fn time_scale() -> f64 {
        1.0
    }
    fn colour() -> Colouring {
        Colouring::Body
    }
}

/// What is drawn and compared.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Post {
    /// Instants of the snapshot panels; none are made after the end.
    #[serde(with = "List::<Time>")]
    #[schemars(transform = not_negative)]
    pub panels: Vec<f64>,
    /// Instants of the averaged pressure and velocity fields; none are made after the end.
    #[serde(with = "List::<Time>")]
    #[schemars(transform = not_negative)]
    pub fields: Vec<f64>,
    /// Curves to draw and compare with.
    pub references: Vec<Reference>,
}

/// No reference curve is longer, bytes.
pub const LONGEST_REFERENCE: u64 = 256 << 20;

/// A reference curve from a CSV file with the column names of `measures.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Name in the plots.
    pub label: String,
    /// CSV file with columns as in measures.csv, from this file.
    #[schemars(with = "String")]
    pub path: PathBuf,
    /// From when its times count: the start of the run, or the contact of the drop. Left out: start
    /// for the column time_s, contact for time_after_contact_s.
    #[serde(default)]
    pub clock: Option<Clock>,
}

/// From which instant the times of a table count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// The start of the run, as in `measures.csv`.
    Start,
    /// The contact of the drop with pool or wall.
    Contact,
}

impl Clock {
    /// Names of the column of times, in seconds, that goes with each clock.
    pub const COLUMNS: [(&'static str, Clock); 2] = [
        ("time_s", Clock::Start),
        ("time_after_contact_s", Clock::Contact),
    ];
}
