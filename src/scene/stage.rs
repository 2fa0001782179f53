//! Settings of the stages: `[pack]`, `[relax]`, `[impact]`, `[frames]` and `[post]`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::schema::{not_negative, positive};
use super::unit::{Density, Length, List, Rate, SpecificEnergy, Time};

/// Initial arrangement of the particles of a body.
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
    /// Standard deviation of density at which the optimisation ends (poisson).
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

/// Relaxation at rest before the impact; none if absent.
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

/// The simulation of the impact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Impact {
    /// Simulated time to reach.
    #[serde(with = "Time")]
    #[schemars(transform = positive)]
    pub end: f64,
    /// Conditions of which the first one that is met ends the run before `end`. They are looked for
    /// in each frame. `crater-deepest`: the surface on the axis has risen from the deepest point of
    /// the crater by a tenth of its depth and by a particle spacing; `level-crossed`: after the
    /// crater it is above the initial level; `rebound`: a drop that has wetted a wall has left it;
    /// each in 3 frames one after the other. `rest`: the kinetic energy is below a hundredth of its
    /// largest value in 10 frames one after the other.
    #[serde(default)]
    pub stop_when: Vec<StopWhen>,
    /// Wall-clock time between checkpoints of a running stage; in no key.
    #[serde(default = "Impact::checkpoint_every", with = "Time")]
    #[schemars(transform = positive)]
    pub checkpoint_every: f64,
}

/// A condition that ends a run, in the measures of its frames.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum StopWhen {
    /// The crater has passed its largest depth.
    CraterDeepest,
    /// The surface on the axis has risen through the initial level after the crater.
    LevelCrossed,
    /// A drop that has wetted a wall has left it.
    Rebound,
    /// The liquid has come to rest.
    Rest,
}

impl StopWhen {
    /// All, in their order.
    pub const ALL: [StopWhen; 4] = [
        StopWhen::CraterDeepest,
        StopWhen::LevelCrossed,
        StopWhen::Rebound,
        StopWhen::Rest,
    ];

    /// As in a scene file.
    pub fn word(self) -> &'static str {
        match self {
            StopWhen::CraterDeepest => "crater-deepest",
            StopWhen::LevelCrossed => "level-crossed",
            StopWhen::Rebound => "rebound",
            StopWhen::Rest => "rest",
        }
    }
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
    /// Colour of the body.
    Body,
    /// Speed of the particle.
    Speed,
    /// Pressure at the particle.
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
    /// Size, letters and resolution of plots and fields.
    pub figures: FigureStyle,
}

/// Size, letters and resolution of plots and fields. The report, SVG and PDF have no resolution.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct FigureStyle {
    /// Width of a figure, from 30 mm to 500 mm.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub width: f64,
    /// Height of a plot, from 30 mm to 500 mm; fields are as high as their liquid.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub height: f64,
    /// Size of letters, points of 1/72 inch.
    #[schemars(range(min = 4.0, max = 36.0))]
    pub font_size: f64,
    /// Pixels per inch of the PNG files.
    #[schemars(range(min = 30.0, max = 600.0))]
    pub dpi: f64,
}

impl Default for FigureStyle {
    fn default() -> Self {
        FigureStyle {
            width: 0.14,
            height: 0.09,
            font_size: 9.0,
            dpi: 300.0,
        }
    }
}

/// Largest size of a reference curve, bytes.
pub const LONGEST_REFERENCE: u64 = 256 << 20;

/// A reference curve from a CSV file with the column names of `measures.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reference {
    /// Name in the plots.
    pub label: String,
    /// CSV file with columns as in measures.csv; its path is relative to this file.
    #[schemars(with = "String")]
    pub path: PathBuf,
    /// Zero of its times: the start of the run, or the contact of the drop. Left out: start for the
    /// column time_s, contact for time_after_contact_s.
    #[serde(default)]
    pub clock: Option<Clock>,
}

/// Zero of the times of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// The start of the run, as in `measures.csv`.
    Start,
    /// The contact of the drop with pool or wall.
    Contact,
}

impl Clock {
    /// Name of the column of times, in seconds, for each clock.
    pub const COLUMNS: [(&'static str, Clock); 2] = [
        ("time_s", Clock::Start),
        ("time_after_contact_s", Clock::Contact),
    ];

    /// A time from contact, s; `None` before it, and if there is none. `time` and `contact` in s
    /// from the start of the run.
    pub fn after_contact(time: f64, contact: Option<f64>) -> Option<f64> {
        let after = contact.map(|contact| time - contact);
        after.filter(|after| *after >= 0.0)
    }
}
