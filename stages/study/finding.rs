//! Results of a study: groups, table, figure, sentences.

use std::iter;

use anyhow::Result;
use coronet::draw::plot::{Curve, Line, PALETTE, Plot, REFERENCE};
use coronet::draw::scatter::{Cloud, Mark, Scatter};
use coronet::measure::tradeoff::{Sample, front, growth, worst};
use coronet::scene::quantity::{Unit, human};

use crate::study::cost::Cost;
use crate::study::figures::{cells, number};
use crate::study::page;
use crate::study::points::Study;
use crate::study::target::{COLUMNS, Found, Target};
use crate::study::trial::{Outcome, Trial};

/// Order below which an error does not decrease significantly with the spacing.
const LEVEL: f64 = 0.2;

/// Relative errors from this value are in the table only, not in the plot.
const HOPELESS: f64 = 10.0;

/// Axes that name groups: not that of the spacing, nor those that repeat. An axis is that of the
/// spacing if points that differ only in it differ in spacing.
fn naming(trials: &[Trial]) -> Vec<bool> {
    let Some(first) = trials.first() else {
        return Vec::new();
    };
    let along = |axis: usize, a: &Trial, b: &Trial| {
        let differ = |k: usize| a.labels[k] != b.labels[k];
        a.spacing != b.spacing && (0..a.labels.len()).all(|k| differ(k) == (k == axis))
    };
    let spaces = |axis: usize| {
        trials
            .iter()
            .any(|a| trials.iter().any(|b| along(axis, a, b)))
    };
    let names = |axis: usize| !first.repeats[axis] && !spaces(axis);
    (0..first.labels.len()).map(names).collect()
}

/// Name of the group of each point: its labels without those of spacing and repeats.
fn names(trials: &[Trial]) -> Vec<String> {
    let naming = naming(trials);
    let name = |trial: &Trial| {
        let labels = trial.labels.iter().zip(&naming);
        let kept: Vec<&str> = labels
            .filter(|(_, is)| **is)
            .map(|(l, _)| l.as_str())
            .collect();
        kept.join(", ")
    };
    trials.iter().map(name).collect()
}

/// All groups, in the order of their first points.
pub fn groups(trials: &[Trial]) -> Vec<String> {
    let mut groups: Vec<String> = Vec::new();
    for name in names(trials) {
        if !groups.contains(&name) {
            groups.push(name);
        }
    }
    groups
}

/// The points as samples.
pub fn samples(cost: Cost, trials: &[Trial], outcomes: &[Outcome], errors: &[f64]) -> Vec<Sample> {
    let (groups, names) = (groups(trials), names(trials));
    let own = |name: &String| groups.iter().position(|group| group == name);
    let points = trials.iter().zip(&names).zip(outcomes);
    points
        .zip(errors)
        .map(|(((trial, name), outcome), error)| Sample {
            group: own(name).unwrap_or(0),
            spacing: trial.spacing,
            count: trial.count,
            error: *error,
            cost: cost.of(outcome),
        })
        .collect()
}

/// Marks the points on the Pareto front; of repeats only the worst counts.
pub fn on_front(samples: &[Sample]) -> Vec<bool> {
    let worst = worst(samples);
    let some: Vec<Sample> = worst.iter().map(|k| samples[*k]).collect();
    let mut on_front = vec![false; samples.len()];
    for (k, on) in worst.into_iter().zip(front(&some)) {
        on_front[k] = on;
    }
    on_front
}

/// The table, one row for each point, as CSV.
pub fn table(
    study: &Study,
    trials: &[Trial],
    outcomes: &[Outcome],
    samples: &[Sample],
    on_front: &[bool],
) -> Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    let axes = study.axis.iter().map(|axis| axis.name.as_str());
    file.write_record(cells(["point"].into_iter().chain(axes).chain(COLUMNS)))?;
    for (k, trial) in trials.iter().enumerate() {
        let mut row = vec![trial.name.clone()];
        row.extend(trial.labels.iter().cloned());
        row.extend([
            number(trial.spacing),
            number(trial.count),
            outcomes[k].status().to_string(),
        ]);
        row.extend([number(samples[k].error), on_front[k].to_string()]);
        let costs = [Cost::Cpu, Cost::Wall, Cost::Memory];
        row.extend(costs.map(|cost| number(cost.of(&outcomes[k]))));
        file.write_record(cells(row))?;
    }
    Ok(file.into_inner()?)
}

