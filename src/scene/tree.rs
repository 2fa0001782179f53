//! A scene file as TOML that keeps the place of each value, with the overrides of `--set`.

use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue, ValueDeserializer};

use super::error::{Place, SceneError};
use super::spelling::printable;

/// A table of the file.
pub type Table<'a> = DeTable<'a>;
/// A value of the file.
pub type Value<'a> = Spanned<DeValue<'a>>;

/// The texts that a tree is read from.
#[derive(Debug)]
pub struct Sources {
    path: PathBuf,
    text: String,
    /// Each `key.key=value`.
    arguments: Vec<String>,
}

impl Sources {
    /// `path` only names the text in errors.
    pub fn new(text: &str, path: &Path, arguments: &[String]) -> Self {
        Sources {
            path: path.to_path_buf(),
            text: text.to_string(),
            arguments: arguments.to_vec(),
        }
    }

    /// Place of a byte of the sources, which follow each other.
    fn place(&self, offset: usize) -> Place {
        let mut end = self.text.len();
        if offset <= end {
            let before = self.text.get(..offset).unwrap_or("");
            let line = before.rsplit('\n').next().unwrap_or("");
            return Place::File {
                path: self.path.clone(),
                line: before.matches('\n').count() + 1,
                column: line.chars().count() + 1,
            };
        }
        let argument = self.arguments.iter().find(|argument| {
            end += argument.len();
            offset <= end
        });
        Place::Argument(argument.cloned().unwrap_or_default())
    }
}

/// The file with the overrides. Spans count bytes of all sources.
#[derive(Clone, Debug)]
pub struct Tree<'a> {
    pub root: Value<'a>,
    sources: &'a Sources,
}

impl<'a> Tree<'a> {
    /// # Errors
    /// [`SceneError::Syntax`], [`SceneError::Argument`].
    pub fn parse(sources: &'a Sources) -> Result<Self, SceneError> {
        let text = &sources.text;
        let parsed = DeTable::parse(text).map_err(|error| SceneError::Syntax {
            place: sources.place(error.span().map_or(0, |span| span.start)),
            message: error.message().replace('\n', ", "),
        })?;
        let root = DeValue::Table(parsed.into_inner());
        let root = Spanned::new(0..text.len(), root);
        let mut tree = Tree { root, sources };
        let mut start = text.len();
        for argument in &sources.arguments {
            let end = start + argument.len();
            tree.set(argument, start + 1..end)?;
            start = end;
        }
        Ok(tree)
    }

    /// Applies `key.key=value`.
    fn set(&mut self, argument: &'a str, span: Range<usize>) -> Result<(), SceneError> {
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
        let value = relocated(parsed(text.trim()), &span);
        let mut slot = &mut self.root;
        for key in keys {
            let DeValue::Table(table) = slot.get_mut() else {
                return Err(wrong(&format!(
                    "`{key}` is inside a value that is not a table"
                )));
            };
            slot = child(table, key, &span);
        }
        *slot = Spanned::new(span, value);
        Ok(())
    }

    /// TOML of the tree.
    pub fn text(&self) -> String {
        toml::to_string(&plain(self.root.get_ref())).unwrap_or_default()
    }

    /// Deserialises the whole file.
    ///
    /// # Errors
    /// [`SceneError::Unfit`] for a value that the schema permits and the type rejects.
    pub fn read<T: for<'de> Deserialize<'de>>(&self) -> Result<T, SceneError> {
        let from = ValueDeserializer::from(self.root.clone());
        T::deserialize(from).map_err(|error| SceneError::Unfit {
            place: self.place(error.span().map_or(0, |span| span.start)),
            message: error.message().to_string(),
        })
    }

    /// Where a byte of the sources is.
    pub fn place(&self, offset: usize) -> Place {
        self.sources.place(offset)
    }

