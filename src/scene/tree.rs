//! A TOML file as a tree that remembers where each value was written, with `--set` laid over it.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::error::{Place, SceneError};

/// A value and the place where it was written.
#[derive(Clone, Debug)]
pub struct Node {
    pub place: Place,
    pub value: Value,
}

/// A TOML value. Dates are kept as text: no setting takes one.
#[derive(Clone, Debug)]
pub enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Truth(bool),
    Date(String),
    List(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key of a table, in file order.
#[derive(Clone, Debug)]
pub struct Entry {
    pub key: String,
    /// Of the key; the node has its own.
    pub place: Place,
    pub node: Node,
}

impl Node {
    /// The entries, if this is a table.
    pub fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The value of `key`, if this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Node> {
        let found = self.entries().iter().find(|entry| entry.key == key);
        found.map(|entry| &entry.node)
    }

    /// As in "an array where a string is wanted".
    pub fn kind(&self) -> &'static str {
        match self.value {
            Value::Text(_) => "a string",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a number",
            Value::Truth(_) => "true or false",
            Value::Date(_) => "a date",
            Value::List(_) => "an array",
            Value::Table(_) => "a table",
        }
    }

    /// The value as it would be written in one line of TOML.
    pub fn inline(&self) -> String {
        match &self.value {
            Value::Text(text) => toml::Value::String(text.clone()).to_string(),
            Value::Integer(value) => value.to_string(),
            Value::Float(value) => toml::Value::Float(*value).to_string(),
            Value::Truth(value) => value.to_string(),
            Value::Date(text) => text.clone(),
            Value::List(items) => {
                let items: Vec<String> = items.iter().map(Node::inline).collect();
                format!("[{}]", items.join(", "))
            }
            Value::Table(entries) => {
                let item = |entry: &Entry| format!("{} = {}", entry.key, entry.node.inline());
                let items: Vec<String> = entries.iter().map(item).collect();
                format!("{{ {} }}", items.join(", "))
            }
        }
    }
}

/// Parses the text of a scene file. `path` only names it in places.
pub fn parse(text: &str, path: &Path) -> Result<Node, SceneError> {
    let lines = Lines::new(text, path);
    match DeTable::parse(text) {
        Ok(table) => Ok(lines.table(table.span().start, table.get_ref())),
        Err(error) => Err(SceneError::Syntax {
            place: lines.place(error.span().map_or(0, |span| span.start)),
            message: error.message().replace('\n', ", "),
        }),
    }
}

/// Lays `key.key=value` over the tree. The value is TOML if it parses as such, else a string.
pub fn set(root: &mut Node, argument: &str) -> Result<(), SceneError> {
    let wrong = |problem: &str| SceneError::Argument {
        argument: argument.to_string(),
        problem: problem.to_string(),
    };
    let (path, text) = argument
        .split_once('=')
        .ok_or_else(|| wrong("has no `=`"))?;
    let keys: Vec<&str> = path.split('.').map(str::trim).collect();
    if keys.iter().any(|key| key.is_empty()) {
        return Err(wrong("names an empty key"));
    }
    let place = Place::Argument(argument.to_string());
    let value = argument_value(text.trim(), &place);
    let mut node = root;
    let (last, tables) = keys.split_last().ok_or_else(|| wrong("names no key"))?;
    for key in tables {
        node = child(node, key, &place)
            .ok_or_else(|| wrong(&format!("`{key}` is inside a value that is no table")))?;
    }
    let slot = child(node, last, &place)
        .ok_or_else(|| wrong(&format!("`{last}` is inside a value that is no table")))?;
    *slot = value;
    Ok(())
}

/// The tree as TOML text that parses into the same values.
pub fn write(root: &Node) -> String {
    let mut text = String::new();
    write_table(root, "", &mut text);
    text
}

/// Scalars first, then tables under their headers, so that no key falls under a foreign header.
fn write_table(node: &Node, path: &str, text: &mut String) {
    for entry in node
        .entries()
        .iter()
        .filter(|entry| !is_section(&entry.node, path))
    {
        text.push_str(&format!("{} = {}\n", entry.key, entry.node.inline()));
    }
    for entry in node
        .entries()
        .iter()
        .filter(|entry| is_section(&entry.node, path))
    {
        let path = match path {
            "" => entry.key.clone(),
            _ => format!("{path}.{}", entry.key),
        };
        let only_sections = !entry.node.entries().is_empty()
            && entry
                .node
                .entries()
                .iter()
                .all(|inner| is_section(&inner.node, &path));
        if !only_sections {
            text.push_str(&format!("\n[{path}]\n"));
        }
        write_table(&entry.node, &path, text);
    }
}

