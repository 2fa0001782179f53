//! What the fuzz targets share. Each target gives bytes to readers of the product as a file of a
//! stranger would; a panic, a hang, or memory beyond the limits of `fuzz/run` is a failure.

#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use coronet::scene::file::{self, Loaded};
use coronet::scene::numbers;
use sha2::{Digest as _, Sha256};

include!(concat!(env!("OUT_DIR"), "/program.rs"));

/// A folder of this process, in memory if `TMPDIR` is.
pub fn scratch() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = tempfile::Builder::new().prefix("coronet-fuzz-").tempdir();
        folder.expect("a folder for temporary files").keep()
    })
}

/// Writes `bytes` as the file of that name, always the same one, and returns its path.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = scratch().join(name);
    std::fs::write(&path, bytes).expect("space for temporary files");
    path
}

pub fn sha256(bytes: &[u8]) -> [u8; 32] {
    Sha256::digest(bytes).into()
}

pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// All that a scene goes through before anything runs: dimensionless numbers, keys and forecasts of
/// all stages (without the probe of this machine, which takes long here). Returns its keys, if it is
/// accepted.
pub fn planned(loaded: &Loaded) -> Option<String> {
    assert!(!numbers::of(&loaded.scene).to_string().is_empty());
    let pipeline = jobs::pipeline(loaded).ok()?;
    let jobs = pipeline.jobs.iter();
    let described = jobs.map(|job| {
        std::hint::black_box(job.work());
        format!("{:?}", job.settings())
    });
    Some(described.collect::<Vec<_>>().join("\n"))
}

/// A scene and overrides, as `run` and `plan` take them. What was accepted must be accepted again
/// in the form in which it is kept beside the results, with the same keys.
pub fn scene(text: &str, sets: &[String]) {
    let path = scratch().join("scene.toml");
    let loaded = match file::read(text, &path, sets) {
        Ok(loaded) => loaded,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let Some(keys) = planned(&loaded) else { return };
    let again = file::read(&loaded.text, &path, &[]);
    let again = again.expect("what was accepted is kept in an acceptable form");
    assert_eq!(
        Some(keys),
        planned(&again),
        "the kept form is another scene"
    );
}

/// A study file, up to its points; nothing runs.
pub fn study_file(path: &Path) {
    match study::points::load(path) {
        Ok((_, trials)) => assert!(trials.iter().all(|trial| !trial.name.is_empty())),
        Err(error) => assert!(!crate::text(&error).is_empty()),
    }
}
