//! The JSON schema: as shipped, and of one mind with the parser.
//!
//! The checker below knows the few words that the schema uses and refuses any other, so that a
//! schema cannot pass by being misunderstood. Patterns are held to the parser by trying values.

use crate::scene_file::SMALL;
use coronet::scene::{file, quantity};
use serde_json::Value;
use std::path::Path;

fn generated() -> Value {
    serde_json::from_str(&file::json_schema()).unwrap()
}

/// Why `value` is not what `schema` allows.
fn check(schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    let wrong = |why: &str| Err(format!("{path}: {why}: {value}"));
    for (word, rule) in schema.as_object().unwrap() {
        match word.as_str() {
            "$schema" | "title" | "description" | "default" | "x-unit" | "x-preset" => {}
            "type" if !is_type(rule.as_str().unwrap(), value) => return wrong("type"),
            "enum" if !rule.as_array().unwrap().contains(value) => return wrong("enum"),
            "const" if rule != value => return wrong("const"),
            "type" | "enum" | "const" => {}
            // Bounds are of numbers, and say nothing about a text.
            "minimum" | "maximum" | "exclusiveMinimum" if !value.is_number() => {}
            "minimum" if value.as_f64() < rule.as_f64() => return wrong("minimum"),
            "maximum" if value.as_f64() > rule.as_f64() => return wrong("maximum"),
            "exclusiveMinimum" if value.as_f64() <= rule.as_f64() => return wrong("minimum"),
            "minimum" | "maximum" | "exclusiveMinimum" => {}
            "minItems" if items(value) < rule.as_u64().unwrap() => return wrong("too few"),
            "maxItems" if items(value) > rule.as_u64().unwrap() => return wrong("too many"),
            "minItems" | "maxItems" => {}
            "items" => {
                for (index, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(rule, item, &format!("{path}[{index}]"))?;
                }
            }
            "pattern" if !fits(rule.as_str().unwrap(), value.as_str().unwrap_or("")) => {
                return wrong("pattern");
            }
            "pattern" => {}
            "anyOf" => {
                let tried = rule.as_array().unwrap().iter();
                if !tried.clone().any(|rule| check(rule, value, path).is_ok()) {
                    return wrong("none of anyOf");
                }
            }
            "oneOf" => {
                let tried = rule.as_array().unwrap().iter();
                if tried
                    .filter(|rule| check(rule, value, path).is_ok())
                    .count()
                    != 1
                {
                    return wrong("not exactly one of");
                }
            }
            "required" => {
                for key in rule.as_array().unwrap() {
                    if value.get(key.as_str().unwrap()).is_none() {
                        return wrong(&format!("lacks {key}"));
                    }
                }
            }
            "properties" | "patternProperties" | "minProperties" => {}
            "additionalProperties" => properties(schema, value, path)?,
            other => panic!("the checker does not know `{other}`"),
        }
    }
    Ok(())
}

fn properties(schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    assert_eq!(schema["additionalProperties"], false);
    for (key, inner) in value.as_object().into_iter().flatten() {
        let named = schema.get("properties").and_then(|all| all.get(key));
        let mut patterns = schema["patternProperties"]
            .as_object()
            .into_iter()
            .flatten();
        let rule = named.or_else(|| patterns.next().map(|(_, rule)| rule));
        let Some(rule) = rule else {
            return Err(format!("{path}: unknown key {key}"));
        };
        check(rule, inner, &format!("{path}.{key}"))?;
    }
    Ok(())
}

fn is_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("type {other}"),
    }
}

fn items(value: &Value) -> u64 {
    value.as_array().map_or(0, |items| items.len() as u64)
}

/// A pattern belongs to a unit; whether the text fits is asked of the parser.
fn fits(pattern: &str, text: &str) -> bool {
    use quantity::Unit::*;
    if pattern.starts_with("^#") {
        return text.len() == 7 && text.starts_with('#');
    }
    let all = [
        Length,
        Time,
        Speed,
        Acceleration,
        Density,
        Viscosity,
        Tension,
        SpecificEnergy,
        Rate,
        Angle,
    ];
    let unit = all.into_iter().find(|unit| pattern_of(*unit) == pattern);
    quantity::parse(text, unit.unwrap_or_else(|| panic!("{pattern}"))).is_ok()
}

/// The pattern that the schema has for a unit, taken from a setting of that unit.
fn pattern_of(unit: quantity::Unit) -> String {
    use quantity::Unit::*;
    let key = match unit {
        Length => "/properties/pack/properties/spacing",
        Time => "/properties/impact/properties/end",
        Speed => "/properties/box/properties/wall_velocity/properties/x_low/items",
        Acceleration => "/properties/effects/properties/gravity/properties/acceleration",
        Density => "/properties/liquid/properties/density",
        Viscosity => "/properties/effects/properties/viscosity/properties/dynamic",
        Tension => "/properties/effects/properties/tension/properties/coefficient",
        SpecificEnergy => "/properties/relax/properties/kinetic_energy",
        Rate => "/properties/relax/properties/damping",
        Angle => "/properties/effects/properties/wetting/properties/angle",
        One => panic!("a number has no pattern"),
    };
    let schema = generated();
    let pattern = schema.pointer(key).unwrap()["anyOf"][1]["pattern"].clone();
    pattern.as_str().unwrap().to_string()
}