/// Tables down to the second level get a header, deeper ones stay in a line.
fn is_section(node: &Node, path: &str) -> bool {
    matches!(node.value, Value::Table(_)) && !path.contains('.')
}

/// The child of a table, made empty if absent; `None` if `node` is no table.
fn child<'a>(node: &'a mut Node, key: &str, place: &Place) -> Option<&'a mut Node> {
    let Value::Table(entries) = &mut node.value else {
        return None;
    };
    let at = entries
        .iter()
        .position(|entry| entry.key == key)
        .unwrap_or_else(|| {
            let value = Value::Table(Vec::new());
            entries.push(Entry {
                key: key.to_string(),
                place: place.clone(),
                node: Node {
                    place: place.clone(),
                    value,
                },
            });
            entries.len() - 1
        });
    Some(&mut entries[at].node)
}

fn argument_value(text: &str, place: &Place) -> Node {
    let line = format!("value = {text}");
    let parsed = DeTable::parse(&line)
        .ok()
        .filter(|table| table.get_ref().len() == 1);
    let mut node = match parsed {
        Some(table) => {
            let lines = Lines::new(&line, Path::new(""));
            let root = lines.table(0, table.get_ref());
            root.get("value").cloned().unwrap_or(root)
        }
        None => Node {
            place: place.clone(),
            value: Value::Text(text.to_string()),
        },
    };
    relocate(&mut node, place);
    node
}

fn relocate(node: &mut Node, place: &Place) {
    node.place = place.clone();
    match &mut node.value {
        Value::List(items) => items.iter_mut().for_each(|item| relocate(item, place)),
        Value::Table(entries) => {
            for entry in entries {
                entry.place = place.clone();
                relocate(&mut entry.node, place);
            }
        }
        _ => {}
    }
}

/// Turns byte offsets into lines and columns while the tree is built.
struct Lines<'a> {
    text: &'a str,
    path: &'a Path,
    /// Offset of the first byte of each line.
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str, path: &'a Path) -> Self {
        let after = text.match_indices('\n').map(|(at, _)| at + 1);
        let starts = std::iter::once(0).chain(after).collect();
        Lines { text, path, starts }
    }

    fn place(&self, offset: usize) -> Place {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        let column = self
            .text
            .get(start..offset)
            .map_or(1, |part| part.chars().count() + 1);
        Place::File {
            path: self.path.to_path_buf(),
            line,
            column,
        }
    }

    fn node(&self, start: usize, value: &DeValue<'_>) -> Node {
        let value = match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(number) => integer(number.as_str(), number.radix()),
            DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(truth) => Value::Truth(*truth),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(items) => Value::List(
                items
                    .iter()
                    .map(|item| self.node(item.span().start, item.get_ref()))
                    .collect(),
            ),
            DeValue::Table(table) => return self.table(start, table),
        };
        Node {
            place: self.place(start),
            value,
        }
    }

    fn table(&self, start: usize, table: &DeTable<'_>) -> Node {
        let mut entries: Vec<(usize, Entry)> = table
            .iter()
            .map(|(key, value)| {
                let offset = key.span().start;
                let entry = Entry {
                    key: key.get_ref().to_string(),
                    place: self.place(offset),
                    node: self.node(value.span().start, value.get_ref()),
                };
                (offset, entry)
            })
            .collect();
        entries.sort_by_key(|(offset, _)| *offset);
        let entries = entries.into_iter().map(|(_, entry)| entry).collect();
        Node {
            place: self.place(start),
            value: Value::Table(entries),
        }
    }
}

/// An integer that fits, else the nearest number.
fn integer(digits: &str, radix: u32) -> Value {
    match i64::from_str_radix(digits, radix) {
        Ok(value) => Value::Integer(value),
        Err(_) => Value::Float(digits.parse().unwrap_or(f64::NAN)),
    }
}