/// Error against cost. A line joins the worst of the repeats of each spacing.
pub fn figure(
    study: &Study,
    target: &Target,
    trials: &[Trial],
    samples: &[Sample],
    on_front: &[bool],
) -> Scatter {
    let place = |s: &Sample| [s.cost, 100.0 * s.error];
    let shown = |s: &&Sample| s.error > 0.0 && s.error < HOPELESS && s.cost > 0.0;
    let worst = worst(samples);
    let looks = looks(trials);
    let clouds = groups(trials).into_iter().zip(looks).enumerate();
    let clouds = clouds
        .map(|(g, (label, (colour, mark)))| {
            let own = (0..samples.len()).filter(|k| samples[*k].group == g && shown(&&samples[*k]));
            let (main, repeats): (Vec<usize>, Vec<usize>) = own.partition(|k| worst.contains(k));
            let named = |k: usize| (place(&samples[k]), short(trials[k].spacing));
            Cloud {
                label,
                colour,
                mark,
                points: main.into_iter().map(named).collect(),
                repeats: repeats.into_iter().map(|k| place(&samples[k])).collect(),
            }
        })
        .collect();
    let mut front: Vec<[f64; 2]> = samples
        .iter()
        .zip(on_front)
        .filter(|(s, on)| **on && shown(s))
        .map(|(s, _)| place(s))
        .collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Scatter {
        title: study.title.clone(),
        x: format!(
            "{} of the impact ({})",
            study.cost.name(),
            study.cost.unit()
        ),
        y: format!("error of {} (%)", target.readable(1.0).words),
        clouds,
        front,
    }
}

/// Results over theory, against theory, for the finest points of each method; and the range of
/// theory over its middle.
pub fn comparison(study: &Study, target: &Target, trials: &[Trial], found: &[Found]) -> Plot {
    let finest = trials
        .iter()
        .map(|t| t.spacing)
        .fold(f64::INFINITY, f64::min);
    let middle = |[_, low, high]: [f64; 3]| 0.5 * (low + high);
    let mut known: Vec<(&Trial, [f64; 3])> = trials
        .iter()
        .zip(found)
        .filter(|(trial, _)| trial.spacing == finest)
        .filter_map(|(trial, found)| Some((trial, found.against?)))
        .collect();
    known.sort_by(|a, b| middle(a.1).total_cmp(&middle(b.1)));
    let curve = |label: &str, colour, points: Vec<[f64; 2]>| Curve {
        label: label.to_string(),
        points,
        line: Line::Solid,
        colour,
    };
    let most = known.iter().map(|p| middle(p.1).abs()).fold(0.0, f64::max);
    let shown = target.readable(most);
    let over = |found: [f64; 3], k: usize| [shown.factor * middle(found), found[k] / middle(found)];
    let bound = |k: usize| known.iter().map(|p| over(p.1, k)).collect::<Vec<_>>();
    let mut curves = match bound(1) == bound(2) {
        true => vec![curve("theory", REFERENCE[0], bound(1))],
        false => vec![
            curve("theory, least", REFERENCE[0], bound(1)),
            curve("theory, largest", REFERENCE[1], bound(2)),
        ],
    };
    let mut methods: Vec<&str> = Vec::new();
    for (trial, _) in &known {
        if !methods.contains(&trial.method) {
            methods.push(trial.method);
        }
    }
    for (k, method) in methods.iter().enumerate() {
        let own = known.iter().filter(|(trial, _)| trial.method == *method);
        let points = own.map(|(_, found)| over(*found, 0)).collect();
        curves.push(curve(method, PALETTE[k % PALETTE.len()], points));
    }
    Plot {
        title: study.title.clone(),
        x: format!("{} by theory", shown.label()),
        y: format!("found at {} over theory", short(finest)),
        curves,
        from_zero: false,
    }
}

