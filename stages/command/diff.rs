//! `coronet diff`: two runs beside each other: settings, figures, curves.

use anyhow::Result;
use coronet::measure::answer::{self, Answer, Figures};
use coronet::measure::series::{Series, is_clock};
use coronet::measure::summary::digits;
use coronet::pipeline::Store;
use serde_json::{Value, json};

use crate::arguments::DiffArguments;
use crate::print::{note, out};
use crate::runs::Run;
use crate::table::{cut, lines};

/// Most characters of a value.
const LONGEST: usize = 36;

/// A setting that differs: its name, and its value in each run, if that has it.
type Setting = (String, [Option<String>; 2]);

/// A figure that both runs have, or one of them.
struct Pair {
    name: &'static str,
    values: [Option<Answer>; 2],
}

/// How far a column of one table is from that of the other.
struct Curve {
    name: String,
    /// The difference that is largest without its sign, second minus first; SI.
    largest: f64,
    /// That, without its sign, over the range of the column in both tables.
    part: f64,
    /// When, s.
    time: f64,
}

pub fn diff(arguments: &DiffArguments) -> Result<()> {
    let store = Store::new(&arguments.store.artifacts);
    let first = Run::meant(&store, &arguments.first)?;
    let second = Run::meant(&store, &arguments.second)?;
    first.tell_gone();
    second.tell_gone();
    let settings = settings(&first, &second);
    if let (Some(first), Some(second)) = (is_plane(&first), is_plane(&second))
        && first != second
    {
        note!(
            "warning: masses, energies and forces of a run in two dimensions are for each metre of \
             depth: do not compare them with those of three"
        );
    }
    let figures = [first.figures()?, second.figures()?];
    let pairs = pairs(&figures);
    let curves = match &figures {
        [Some(first), Some(second)] => curves(first, second),
        _ => Vec::new(),
    };
    if arguments.store.json {
        let object = json!({
            "first": first.name,
            "second": second.name,
            "settings": settings.iter().map(setting_object).collect::<Vec<_>>(),
            "figures": pairs.iter().map(Pair::json).collect::<Vec<_>>(),
            "curves": curves.iter().map(Curve::json).collect::<Vec<_>>(),
        });
        out!("{object}");
        return Ok(());
    }
    print_settings([&first.name, &second.name], &settings);
    for (run, figures) in [&first, &second].into_iter().zip(&figures) {
        if figures.is_none() {
            out!("{} has no evaluation, so no figures", run.name);
        }
    }
    print_figures(&pairs);
    print_curves(&curves);
    Ok(())
}

/// Whether a run is in two dimensions, without an axis; `None` if it has no settings.
fn is_plane(run: &Run) -> Option<bool> {
    let settings = run.settings();
    let find = |name: &str| settings.iter().find(|(known, _)| known == name);
    let (_, dimension) = find("dimension")?;
    let has_axis = find("box.x").is_some_and(|(_, sides)| sides.contains("axis"));
    Some(dimension == "2" && !has_axis)
}

fn settings(first: &Run, second: &Run) -> Vec<Setting> {
    let [first, second] = [first.settings(), second.settings()];
    let find = |of: &[(String, String)], name: &str| {
        let setting = of.iter().find(|(known, _)| known == name);
        setting.map(|(_, value)| value.clone())
    };
    let only_second = second
        .iter()
        .filter(|(name, _)| find(&first, name).is_none());
    let names = first.iter().chain(only_second).map(|(name, _)| name);
    let values = names.map(|name| (name.clone(), [find(&first, name), find(&second, name)]));
    values.filter(|(_, [a, b])| a != b).collect()
}

fn pairs(figures: &[Option<Figures>; 2]) -> Vec<Pair> {
    let names = answer::names(figures.iter().flatten());
    let values = |name| {
        let find = |figures: &Option<Figures>| figures.as_ref()?.find(name).cloned();
        [find(&figures[0]), find(&figures[1])]
    };
    let pairs = names.into_iter();
    pairs
        .map(|name| Pair {
            name,
            values: values(name),
        })
        .collect()
}

impl Pair {
    /// Second minus first, and that over the first.
    fn difference(&self) -> Option<(f64, f64)> {
        let [Some(first), Some(second)] = &self.values else {
            return None;
        };
        let difference = second.value - first.value;
        Some((difference, difference / first.value.abs()))
    }

