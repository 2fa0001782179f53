//! The reference page of all settings in Markdown, from the schema.

use serde_json::Value;

use super::file::SCHEMA;
use super::rule::{required, unit_of, wording, words};
use super::schema::NAME;
use super::tree::dotted;

/// Every table of a scene file with its keys: values, defaults and meanings.
pub fn markdown() -> String {
    let mut page = String::from(
        "# Settings of a scene file\n\n\
         Written by `coronet schema pipeline --markdown`.\n\n\
         A quantity is a number in SI units (angles: degrees), or a text with a unit.\n",
    );
    table(&SCHEMA, "", &mut page);
    page
}

fn table(schema: &Value, path: &str, page: &mut String) {
    let all = schema["properties"].as_object().into_iter().flatten();
    let (tables, keys): (Vec<_>, Vec<_>) = all.partition(|(_, inner)| is_table(inner));
    if !path.is_empty() {
        page.push_str(&format!("\n## `[{path}]`\n\n{}\n", about(schema)));
    }
    if !keys.is_empty() {
        page.push_str("\n| Key | Value | If left out | Meaning |\n|---|---|---|---|\n");
    }
    for (key, inner) in keys {
        let (value, default) = (value(inner), default(schema, key, inner));
        page.push_str(&format!(
            "| `{key}` | {value} | {default} | {} |\n",
            about(inner)
        ));
    }
    for (key, inner) in tables {
        let path = dotted(path, key);
        match inner["patternProperties"].get(NAME) {
            Some(each) => table(each, &format!("{path}.NAME"), page),
            None => table(inner, &path, page),
        }
    }
}

/// Whether a key has its own section: a table that is not one of several choices.
fn is_table(schema: &Value) -> bool {
    schema["type"] == "object"
}

fn about(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or("");
    text.replace('\n', " ").replace('|', "\\|")
}

/// The values that a key accepts.
fn value(schema: &Value) -> String {
    let range = range(schema);
    if let Some(words) = words(schema) {
        let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
        return words.join(", ");
    }
    if unit_of(schema).is_some() {
        return format!("{}{range}", wording(schema));
    }
    let alternatives = schema["oneOf"].as_array().or(schema["anyOf"].as_array());
    if let Some(kinds) = alternatives {
        let kinds: Vec<String> = kinds.iter().map(choice).collect();
        return format!("{}{range}", kinds.join(", or "));
    }
    match schema["type"].as_str() {
        Some("array") if is_table(&schema["items"]) => {
            let keys = schema["items"]["properties"].as_object();
            let keys: Vec<String> = keys
                .into_iter()
                .flatten()
                .map(|(key, inner)| format!("`{key}`: {}", about(inner)))
                .collect();
            format!("an array of tables. {}", keys.join(" "))
        }
        Some("array") => format!("an array of {}", value(&schema["items"])),
        _ => format!("{}{range}", wording(schema)),
    }
}

/// One of several alternatives: a table of one key with its own keys, a word, or a value.
fn choice(schema: &Value) -> String {
    let Some((key, inner)) = schema["properties"]
        .as_object()
        .and_then(|all| all.iter().next())
    else {
        return value(schema);
    };
    let parts = inner["properties"].as_object().into_iter().flatten();
    let part = |(key, part): (&String, &Value)| {
        let default = default(inner, key, part);
        let meaning = about(part);
        format!("`{key}` ({}; {default}): {meaning}", value(part))
    };
    let parts: Vec<String> = parts.map(part).collect();
    format!("`{key}` = {{ {} }}", parts.join(" "))
}

fn range(schema: &Value) -> String {
    let bound = |word: &str| schema[word].as_f64();
    match (
        bound("exclusiveMinimum"),
        bound("minimum"),
        bound("maximum"),
    ) {
        (Some(_), ..) => ", above zero".to_string(),
        (_, Some(low), Some(high)) => format!(", {low} to {high}"),
        (_, Some(low), None) => format!(", at least {low}"),
        _ => String::new(),
    }
}

fn default(table: &Value, key: &str, schema: &Value) -> String {
    if schema["x-preset"] == true {
        return "of the preset".to_string();
    }
    match schema.get("default") {
        Some(value) => format!("`{value}`"),
        None if required(table).contains(&key) => "required".to_string(),
        None => "none".to_string(),
    }
}
