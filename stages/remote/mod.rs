//! The remote store that `--remote` names.

#[cfg(feature = "remote")]
mod s3;

use std::path::Path;

use anyhow::{Result, bail};
use coronet::pipeline::remote::{Folder, Objects};

use crate::fault::Usage;

/// The store at a URL; `None` without one. `own`: the store of this machine.
///
/// # Errors
/// If the URL cannot be used, whether the store answers or not.
pub fn open(url: Option<&str>, own: &Path) -> Result<Option<Box<dyn Objects>>> {
    let Some(url) = url.filter(|url| !url.is_empty()) else {
        return Ok(None);
    };
    if let Some(path) = url.strip_prefix("file://") {
        let path = Path::new(path);
        if !path.is_absolute() {
            bail!(Usage(format!(
                "--remote {url}: the path is not absolute; write file:///absolute/path"
            )));
        }
        if let (Ok(there), Ok(here)) = (path.canonicalize(), own.canonicalize())
            && there.starts_with(&here)
        {
            bail!(Usage(format!(
                "--remote {url}: that is in the store of this machine, {}; a remote store is a \
                 folder of its own",
                own.display()
            )));
        }
        return Ok(Some(Box::new(Folder::new(path))));
    }
    if url.starts_with("s3://") {
        return Ok(Some(service(url)?));
    }
    bail!(Usage(format!(
        "--remote {url}: it starts with neither file:/// nor s3://"
    )))
}

#[cfg(feature = "remote")]
fn service(url: &str) -> Result<Box<dyn Objects>> {
    Ok(Box::new(s3::S3::open(url)?))
}

#[cfg(not(feature = "remote"))]
fn service(url: &str) -> Result<Box<dyn Objects>> {
    bail!(Usage(format!(
        "--remote {url}: this program was built without S3; build it with `--features remote`"
    )))
}
