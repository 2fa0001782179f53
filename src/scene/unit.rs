//! Quantities as settings: f64 in SI in memory, in a file a number in SI or a text with a unit.
//!
//! A field names its unit once: `#[serde(with = "Length")] spacing: f64`. Reading, writing and the
//! JSON schema follow from it. [`Maybe`], [`List`] and [`Unlimited`] are for `Option<f64>`,
//! `Vec<f64>` and an f64 that may be infinite.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::quantity::{self, Unit};

/// A type that represents a unit.
pub trait Dimension {
    const UNIT: Unit;
}

macro_rules! units {
    ($($name:ident)*) => {$(
        /// An f64 with this unit.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name;

        impl Dimension for $name {
            const UNIT: Unit = Unit::$name;
        }

        impl JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn inline_schema() -> bool {
                true
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                schema(Unit::$name)
            }
        }
    )*};
}

/// The functions that `#[serde(with = "...")]` calls.
macro_rules! fields {
    ($($name:ident)*) => {$(
        impl $name {
            /// Writes the value with its unit.
            ///
            /// # Errors
            /// Those of the format.
            pub fn serialize<S: Serializer>(si: &f64, to: S) -> Result<S::Ok, S::Error> {
                Value::<Self>::of(*si).serialize(to)
            }

            /// Reads the SI value.
            ///
            /// # Errors
            /// A text that is not a quantity of this unit, or another type.
            pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
                Value::<Self>::deserialize(from).map(|value| value.si)
            }
        }
    )*};
}

units!(Length Time Speed Acceleration Density Viscosity Tension SpecificEnergy Rate Angle One);
fields!(Length Time Speed Acceleration Density Viscosity Tension SpecificEnergy Rate);

/// One value with its unit.
struct Value<U> {
    si: f64,
    unit: PhantomData<U>,
}

impl<U: Dimension> Value<U> {
    fn of(si: f64) -> Self {
        let unit = PhantomData;
        // -0 and 0 are one value.
        let si = si + 0.0;
        Value { si, unit }
    }
}

impl<U: Dimension> Serialize for Value<U> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match U::UNIT {
            Unit::One => to.serialize_f64(self.si),
            unit => to.serialize_str(&quantity::human(self.si, unit)),
        }
    }
}

impl<'de, U: Dimension> Deserialize<'de> for Value<U> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(One::visitor(U::UNIT)).map(Self::of)
    }
}

impl One {
    fn visitor(unit: Unit) -> Reader {
        Reader { unit, word: None }
    }
}

/// Reads a quantity, or a word for infinity.
struct Reader {
    unit: Unit,
    word: Option<&'static str>,
}

impl Visitor<'_> for Reader {
    type Value = f64;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} such as {}", self.unit.name(), self.unit.example())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<f64, E> {
        Ok(value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<f64, E> {
        match self.word {
            Some(word) if word == text => Ok(f64::INFINITY),
            _ => quantity::parse(text, self.unit).map_err(E::custom),
        }
    }
}

/// A quantity that may be absent.
pub struct Maybe<U>(PhantomData<U>);

impl<U: Dimension> Maybe<U> {
    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(si: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
        si.map(Value::<U>::of).serialize(to)
    }

    /// # Errors
    /// As the quantity itself.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Option::<Value<U>>::deserialize(from).map(|value| value.map(|value| value.si))
    }
}

impl<U: Dimension> JsonSchema for Maybe<U> {
    fn schema_name() -> Cow<'static, str> {
        format!("Maybe{:?}", U::UNIT).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schema(U::UNIT)
    }
}

/// Any number of quantities.
pub struct List<U>(PhantomData<U>);

impl<U: Dimension> List<U> {
    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(si: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(si.iter().map(|si| Value::<U>::of(*si)))
    }

    /// # Errors
    /// As the quantity itself.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let values = Vec::<Value<U>>::deserialize(from)?;
        Ok(values.into_iter().map(|value| value.si).collect())
    }
}

impl<U: Dimension> JsonSchema for List<U> {
    fn schema_name() -> Cow<'static, str> {
        format!("List{:?}", U::UNIT).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": schema(U::UNIT) })
    }
}

