//! Holds a tree against the format: unknown keys, missing keys, wrong types, units and ranges.

use super::error::{Mistakes, SceneError};
use super::format::{self, FILE, Field, Kind, Need};
use super::quantity;
use super::spelling::{ALIKE, beside, is_printable, nearest, printable};
use super::tree::{Entry, Node, Value};

/// All mistakes of the whole file.
pub fn check(root: &Node) -> Mistakes {
    let mut found = Mistakes::default();
    table(root, "", FILE, &[], &mut found);
    found
}

/// `parent.key`, or `key` at the root.
pub fn dotted(parent: &str, key: &str) -> String {
    if parent.is_empty() {
        key.to_string()
    } else {
        format!("{parent}.{key}")
    }
}

fn table(node: &Node, path: &str, fields: &[Field], one_of: &[&str], found: &mut Mistakes) {
    let Value::Table(entries) = &node.value else {
        return found.add(unfit(node, path, "a table"));
    };
    let mut meant = Vec::new();
    for entry in entries {
        match fields.iter().find(|field| field.name == entry.key) {
            Some(field) => value(&entry.node, &dotted(path, &entry.key), &field.kind, found),
            None => {
                let (mistake, nearest) = unknown(entry, path, fields);
                meant.extend(nearest);
                found.add(mistake);
            }
        }
    }
    // What is spelled wrong is not missing too.
    let is_meant = |key: &str| meant.contains(&dotted(path, key));
    let absent = |field: &&Field| field.need == Need::Required && node.get(field.name).is_none();
    for field in fields.iter().filter(absent).filter(|f| !is_meant(f.name)) {
        found.add(SceneError::Missing {
            place: node.place.clone(),
            key: dotted(path, field.name),
            remedy: format!("{} Write {}", field.about, example(field)),
        });
    }
    if !one_of.iter().any(|key| is_meant(key)) {
        found.take(exactly_one(node, path, entries, one_of));
    }
}

fn exactly_one(
    node: &Node,
    path: &str,
    entries: &[Entry],
    one_of: &[&str],
) -> Result<(), SceneError> {
    if one_of.is_empty() {
        return Ok(());
    }
    let mut given = entries
        .iter()
        .filter(|entry| one_of.contains(&entry.key.as_str()));
    let choice = format!("give exactly one of {}", one_of.join(", "));
    match (given.next(), given.next()) {
        (Some(_), None) => Ok(()),
        (None, _) => Err(SceneError::Missing {
            place: node.place.clone(),
            key: dotted(path, one_of[0]),
            remedy: choice,
        }),
        (Some(first), Some(second)) => Err(SceneError::Value {
            place: second.place.clone(),
            key: dotted(path, &second.key),
            value: second.node.inline(),
            problem: format!("`{}` is given already", first.key),
            remedy: choice,
        }),
    }
}

fn value(node: &Node, path: &str, kind: &Kind, found: &mut Mistakes) {
    match kind {
        Kind::List(item, least, most) => list(node, path, item, (*least, *most), found),
        Kind::Table(fields, one_of) => table(node, path, fields, one_of, found),
        Kind::Named(fields, one_of) => named(node, path, fields, one_of, found),
        Kind::Either(kinds) => either(node, path, kinds, found),
        _ => {
            found.take(single(node, path, kind));
        }
    }
}

/// A value without parts.
fn single(node: &Node, path: &str, kind: &Kind) -> Result<(), SceneError> {
    match kind {
        Kind::Text => text(node, path).map(|_| ()),
        Kind::Colour => colour(node, path).map(|_| ()),
        Kind::Word(words) => word(node, path, words),
        Kind::Quantity(unit, range) => {
            let value = quantity_of(node, path, *unit)?;
            within(node, path, *range, value)
        }
        Kind::Number(range) => match node.value {
            Value::Float(value) => within(node, path, *range, value),
            Value::Integer(value) => within(node, path, *range, value as f64),
            _ => Err(unfit(node, path, "a number without a unit")),
        },
        Kind::Count(least) => match node.value {
            Value::Integer(value) if value >= *least => Ok(()),
            _ => Err(unfit(
                node,
                path,
                &format!("a whole number of at least {least}"),
            )),
        },
        Kind::List(..) | Kind::Table(..) | Kind::Named(..) | Kind::Either(_) => Ok(()),
    }
}

