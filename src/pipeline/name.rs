//! Names from files and arguments that become parts of paths.

use std::path::{Component, Path};

/// Name of the manifest in the folder of each name of results.
pub const MANIFEST: &str = "manifest.json";

/// Whether the last part of `path` is a key.
pub fn is_key(path: &Path) -> bool {
    let name = path
        .file_name()
        .and_then(|name| name.to_str())
        .unwrap_or_default();
    name.len() == 64
        && name
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// Whether `text` is a path that stays inside the folder that it is joined to: one or more plain
/// names.
pub fn is_inside(text: &str) -> bool {
    let path = Path::new(text);
    let plain = |part| matches!(part, Component::Normal(_));
    !text.is_empty()
        && !text.contains(['\\', '\0'])
        && path.components().all(plain)
        && !text.chars().any(char::is_control)
}

/// Whether `name` is one plain name.
pub fn is_plain_name(name: &str) -> bool {
    is_inside(name) && !name.contains('/') && !name.starts_with('.') && name.len() <= 200
}

/// Whether `name` can be the name of results: a plain name, or several with `/` between them.
pub fn is_name(name: &str) -> bool {
    is_inside(name)
        && name
            .split('/')
            .all(|part| is_plain_name(part) && part != MANIFEST)
}