    /// The value at a dotted key, `name[0]` for an item, or the nearest value above it, with its
    /// own key.
    fn nearest<'k>(&self, key: &'k str) -> (&Value<'a>, &'k str) {
        let mut found = (&self.root, "");
        let ends = key.char_indices().filter(|(_, c)| ['.', '['].contains(c));
        let ends = ends.map(|(at, _)| at).chain([key.len()]);
        for end in ends {
            let path = &key[..end];
            let step = key[found.1.len()..end].trim_start_matches('.');
            let next = match step.strip_prefix('[') {
                Some(index) => {
                    let index = index.trim_end_matches(']').parse::<usize>();
                    let items = found.0.get_ref().as_array();
                    items
                        .zip(index.ok())
                        .and_then(|(items, index)| items.get(index))
                }
                None => get(found.0, step),
            };
            match next {
                Some(next) => found = (next, path),
                None => break,
            }
        }
        found
    }

    /// The value at a dotted key, if it is present.
    pub fn get(&self, key: &str) -> Option<&Value<'a>> {
        let (value, found) = self.nearest(key);
        (found == key).then_some(value)
    }

    /// A text at a dotted key.
    pub fn text_at(&self, key: &str) -> Option<&str> {
        self.get(key)?.get_ref().as_str()
    }

    /// Keys of the table at a dotted key, in the order of the file.
    pub fn keys(&self, key: &str) -> Vec<&str> {
        let table = self.get(key).and_then(|value| value.get_ref().as_table());
        let keys = table.into_iter().flat_map(Table::keys);
        keys.map(|key| key.get_ref().as_ref()).collect()
    }

    /// An error about the value at a dotted key, or about the nearest value above it.
    pub fn fault(&self, key: &str, problem: &str, remedy: &str) -> SceneError {
        let (value, found) = self.nearest(key);
        self.fault_of(value, found, problem, remedy)
    }

    /// An error about a value.
    pub fn fault_of(
        &self,
        value: &Value<'_>,
        key: &str,
        problem: &str,
        remedy: &str,
    ) -> SceneError {
        let key = if key.is_empty() { "(the file)" } else { key };
        SceneError::Value {
            place: self.place(value.span().start),
            key: key.to_string(),
            value: shortened(printable(&inline(value.get_ref()))),
            problem: problem.to_string(),
            remedy: remedy.to_string(),
        }
    }

    /// An error about a key that the table at a dotted key lacks.
    pub fn missing(&self, table: &str, key: &str, remedy: &str) -> SceneError {
        let (value, found) = self.nearest(table);
        SceneError::Missing {
            place: self.place(value.span().start),
            key: dotted(found, key),
            remedy: remedy.to_string(),
        }
    }
}

/// The value of a `--set`: TOML if it parses as such, else a string.
fn parsed(text: &str) -> DeValue<'_> {
    match DeValue::parse(text) {
        Ok(parsed) => parsed.into_inner(),
        Err(_) => DeValue::String(text.into()),
    }
}

/// The same, without places.
pub fn value_of(text: &str) -> toml::Value {
    plain(&parsed(text))
}

/// `parent.key`, or `key` at the root.
pub fn dotted(parent: &str, key: &str) -> String {
    match parent.is_empty() {
        true => key.to_string(),
        false => format!("{parent}.{key}"),
    }
}

/// The value of a key of a table.
pub fn get<'t, 'a>(table: &'t Value<'a>, key: &str) -> Option<&'t Value<'a>> {
    let mut entries = table.get_ref().as_table()?.iter();
    entries.find_map(|(name, value)| (name.get_ref() == key).then_some(value))
}

/// The value of a key, an empty table if it is absent.
pub fn child<'t, 'a>(
    table: &'t mut Table<'a>,
    key: &'a str,
    span: &Range<usize>,
) -> &'t mut Value<'a> {
    let name: Spanned<DeString<'a>> = Spanned::new(span.clone(), key.into());
    let empty = || Spanned::new(span.clone(), DeValue::Table(Table::new()));
    table.entry(name).or_insert_with(empty)
}

/// As in "an array where a string is expected".
pub fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "an integer",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}

/// A number of either kind.
pub fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(number) => {
            let whole = i64::from_str_radix(number.as_str(), number.radix());
            whole
                .map(|value| value as f64)
                .ok()
                .or_else(|| number.as_str().parse().ok())
        }
        DeValue::Float(number) => number.as_str().parse().ok(),
        _ => None,
    }
}

/// The value in one line of TOML.
fn inline(value: &DeValue<'_>) -> String {
    plain(value).to_string()
}

/// The value without places.
fn plain(value: &DeValue<'_>) -> toml::Value {
    match value {
        DeValue::String(text) => toml::Value::String(text.to_string()),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(value) => toml::Value::Integer(value),
            Err(_) => toml::Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        },
        DeValue::Float(number) => toml::Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(truth) => toml::Value::Boolean(*truth),
        DeValue::Datetime(date) => toml::Value::Datetime(*date),
        DeValue::Array(items) => {
            toml::Value::Array(items.iter().map(|item| plain(item.get_ref())).collect())
        }
        DeValue::Table(table) => {
            let entries = table.iter();
            let entry = |(key, value): (&Spanned<DeString<'_>>, &Value<'_>)| {
                (key.get_ref().to_string(), plain(value.get_ref()))
            };
            toml::Value::Table(entries.map(entry).collect())
        }
    }
}

/// Sets the span of a value and of all that it contains.
fn relocated<'a>(value: DeValue<'a>, span: &Range<usize>) -> DeValue<'a> {
    let moved = |item: Value<'a>| {
        let value = relocated(item.into_inner(), span);
        Spanned::new(span.clone(), value)
    };
    match value {
        DeValue::Array(items) => DeValue::Array(items.into_iter().map(moved).collect()),
        DeValue::Table(table) => {
            let entries = table.into_iter();
            let entry = |(key, item): (Spanned<DeString<'a>>, Value<'a>)| {
                (Spanned::new(span.clone(), key.into_inner()), moved(item))
            };
            DeValue::Table(entries.map(entry).collect())
        }
        other => other,
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
