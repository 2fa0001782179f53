//! `stamp.json`: identity, inputs, machine and time of a result.
//!
//! Users and the next run read it. Its last member, `seal`, is the SHA-256 of the text with the
//! seal's digits set to zero, so that a damaged stamp is detected.

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

/// Largest size of a stamp, bytes.
pub(super) const LONGEST: u64 = 16 << 20;

/// A setting in a stamp.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SettingStamp {
    /// Dotted name, as in the scene file.
    pub name: String,
    /// The value with its unit.
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

/// An input: the job that made it, and its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputStamp {
    /// Name of the stage.
    pub stage: String,
    /// What the stage was applied to, or empty.
    pub body: String,
    /// Key of the input.
    pub key: Digest,
    /// Digest of its content.
    pub digest: Digest,
}

/// One file of the result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutputStamp {
    /// Name in the folder of the result.
    pub file: String,
    /// Size of the file.
    pub bytes: u64,
    /// Of the content: see [`super::content::content`].
    pub digest: Digest,
    /// SHA-256 of all bytes of the file, where `digest` does not include them all; missing in early
    /// stamps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<Digest>,
    /// Whether the result's digest includes it.
    pub counted: bool,
}

/// The record of a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stamp {
    /// Version of this layout.
    pub stamp: u32,
    /// Name of the stage.
    pub stage: String,
    /// What it was applied to, or empty.
    pub body: String,
    /// Version of the stage.
    pub version: u32,
    /// Version of the checkpoint format.
    pub format: u32,
    /// Key of the result.
    pub key: Digest,
    /// Key without the setting that may grow, if the stage has one.
    pub family: Option<Digest>,
    /// The settings that the stage read.
    pub settings: Vec<SettingStamp>,
    /// The results that the stage read.
    pub inputs: Vec<InputStamp>,
    /// Of all counted outputs.
    pub digest: Digest,
    /// Files of the result.
    pub outputs: Vec<OutputStamp>,
    /// Notes of the stage.
    pub notes: Vec<String>,
    /// Name and version of the program.
    pub program: String,
    /// Where it was made.
    pub machine: super::machine::Machine,
    /// Number of threads.
    pub threads: usize,
    /// UTC, when the first attempt at this result started.
    pub started: String,
    /// Number of interruptions of the job.
    pub resumptions: u32,
    /// Wall time over all attempts, as far as they were recorded, s.
    pub wall_seconds: f64,
    /// CPU time over all attempts, s.
    pub cpu_seconds: f64,
    /// Peak memory of the process at the end of the stage, bytes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory_bytes: Option<u64>,
    /// CPU time that was forecast, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forecast_seconds: Option<f64>,
}

/// A stamp that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StampError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The content is not a stamp of this layout.
    #[error("{path} is not a valid stamp: {what}")]
    Invalid {
        /// The file.
        path: String,
        /// What is wrong.
        what: String,
    },
}

impl Stamp {
    /// The layout that this program writes.
    pub fn layout() -> u32 {
        LAYOUT
    }

    /// Reads and checks `folder/stamp.json`; `None` if there is none.
    ///
    /// # Errors
    /// See [`StampError`].
    pub fn read(folder: &Path) -> Result<Option<Stamp>, StampError> {
        match read_file(&folder.join(FILE)) {
            Err(StampError::File(error)) if error.is_not_found() => Ok(None),
            other => other.map(Some),
        }
    }

    /// Writes `folder/stamp.json`, atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<(), FileError> {
        write_file(&folder.join(FILE), self.text().as_bytes())
    }

    fn text(&self) -> String {
        seal::seal(&serde_json::to_string_pretty(self).expect("a stamp is plain data"))
    }

    /// Name of the job in messages: `relax drop`.
    pub fn label(&self) -> String {
        label(&self.stage, &self.body)
    }
}

/// Name of a job in messages: `relax drop`, `impact`.
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

/// Reads and checks a stamp under any name. Rejects names that lead out of its folder or the store.
///
/// # Errors
/// If the file cannot be read, or is not a stamp that this program can use.
pub fn read_file(path: &Path) -> Result<Stamp, StampError> {
    let bytes = file::read_no_link(path, LONGEST)?;
    parse(bytes, &path.display().to_string())
}

/// Checks the content of a stamp; `path`: where it is from.
pub(super) fn parse(bytes: Vec<u8>, path: &str) -> Result<Stamp, StampError> {
    let invalid = |what: String| StampError::Invalid {
        path: path.to_string(),
        what,
    };
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
