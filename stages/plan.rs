//! `coronet plan`, and the head of `coronet run`.

use std::io::Write as _;

use anyhow::Result;
use coronet::pipeline::{self, Decision, Store};
use serde_json::json;

use crate::arguments::{PipelineArguments, PlanArguments};
use crate::jobs;
use crate::watch::duration;
use coronet::scene::file::{self, Loaded};

pub fn load(arguments: &PipelineArguments) -> Result<Loaded> {
    Ok(file::load(&arguments.pipeline, &arguments.set)?)
}

pub fn plan(arguments: &PlanArguments) -> Result<()> {
    let loaded = load(&arguments.pipeline)?;
    let pipeline = jobs::pipeline(&loaded)?;
    let store = Store::new(&arguments.store.artifacts);
    let decisions = pipeline::plan(&store, &pipeline);
    let mut out = std::io::stdout().lock();
    if arguments.store.json {
        for decision in &decisions {
            writeln!(out, "{}", object(decision))?;
        }
        return Ok(());
    }
    write!(out, "{}", text(&decisions))?;
    let seconds: f64 = decisions
        .iter()
        .filter_map(|decision| decision.seconds)
        .sum();
    if decisions.iter().any(|decision| decision.fresh.is_none()) {
        writeln!(out, "about {} of work", duration(seconds))?;
    }
    Ok(())
}

/// One line a job; a stale one with its reasons, one a line.
pub fn text(decisions: &[Decision]) -> String {
    let mut text = String::new();
    for decision in decisions {
        let (word, label) = (decision.word(), decision.label());
        let mut details = decision.reasons.clone();
        if let Some(start) = &decision.start {
            details.push(format!("goes on from {start}"));
        }
        if let Some(seconds) = decision.seconds {
            details.push(format!("about {}", duration(seconds)));
        }
        if let Some(stamp) = &decision.fresh {
            details.push(stamp.digest.short());
        }
        for (index, detail) in details.iter().enumerate() {
            let (word, label) = if index == 0 {
                (word, label.as_str())
            } else {
                ("", "")
            };
            text += &format!("{word:8} {label:20} {detail}\n");
        }
    }
    text
}

fn object(decision: &Decision) -> serde_json::Value {
    json!({
        "stage": decision.stage,
        "body": decision.body,
        "status": decision.word(),
        "key": decision.key,
        "digest": decision.fresh.as_ref().map(|stamp| stamp.digest),
        "reasons": decision.reasons,
        "start": decision.start,
        "seconds": decision.seconds,
    })
}
