//! What the pipeline needs of each job: the settings in its key, and its expected cost.

use anyhow::Result;
use coronet::pipeline::{Setting, Work};
use coronet::scene::{Problem, key};
use serde::Serialize;

/// The expected cost of a job, computed on demand.
pub type Forecast<'a> = Box<dyn Fn() -> Option<Work> + Sync + 'a>;

/// Settings in the input of a stage, for the pipeline; `problem` is the scene's.
pub fn list(input: &impl Serialize, problem: &Problem) -> Result<Vec<Setting>> {
    let setting = |setting: key::Setting| Setting {
        name: setting.name,
        shown: setting.value,
        canonical: setting.canonical,
    };
    let settings = key::settings(input, problem)?;
    Ok(settings.into_iter().map(setting).collect())
}
