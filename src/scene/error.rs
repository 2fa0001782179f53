//! Errors of a scene file, each with its place and a remedy.

use std::fmt;
use std::path::PathBuf;

use crate::file::FileError;

/// Where a value was written: a file with line and column (from 1), or a `--set` argument.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A place in a file.
    File {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: usize,
        /// Column number, from 1.
        column: usize,
    },
    /// The text of a `--set` argument.
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

/// A scene file that cannot be loaded. Every variant names the place; the message ends with a
/// remedy.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not UTF-8 text.
    #[error("{}: is not UTF-8 text; give a TOML file", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
    },
    /// A file for another command.
    #[error("{}: is a {kind}; {remedy}", path.display())]
    OtherKind {
        /// The file.
        path: PathBuf,
        /// What it is.
        kind: &'static str,
        /// What to do with it.
        remedy: String,
    },
    /// The file is not valid TOML.
    #[error("{place}: not TOML: {message}")]
    Syntax {
        /// Where the parser stopped.
        place: Place,
        /// The parser's message.
        message: String,
    },
    /// A value that the schema permits and the type rejects.
    #[error("{place}: {message}")]
    Unfit {
        /// Where the value is.
        place: Place,
        /// The reason.
        message: String,
    },
    /// A `--set` argument that cannot be read.
    #[error(
        "--set {argument}: {problem}; write --set key.key=value, as in --set impact.end=\"20 ms\""
    )]
    Argument {
        /// The argument.
        argument: String,
        /// The reason.
        problem: String,
    },
    /// A key that the schema does not contain.
    #[error("{place}: unknown key `{key}`; {remedy}")]
    UnknownKey {
        /// Where the key is.
        place: Place,
        /// Dotted, from the root.
        key: String,
        /// The known key that is spelled most like it, dotted, if one is close.
        nearest: Option<String>,
        /// What to write instead.
        remedy: String,
    },
    /// A required key that is not there.
    #[error("{place}: `{key}` is missing; {remedy}")]
    Missing {
        /// Where its table starts.
        place: Place,
        /// Dotted, from the root.
        key: String,
        /// What to write.
        remedy: String,
    },
    /// A value that is not allowed.
    #[error("{place}: `{key}` = {value}: {problem}; {remedy}")]
    Value {
        /// Where the value is.
        place: Place,
        /// Dotted, from the root.
        key: String,
        /// As written.
        value: String,
        /// Why it is not allowed.
        problem: String,
        /// What to write instead.
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

/// Collects the mistakes of a scene file, so that all are reported at once.
#[derive(Debug, Default)]
pub struct Mistakes(Vec<SceneError>);

impl Mistakes {
    /// Adds a mistake.
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

    /// Whether there is no mistake.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Ends the collection.
    ///
    /// # Errors
    /// The mistake, or [`SceneError::Many`].
    pub fn told(mut self) -> Result<(), SceneError> {
        self.0.sort_by_key(SceneError::order);
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(SceneError::Many(self.0)),
        }
    }
}