    fn json(&self) -> Value {
        let value = |answer: &Option<Answer>| answer.as_ref().map(|answer| answer.value);
        let quantity = self.values.iter().flatten().next();
        json!({
            "name": self.name,
            "unit": quantity.map(|answer| answer.quantity.si()),
            "first": value(&self.values[0]),
            "second": value(&self.values[1]),
            "difference": self.difference().map(|(difference, _)| difference),
            "relative": self.difference().map(|(_, part)| part).filter(|part| part.is_finite()),
        })
    }

    fn row(&self) -> Vec<String> {
        let text = |answer: &Option<Answer>| match answer {
            Some(answer) => answer.text(),
            None => "-".to_string(),
        };
        let mut row = vec![self.name.to_string()];
        row.extend(self.values.iter().map(text));
        if let (Some((difference, part)), Some(answer)) = (self.difference(), &self.values[0]) {
            row.push(signed(answer.quantity.text(difference), difference));
            row.push(percent(part));
        }
        row
    }
}

/// Differences of all columns that both tables have; times from contact, if both runs have one.
fn curves(first: &Figures, second: &Figures) -> Vec<Curve> {
    let names = first.measures.names.iter();
    let names = names.filter(|name| !is_clock(name) && second.measures.has(name));
    let shift = second.contact - first.contact;
    names
        .filter_map(|name| curve(&first.measures, &second.measures, name, shift))
        .map(|curve| Curve {
            time: curve.time - first.contact,
            ..curve
        })
        .collect()
}

/// `shift`: time of the second minus time of the first at the same instant, s.
fn curve(first: &Series, second: &Series, name: &str, shift: f64) -> Option<Curve> {
    let (mut largest, mut when) = (0.0f64, None);
    let values = first.column(name)?;
    for (&time, value) in first.time().iter().zip(values) {
        let Some(other) = second.at(name, time + shift).filter(|_| value.is_finite()) else {
            continue;
        };
        if when.is_none() || (other - value).abs() > largest.abs() {
            (largest, when) = (other - value, Some(time));
        }
    }
    let both = values.iter().chain(second.column(name)?);
    let ends = both.filter(|value| value.is_finite());
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(*value), high.max(*value))
    });
    let part = match largest == 0.0 {
        true => 0.0,
        false => largest.abs() / (high - low),
    };
    Some(Curve {
        name: name.to_string(),
        largest,
        part,
        time: when?,
    })
}

impl Curve {
    fn json(&self) -> Value {
        json!({
            "column": self.name,
            "largest_difference": self.largest,
            "over_range": self.part,
            "time_after_contact_s": self.time,
        })
    }
}

fn setting_object((name, [first, second]): &Setting) -> Value {
    json!({"name": name, "first": first, "second": second})
}

fn print_settings(names: [&str; 2], settings: &[Setting]) {
    if settings.is_empty() {
        out!("no setting differs");
    }
    let [first, second] = names.map(|name| cut(name, LONGEST));
    let mut rows = vec![vec!["settings".to_string(), first, second]];
    rows.extend(settings.iter().map(|(name, values)| {
        let value = |value: &Option<String>| cut(value.as_deref().unwrap_or("-"), LONGEST);
        vec![name.clone(), value(&values[0]), value(&values[1])]
    }));
    lines(&rows, &[]).iter().for_each(|line| out!("{line}"));
}

fn print_figures(pairs: &[Pair]) {
    if pairs.is_empty() {
        return;
    }
    let head = ["figures", "first", "second", "difference", "relative"];
    let mut rows = vec![head.map(str::to_string).to_vec()];
    rows.extend(pairs.iter().map(Pair::row));
    out!("");
    lines(&rows, &[1, 2, 3, 4])
        .iter()
        .for_each(|line| out!("{line}"));
}

fn print_curves(curves: &[Curve]) {
    if curves.is_empty() {
        return;
    }
    let head = [
        "curves",
        "largest difference",
        "of the range",
        "after contact",
    ];
    let mut rows = vec![head.map(str::to_string).to_vec()];
    rows.extend(curves.iter().map(|curve| {
        let largest = signed(digits(curve.largest), curve.largest);
        let part = format!("{:.2} %", 100.0 * curve.part);
        let time = format!("{:.2} ms", 1e3 * curve.time).replace("-0.00", "0.00");
        vec![curve.name.clone(), largest, part, time]
    }));
    out!("");
    lines(&rows, &[1, 2, 3])
        .iter()
        .for_each(|line| out!("{line}"));
    out!("differences are second minus first, in the units of the names");
}

fn signed(text: String, value: f64) -> String {
    if value > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

fn percent(part: f64) -> String {
    match part.is_finite() {
        true => format!("{:+.2} %", 100.0 * part),
        false => "-".to_string(),
    }
}
