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
}
