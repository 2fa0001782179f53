//! `[method]`.

use super::{Field, Kind, Range, TIME, Unit, default, optional, required};

pub static METHOD: &[Field] = &[
    default(
        "name",
        Kind::Word(&["wcsph", "isph", "mps"]),
        "\"wcsph\"",
        "The solver.",
    ),
    default(
        "preset",
        Kind::Word(&["paper", "corrected", "modern"]),
        "\"modern\"",
        "As printed; the same with known errors removed; as a specialist would today.",
    ),
    default(
        "precision",
        Kind::Word(&["single", "mixed", "double"]),
        "\"mixed\"",
        "Of the pair sums: f32 throughout, f32 from the exact separations on, or f64.",
    ),
    default(
        "slack",
        Kind::Number(Range::Between(0.0, 0.5)),
        "0.1",
        "Extra reach of neighbour rows over the support: more is longer rows, found more seldom.",
    ),
    default(
        "wcsph",
        Kind::Table(WCSPH, &[]),
        "{}",
        "Settings of WCSPH in place of the preset's.",
    ),
    default(
        "isph",
        Kind::Table(ISPH, &[]),
        "{}",
        "Settings of ISPH in place of the preset's.",
    ),
    default(
        "mps",
        Kind::Table(MPS, &[]),
        "{}",
        "Settings of MPS in place of the preset's.",
    ),
];

pub static MPS: &[Field] = &[
    optional(
        "radius",
        Kind::Number(Range::Between(1.5, 5.0)),
        "Radius r_e / l0 of number density and gradient.",
    ),
    optional(
        "laplacian_radius",
        Kind::Number(Range::Between(2.0, 5.0)),
        "Radius r_e / l0 of the Laplacian.",
    ),
    optional(
        "core",
        Kind::Number(Range::Between(0.0, 1.5)),
        "Distance over l0 below which the weight of gradients stays what it is there.",
    ),
    optional(
        "beta",
        Kind::Number(Range::Between(0.5, 1.0)),
        "Number density over n0 below which a particle is at the free surface.",
    ),
    POISSON,
    optional(
        "closure",
        Kind::Word(&["threshold", "completed"]),
        "How the pressure ends at a free surface: zero below `beta`, or without flags.",
    ),
    optional(
        "gradient",
        Kind::Word(&["minimum", "symmetric", "corrected", "blended"]),
        "Pressure gradient: from the least pressure about, one that keeps momentum, one exact for \
         linear pressure, or that with a smooth weight near free surfaces.",
    ),
    optional(
        "pressure",
        Kind::Word(&["clipped", "signed"]),
        "What a pressure below zero becomes.",
    ),
    PRECONDITIONER,
    TOLERANCE,
    ITERATIONS,
    SHIFTING,
    THETA,
    COURANT,
    SHORTEST,
    LONGEST,
    COHESION,
];

pub static ISPH: &[Field] = &[
    KERNEL,
    SMOOTHING,
    MASS,
    POISSON,
    optional(
        "closure",
        Kind::Word(&["mirrored", "completed"]),
        "How the pressure ends at a free surface: at flagged particles, or without flags.",
    ),
    optional(
        "gradient",
        Kind::Word(&["symmetric", "corrected"]),
        "Pressure gradient that keeps momentum, or one exact for linear pressure.",
    ),
    PRECONDITIONER,
    TOLERANCE,
    ITERATIONS,
    SHIFTING,
    THETA,
    COURANT,
    SHORTEST,
    LONGEST,
    COHESION,
];

static EITHER_SOURCE: &[Kind] = &[
    Kind::Word(&["density"]),
    Kind::Table(SOURCE, &["divergence"]),
];

const POISSON: Field = optional(
    "source",
    Kind::Either(EITHER_SOURCE),
    "What the pressure makes: density rho0 at once, or no divergence.",
);

const PRECONDITIONER: Field = optional(
    "preconditioner",
    Kind::Word(&["none", "diagonal", "ssor", "multigrid"]),
    "Preconditioner of the conjugate gradients.",
);

const TOLERANCE: Field = optional(
    "tolerance",
    Kind::Number(Range::Between(1e-14, 0.1)),
    "Residual over right-hand side at which the pressure is found.",
);

const ITERATIONS: Field = optional(
    "iterations",
    Kind::Count(1),
    "Most iterations of one solution.",
);