/// The text of a node: one line that can be printed.
pub fn text<'a>(node: &'a Node, path: &str) -> Result<&'a str, SceneError> {
    match &node.value {
        Value::Text(text) if text.chars().all(is_printable) => Ok(text),
        Value::Text(_) => {
            let problem = "has a control character, which terminals and tables would act on";
            Err(fault(
                node,
                path,
                problem,
                "leave it out; a text is one line",
            ))
        }
        _ => Err(unfit(node, path, "a string")),
    }
}

/// Red, green and blue of `"#rrggbb"`.
pub fn colour(node: &Node, path: &str) -> Result<[u8; 3], SceneError> {
    let wrong = || {
        fault(
            node,
            path,
            "is no colour",
            "write red, green, blue as \"#1f77b4\"",
        )
    };
    let digits = text(node, path)?.strip_prefix('#').ok_or_else(wrong)?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return Err(wrong());
    }
    let code = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
    let [_, red, green, blue] = code.to_be_bytes();
    Ok([red, green, blue])
}

/// The SI value of a number or of a text with a unit.
pub fn quantity_of(node: &Node, path: &str, unit: quantity::Unit) -> Result<f64, SceneError> {
    let remedy = || {
        let names: Vec<&str> = unit.spellings().iter().map(|(name, _)| *name).collect();
        format!(
            "write for example {}; units: {}",
            unit.example(),
            names.join(", ")
        )
    };
    let problem = match &node.value {
        Value::Float(value) => return Ok(*value),
        Value::Integer(value) => return Ok(*value as f64),
        Value::Text(text) => match quantity::parse(text, unit) {
            Ok(value) => return Ok(value),
            Err(error) => error.to_string(),
        },
        _ => format!("is {} where {} is wanted", node.kind(), unit.name()),
    };
    Err(fault(node, path, &problem, &remedy()))
}

fn within(node: &Node, path: &str, range: format::Range, value: f64) -> Result<(), SceneError> {
    if range.holds(value) {
        return Ok(());
    }
    let remedy = format!("it must be {}", range.wording());
    Err(fault(node, path, "is out of range", &remedy))
}

fn word(node: &Node, path: &str, words: &[&str]) -> Result<(), SceneError> {
    let given = match &node.value {
        Value::Text(text) => text.as_str(),
        _ => {
            return Err(unfit(
                node,
                path,
                &format!("one of \"{}\"", words.join("\", \"")),
            ));
        }
    };
    if words.contains(&given) {
        return Ok(());
    }
    let guess = nearest(given, words.iter().copied())
        .filter(|(_, likeness)| *likeness >= ALIKE)
        .map(|(word, _)| format!("did you mean \"{word}\"? "))
        .unwrap_or_default();
    let remedy = format!("{guess}known are \"{}\"", words.join("\", \""));
    Err(fault(node, path, "is not known", &remedy))
}

fn list(node: &Node, path: &str, item: &Kind, (least, most): (usize, usize), found: &mut Mistakes) {
    let Value::List(items) = &node.value else {
        return found.add(unfit(node, path, "an array"));
    };
    if items.len() < least || items.len() > most {
        let problem = format!("has {} entries", items.len());
        let remedy = if least == most {
            format!("give {least}")
        } else {
            format!("give {least} to {most}, one for each dimension")
        };
        found.add(fault(node, path, &problem, &remedy));
    }
    for (index, entry) in items.iter().enumerate() {
        value(entry, &format!("{path}[{index}]"), item, found);
    }
}

fn named(node: &Node, path: &str, fields: &[Field], one_of: &[&str], found: &mut Mistakes) {
    let Value::Table(entries) = &node.value else {
        return found.add(unfit(node, path, "a table of named tables"));
    };
    for entry in entries {
        let letter = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
        let whole = entry
            .key
            .chars()
            .all(|each| letter(each) || "_-".contains(each));
        if !whole
            || !entry
                .key
                .starts_with(|first: char| first.is_ascii_lowercase())
        {
            found.add(SceneError::Value {
                place: entry.place.clone(),
                key: dotted(path, &printable(&entry.key)),
                value: toml::Value::String(printable(&entry.key)).to_string(),
                problem: "is no name".to_string(),
                remedy: "use lower-case letters, digits, - and _, a letter first".to_string(),
            });
            continue;
        }
        table(
            &entry.node,
            &dotted(path, &entry.key),
            fields,
            one_of,
            found,
        );
    }
}

