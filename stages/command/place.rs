//! Resolves a path that a user gives.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::file::exists;
use coronet::pipeline::content::{CHECKPOINT, LOG};
use coronet::pipeline::stamp;
use coronet::record::log::Reel;

use crate::fault::Usage;

/// An error if a new file or folder would be among results.
pub fn keep_results(path: &Path, artifacts: &Path) -> Result<()> {
    let path = std::path::absolute(path)?;
    let folder = path
        .ancestors()
        .find_map(|folder| folder.canonicalize().ok());
    let store = artifacts.canonicalize();
    if folder
        .zip(store.ok())
        .is_some_and(|(folder, store)| folder.starts_with(store))
    {
        let text = format!(
            "{} would be among results; give an --output elsewhere",
            path.display()
        );
        bail!(Usage(text));
    }
    Ok(())
}

/// The thing at a path.
pub enum Thing {
    Checkpoint(PathBuf),
    Log(Reel),
    Result(PathBuf),
    /// A folder of results: `artifacts/latest/NAME`.
    Latest(Vec<PathBuf>),
}

pub fn thing(path: &Path) -> Result<Thing> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let cannot = |what| move || format!("cannot {what} {}", path.display());
    let metadata = fs::metadata(path).with_context(cannot("read"))?;
    if metadata.is_dir() {
        if exists(&path.join(stamp::FILE))? {
            return Ok(Thing::Result(path.to_path_buf()));
        }
        let mut results = Vec::new();
        for entry in fs::read_dir(path).with_context(cannot("list"))? {
            let folder = entry.with_context(cannot("list"))?.path();
            if exists(&folder.join(stamp::FILE))? {
                results.push(folder);
            }
        }
        results.sort();
        if results.is_empty() {
            let text = format!("{} neither is nor contains a result", path.display());
            bail!(Usage(text));
        }
        return Ok(Thing::Latest(results));
    }
    match extension {
        Some(LOG) => Ok(Thing::Log(Reel::finished(path))),
        Some(CHECKPOINT) => Ok(Thing::Checkpoint(path.to_path_buf())),
        _ => bail!(Usage(format!(
            "{} is not a checkpoint (.{CHECKPOINT}), log (.{LOG}) or folder of a result",
            path.display()
        ))),
    }
}
