//! Results of a study of cases: the promises that are kept, as tables and in words.

use std::iter;

use anyhow::Result;

use crate::study::figures::cells;
use crate::study::page;
use crate::study::points::Study;
use crate::study::promise::{COLUMNS, Verdict};
use crate::study::trial::{Outcome, Trial};

/// All promises, one row for each, as CSV.
pub fn table(study: &Study, trials: &[Trial], verdicts: &[Verdict]) -> Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    let axes = study.axis.iter().map(|axis| axis.name.as_str());
    file.write_record(cells(
        ["point", "case"].into_iter().chain(axes).chain(COLUMNS),
    ))?;
    for (trial, verdict) in trials.iter().zip(verdicts) {
        for promise in &verdict.promises {
            let mut row = vec![trial.name.clone(), case(study, trial).to_string()];
            row.extend(trial.labels.iter().cloned());
            row.extend([promise.name.clone(), promise.bound.clone()]);
            row.extend([promise.found.clone(), promise.kept.to_string()]);
            row.push(verdict.known.clone().unwrap_or_default());
            file.write_record(cells(row))?;
        }
    }
    Ok(file.into_inner()?)
}

fn case<'a>(study: &'a Study, trial: &Trial) -> &'a str {
    trial.case.map_or("", |case| &study.case[case].name)
}

/// Labels of the points of the axes, in the order of their first trials.
fn columns(trials: &[Trial]) -> Vec<String> {
    let mut columns: Vec<String> = Vec::new();
    for trial in trials {
        let label = trial.labels.join(", ");
        if !columns.contains(&label) {
            columns.push(label);
        }
    }
    columns
}

/// A page: one row for each case, one column for each point of the axes; then the broken promises,
/// with reasons.
pub fn page(study: &Study, trials: &[Trial], outcomes: &[Outcome], verdicts: &[Verdict]) -> String {
    let columns = columns(trials);
    let heads: Vec<&str> = iter::once("case")
        .chain(columns.iter().map(String::as_str))
        .collect();
    let mut page = format!("# {}\n\n{}", study.title, page::heads(&heads));
    for (index, case) in study.case.iter().enumerate() {
        let cells: Vec<String> = columns
            .iter()
            .map(|column| {
                let own = |k: &usize| {
                    trials[*k].case == Some(index) && trials[*k].labels.join(", ") == *column
                };
                let found = (0..trials.len()).find(own);
                found.map_or("".to_string(), |k| cell(&verdicts[k], &outcomes[k]))
            })
            .collect();
        page += &page::row(iter::once(case.name.clone()).chain(cells));
    }
    let lines = broken(trials, verdicts);
    if !lines.is_empty() {
        page += "\nNot kept:\n\n";
        lines.iter().for_each(|line| page += &format!("* {line}\n"));
    }
    page
}

fn cell(verdict: &Verdict, outcome: &Outcome) -> String {
    match outcome {
        Outcome::Done { cpu_seconds, .. } => {
            format!("{}, {cpu_seconds:.0} s", verdict.word())
        }
        Outcome::Failed { .. } => verdict.word().to_string(),
    }
}

/// One line for each point that breaks a promise, or was expected to.
pub fn broken(trials: &[Trial], verdicts: &[Verdict]) -> Vec<String> {
    let points = trials.iter().zip(verdicts);
    let bad = points.filter(|(_, verdict)| verdict.word() != "kept");
    bad.map(|(trial, verdict)| {
        let title = &trial.title;
        match (&verdict.known, verdict.kept()) {
            (Some(why), false) => {
                format!("known: {title}: {}. {why}", verdict.broken())
            }
            (Some(_), true) => {
                format!("KEPT: {title}: every promise is kept; remove it from `known`")
            }
            _ => format!("BROKEN: {title}: {}", verdict.broken()),
        }
    })
    .collect()
}
