//! The format of a scene file as data: what may stand where. The parser, the list of known keys
//! and the JSON schema all read these tables, so they cannot disagree.

use super::quantity::Unit;

/// What a number may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    Any,
    Positive,
    NotNegative,
    Between(f64, f64),
}

impl Range {
    /// True if `value` is allowed.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Range::Any => value.is_finite(),
            Range::Positive => value > 0.0 && value.is_finite(),
            Range::NotNegative => value >= 0.0 && value.is_finite(),
            Range::Between(low, high) => value >= low && value <= high,
        }
    }

    /// As in "must be ...".
    pub fn wording(self) -> String {
        match self {
            Range::Any => "finite".to_string(),
            Range::Positive => "above zero".to_string(),
            Range::NotNegative => "zero or above".to_string(),
            Range::Between(low, high) => format!("between {low} and {high}"),
        }
    }
}

/// What a value may be.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// Any text.
    Text,
    /// `"#rrggbb"`.
    Colour,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A number in SI, or a text with a unit.
    Quantity(Unit, Range),
    /// A number without a unit.
    Number(Range),
    /// A whole number, at least this.
    Count(i64),
    /// An array of so many to so many values.
    List(&'static Kind, usize, usize),
    /// Keys of the table, and keys of which exactly one must be there (none: no such rule).
    Table(&'static [Field], &'static [&'static str]),
    /// A table whose keys are names that the user chooses; each holds such a table.
    Named(&'static [Field], &'static [&'static str]),
    /// The first of these that fits.
    Either(&'static [Kind]),
}

/// Whether a key may be left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need {
    Required,
    Optional,
    /// Left out, it has this value, written in TOML.
    Default(&'static str),
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub name: &'static str,
    pub kind: Kind,
    pub need: Need,
    /// One sentence for a person.
    pub about: &'static str,
}

const fn required(name: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        name,
        kind,
        need: Need::Required,
        about,
    }
}

const fn optional(name: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        name,
        kind,
        need: Need::Optional,
        about,
    }
}

const fn default(
    name: &'static str,
    kind: Kind,
    value: &'static str,
    about: &'static str,
) -> Field {
    Field {
        name,
        kind,
        need: Need::Default(value),
        about,
    }
}

const LENGTH: Kind = Kind::Quantity(Unit::Length, Range::Positive);
const TIME: Kind = Kind::Quantity(Unit::Time, Range::Positive);
const POINT: Kind = Kind::List(&Kind::Quantity(Unit::Length, Range::Any), 2, 3);
const SIZES: Kind = Kind::List(&LENGTH, 2, 3);
const VELOCITY: Kind = Kind::List(&Kind::Quantity(Unit::Speed, Range::Any), 2, 3);
const INSTANTS: Kind = Kind::List(
    &Kind::Quantity(Unit::Time, Range::NotNegative),
    0,
    usize::MAX,
);
const SIDE: Kind = Kind::Word(&["periodic", "wall", "open"]);
const SIDES: Kind = Kind::Either(&[SIDE, Kind::List(&SIDE, 2, 2)]);

/// The whole file.
pub static FILE: &[Field] = &[
    default(
        "title",
        Kind::Text,
        "\"\"",
        "What the run is about; stands on the report.",
    ),
    default(
        "dimension",
        Kind::Count(2),
        "3",
        "3, or 2 for the x-z plane.",
    ),
    required(
        "box",
        Kind::Table(BOX, &[]),
        "The box [0, size] in which everything happens.",
    ),
    required(
        "liquid",
        Kind::Table(LIQUID, &[]),
        "The liquid of all bodies.",
    ),
    default(
        "effects",
        Kind::Table(EFFECTS, &[]),
        "{}",
        "What acts: a table each; absent is off.",
    ),
    required(
        "body",
        Kind::Named(BODY, SHAPES),
        "Bodies of liquid, by name.",
    ),
    required(
        "pack",
        Kind::Table(PACK, &[]),
        "How the particles of a body are placed.",
    ),
    optional(
        "relax",
        Kind::Table(RELAX, &[]),
        "Run at rest before the impact; absent is none.",
    ),
    required("impact", Kind::Table(IMPACT, &[]), "The simulation proper."),
    required(
        "frames",
        Kind::Table(FRAMES, &[]),
        "What is recorded for viewers and measures.",
    ),
    default(
        "post",
        Kind::Table(POST, &[]),
        "{}",
        "What is drawn and compared.",
    ),
    default(
        "method",
        Kind::Table(METHOD, &[]),
        "{}",
        "Which solver, with which settings.",
    ),
];

static BOX: &[Field] = &[
    required("size", SIZES, "Lengths along x, y, z (x, z in 2-D)."),
    default(
        "x",
        SIDES,
        "\"periodic\"",
        "Low and high side in x: periodic, wall or open.",
    ),
    default("y", SIDES, "\"periodic\"", "Low and high side in y (3-D)."),
    default(
        "z",
        SIDES,
        "[\"wall\", \"open\"]",
        "Low and high side in z.",
    ),
    default(
        "wall_velocity",
        Kind::Table(WALLS, &[]),
        "{}",
        "Velocities of sliding walls.",
    ),
];

static WALLS: &[Field] = &[
    optional("x_low", VELOCITY, "Velocity of the wall at x = 0."),
    optional(
        "x_high",
        VELOCITY,
        "Velocity of the wall at the far end of x.",
    ),
    optional("y_low", VELOCITY, "Velocity of the wall at y = 0."),
    optional(
        "y_high",
        VELOCITY,
        "Velocity of the wall at the far end of y.",
    ),
    optional("z_low", VELOCITY, "Velocity of the floor."),
    optional("z_high", VELOCITY, "Velocity of the lid."),
];

static LIQUID: &[Field] = &[required(
    "density",
    Kind::Quantity(Unit::Density, Range::Positive),
    "Density at rest.",
)];

static EFFECTS: &[Field] = &[
    optional(
        "gravity",
        Kind::Table(GRAVITY, &[]),
        "A constant acceleration.",
    ),
    optional(
        "viscosity",
        Kind::Table(VISCOSITY, &[]),
        "Newtonian viscosity.",
    ),
    optional("tension", Kind::Table(TENSION, &[]), "Surface tension."),
];

static GRAVITY: &[Field] = &[
    required(
        "acceleration",
        Kind::Quantity(Unit::Acceleration, Range::Positive),
        "Magnitude.",
    ),
    optional(
        "direction",
        Kind::List(&Kind::Number(Range::Any), 2, 3),
        "Direction, of any length; downward if left out.",
    ),
];

static VISCOSITY: &[Field] = &[
    required(
        "dynamic",
        Kind::Quantity(Unit::Viscosity, Range::Positive),
        "Dynamic viscosity.",
    ),
    optional(
        "form",
        Kind::Word(&["two-term", "two-term-exact", "morris"]),
        "Form of the viscous term, in place of the preset's.",
    ),
];

static TENSION: &[Field] = &[
    required(
        "coefficient",
        Kind::Quantity(Unit::Tension, Range::Positive),
        "Surface tension coefficient.",
    ),
    optional(
        "form",
        Kind::Word(&["normalised-colour", "raw-colour"]),
        "Form of the surface stress, in place of the preset's.",
    ),
    optional(
        "strength",
        Kind::Either(&[Kind::Word(&["virial"]), Kind::Number(Range::Positive)]),
        "Factor alpha of the surface stress: a number, or \"virial\" to calibrate it.",
    ),
    optional(
        "smoothing",
        Kind::Number(Range::Between(1.0, 3.0)),
        "Long smoothing length over the short one, H / h.",
    ),
];

/// Keys of a body of which exactly one is there.
pub static SHAPES: &[&str] = &[
    "layer",
    "sphere",
    "disc",
    "ellipsoid",
    "ellipse",
    "block",
    "rectangle",
];

static BODY: &[Field] = &[
    optional(
        "layer",
        Kind::Table(LAYER, &[]),
        "Liquid on the floor, from side to side.",
    ),
    optional("sphere", Kind::Table(SPHERE, &[]), "A sphere (3-D)."),
    optional("disc", Kind::Table(SPHERE, &[]), "A disc (2-D)."),
    optional(
        "ellipsoid",
        Kind::Table(ELLIPSOID, &[]),
        "An ellipsoid along the axes (3-D).",
    ),
    optional(
        "ellipse",
        Kind::Table(ELLIPSOID, &[]),
        "An ellipse along the axes (2-D).",
    ),
    optional(
        "block",
        Kind::Table(BLOCK, &[]),
        "A block along the axes (3-D).",
    ),
    optional(
        "rectangle",
        Kind::Table(BLOCK, &[]),
        "A rectangle along the axes (2-D).",
    ),
    optional(
        "velocity",
        Kind::Either(&[Kind::Quantity(Unit::Speed, Range::Any), VELOCITY]),
        "Initial velocity: a speed downward, or all components.",
    ),
    optional(
        "taylor_green",
        Kind::Table(VORTEX, &[]),
        "Initial velocity: Taylor-Green vortices.",
    ),
    optional(
        "stretch",
        Kind::Table(STRETCH, &[]),
        "Initial velocity: stretching along z.",
    ),
    optional(
        "colour",
        Kind::Colour,
        "Colour in pictures and viewers, \"#rrggbb\".",
    ),
];

static LAYER: &[Field] = &[required("depth", LENGTH, "Depth of the liquid.")];

static SPHERE: &[Field] = &[
    required("diameter", LENGTH, "Diameter."),
    optional("centre", POINT, "Centre, in place of `gap` and `above`."),
    optional(
        "gap",
        Kind::Quantity(Unit::Length, Range::NotNegative),
        "Clear distance from the top of the body `above` which it hangs.",
    ),
    optional(
        "above",
        Kind::Text,
        "Name of that body; it stands earlier in the file.",
    ),
    optional(
        "offset",
        Kind::List(&Kind::Quantity(Unit::Length, Range::Any), 1, 2),
        "Lateral distance from the middle of the box, with `above`.",
    ),
];

static ELLIPSOID: &[Field] = &[
    required(
        "semi_axes",
        SIZES,
        "Half lengths along x, y, z (x, z in 2-D).",
    ),
    required("centre", POINT, "Centre."),
];

static BLOCK: &[Field] = &[
    required("low", POINT, "Lowest corner."),
    required("high", POINT, "Highest corner."),
];

static VORTEX: &[Field] = &[required(
    "speed",
    Kind::Quantity(Unit::Speed, Range::Positive),
    "Largest speed.",
)];

static STRETCH: &[Field] = &[required(
    "rate",
    Kind::Quantity(Unit::Rate, Range::Any),
    "Rate of stretching along z.",
)];

static PACK: &[Field] = &[
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

static RELAX: &[Field] = &[
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

static IMPACT: &[Field] = &[
    required("end", TIME, "Simulated time to reach."),
    default(
        "checkpoint_every",
        TIME,
        "\"30 s\"",
        "Wall-clock time between checkpoints in flight; in no key.",
    ),
];

static FRAMES: &[Field] = &[
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

static POST: &[Field] = &[
    default("panels", INSTANTS, "[]", "Instants of the snapshot panels."),
    default(
        "fields",
        INSTANTS,
        "[]",
        "Instants of the averaged pressure and velocity fields.",
    ),
    default(
        "references",
        Kind::List(&Kind::Table(REFERENCE, &[]), 0, usize::MAX),
        "[]",
        "Curves to draw and compare with.",
    ),
];

static REFERENCE: &[Field] = &[
    required("label", Kind::Text, "Name in the plots."),
    required(
        "path",
        Kind::Text,
        "CSV file with columns as in measures.csv, from this file.",
    ),
];

static METHOD: &[Field] = &[
    default("name", Kind::Word(&["wcsph"]), "\"wcsph\"", "The solver."),
    default(
        "preset",
        Kind::Word(&["paper", "corrected", "modern"]),
        "\"modern\"",
        "As printed; the same with known errors removed; as a specialist would today.",
    ),
    default(
        "wcsph",
        Kind::Table(WCSPH, &[]),
        "{}",
        "Settings of WCSPH in place of the preset's.",
    ),
];

static WCSPH: &[Field] = &[
    optional(
        "kernel",
        Kind::Word(&["cubic-spline", "wendland-c2"]),
        "Smoothing kernel.",
    ),
    optional(
        "smoothing",
        Kind::Number(Range::Between(1.0, 2.5)),
        "Smoothing length h / s0.",
    ),
    optional(
        "density",
        Kind::Either(&[
            Kind::Word(&["summation"]),
            Kind::Table(DENSITY, &["continuity"]),
        ]),
        "\"summation\", or the continuity equation with density diffusion.",
    ),
    optional(
        "pressure",
        Kind::Word(&["clipped", "signed"]),
        "What a pressure below zero becomes.",
    ),
    optional(
        "exponent",
        Kind::Number(Range::Between(1.0, 10.0)),
        "Exponent chi of the equation of state; 1 is linear.",
    ),
    optional(
        "sound_speed_factor",
        Kind::Number(Range::Between(2.0, 1000.0)),
        "Speed of sound over the reference speed; 10 is Mach 0.1.",
    ),
    optional(
        "reference_speed",
        Kind::Either(&[
            Kind::Word(&["scene"]),
            Kind::Quantity(Unit::Speed, Range::Positive),
        ]),
        "A speed, or \"scene\": the largest that the scene suggests.",
    ),
    optional(
        "mass",
        Kind::Word(&["nominal", "lattice-sum"]),
        "rho0 s0^d, or rho0 / lattice sum.",
    ),
    optional(
        "wall_pressure",
        Kind::Word(&["summation", "extrapolated"]),
        "How walls push.",
    ),
    optional(
        "shifting",
        Kind::Number(Range::NotNegative),
        "Strength of particle shifting.",
    ),
    optional(
        "shock_dissipation",
        Kind::Number(Range::NotNegative),
        "Strength of the dissipation in compression.",
    ),
    optional(
        "time_stepping",
        Kind::Table(STEPPING, &["fixed", "adaptive", "dual"]),
        "How the time step is chosen.",
    ),
];

static DENSITY: &[Field] = &[optional(
    "continuity",
    Kind::Table(CONTINUITY, &[]),
    "The continuity equation.",
)];

static CONTINUITY: &[Field] = &[default(
    "diffusion",
    Kind::Number(Range::NotNegative),
    "0.1",
    "Strength delta of the density diffusion.",
)];

static STEPPING: &[Field] = &[
    optional(
        "fixed",
        Kind::Table(FIXED, &[]),
        "The same step throughout.",
    ),
    optional(
        "adaptive",
        Kind::Table(ADAPTIVE, &[]),
        "The least limit, times a factor.",
    ),
    optional(
        "dual",
        Kind::Table(DUAL, &[]),
        "Advective steps with acoustic steps inside.",
    ),
];

static FIXED: &[Field] = &[required("step", TIME, "The step.")];

static ADAPTIVE: &[Field] = &[default(
    "safety",
    Kind::Number(Range::Between(0.01, 2.0)),
    "1",
    "Factor on the limits.",
)];

static DUAL: &[Field] = &[
    default(
        "advective",
        Kind::Number(Range::Between(0.01, 1.0)),
        "0.25",
        "Advective CFL number.",
    ),
    default(
        "acoustic",
        Kind::Number(Range::Between(0.01, 1.0)),
        "0.6",
        "Acoustic CFL number.",
    ),
];