/// Colour and mark of each group: one colour for each group, or for each method if there are more
/// groups than colours.
fn looks(trials: &[Trial]) -> Vec<([u8; 3], Mark)> {
    let (groups, names) = (groups(trials), names(trials));
    let method = |group: &String| {
        let first = names.iter().position(|name| name == group);
        first.map_or("", |k| trials[k].method)
    };
    let mut methods: Vec<(&str, usize)> = Vec::new();
    let look = |(g, name): (usize, &String)| {
        if groups.len() <= PALETTE.len() {
            return (PALETTE[g], Mark::Disc);
        }
        let method = method(name);
        let place = methods.iter().position(|(other, _)| *other == method);
        let place = place.unwrap_or_else(|| {
            methods.push((method, 0));
            methods.len() - 1
        });
        methods[place].1 += 1;
        let mark = Mark::ALL[(methods[place].1 - 1) % Mark::ALL.len()];
        (PALETTE[place % PALETTE.len()], mark)
    };
    groups.iter().enumerate().map(look).collect()
}

/// A spacing to four digits: "0.5556 mm".
fn short(spacing: f64) -> String {
    let rounded = format!("{spacing:.3e}").parse();
    human(rounded.unwrap_or(spacing), Unit::Length)
}

/// A page: one row for each group, one column for each spacing, with error and cost; then the
/// sentences.
pub fn page(
    study: &Study,
    target: &Target,
    trials: &[Trial],
    outcomes: &[Outcome],
    samples: &[Sample],
) -> String {
    let groups = groups(trials);
    let mut spacings: Vec<f64> = trials.iter().map(|trial| trial.spacing).collect();
    spacings.sort_by(|a, b| b.total_cmp(a));
    spacings.dedup();
    let written: Vec<String> = spacings.iter().map(|spacing| short(*spacing)).collect();
    let heads: Vec<&str> = iter::once("")
        .chain(written.iter().map(String::as_str))
        .collect();
    let mut page = format!(
        "# {}\n\nError of `{}`, {} of the impact.\n\n{}",
        study.title,
        target.column,
        study.cost.name(),
        page::heads(&heads)
    );
    for (group, name) in groups.iter().enumerate() {
        let cells = spacings.iter().map(|spacing| {
            let own = |k: &usize| samples[*k].group == group && trials[*k].spacing == *spacing;
            let cells = (0..trials.len()).filter(own);
            let cells = cells.map(|k| cell(study, target, &outcomes[k], &samples[k]));
            cells.collect::<Vec<_>>().join("; ")
        });
        let cells: Vec<String> = cells.collect();
        page += &page::row(iter::once(named(name).to_string()).chain(cells));
    }
    page += "\n";
    for (group, name) in groups.iter().enumerate() {
        if let Some(sentence) = sentence(study.cost, name, samples, group) {
            page += &format!("* {sentence}\n");
        }
    }
    page
}

fn cell(study: &Study, target: &Target, outcome: &Outcome, sample: &Sample) -> String {
    match outcome {
        Outcome::Done { .. } => {
            let cost = study.cost.short(sample.cost);
            match sample.error.is_finite() {
                true => format!("{:.1} %, {cost}", 100.0 * sample.error),
                false if target.finest => format!("reference, {cost}"),
                false => format!("unknown, {cost}"),
            }
        }
        Outcome::Failed { .. } => outcome.status().to_string(),
    }
}

/// Name of a group in messages.
pub fn named(group: &str) -> &str {
    if group.is_empty() { "all" } else { group }
}

/// The cost of accuracy of a group, as a sentence.
pub fn sentence(cost: Cost, name: &str, samples: &[Sample], group: usize) -> Option<String> {
    let growth = growth(samples, group);
    let mut parts = Vec::new();
    if let Some(order) = growth.order {
        parts.push(format!("error ~ s0^{order:.2}"));
        if order < -LEVEL {
            parts.push("it grows as the spacing decreases".to_string());
        } else if order < LEVEL {
            parts.push("it hardly decreases with the spacing".to_string());
        }
    }
    if let Some(work) = growth.work {
        parts.push(format!("{} ~ N^{work:.2}", cost.word()));
    }
    if let Some(halving) = growth.halving.filter(|_| growth.order > Some(LEVEL)) {
        parts.push(format!(
            "each halving of the error costs {halving:.1} times the {}",
            cost.name()
        ));
    }
    let name = named(name);
    (!parts.is_empty()).then(|| format!("{name}: {}", parts.join("; ")))
}
