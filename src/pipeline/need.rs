//! What a run of a part of a pipeline needs.

use super::{Pipeline, PipelineError};

/// Which jobs run: those of the stage named last and what they need; all if none is named.
///
/// # Errors
/// If there is no such stage.
pub(super) fn needed(pipeline: &Pipeline, until: Option<&str>) -> Result<Vec<bool>, PipelineError> {
    let jobs = &pipeline.jobs;
    let Some(name) = until else {
        return Ok(vec![true; jobs.len()]);
    };
    let mut needed: Vec<bool> = jobs.iter().map(|stage| stage.name() == name).collect();
    if !needed.contains(&true) {
        let mut known: Vec<&str> = Vec::new();
        for stage in jobs {
            if !known.contains(&stage.name()) {
                known.push(stage.name());
            }
        }
        return Err(PipelineError::UnknownStage {
            name: name.to_string(),
            known: known.join(", "),
        });
    }
    // Inputs come before what needs them.
    for job in (0..jobs.len()).rev() {
        if needed[job] {
            jobs[job]
                .inputs()
                .into_iter()
                .for_each(|input| needed[input] = true);
        }
    }
    Ok(needed)
}
