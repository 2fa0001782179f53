//! What makes the figures of a study doubtful: points that failed, and the warnings at the end of
//! the others.
//!
//! Test: tests/pipeline/figures.rs.

use crate::print::note;
use crate::relax::UNREST;
use crate::study::target::Target;
use crate::study::trial::{Outcome, Trial};

/// Points that are named; further ones are counted.
const NAMED: usize = 3;

/// The warnings of all points, one line for each kind: how many points have it, and its text, of
/// the first one where it differs.
fn warnings(trials: &[Trial], outcomes: &[Outcome]) -> Vec<String> {
    let mut kinds: Vec<Vec<(&str, &str)>> = Vec::new();
    for (trial, outcome) in trials.iter().zip(outcomes) {
        for text in outcome.warnings() {
            let point = (trial.title.as_str(), text.as_str());
            let same = |of: &&mut Vec<(&str, &str)>| kind(of[0].1) == kind(text);
            match kinds.iter_mut().find(same) {
                Some(points) => points.push(point),
                None => kinds.push(vec![point]),
            }
        }
    }
    let line = |points: &Vec<(&str, &str)>| {
        let (count, all) = (points.len(), trials.len());
        let titles: Vec<&str> = points.iter().take(NAMED).map(|(title, _)| *title).collect();
        let named = titles.join("; ");
        let more = match count > NAMED {
            true => format!("; {} more", count - NAMED),
            false => String::new(),
        };
        let (first, text) = points[0];
        let of = match points.iter().any(|(_, other)| *other != text) {
            true => format!("of {first}: "),
            false => String::new(),
        };
        format!("{count} of {all} points ({named}{more}): {of}{text}")
    };
    kinds.iter().map(line).collect()
}

/// Prints them.
pub fn tell(trials: &[Trial], outcomes: &[Outcome]) {
    let all = warnings(trials, outcomes);
    all.iter().for_each(|text| note!("warning: {text}"));
}

/// The key that a warning is about, or the body that did not come to rest.
fn kind(text: &str) -> &str {
    let end = text.find(" = ").or_else(|| text.find(UNREST));
    &text[..end.unwrap_or(text.len())]
}

/// Names of the points that failed, and why.
fn failures<'a>(
    trials: &'a [Trial],
    outcomes: &'a [Outcome],
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let points = trials.iter().zip(outcomes);
    points.filter_map(|(trial, outcome)| match outcome {
        Outcome::Failed { why, .. } => Some((trial.title.as_str(), why.as_str())),
        Outcome::Done { .. } => None,
    })
}

/// The failures and warnings as sections of a page; empty without any.
pub fn section(trials: &[Trial], outcomes: &[Outcome]) -> String {
    let failures = failures(trials, outcomes).map(|(name, why)| format!("{name}: {why}"));
    let list = |head: &str, all: Vec<String>| match all.is_empty() {
        true => String::new(),
        false => format!("\n## {head}\n\n* {}\n", all.join("\n* ")),
    };
    list("Failures", failures.collect()) + &list("Warnings", warnings(trials, outcomes))
}

/// The failures, for programs.
pub fn objects(trials: &[Trial], outcomes: &[Outcome]) -> Vec<serde_json::Value> {
    let failures = failures(trials, outcomes);
    let object = |(name, why)| serde_json::json!({ "point": name, "why": why });
    failures.map(object).collect()
}

/// Warns if points have ended and none has an error.
pub fn warn_unknown(target: &Target, outcomes: &[Outcome], errors: &[f64]) {
    let is_done = |outcome: &Outcome| matches!(outcome, Outcome::Done { .. });
    if outcomes.iter().any(is_done) && errors.iter().all(|error| error.is_nan()) {
        note!(
            "warning: no point has an error: {} and what it is compared with share no instant of \
             the impact with values, or it is not measured",
            target.column
        );
    }
}