/// Two or three components: x, z or x, y, z.
#[derive(Clone, Debug, PartialEq)]
pub struct Vector<U> {
    /// SI, in the order of the file.
    pub components: Vec<f64>,
    unit: PhantomData<U>,
}

impl<U> Vector<U> {
    pub fn new(components: Vec<f64>) -> Self {
        let unit = PhantomData;
        Vector { components, unit }
    }
}

impl<U: Dimension> Serialize for Vector<U> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        List::<U>::serialize(&self.components, to)
    }
}

impl<'de, U: Dimension> Deserialize<'de> for Vector<U> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        List::<U>::deserialize(from).map(Self::new)
    }
}

impl<U: Dimension> JsonSchema for Vector<U> {
    fn schema_name() -> Cow<'static, str> {
        format!("Vector{:?}", U::UNIT).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "array", "items": schema(U::UNIT), "minItems": 2, "maxItems": 3 })
    }
}

/// A quantity, or `"none"` for infinity.
pub struct Unlimited<U>(PhantomData<U>);

const NONE: &str = "none";

impl<U: Dimension> Unlimited<U> {
    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(si: &f64, to: S) -> Result<S::Ok, S::Error> {
        match si.is_finite() {
            true => Value::<U>::of(*si).serialize(to),
            false => to.serialize_str(NONE),
        }
    }

    /// # Errors
    /// As the quantity itself.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        let (unit, word) = (U::UNIT, Some(NONE));
        from.deserialize_any(Reader { unit, word })
    }
}

impl<U: Dimension> JsonSchema for Unlimited<U> {
    fn schema_name() -> Cow<'static, str> {
        format!("Unlimited{:?}", U::UNIT).into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "const": NONE }, schema(U::UNIT)] })
    }
}

/// `"#rrggbb"`.
pub struct Rgb;

impl Rgb {
    /// The colour that a text is, if it is one.
    pub fn parse(text: &str) -> Option<[u8; 3]> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6)?;
        let [_, rgb @ ..] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
        Some(rgb)
    }

    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(rgb: &[u8; 3], to: S) -> Result<S::Ok, S::Error> {
        let [red, green, blue] = rgb;
        to.serialize_str(&format!("#{red:02x}{green:02x}{blue:02x}"))
    }

    /// # Errors
    /// A text that is not a colour.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[u8; 3], D::Error> {
        let text = String::deserialize(from)?;
        Rgb::parse(&text).ok_or_else(|| D::Error::custom("not #rrggbb"))
    }
}

/// [`Rgb`] that may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Colour(#[serde(with = "Rgb")] pub [u8; 3]);

impl JsonSchema for Colour {
    fn schema_name() -> Cow<'static, str> {
        "Colour".into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "string", "pattern": "^#[0-9A-Fa-f]{6}$" })
    }
}

/// A number, or a number with a unit as [`quantity::parse`] reads it.
fn schema(unit: Unit) -> Schema {
    if unit == Unit::One {
        return json_schema!({ "type": "number" });
    }
    json_schema!({
        "anyOf": [{ "type": "number" }, { "type": "string", "pattern": pattern(unit) }],
        "x-unit": unit.noun(),
    })
}

/// Micro and products have several spellings.
fn pattern(unit: Unit) -> String {
    let spellings = unit.spellings().iter().map(|(name, _)| {
        let escaped: String = name
            .chars()
            .map(|letter| match letter {
                '^' | '(' | ')' => format!("\\{letter}"),
                ' ' => "[ \u{b7}*\u{22c5}]+".to_string(),
                other => other.to_string(),
            })
            .collect();
        let powers = escaped
            .replace("\\^2", "(\\^2|\u{b2})")
            .replace("\\^3", "(\\^3|\u{b3})");
        match powers.strip_prefix('u') {
            Some(rest) => format!("[u\u{b5}\u{3bc}]{rest}"),
            None => powers,
        }
    });
    let units: Vec<String> = spellings.collect();
    let number = "[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?";
    format!("^\\s*{number}\\s*({})\\s*$", units.join("|"))
}
