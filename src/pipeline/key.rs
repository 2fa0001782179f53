//! The key of a result: SHA-256 over everything that it depends on, and nothing else.
//!
//! In it: the stage's name and VERSION, the version of the checkpoint format, each setting that the
//! stage reads (canonical bytes) and the digest of each input. Not in it: paths, times,
//! number of threads, compression level, names of bodies. Inputs count by the digest of what they
//! contain, so a producer that runs again with the same result changes nothing after it.

use super::{Setting, Stage};
use crate::record::Digest;
use crate::record::checkpoint::FORMAT_VERSION;
use crate::record::digest::Hasher;

/// Key of `stage` with these settings on inputs with these digests.
pub fn key(stage: &dyn Stage, settings: &[Setting], inputs: &[Digest]) -> Digest {
    hash(stage, settings, inputs, None)
}

/// Key without the setting that [`Stage::extends`] names: what results that are beginnings of
/// each other share. `None` if the stage has no such setting.
pub fn family(stage: &dyn Stage, settings: &[Setting], inputs: &[Digest]) -> Option<Digest> {
    let free = stage.extends()?;
    Some(hash(stage, settings, inputs, Some(free)))
}

fn hash(
    stage: &dyn Stage,
    settings: &[Setting],
    inputs: &[Digest],
    without: Option<&str>,
) -> Digest {
    let mut hasher = Hasher::new(match without {
        None => "coronet key 1",
        Some(_) => "coronet family 1",
    });
    hasher.text(stage.name());
    hasher.number(u64::from(stage.version()));
    hasher.number(u64::from(FORMAT_VERSION));
    let counted = settings
        .iter()
        .filter(|setting| without != Some(setting.name.as_str()));
    hasher.number(counted.clone().count() as u64);
    for setting in counted {
        hasher.bytes(&setting.canonical);
    }
    hasher.number(inputs.len() as u64);
    for digest in inputs {
        hasher.digest(digest);
    }
    hasher.finish()
}
