//! `[box]`, `[liquid]`, `[effects]` and `[body]`.

use super::{Field, Kind, LENGTH, Range, Unit, default, optional, required};

const POINT: Kind = Kind::List(&Kind::Quantity(Unit::Length, Range::Any), 2, 3);
const SIZES: Kind = Kind::List(&LENGTH, 2, 3);
const VELOCITY: Kind = Kind::List(&Kind::Quantity(Unit::Speed, Range::Any), 2, 3);
const SIDE: Kind = Kind::Word(&["periodic", "wall", "open"]);
const LATERAL: Kind = Kind::Word(&["periodic", "wall", "open", "mirror"]);
const LATERALS: Kind = Kind::Either(&[LATERAL, Kind::List(&LATERAL, 2, 2)]);
const SIDES: Kind = Kind::Either(&[SIDE, Kind::List(&SIDE, 2, 2)]);

pub static BOX: &[Field] = &[
    required("size", SIZES, "Lengths along x, y, z (x, z in 2-D)."),
    default(
        "x",
        LATERALS,
        "\"periodic\"",
        "Low and high side in x: periodic, wall, open or mirror.",
    ),
    default(
        "y",
        LATERALS,
        "\"periodic\"",
        "Low and high side in y (3-D).",
    ),
    default(
        "z",
        SIDES,
        "[\"wall\", \"open\"]",
        "Low and high side in z.",
    ),
    optional(
        "symmetry",
        Kind::Word(&["half", "quarter"]),
        "Simulates a part of a symmetric scene: half in x, or a quarter in x and y.",
    ),
    default(
        "wall_velocity",
        Kind::Table(WALLS, &[]),
        "{}",
        "Velocities of sliding walls.",
    ),
];

pub static WALLS: &[Field] = &[
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

pub static LIQUID: &[Field] = &[required(
    "density",
    Kind::Quantity(Unit::Density, Range::Positive),
    "Density at rest.",
)];

pub static EFFECTS: &[Field] = &[
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
    optional(
        "wetting",
        Kind::Table(WETTING, &[]),
        "Contact angle on the walls; needs tension.",
    ),
];

pub static WETTING: &[Field] = &[
    optional("angle", CONTACT, "Contact angle, through the liquid."),
    optional(
        "form",
        Kind::Word(&["young", "particle-types"]),
        "How a wall gives it, in place of the preset's.",
    ),
    optional(
        "layers",
        Kind::List(&Kind::Number(Range::Positive), 3, 3),
        "L1, L2, L3 of particle-types, in spacings.",
    ),
    optional(
        "advancing",
        CONTACT,
        "In place of `angle`: that at which a contact line begins to advance.",
    ),
    optional(
        "receding",
        CONTACT,
        "With `advancing`: that at which a contact line begins to recede.",
    ),
];

const CONTACT: Kind = Kind::Quantity(Unit::Angle, Range::Between(0.0, 180.0));

pub static GRAVITY: &[Field] = &[
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

pub static VISCOSITY: &[Field] = &[
    required(
        "dynamic",
        Kind::Quantity(Unit::Viscosity, Range::Positive),
        "Dynamic viscosity.",
    ),
    optional(
        "form",
        Kind::Word(&["two-term", "two-term-exact", "morris", "cleary"]),
        "Form of the viscous term, in place of the preset's.",
    ),
];

pub static TENSION: &[Field] = &[
    required(
        "coefficient",
        Kind::Quantity(Unit::Tension, Range::Positive),
        "Surface tension coefficient.",
    ),
    optional(
        "form",
        Kind::Word(&[
            "normalised-colour",
            "raw-colour",
            "surface-energy",
            "cahn-hilliard",
            "number-density",
            "number-density-exact",
        ]),
        "Form of the tension, in place of the preset's; surface-energy: derived from an energy.",
    ),
    optional(
        "strength",
        Kind::Either(&[
            Kind::Word(&["virial", "flat"]),
            Kind::Number(Range::Positive),
        ]),
        "Factor alpha of the surface stress: a number, calibrated, or that of a flat interface.",
    ),
    optional(
        "smoothing",
        Kind::Number(Range::Between(0.5, 3.0)),
        "Long smoothing length over the short one, H / h.",
    ),
    optional(
        "level",
        Kind::Word(&["inside", "surface"]),
        "Where the tension counts as sigma: where the stress acts, or at the surface (raw-colour).",
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

pub static BODY: &[Field] = &[
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

pub static LAYER: &[Field] = &[required("depth", LENGTH, "Depth of the liquid.")];

pub static SPHERE: &[Field] = &[
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

pub static ELLIPSOID: &[Field] = &[
    required(
        "semi_axes",
        SIZES,
        "Half lengths along x, y, z (x, z in 2-D).",
    ),
    required("centre", POINT, "Centre."),
];

pub static BLOCK: &[Field] = &[
    required("low", POINT, "Lowest corner."),
    required("high", POINT, "Highest corner."),
];

pub static VORTEX: &[Field] = &[required(
    "speed",
    Kind::Quantity(Unit::Speed, Range::Positive),
    "Largest speed.",
)];

pub static STRETCH: &[Field] = &[required(
    "rate",
    Kind::Quantity(Unit::Rate, Range::Any),
    "Rate of stretching along z.",
)];
