//! A readable name for what `--set` changes, safe as a part of a path:
//! `body.drop.velocity=2.42_m_s`.
//!
//! Equal settings have one name: quantities are converted, the last value of a key counts, and the
//! order of the keys does not. Different settings have different names: where letters of a value
//! are replaced or a name is cut, a hash follows. Signs in the unit of a quantity are replaced
//! without one, as each key has units that differ without them.
//!
//! Test: tests/engine/scene_variant.rs, tests/pipeline/sweep.rs.

use serde_json::Value as Schema;
use sha2::{Digest, Sha256};
use toml::Value;

use super::file::SCHEMA;
use super::quantity::{self, Unit};
use super::rule::unit_of;
use super::schema::property;
use super::tree::value_of;

/// Most letters of a name that is not cut.
const LONGEST: usize = 120;
/// Letters that stay of one that is.
const KEPT: usize = 100;
/// Digits of a hash.
const DIGITS: usize = 8;

/// The name of what the arguments `sets` of `--set` change, each `key.key=value`; empty without
/// any.
pub fn name(sets: &[String]) -> String {
    let mut values: Vec<(String, Value)> = Vec::new();
    for set in sets {
        let (key, value) = set.split_once('=').unwrap_or((set, ""));
        let key: Vec<&str> = key.split('.').map(str::trim).collect();
        let key = key.join(".");
        let inside = format!("{key}.");
        values.retain(|(known, _)| *known != key && !known.starts_with(&inside));
        values.push((key, value_of(value.trim())));
    }
    values.sort_by(|(a, _), (b, _)| a.cmp(b));
    let parts = values.iter().map(|(key, value)| {
        let schema = key.split('.').try_fold(&*SCHEMA, property);
        let text = text(value, schema);
        let (key, shown) = (plain(key), plain(&text));
        match is_quantity(value, schema) || shown == text {
            true => format!("{key}={shown}"),
            false => format!("{key}={}-{}", shown.trim_matches('_'), hash(&text)),
        }
    });
    let name = parts.collect::<Vec<_>>().join(",");
    match name.len() > LONGEST {
        // Each part names its value, so the whole does.
        true => format!("{}-{}", &name[..KEPT], hash(&name)),
        false => name,
    }
}

/// The unit of a key, or of the items of its list.
fn unit(schema: &Schema) -> Option<Unit> {
    let kinds = ["anyOf", "oneOf"].into_iter();
    let mut kinds = kinds.filter_map(|word| schema[word].as_array()).flatten();
    unit_of(schema)
        .or_else(|| kinds.find_map(unit))
        .or_else(|| unit(schema.get("items")?))
}

/// The SI value, if it is a number with a unit.
fn quantity(value: &Value, unit: Unit) -> Option<f64> {
    match value {
        Value::String(text) => quantity::parse(text, unit).ok(),
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

fn is_quantity(value: &Value, schema: Option<&Schema>) -> bool {
    let unit = schema.and_then(unit);
    unit.is_some_and(|unit| quantity(value, unit).is_some())
}

/// A value, the same for equal values.
fn text(value: &Value, schema: Option<&Schema>) -> String {
    let unit = schema.and_then(unit);
    if let Some(unit) = unit
        && let Some(si) = quantity(value, unit)
    {
        return quantity::human(si, unit);
    }
    match value {
        Value::String(text) => text.clone(),
        // 1, not 1.0.
        Value::Float(number) => number.to_string(),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(|item| text(item, schema)).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Table(table) => {
            let mut items: Vec<String> = table
                .iter()
                .map(|(key, value)| {
                    let schema = schema.and_then(|schema| property(schema, key));
                    format!("{key} = {}", text(value, schema))
                })
                .collect();
            items.sort();
            format!("{{ {} }}", items.join(", "))
        }
        other => other.to_string(),
    }
}

/// Letters, digits and `.+-_=`; a `_` for each run of others.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for letter in text.chars() {
        match letter {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' | '+' | '-' | '_' | '=' => plain.push(letter),
            _ if plain.ends_with('_') => {}
            _ => plain.push('_'),
        }
    }
    plain
}

fn hash(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    let digits: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
    digits[..DIGITS].to_string()
}
