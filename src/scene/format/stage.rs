//! `[pack]`, `[relax]`, `[impact]`, `[frames]` and `[post]`.

use super::{Field, Kind, LENGTH, Range, TIME, Unit, default, optional, required};

const INSTANTS: Kind = Kind::List(
    &Kind::Quantity(Unit::Time, Range::NotNegative),
    0,
    usize::MAX,
);

pub static PACK: &[Field] = &[
    required("spacing", LENGTH, "Particle spacing s0."),
    default(
        "arrangement",
        Kind::Word(&["poisson", "lattice"]),
        "\"poisson\"",
        "Poisson-disk sampling and optimisation, or a simple cubic lattice.",
    ),
    default(
        "tolerance",
        Kind::Quantity(Unit::Density, Range::Positive),
        "\"0.1 kg/m^3\"",
        "Standard deviation of density at which the optimisation is done (poisson).",
    ),
    default(
        "seed",
        Kind::Count(0),
        "1",
        "Seed of the sampling (poisson).",
    ),
    default(
        "iterations",
        Kind::Count(1),
        "2000",
        "Iterations after which it fails (poisson).",
    ),
];

pub static RELAX: &[Field] = &[
    default("time", TIME, "\"20 ms\"", "Longest simulated time."),
    default(
        "kinetic_energy",
        Kind::Quantity(Unit::SpecificEnergy, Range::Positive),
        "\"1 uJ/kg\"",
        "Done when the kinetic energy per mass is below this ...",
    ),
    default(
        "density_spread",
        Kind::Quantity(Unit::Density, Range::Positive),
        "\"1 kg/m^3\"",
        "... and the standard deviation of density below this.",
    ),
    default(
        "damping",
        Kind::Quantity(Unit::Rate, Range::NotNegative),
        "\"500 1/s\"",
        "Deceleration per velocity.",
    ),
];

pub static IMPACT: &[Field] = &[
    required("end", TIME, "Simulated time to reach."),
    default(
        "checkpoint_every",
        TIME,
        "\"30 s\"",
        "Wall-clock time between checkpoints in flight; in no key.",
    ),
];

pub static FRAMES: &[Field] = &[
    required("interval", TIME, "Simulated time between frames."),
    default(
        "time_scale",
        Kind::Number(Range::Positive),
        "1",
        "Log time over simulated time; 1000 plays a millisecond in a second.",
    ),
    default(
        "colour",
        Kind::Word(&["body", "speed", "pressure"]),
        "\"body\"",
        "What the colours of the particles show.",
    ),
];

pub static POST: &[Field] = &[
    default(
        "panels",
        INSTANTS,
        "[]",
        "Instants of the snapshot panels; none are made after the end.",
    ),
    default(
        "fields",
        INSTANTS,
        "[]",
        "Instants of the averaged pressure and velocity fields; none are made after the end.",
    ),
    default(
        "references",
        Kind::List(&Kind::Table(REFERENCE, &[]), 0, usize::MAX),
        "[]",
        "Curves to draw and compare with.",
    ),
];

pub static REFERENCE: &[Field] = &[
    required("label", Kind::Text, "Name in the plots."),
    required(
        "path",
        Kind::Text,
        "CSV file with columns as in measures.csv, from this file.",
    ),
    optional(
        "clock",
        Kind::Word(&["start", "contact"]),
        "From when its times count: the start of the run, or the contact of the drop. Left out: \
         start for the column time_s, contact for time_after_contact_s.",
    ),
];
