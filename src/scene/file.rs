//! The scene file: TOML with units, and `--set` over it.

use std::path::{Path, PathBuf};

use super::cursor::{self, Cursor};
use super::error::SceneError;
use super::{Scene, body, check, conform, resolve, tree};

/// No scene file is longer, bytes.
const LONGEST: u64 = 16 << 20;

/// No reference curve is longer, bytes.
pub const LONGEST_REFERENCE: u64 = 256 << 20;

/// A scene with the text that it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    pub scene: Scene,
    /// TOML that gives the same scene: the file as it stands, or, after `--set`, rewritten.
    pub text: String,
    /// The scene file, as given.
    pub path: PathBuf,
}

/// Reads the scene file at `path` with the overrides `sets`, each `key.key=value`.
///
/// # Errors
/// [`SceneError`]: unreadable file, no TOML; all unknown keys, missing keys, wrong types, units and
/// ranges; or, of a file without these, what makes no sense.
pub fn load(path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let content = crate::file::read(path, LONGEST)?;
    let text = String::from_utf8(content).map_err(|_| SceneError::NotText {
        path: path.to_path_buf(),
    })?;
    read(&text, path, sets)
}

/// As [`load`], with the text at hand; `path` names it and leads to reference curves.
///
/// # Errors
/// As [`load`].
pub fn read(text: &str, path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let mut root = tree::parse(text, path)?;
    for set in sets {
        tree::set(&mut root, set)?;
    }
    let mut found = conform::check(&root);
    if !found.is_empty() {
        body::supports(&root, &mut found);
    }
    found.told()?;
    let full = cursor::with_defaults(&root)?;
    let cursor = Cursor::root(&full);
    let name = path
        .file_stem()
        .map_or("scene".into(), |stem| stem.to_string_lossy());
    let scene = resolve::scene(&cursor, &name)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    check::scene(&scene, &cursor, folder)?;
    let text = if sets.is_empty() {
        text.to_string()
    } else {
        tree::write(&root)
    };
    Ok(Loaded {
        scene,
        text,
        path: path.to_path_buf(),
    })
}
