//! `stamp.json`: what a result is, what it was made from, where and how fast.
//!
//! For people to read and for the next run to trust. Its last member, `seal`, is the SHA-256 of the
//! text with the seal's digits set to zero, so that a damaged stamp is noticed.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::name::{is_inside, is_plain_name};
use super::{Setting, seal};
use crate::file::{self, FileError};
use crate::record::Digest;
use crate::record::atomic::write_file;
use crate::record::digest::Hasher;

/// Name of the file.
pub const FILE: &str = "stamp.json";

/// Version of the stamp's layout.
const LAYOUT: u32 = 1;

/// No stamp is longer, bytes.
const LONGEST: u64 = 16 << 20;

/// A setting as the stamp keeps it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SettingStamp {
    pub name: String,
    pub value: String,
    /// Canonical bytes, hexadecimal.
    pub canonical: String,
}

impl From<&Setting> for SettingStamp {
    fn from(setting: &Setting) -> Self {
        let hex = setting.canonical.iter().map(|byte| format!("{byte:02x}"));
        SettingStamp {
            name: setting.name.clone(),
            value: setting.shown.clone(),
            canonical: hex.collect(),
        }
    }
}

/// An input: which job made it, and what it contains.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputStamp {
    pub stage: String,
    pub body: String,
    pub key: Digest,
    pub digest: Digest,
}

/// One file of the result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputStamp {
    pub file: String,
    pub bytes: u64,
    /// Of the content: see [`super::content::content`].
    pub digest: Digest,
    /// SHA-256 of all bytes of the file, where `digest` does not count them all; early stamps
    /// lack it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<Digest>,
    /// Whether the result's digest counts it.
    pub counted: bool,
}

/// All that is known about a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stamp {
    /// Version of this layout.
    pub stamp: u32,
    pub stage: String,
    pub body: String,
    pub version: u32,
    /// Version of the checkpoint format.
    pub format: u32,
    pub key: Digest,
    /// Key without the setting that may grow, if the stage has one.
    pub family: Option<Digest>,
    pub settings: Vec<SettingStamp>,
    pub inputs: Vec<InputStamp>,
    /// Of all counted outputs.
    pub digest: Digest,
    pub outputs: Vec<OutputStamp>,
    /// What the stage found worth saying.
    pub notes: Vec<String>,
    /// Name and version of the program.
    pub program: String,
    pub machine: super::machine::Machine,
    pub threads: usize,
    /// UTC, when the first attempt at this result started.
    pub started: String,
    /// How often it was stopped or killed on the way.
    pub resumptions: u32,
    /// Over all attempts, as far as they were recorded.
    pub wall_seconds: f64,
    pub cpu_seconds: f64,
    /// The most memory that the process had held when it ended the stage, bytes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory_bytes: Option<u64>,
    /// Size of the work in the stage's unit, for estimates.
    pub work: Option<f64>,
}

/// A stamp that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StampError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{path} is no valid stamp: {what}")]
    Invalid { path: String, what: String },
}

impl Stamp {
    /// The layout that this program writes.
    pub fn layout() -> u32 {
        LAYOUT
    }

    /// Reads and checks `folder/stamp.json`; `None` if there is none.
    pub fn read(folder: &Path) -> Result<Option<Stamp>, StampError> {
        match read_file(&folder.join(FILE)) {
            Err(StampError::File(error)) if error.is_not_found() => Ok(None),
            other => other.map(Some),
        }
    }

    /// Writes `folder/stamp.json`, atomically.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        write_file(&folder.join(FILE), self.text().as_bytes())
    }

    fn text(&self) -> String {
        seal::seal(&serde_json::to_string_pretty(self).expect("a stamp is plain data"))
    }

    /// For people: `relax drop`.
    pub fn label(&self) -> String {
        label(&self.stage, &self.body)
    }
}

/// For people: `relax drop`, `impact`.
pub fn label(stage: &str, part: &str) -> String {
    if part.is_empty() {
        stage.to_string()
    } else {
        format!("{stage} {part}")
    }
}

/// Digest of a result: of its only counted file, or of all their names and digests.
pub(super) fn digest_of(outputs: &[OutputStamp]) -> Digest {
    let counted: Vec<_> = outputs.iter().filter(|output| output.counted).collect();
    if let [only] = counted[..] {
        return only.digest;
    }
    let mut hasher = Hasher::new("coronet result 1");
    for output in counted {
        hasher.text(&output.file).digest(&output.digest);
    }
    hasher.finish()
}

/// Reads and checks a stamp under any name. It names nothing outside its own folder and store.
///
/// # Errors
/// If the file cannot be read, or is not a stamp that this program can use.
pub fn read_file(path: &Path) -> Result<Stamp, StampError> {
    let invalid = |what: String| StampError::Invalid {
        path: path.display().to_string(),
        what,
    };
    let bytes = file::read_no_link(path, LONGEST)?;
    let text = String::from_utf8(bytes).map_err(|error| invalid(error.to_string()))?;
    seal::check(&text).map_err(|what| invalid(what.to_string()))?;
    let stamp: Stamp = serde_json::from_str(&text).map_err(|error| invalid(error.to_string()))?;
    if stamp.stamp != LAYOUT {
        let what = format!("layout {}; this program reads {LAYOUT}", stamp.stamp);
        return Err(invalid(what));
    }
    let stages = stamp.inputs.iter().map(|input| &input.stage);
    if let Some(name) = stages
        .chain([&stamp.stage])
        .find(|name| !is_plain_name(name))
    {
        return Err(invalid(format!("{name:?} cannot be the name of a stage")));
    }
    let mut files = stamp.outputs.iter().map(|output| &output.file);
    if let Some(name) = files.find(|name| !is_inside(name)) {
        return Err(invalid(format!("{name:?} leads out of its folder")));
    }
    Ok(stamp)
}
