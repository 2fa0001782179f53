//! What can be wrong with a scene file, said so that it can be put right.

use std::fmt;
use std::path::PathBuf;

use crate::file::FileError;

/// Where a value was written: a file with line and column (from 1), or a `--set` argument.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    File {
        path: PathBuf,
        line: usize,
        column: usize,
    },
    Argument(String),
}

impl fmt::Display for Place {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File { path, line, column } => {
                write!(out, "{}:{line}:{column}", path.display())
            }
            Place::Argument(text) => write!(out, "--set {text}"),
        }
    }
}

/// A scene that cannot be had from its file. Every variant names the place; the message ends with
/// what would be right.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: is not UTF-8 text; give a TOML file", path.display())]
    NotText { path: PathBuf },
    #[error("{place}: not TOML: {message}")]
    Syntax { place: Place, message: String },
    /// What the schema allows and the type does not.
    #[error("{place}: {message}")]
    Unfit { place: Place, message: String },
    #[error(
        "--set {argument}: {problem}; write --set key.key=value, as in --set impact.end=\"20 ms\""
    )]
    Argument { argument: String, problem: String },
    #[error("{place}: unknown key `{key}`; {remedy}")]
    UnknownKey {
        place: Place,
        /// Dotted, from the root.
        key: String,
        /// The known key that is spelled most like it, dotted, if one is close.
        nearest: Option<String>,
        remedy: String,
    },
    #[error("{place}: `{key}` is missing; {remedy}")]
    Missing {
        place: Place,
        key: String,
        remedy: String,
    },
    #[error("{place}: `{key}` = {value}: {problem}; {remedy}")]
    Value {
        place: Place,
        key: String,
        /// As written.
        value: String,
        problem: String,
        remedy: String,
    },
    /// Two or more of these, in the order of the file.
    #[error("{} mistakes:\n{}", .0.len(), lines(.0))]
    Many(Vec<SceneError>),
}

fn lines(errors: &[SceneError]) -> String {
    let lines: Vec<String> = errors.iter().map(|error| format!("  {error}")).collect();
    lines.join("\n")
}

impl SceneError {
    /// The file with line and column, then arguments.
    fn order(&self) -> (bool, usize, usize) {
        let place = match self {
            SceneError::Syntax { place, .. }
            | SceneError::Unfit { place, .. }
            | SceneError::UnknownKey { place, .. }
            | SceneError::Missing { place, .. }
            | SceneError::Value { place, .. } => place,
            _ => return (true, 0, 0),
        };
        match place {
            Place::File { line, column, .. } => (false, *line, *column),
            Place::Argument(_) => (true, 0, 0),
        }
    }
}

/// The mistakes of a scene file, so that all are told at once.
#[derive(Debug, Default)]
pub struct Mistakes(Vec<SceneError>);

impl Mistakes {
    /// Notes a mistake.
    pub fn add(&mut self, mistake: SceneError) {
        match mistake {
            SceneError::Many(more) => self.0.extend(more),
            one => self.0.push(one),
        }
    }

    /// The value of a part, unless it has a mistake.
    pub fn take<T>(&mut self, part: Result<T, SceneError>) -> Option<T> {
        part.map_err(|mistake| self.add(mistake)).ok()
    }

    /// Whether there is any.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// # Errors
    /// The mistake, or all of them.
    pub fn told(mut self) -> Result<(), SceneError> {
        self.0.sort_by_key(SceneError::order);
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(SceneError::Many(self.0)),
        }
    }
}
