//! What a JSON schema permits, worded for error messages.

use serde_json::Value as Schema;
use toml::de::DeValue;

use super::quantity::Unit;
use super::tree::Value;

/// Keys of the tables of a schema, in its order.
pub fn keys(schema: &Schema) -> Vec<&str> {
    let properties = schema["properties"].as_object();
    properties.map_or(Vec::new(), |all| all.keys().map(String::as_str).collect())
}

pub fn required(schema: &Schema) -> Vec<&str> {
    let keys = schema["required"].as_array().into_iter().flatten();
    keys.filter_map(Schema::as_str).collect()
}

/// Keys of which exactly one must be present.
pub fn choice(schema: &Schema) -> Vec<&str> {
    let kinds = schema["oneOf"].as_array().into_iter().flatten();
    kinds.flat_map(required).collect()
}

pub fn unit_of(schema: &Schema) -> Option<Unit> {
    Unit::called(schema["x-unit"].as_str()?)
}

/// The words of a schema that permits nothing else.
pub fn words(schema: &Schema) -> Option<Vec<Schema>> {
    if let Some(words) = schema["enum"].as_array() {
        return Some(words.clone());
    }
    if let Some(word) = schema.get("const") {
        return Some(vec![word.clone()]);
    }
    if schema["type"] == "object" {
        return None;
    }
    let kinds = schema["oneOf"].as_array().or(schema["anyOf"].as_array())?;
    let words: Option<Vec<Vec<Schema>>> = kinds.iter().map(words).collect();
    words.map(|words| words.concat())
}

/// Alternatives of different types: words in one, tables of one key each in one.
pub fn alternatives(schema: &Schema) -> Option<Vec<Schema>> {
    if schema["type"] == "object" {
        return None;
    }
    let kinds = schema["oneOf"].as_array().or(schema["anyOf"].as_array())?;
    let known: Vec<Schema> = kinds.iter().filter_map(words).flatten().collect();
    let mut merged = Vec::new();
    if !known.is_empty() {
        merged.push(serde_json::json!({ "enum": known }));
    }
    let (tables, rest): (Vec<&Schema>, Vec<&Schema>) = kinds
        .iter()
        .filter(|kind| words(kind).is_none())
        .partition(|kind| kind["type"] == "object");
    if !tables.is_empty() {
        let properties = tables
            .iter()
            .filter_map(|table| table["properties"].as_object());
        let properties = properties.flat_map(|all| all.clone());
        let choice = tables.iter().flat_map(|table| required(table));
        let choice = choice.map(|key| serde_json::json!({ "required": [key] }));
        merged.push(serde_json::json!({
            "type": "object",
            "properties": properties.collect::<serde_json::Map<_, _>>(),
            "oneOf": choice.collect::<Vec<_>>(),
        }));
    }
    for kind in rest {
        let mut kind = kind.clone();
        // A range beside the alternatives applies to the alternative with numbers.
        for word in ["minimum", "maximum", "exclusiveMinimum"] {
            if let (Some(bound), Some(object)) = (schema.get(word), kind.as_object_mut()) {
                object.entry(word).or_insert(bound.clone());
            }
        }
        merged.push(kind);
    }
    Some(merged)
}

pub fn same_type(value: &Value<'_>, schema: &Schema) -> bool {
    let is_quantity = unit_of(schema).is_some();
    match value.get_ref() {
        DeValue::String(_) => is_quantity || words(schema).is_some() || schema["type"] == "string",
        DeValue::Float(_) | DeValue::Integer(_) => is_quantity || schema["type"] == "number",
        DeValue::Array(_) => schema["type"] == "array",
        DeValue::Table(_) => schema["type"] == "object",
        _ => false,
    }
}

/// As in "write ...".
pub fn wording(schema: &Schema) -> String {
    if let Some(words) = words(schema) {
        let words: Vec<String> = words.iter().map(|word| word.to_string()).collect();
        return format!("one of {}", words.join(", "));
    }
    if let Some(unit) = unit_of(schema) {
        return format!("{} such as {}", unit.name(), unit.example());
    }
    match schema["type"].as_str() {
        Some("object") => format!("a table with {}", keys(schema).join(", ")),
        Some("array") => format!("an array of {}", wording(&schema["items"])),
        Some("string") => "a string".to_string(),
        Some("integer") => "a whole number".to_string(),
        _ => "a number".to_string(),
    }
}

/// An example of a key with a value.
pub fn example(name: &str, schema: &Schema) -> String {
    let item = unit_of(&schema["items"]);
    let value = match (unit_of(schema), item, words(schema)) {
        (Some(unit), ..) => unit.example().to_string(),
        (_, Some(unit), _) => format!("[{0}, {0}, {0}]", unit.example()),
        (_, _, Some(words)) => words.first().map_or(String::new(), Schema::to_string),
        _ if schema.get("patternProperties").is_some() => {
            return format!("a table [{name}.NAME] for each");
        }
        _ if schema["type"] == "object" => {
            let needed = required(schema).into_iter();
            let items: Vec<String> = needed
                .map(|key| example(key, &schema["properties"][key]))
                .collect();
            format!("{{ {} }}", items.join(", "))
        }
        _ => "...".to_string(),
    };
    format!("{name} = {value}")
}
