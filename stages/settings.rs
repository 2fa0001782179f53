//! What each stage reads, for its key.

use anyhow::Result;
use coronet::pipeline::Setting;
use coronet::scene::{Problem, key};
use serde::Serialize;

/// Settings in the input of a stage, as the pipeline knows them; `problem` is the scene's.
pub fn list(input: &impl Serialize, problem: &Problem) -> Result<Vec<Setting>> {
    let setting = |setting: key::Setting| Setting {
        name: setting.name,
        shown: setting.value,
        canonical: setting.canonical,
    };
    let settings = key::settings(input, problem)?;
    Ok(settings.into_iter().map(setting).collect())
}
