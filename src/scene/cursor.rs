//! Reading a tree that conforms to the format: defaults filled in, values typed, places kept.

use super::conform::{self, dotted};
use super::error::{Place, SceneError};
use super::format::{FILE, Field, Kind, Need};
use super::quantity::Unit;
use super::tree::{self, Entry, Node, Value};

/// The tree with every default written in.
pub fn with_defaults(root: &Node) -> Result<Node, SceneError> {
    let mut root = root.clone();
    fill(&mut root, FILE)?;
    Ok(root)
}

fn fill(node: &mut Node, fields: &[Field]) -> Result<(), SceneError> {
    let place = node.place.clone();
    let Value::Table(entries) = &mut node.value else {
        return Ok(());
    };
    for field in fields {
        if let Need::Default(text) = field.need
            && !entries.iter().any(|entry| entry.key == field.name)
        {
            let node = default_node(field.name, text, &place)?;
            entries.push(Entry {
                key: field.name.to_string(),
                place: place.clone(),
                node,
            });
        }
    }
    for entry in entries {
        if let Some(field) = fields.iter().find(|field| field.name == entry.key) {
            fill_kind(&mut entry.node, &field.kind)?;
        }
    }
    Ok(())
}

fn fill_kind(node: &mut Node, kind: &Kind) -> Result<(), SceneError> {
    match (kind, &mut node.value) {
        (Kind::Table(fields, _), Value::Table(_)) => fill(node, fields),
        (Kind::Named(fields, _), Value::Table(entries)) => entries
            .iter_mut()
            .try_for_each(|entry| fill(&mut entry.node, fields)),
        (Kind::List(item, ..), Value::List(items)) => {
            items.iter_mut().try_for_each(|each| fill_kind(each, item))
        }
        (Kind::Either(kinds), _) => kinds.iter().try_for_each(|kind| fill_kind(node, kind)),
        _ => Ok(()),
    }
}

/// A default stands where its table stands: an error about it leads there.
fn default_node(name: &str, text: &str, place: &Place) -> Result<Node, SceneError> {
    let line = format!("{name} = {text}");
    let root = tree::parse(&line, std::path::Path::new("(default)"))?;
    let mut node = root.get(name).cloned().unwrap_or(root);
    node.place = place.clone();
    Ok(node)
}

/// A node with its dotted key.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    pub node: &'a Node,
    pub path: String,
}

impl<'a> Cursor<'a> {
    /// At the root of a tree.
    pub fn root(node: &'a Node) -> Self {
        Cursor {
            node,
            path: String::new(),
        }
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<Cursor<'a>> {
        let node = self.node.get(key)?;
        Some(Cursor {
            node,
            path: dotted(&self.path, key),
        })
    }

    /// The value of a key that must be there.
    pub fn need(&self, key: &str) -> Result<Cursor<'a>, SceneError> {
        self.get(key).ok_or_else(|| SceneError::Missing {
            place: self.node.place.clone(),
            key: dotted(&self.path, key),
            remedy: "write it into this table".to_string(),
        })
    }

    /// The value at a dotted key, or the nearest table above it: where an error about it belongs.
    pub fn nearest(&self, key: &str) -> Cursor<'a> {
        let mut cursor = self.clone();
        for part in key.split('.') {
            match cursor.get(part) {
                Some(next) => cursor = next,
                None => break,
            }
        }
        cursor
    }

    /// Keys and values of a table, in file order.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, Cursor<'a>)> + '_ {
        self.node.entries().iter().map(|entry| {
            let path = dotted(&self.path, &entry.key);
            (
                entry.key.as_str(),
                Cursor {
                    node: &entry.node,
                    path,
                },
            )
        })
    }

    /// Values of an array; none of anything else.
    pub fn items(&self) -> Vec<Cursor<'a>> {
        let Value::List(items) = &self.node.value else {
            return Vec::new();
        };
        let cursor = |(index, node)| Cursor {
            node,
            path: format!("{}[{index}]", self.path),
        };
        items.iter().enumerate().map(cursor).collect()
    }

    /// SI value.
    pub fn quantity(&self, unit: Unit) -> Result<f64, SceneError> {
        conform::quantity_of(self.node, &self.path, unit)
    }

    /// SI value of a key that must be there.
    pub fn quantity_at(&self, key: &str, unit: Unit) -> Result<f64, SceneError> {
        self.need(key)?.quantity(unit)
    }

    /// A number without a unit.
    pub fn number(&self) -> Result<f64, SceneError> {
        match self.node.value {
            Value::Float(value) => Ok(value),
            Value::Integer(value) => Ok(value as f64),
            _ => Err(self.fault("is no number", "write a number without a unit")),
        }
    }

    /// A number of a key that must be there.
    pub fn number_at(&self, key: &str) -> Result<f64, SceneError> {
        self.need(key)?.number()
    }

    /// A whole number, not negative.
    pub fn count(&self) -> Result<u64, SceneError> {
        match self.node.value {
            Value::Integer(value) if value >= 0 => Ok(value.unsigned_abs()),
            _ => Err(self.fault("is no count", "write a whole number")),
        }
    }

    /// Text.
    pub fn text(&self) -> Result<&'a str, SceneError> {
        conform::text(self.node, &self.path)
    }

    /// Text of a key that must be there.
    pub fn text_at(&self, key: &str) -> Result<&'a str, SceneError> {
        self.need(key)?.text()
    }

    /// Values of an array of quantities, SI.
    pub fn quantities(&self, unit: Unit) -> Result<Vec<f64>, SceneError> {
        self.items()
            .iter()
            .map(|item| item.quantity(unit))
            .collect()
    }

    /// A vector of as many components as there are dimensions: [x, y, z], or [x, 0, z] of two.
    pub fn vector(&self, unit: Unit, dimension: super::Dimension) -> Result<[f64; 3], SceneError> {
        let read = |item: &Cursor<'_>| match unit {
            Unit::One => item.number(),
            _ => item.quantity(unit),
        };
        let values: Vec<f64> = self.items().iter().map(read).collect::<Result<_, _>>()?;
        match (dimension, values.as_slice()) {
            (super::Dimension::Two, &[x, z]) => Ok([x, 0.0, z]),
            (super::Dimension::Three, &[x, y, z]) => Ok([x, y, z]),
            (super::Dimension::Two, _) => Err(self.fault(
                &format!("has {} components in a 2-D scene", values.len()),
                "give 2: x and z",
            )),
            (super::Dimension::Three, _) => Err(self.fault(
                &format!("has {} components in a 3-D scene", values.len()),
                "give 3: x, y and z",
            )),
        }
    }

    /// An error about this value.
    pub fn fault(&self, problem: &str, remedy: &str) -> SceneError {
        conform::fault(self.node, &self.path, problem, remedy)
    }
}
