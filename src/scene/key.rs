//! The settings in the input of a stage, one by one, from which keys and reasons are made.

use serde::Serialize;
use serde_json::Value;

use super::Problem;

/// One setting that a stage reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Dotted, as in the scene file, for messages. Contains names of bodies, so hash `canonical`.
    pub name: String,
    /// The value with its unit.
    pub value: String,
    /// Identity and value of the setting: equal for equal settings only.
    pub canonical: Vec<u8>,
}

/// A setting that cannot be part of a key.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KeyError {
    /// A setting is NaN; its name.
    #[error("`{0}` is not a number: it cannot be part of a key")]
    NotANumber(String),
    /// A reference curve cannot be read.
    #[error("`{name}`: {problem}")]
    Reference {
        /// Dotted key of its path.
        name: String,
        /// The reason.
        problem: String,
    },
}

/// The settings in an input; `problem` is the scene's, for the names of bodies and method.
///
/// # Errors
/// [`KeyError::NotANumber`].
pub fn settings(input: &impl Serialize, problem: &Problem) -> Result<Vec<Setting>, KeyError> {
    let value = serde_json::to_value(input).expect("inputs are plain data");
    let mut list = Vec::new();
    flatten(&value, "", &mut list)?;
    list.retain(|setting| !problem.ignores(&setting.name));
    for setting in &mut list {
        setting.name = named(&setting.name, problem);
    }
    Ok(list)
}

/// The name in messages: with names of bodies in place of their numbers.
fn named(name: &str, problem: &Problem) -> String {
    for list in ["body", "labels"] {
        if let Some((index, rest)) = indexed(name, list)
            && let Some(body) = problem.bodies.get(index)
        {
            return format!("body.{}{rest}", body.name);
        }
    }
    match name.strip_prefix("method.") {
        // Kernel, smoothing and mass of a packing, for any method.
        Some(key @ ("kernel" | "smoothing" | "mass")) => {
            format!("method.{}.{key}", problem.method.name())
        }
        _ => name.to_string(),
    }
}

/// The number and the rest of `list[number]rest`.
fn indexed<'a>(name: &'a str, list: &str) -> Option<(usize, &'a str)> {
    let (index, rest) = name
        .strip_prefix(list)?
        .strip_prefix('[')?
        .split_once(']')?;
    Some((index.parse().ok()?, rest))
}

/// Lists every value with its dotted name.
fn flatten(value: &Value, name: &str, list: &mut Vec<Setting>) -> Result<(), KeyError> {
    let is_plain = |value: &Value| !value.is_object() && !value.is_array();
    match value {
        Value::Null => {}
        Value::Object(entries) => {
            for (key, value) in entries {
                flatten(value, &super::tree::dotted(name, key), list)?;
            }
        }
        Value::Array(items) if !items.iter().all(is_plain) => {
            for (index, value) in items.iter().enumerate() {
                flatten(value, &format!("{name}[{index}]"), list)?;
            }
        }
        value => {
            let text = shown(value);
            if text.contains("NaN") {
                return Err(KeyError::NotANumber(name.to_string()));
            }
            list.push(Setting {
                name: name.to_string(),
                canonical: format!("{name} = {value}").into_bytes(),
                value: text,
            });
        }
    }
    Ok(())
}

/// A value as a user writes it.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        // 1, not 1.0.
        Value::Number(number) => number
            .as_f64()
            .map_or(number.to_string(), |x| x.to_string()),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(shown).collect();
            format!("[{}]", items.join(", "))
        }
        other => other.to_string(),
    }
}
