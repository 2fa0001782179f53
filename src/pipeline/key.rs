//! The key of a result: SHA-256 over exactly what it depends on.
//!
//! Included: the stage's name and VERSION, the version of the checkpoint format, each setting that
//! the stage reads (canonical bytes) and the digest of each input. Not included: paths, times,
//! number of threads, compression level, names of bodies. Inputs count by the digest of their
//! content, so a producer that runs again with an equal result leaves later results fresh.

use super::stamp::{Stamp, digest_of};
use super::{Setting, Stage};
use crate::record::Digest;
use crate::record::checkpoint::FORMAT_VERSION;
use crate::record::digest::Hasher;

/// The parts of a key.
struct Parts<'a> {
    stage: &'a str,
    version: u32,
    format: u32,
    /// Canonical bytes of the settings.
    settings: Vec<&'a [u8]>,
    inputs: Vec<Digest>,
}

/// Key of `stage` with these settings on inputs with these digests.
pub fn key(stage: &dyn Stage, settings: &[Setting], inputs: &[Digest]) -> Digest {
    parts(stage, settings.iter(), inputs).key()
}

/// Key without the setting that [`Stage::extends`] names, equal for results that are beginnings of
/// each other. `None` if the stage has no such setting.
pub fn family(stage: &dyn Stage, settings: &[Setting], inputs: &[Digest]) -> Option<Digest> {
    let free = stage.extends()?;
    let counted = settings.iter().filter(|setting| setting.name != free);
    Some(parts(stage, counted, inputs).family())
}

fn parts<'a>(
    stage: &'a dyn Stage,
    settings: impl Iterator<Item = &'a Setting>,
    inputs: &[Digest],
) -> Parts<'a> {
    Parts {
        stage: stage.name(),
        version: stage.version(),
        format: FORMAT_VERSION,
        settings: settings
            .map(|setting| setting.canonical.as_slice())
            .collect(),
        inputs: inputs.to_vec(),
    }
}

/// What in a stamp contradicts the rest of it, if anything.
pub fn contradiction(stamp: &Stamp) -> Option<&'static str> {
    if digest_of(&stamp.outputs) != stamp.digest {
        return Some("its digest is not that of its outputs");
    }
    (!follows(stamp)).then_some("its key is not that of its settings and inputs")
}

/// Whether the key of a stamp, and its family if it has one, are those of the settings and inputs
/// that the stamp names.
fn follows(stamp: &Stamp) -> bool {
    let settings = stamp.settings.iter();
    let canonical: Option<Vec<Vec<u8>>> = settings.map(|s| bytes(&s.canonical)).collect();
    let Some(canonical) = canonical else {
        return false;
    };
    let parts = |without: Option<usize>| Parts {
        stage: &stamp.stage,
        version: stamp.version,
        format: stamp.format,
        settings: (0..canonical.len())
            .filter(|index| Some(*index) != without)
            .map(|index| canonical[index].as_slice())
            .collect(),
        inputs: stamp.inputs.iter().map(|input| input.digest).collect(),
    };
    // The stamp does not contain which setting may grow, so any one may be left out.
    let is_family = |family| (0..canonical.len()).any(|k| parts(Some(k)).family() == family);
    parts(None).key() == stamp.key && stamp.family.is_none_or(is_family)
}

/// Bytes of hexadecimal digits.
fn bytes(hex: &str) -> Option<Vec<u8>> {
    let digits = hex.as_bytes().chunks(2);
    let byte = |pair: &[u8]| {
        let text = std::str::from_utf8(pair).ok()?;
        (pair.len() == 2)
            .then(|| u8::from_str_radix(text, 16).ok())
            .flatten()
    };
    digits.map(byte).collect()
}

impl Parts<'_> {
    fn key(&self) -> Digest {
        self.hash("coronet key 1")
    }

    fn family(&self) -> Digest {
        self.hash("coronet family 1")
    }

    fn hash(&self, domain: &str) -> Digest {
        let mut hasher = Hasher::new(domain);
        hasher.text(self.stage);
        hasher.number(u64::from(self.version));
        hasher.number(u64::from(self.format));
        hasher.number(self.settings.len() as u64);
        for setting in &self.settings {
            hasher.bytes(setting);
        }
        hasher.number(self.inputs.len() as u64);
        for digest in &self.inputs {
            hasher.digest(digest);
        }
        hasher.finish()
    }
}
