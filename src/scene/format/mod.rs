//! The format of a scene file as data: what may stand where. The parser, the list of known keys
//! and the JSON schema all read these tables, so they cannot disagree.

mod method;
mod physics;
mod stage;

pub use physics::SHAPES;

use super::quantity::Unit;
use method::METHOD;
use physics::{BODY, BOX, EFFECTS, LIQUID};
use stage::{FRAMES, IMPACT, PACK, POST, RELAX};

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

pub(super) const fn required(name: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        name,
        kind,
        need: Need::Required,
        about,
    }
}

pub(super) const fn optional(name: &'static str, kind: Kind, about: &'static str) -> Field {
    Field {
        name,
        kind,
        need: Need::Optional,
        about,
    }
}

pub(super) const fn default(
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

/// Every key of the format, dotted; a body's name stands as NAME.
pub fn collect(into: &mut Vec<String>) {
    collect_fields(FILE, "", into);
}

fn collect_fields(fields: &[Field], path: &str, into: &mut Vec<String>) {
    for field in fields {
        let key = match path {
            "" => field.name.to_string(),
            _ => format!("{path}.{}", field.name),
        };
        into.push(key.clone());
        collect_kind(&field.kind, &key, into);
    }
}

fn collect_kind(kind: &Kind, key: &str, into: &mut Vec<String>) {
    match kind {
        Kind::Table(fields, _) => collect_fields(fields, key, into),
        Kind::Named(fields, _) => collect_fields(fields, &format!("{key}.NAME"), into),
        Kind::List(item, ..) => collect_kind(item, key, into),
        Kind::Either(kinds) => kinds.iter().for_each(|kind| collect_kind(kind, key, into)),
        _ => {}
    }
}
