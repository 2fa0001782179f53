//! What the pipeline asks of each job: the settings in its key, and what it will cost.

use anyhow::Result;
use coronet::pipeline::{Setting, Work};
use coronet::scene::{Problem, key};
use serde::Serialize;

/// What a job will cost, found when it is asked for.
pub type Forecast<'a> = Box<dyn Fn() -> Option<Work> + Sync + 'a>;

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