fn json_of(toml: &str) -> Value {
    serde_json::to_value(toml.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn the_shipped_schema_is_the_generated_one() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/pipeline.schema.json");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, file::json_schema()).unwrap();
    }
    let shipped = std::fs::read_to_string(&path).unwrap();
    let remedy = "UPDATE=1 cargo test --release --test engine schema";
    assert_eq!(
        shipped,
        file::json_schema(),
        "the format changed: run {remedy}"
    );
}

#[test]
fn every_shipped_scene_fits_the_schema() {
    let schema = generated();
    for path in crate::scene_file::shipped() {
        let text = std::fs::read_to_string(&path).unwrap();
        check(&schema, &json_of(&text), "").unwrap_or_else(|why| panic!("{}{why}", path.display()));
    }
    check(&schema, &json_of(SMALL), "").unwrap();
}

#[test]
fn schema_and_parser_refuse_the_same() {
    let schema = generated();
    for (from, to) in [
        ("[relax]", "[relaxation]"),
        ("spacing =", "spaceing ="),
        ("velocity =", "veloctiy ="),
        ("dynamic =", "kinematic ="),
        (
            "[relax]",
            "[method.wcsph]\ntime_stepping = { fixed = { stepp = 1 } }",
        ),
        (
            "[relax]",
            "[method.wcsph]\ndensity = { continuity = { delta = 1 } }",
        ),
        ("[relax]", "[method.wcsph]\ntime_stepping = {}"),
        ("\"1.5 m/s\"", "\"1.5 mm\""),
        ("\"1.5 m/s\"", "\"1.5\""),
        ("\"1.5 m/s\"", "true"),
        ("\"5 ms\"", "-1"),
        ("end = \"5 ms\"", ""),
        ("[relax]", "seed = 1.5"),
        ("[relax]", "seed = -1"),
        ("velocity =", "colour = \"red\"\nvelocity ="),
        ("velocity =", "layer = { depth = 1 }\nvelocity ="),
        ("[relax]", "[method]\npreset = \"papre\""),
        ("\"8 mm\", \"8 mm\", \"10 mm\"", "1"),
    ] {
        let text = SMALL.replacen(from, to, 1);
        assert_ne!(text, SMALL, "{from}");
        assert!(
            check(&schema, &json_of(&text), "").is_err(),
            "the schema takes {to}"
        );
        let parsed = file::read(&text, Path::new("small.toml"), &[]);
        assert!(parsed.is_err(), "the parser takes {to}");
    }
}

/// A table with every key of the schema in it, one alternative at a time.
fn samples(schema: &Value) -> Vec<Value> {
    if let Some(kinds) = schema.get("anyOf") {
        return kinds.as_array().unwrap().iter().flat_map(samples).collect();
    }
    if let Some(words) = schema.get("enum") {
        return words.as_array().unwrap().clone();
    }
    if let Some(word) = schema.get("const") {
        return vec![word.clone()];
    }
    if schema["type"] != "object"
        && let Some(kinds) = schema.get("oneOf")
    {
        return kinds.as_array().unwrap().iter().flat_map(samples).collect();
    }
    match schema["type"].as_str().unwrap() {
        "integer" => vec![schema.get("minimum").cloned().unwrap_or(0.into())],
        "number" => vec![schema.get("maximum").cloned().unwrap_or(1.0.into())],
        "array" => {
            let count = schema["minItems"].as_u64().unwrap_or(1) as usize;
            let items = samples(&schema["items"]);
            items
                .into_iter()
                .map(|item| Value::Array(vec![item; count]))
                .collect()
        }
        "string" if schema.get("pattern").is_none() => vec!["text".into()],
        "string" => vec![sample_text(schema["pattern"].as_str().unwrap())],
        _ => Vec::new(),
    }
}

fn sample_text(pattern: &str) -> Value {
    let units = [
        "m", "s", "m/s", "m/s^2", "kg/m^3", "Pa s", "N/m", "J/kg", "1/s", "deg",
    ];
    if fits(pattern, "#102030") {
        return "#102030".into();
    }
    let texts = units.map(|unit| match unit {
        "deg" => "45 deg".to_string(),
        _ => format!("1.5 {unit}"),
    });
    texts
        .into_iter()
        .find(|text| fits(pattern, text))
        .unwrap()
        .into()
}

/// Calls `each` with the dotted path and schema of every leaf.
fn leaves(schema: &Value, path: &str, each: &mut dyn FnMut(&str, &Value)) {
    let tables = ["properties", "patternProperties"];
    let mut inner = tables.iter().filter_map(|word| schema.get(word)).peekable();
    if inner.peek().is_none() {
        each(path, schema);
    }
    for (key, schema) in inner.flat_map(|table| table.as_object().unwrap()) {
        let key = if key.starts_with('^') { "drop" } else { key };
        let path = if path.is_empty() {
            key.to_string()
        } else {
            format!("{path}.{key}")
        };
        leaves(schema, &path, each);
    }
}

#[test]
fn every_key_of_the_schema_is_accepted() {
    let mut tried = 0;
    leaves(&generated(), "", &mut |path, schema| {
        for sample in samples(schema) {
            let set = format!("{path}={}", sample);
            let sets = [set.clone()];
            tried += 1;
            let Err(error) = file::read(SMALL, Path::new("small.toml"), &sets) else {
                continue;
            };
            // The value may make no sense in this scene, but the key and its type are known.
            let message = error.to_string();
            for refusal in [
                "unknown key",
                "; write ",
                "out of range",
                "is not known",
                "no unit",
            ] {
                assert!(!message.contains(refusal), "{set}: {message}");
            }
        }
    });
    assert!(tried > 80, "{tried} values tried");
}
