//! The JSON schema of scene files, from the types that read them, with extensions.
//!
//! The schema is used in the search for mistakes ([`super::conform`]), for presets
//! ([`super::preset`]) and by editors, which complete keys and underline mistakes. It has two
//! extensions: `x-unit` names the unit of a quantity, `x-preset` marks a key of a preset.

use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};

/// Names of bodies.
pub const NAME: &str = "^[a-z][a-z0-9_-]*$";

/// JSON Schema 2020-12 of TOML files that `T` reads: no null, no unnamed keys.
pub fn of<T: JsonSchema>(title: &str) -> Schema {
    let settings =
        SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    RecursiveTransform(without_null).transform(&mut schema);
    RecursiveTransform(closed).transform(&mut schema);
    schema.insert("title".to_string(), title.into());
    schema
}

/// TOML has no null: an optional key is left out.
fn without_null(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else {
        return;
    };
    let is_null = |value: &Value| value.is_null() || *value == json!({ "type": "null" });
    if object.get("default").is_some_and(Value::is_null) {
        object.remove("default");
    }
    if let Some(default) = object.get_mut("default") {
        drop_nulls(default);
    }
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|word| word != "null");
        if let [one] = types.as_slice() {
            object["type"] = one.clone();
        }
    }
    if let Some(Value::Array(words)) = object.get_mut("enum") {
        words.retain(|word| !is_null(word));
    }
    if let Some(Value::Array(kinds)) = object.get_mut("anyOf") {
        kinds.retain(|kind| !is_null(kind));
        if let [Value::Object(only)] = kinds.as_slice() {
            let only = only.clone();
            object.remove("anyOf");
            for (key, value) in only {
                object.entry(key).or_insert(value);
            }
        }
    }
    object.remove("format");
}

fn drop_nulls(value: &mut Value) {
    if let Value::Object(object) = value {
        object.retain(|_, value| !value.is_null());
        object.values_mut().for_each(drop_nulls);
    }
}

/// Permits no unnamed keys; a key that a preset supplies may be left out.
fn closed(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else {
        return;
    };
    let Some(Value::Object(properties)) = object.get("properties") else {
        return;
    };
    let is_given = |key: &Value| properties[key.as_str().unwrap_or("")]["x-preset"] == true;
    let required: Vec<Value> = match object.get("required") {
        Some(Value::Array(keys)) => keys.iter().filter(|key| !is_given(key)).cloned().collect(),
        _ => Vec::new(),
    };
    match required.is_empty() {
        true => object.remove("required"),
        false => object.insert("required".to_string(), required.into()),
    };
    object.insert("additionalProperties".to_string(), false.into());
}

/// The schema to which a range belongs: that of the items of a list.
fn ranged(schema: &mut Schema) -> Option<&mut Map<String, Value>> {
    let object = schema.as_object_mut()?;
    match object.contains_key("items") {
        true => object.get_mut("items")?.as_object_mut(),
        false => Some(object),
    }
}

/// Above zero; each item of a list.
pub fn positive(schema: &mut Schema) {
    if let Some(object) = ranged(schema) {
        object.insert("exclusiveMinimum".to_string(), 0.into());
    }
}

/// Zero or above; each item of a list.
pub fn not_negative(schema: &mut Schema) {
    if let Some(object) = ranged(schema) {
        object.insert("minimum".to_string(), 0.into());
    }
}

/// A preset supplies the key where a scene leaves it out.
pub fn by_preset(schema: &mut Schema) {
    schema.insert("x-preset".to_string(), true.into());
}

/// All keys of a table [`by_preset`].
pub fn by_preset_all(schema: &mut Schema) {
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        for property in properties.values_mut().filter_map(Value::as_object_mut) {
            property.insert("x-preset".to_string(), true.into());
        }
    }
}

/// A table of named tables, of which there is at least one.
pub fn named(schema: &mut Schema) {
    let Some(object) = schema.as_object_mut() else {
        return;
    };
    let each = object.insert("additionalProperties".to_string(), false.into());
    let each = each.unwrap_or_default();
    object.insert("patternProperties".to_string(), json!({ NAME: each }));
    object.insert("minProperties".to_string(), 1.into());
}

/// The schema of a key of a table, which may be one of several alternatives.
pub fn property<'a>(schema: &'a Value, key: &str) -> Option<&'a Value> {
    let alternatives = ["anyOf", "oneOf"]
        .iter()
        .filter_map(|word| schema[word].as_array());
    let direct = schema["properties"].get(key);
    let named = || schema["patternProperties"].get(NAME);
    direct
        .or_else(named)
        .or_else(|| alternatives.flatten().find_map(|one| property(one, key)))
}

/// Every key of a schema, dotted; NAME stands for the name of a body.
pub fn keys(schema: &Value) -> Vec<String> {
    let mut found = Vec::new();
    collect(schema, "", &mut found);
    found
}

fn collect(schema: &Value, path: &str, found: &mut Vec<String>) {
    for (key, inner) in schema["properties"].as_object().into_iter().flatten() {
        let key = super::tree::dotted(path, key);
        collect(inner, &key, found);
        found.push(key);
    }
    for each in schema["patternProperties"]
        .as_object()
        .into_iter()
        .flatten()
    {
        collect(each.1, &format!("{path}.NAME"), found);
    }
    let alternatives = ["anyOf", "oneOf"]
        .iter()
        .filter_map(|word| schema[word].as_array());
    for inner in alternatives.flatten().chain(schema.get("items")) {
        collect(inner, path, found);
    }
}
