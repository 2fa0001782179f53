//! The JSON schema of a scene file, from the same tables as the parser: editors complete keys and
//! underline what is wrong.

use serde_json::{Map, Value, json};

use super::format::{FILE, Field, Kind, Need, Range};
use super::quantity::Unit;

/// JSON Schema 2020-12 of the scene file, as shipped in `docs/pipeline.schema.json`.
pub fn json() -> String {
    let mut schema = table(FILE, &[]);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("Coronet scene");
    // `{:#}` of a JSON value is pretty-printed, keys sorted.
    format!("{schema:#}\n")
}

fn table(fields: &[Field], one_of: &[&str]) -> Value {
    let properties: Map<String, Value> = fields
        .iter()
        .map(|field| (field.name.to_string(), property(field)))
        .collect();
    let is_required = |field: &&Field| field.need == Need::Required;
    let required: Vec<&str> = fields
        .iter()
        .filter(is_required)
        .map(|field| field.name)
        .collect();
    let mut schema = json!({
        "type": "object",
        "additionalProperties": false,
        "properties": properties,
    });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    if !one_of.is_empty() {
        let choice = one_of.iter().map(|key| json!({ "required": [key] }));
        schema["oneOf"] = Value::Array(choice.collect());
    }
    schema
}

fn property(field: &Field) -> Value {
    let mut schema = kind(&field.kind);
    schema["description"] = json!(field.about);
    if let Need::Default(text) = field.need
        && let Some(value) = default_value(text)
    {
        schema["default"] = value;
    }
    schema
}

/// A default is written in TOML.
fn default_value(text: &str) -> Option<Value> {
    let table: toml::Table = format!("value = {text}").parse().ok()?;
    serde_json::to_value(table.get("value")?).ok()
}

fn kind(kind_of: &Kind) -> Value {
    match kind_of {
        Kind::Text => json!({ "type": "string" }),
        Kind::Colour => json!({ "type": "string", "pattern": "^#[0-9A-Fa-f]{6}$" }),
        Kind::Word(words) => json!({ "enum": words }),
        Kind::Quantity(unit, range) => {
            json!({ "anyOf": [number(*range), { "type": "string", "pattern": pattern(*unit) }] })
        }
        Kind::Number(range) => number(*range),
        Kind::Count(least) => json!({ "type": "integer", "minimum": least }),
        Kind::List(item, least, most) => {
            let mut schema = json!({ "type": "array", "items": kind(item), "minItems": least });
            if *most < usize::MAX {
                schema["maxItems"] = json!(most);
            }
            schema
        }
        Kind::Table(fields, one_of) => table(fields, one_of),
        Kind::Named(fields, one_of) => json!({
            "type": "object",
            "minProperties": 1,
            "additionalProperties": false,
            "patternProperties": { "^[a-z][a-z0-9_-]*$": table(fields, one_of) },
        }),
        Kind::Either(kinds) => {
            json!({ "anyOf": kinds.iter().map(kind).collect::<Vec<_>>() })
        }
    }
}

fn number(range: Range) -> Value {
    match range {
        Range::Any => json!({ "type": "number" }),
        Range::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Range::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Range::Between(low, high) => {
            json!({ "type": "number", "minimum": low, "maximum": high })
        }
    }
}

/// A number and a unit as `quantity::parse` reads them; micro and products have several spellings.
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