const THETA: Field = optional(
    "theta",
    Kind::Number(Range::Between(0.5, 1.0)),
    "Part of a step after which the flow has no divergence (theta method); 1: implicit Euler.",
);

const COURANT: Field = optional(
    "courant",
    Kind::Number(Range::Between(0.001, 5.0)),
    "Spacings that the fastest particle crosses in a step.",
);

const SHORTEST: Field = optional("shortest", TIME, "Shortest time step.");

const LONGEST: Field = optional(
    "longest",
    Kind::Either(&[Kind::Word(&["none"]), TIME]),
    "Longest time step, or \"none\".",
);

const COHESION: Field = optional(
    "cohesion",
    Kind::Number(Range::NotNegative),
    "What a free surface holds before it tears, in (d - 1) sigma / h.",
);

pub static SOURCE: &[Field] = &[optional(
    "divergence",
    Kind::Table(DIVERGENCE, &[]),
    "No divergence.",
)];

pub static DIVERGENCE: &[Field] = &[default(
    "density",
    Kind::Number(Range::Between(0.0, 1.0)),
    "0.01",
    "Part of the deviation of density that goes in a step at the scene's speed.",
)];

const KERNEL: Field = optional(
    "kernel",
    Kind::Word(&["cubic-spline", "wendland-c2"]),
    "Smoothing kernel.",
);

const SMOOTHING: Field = optional(
    "smoothing",
    Kind::Number(Range::Between(1.0, 2.5)),
    "Smoothing length h / s0.",
);

const MASS: Field = optional(
    "mass",
    Kind::Word(&["nominal", "lattice-sum"]),
    "rho0 s0^d, or rho0 / lattice sum.",
);

const SHIFTING: Field = optional(
    "shifting",
    Kind::Number(Range::NotNegative),
    "Strength of particle shifting.",
);

pub static WCSPH: &[Field] = &[
    KERNEL,
    SMOOTHING,
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
        Kind::Word(&["clipped", "controlled", "signed", "tearing"]),
        "What a pressure below zero becomes: zero; itself, with or without control of the tensile \
         instability; or itself, but at a free surface no less than tension can hold.",
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
        "sound_speed",
        Kind::Word(&["adaptive", "constant"]),
        "Whether the speed of sound follows the largest speed of the moment.",
    ),
    optional(
        "reference_speed",
        Kind::Either(&[
            Kind::Word(&["scene"]),
            Kind::Quantity(Unit::Speed, Range::Positive),
        ]),
        "A speed, or \"scene\": the largest that the scene suggests.",
    ),
    MASS,
    optional(
        "wall_pressure",
        Kind::Word(&["summation", "extrapolated"]),
        "How walls push.",
    ),
    SHIFTING,
    optional(
        "time_stepping",
        Kind::Table(STEPPING, &["fixed", "adaptive", "dual"]),
        "How the time step is chosen.",
    ),
];

pub static DENSITY: &[Field] = &[optional(
    "continuity",
    Kind::Table(CONTINUITY, &[]),
    "The continuity equation.",
)];

pub static CONTINUITY: &[Field] = &[
    default(
        "diffusion",
        Kind::Number(Range::NotNegative),
        "0.1",
        "Strength delta of the density diffusion.",
    ),
    default(
        "compaction",
        Kind::Either(&[
            Kind::Word(&["none"]),
            Kind::Number(Range::Between(1.02, 2.0)),
        ]),
        "1.1",
        "Kernel sum from which crushed liquid shows its density.",
    ),
];

pub static STEPPING: &[Field] = &[
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

pub static FIXED: &[Field] = &[required("step", TIME, "The step.")];

pub static ADAPTIVE: &[Field] = &[
    default(
        "safety",
        Kind::Number(Range::Between(0.01, 5.0)),
        "1",
        "Factor on the limits.",
    ),
    default(
        "tension",
        Kind::Word(&["each", "held"]),
        "\"each\"",
        "Found in each step, or held while neighbour rows last, up to the capillary limit.",
    ),
];

pub static DUAL: &[Field] = &[
    default(
        "advective",
        Kind::Number(Range::Between(0.01, 5.0)),
        "0.25",
        "Advective CFL number.",
    ),
    default(
        "acoustic",
        Kind::Number(Range::Between(0.01, 5.0)),
        "0.6",
        "Acoustic CFL number.",
    ),
];