/// The mistakes are those of the alternative whose TOML type fits, if there is one.
fn either(node: &Node, path: &str, kinds: &[Kind], found: &mut Mistakes) {
    let mut fitting = None;
    for kind in kinds {
        let mut own = Mistakes::default();
        value(node, path, kind, &mut own);
        match own.told() {
            Ok(()) => return,
            Err(mistake) if same_type(node, kind) => fitting = Some(mistake),
            Err(_) => {}
        }
    }
    let wanted: Vec<String> = kinds.iter().map(wording).collect();
    found.add(fitting.unwrap_or_else(|| unfit(node, path, &wanted.join(", or "))));
}

fn same_type(node: &Node, kind: &Kind) -> bool {
    matches!(
        (&node.value, kind),
        (
            Value::Text(_),
            Kind::Text | Kind::Colour | Kind::Word(_) | Kind::Quantity(..)
        ) | (
            Value::Float(_) | Value::Integer(_),
            Kind::Quantity(..) | Kind::Number(_)
        ) | (Value::List(_), Kind::List(..))
            | (Value::Table(_), Kind::Table(..) | Kind::Named(..))
    )
}

fn wording(kind: &Kind) -> String {
    match kind {
        Kind::Text => "a string".to_string(),
        Kind::Colour => "a colour such as \"#1f77b4\"".to_string(),
        Kind::Word(words) => format!("one of \"{}\"", words.join("\", \"")),
        Kind::Quantity(unit, _) => format!("{} such as {}", unit.name(), unit.example()),
        Kind::Number(_) => "a number".to_string(),
        Kind::Count(_) => "a whole number".to_string(),
        Kind::List(item, ..) => format!("an array of {}", wording(item)),
        Kind::Table(fields, _) | Kind::Named(fields, _) => {
            let names: Vec<&str> = fields.iter().map(|field| field.name).collect();
            format!("a table with {}", names.join(", "))
        }
        Kind::Either(kinds) => kinds.iter().map(wording).collect::<Vec<_>>().join(", or "),
    }
}

fn example(field: &Field) -> String {
    let value = match &field.kind {
        Kind::Quantity(unit, _) => unit.example().to_string(),
        Kind::List(Kind::Quantity(unit, _), ..) => {
            format!("[{0}, {0}, {0}]", unit.example())
        }
        Kind::Word(words) => format!("\"{}\"", words[0]),
        Kind::Table(fields, _) => {
            let needed = fields.iter().filter(|inner| inner.need == Need::Required);
            let items: Vec<String> = needed.map(example).collect();
            return format!("{} = {{ {} }}", field.name, items.join(", "));
        }
        Kind::Named(..) => {
            return format!("a table [{}.NAME] for each", field.name);
        }
        _ => "...".to_string(),
    };
    format!("{} = {value}", field.name)
}

/// The mistake, and the known key that is meant, if one is near.
fn unknown(entry: &Entry, path: &str, fields: &[Field]) -> (SceneError, Option<String>) {
    let here = nearest(&entry.key, fields.iter().map(|field| field.name));
    let here = here.map(|(name, likeness)| (dotted(path, name), likeness));
    let guess = match here {
        Some((_, likeness)) if likeness >= ALIKE => here,
        _ => beside(&entry.key, path),
    };
    let known: Vec<&str> = fields.iter().map(|field| field.name).collect();
    let nearest = guess.map(|(key, _)| key);
    let question = nearest
        .as_ref()
        .map(|key| format!("did you mean `{key}`? "));
    let mistake = SceneError::UnknownKey {
        place: entry.place.clone(),
        key: dotted(path, &printable(&entry.key)),
        remedy: format!(
            "{}known here: {}",
            question.unwrap_or_default(),
            known.join(", ")
        ),
        nearest: nearest.clone(),
    };
    (mistake, nearest)
}

fn unfit(node: &Node, path: &str, wanted: &str) -> SceneError {
    let problem = format!("is {}", node.kind());
    fault(node, path, &problem, &format!("write {wanted}"))
}

/// An error about the value of a node.
pub fn fault(node: &Node, path: &str, problem: &str, remedy: &str) -> SceneError {
    SceneError::Value {
        place: node.place.clone(),
        key: if path.is_empty() {
            "(the file)".to_string()
        } else {
            path.to_string()
        },
        value: shortened(printable(&node.inline())),
        problem: problem.to_string(),
        remedy: remedy.to_string(),
    }
}

/// Long values in messages are cut.
fn shortened(text: String) -> String {
    const LONGEST: usize = 80;
    match text.char_indices().nth(LONGEST) {
        Some((at, _)) => format!("{} ...", &text[..at]),
        None => text,
    }
}
