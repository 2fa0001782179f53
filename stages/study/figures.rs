//! Results of a study without an error: figures of each point, and plots of their curves in time.

use std::path::Path;

use anyhow::Result;
use coronet::draw::plot::{Curve, Line, PALETTE, Plot, REFERENCE};
use coronet::draw::readable::Readable;
use coronet::measure::kind::contact_within;
use coronet::measure::series::{Reference, Series};
use coronet::measure::summary::digits;
use coronet::record::export::cell;
use coronet::scene::Dimension;

use crate::fault::Usage;
use crate::study::cost::Cost;
use crate::study::page;
use crate::study::points::{Figure, Study};
use crate::study::target::{Feature, window};
use crate::study::trial::{Outcome, Trial};

/// The measures of a point, times from contact.
pub struct Measured {
    series: Series,
    /// Time of contact, s from the start.
    contact: f64,
    /// Whether there is one.
    meets: bool,
    /// Whether energies and masses are by the metre of depth.
    is_plane: bool,
}

/// The table of a reference with its times from a contact at `contact` s.
fn beside_point(reference: &Reference, contact: f64) -> Series {
    from(&reference.table, contact - reference.shift(contact))
}

/// A table with its times from `instant` s on.
fn from(table: &Series, instant: f64) -> Series {
    let mut table = table.clone();
    let times = table.column_mut("time_s").into_iter().flatten();
    times.for_each(|time| *time -= instant);
    table
}

/// Whether measures go on to a time, to a row; all do without one.
fn reaches(measures: &Series, to: f64) -> bool {
    let times = measures.time();
    match times {
        [.., before, last] if to.is_finite() => last + 1.5 * (last - before) >= to,
        _ => true,
    }
}

impl Figure {
    fn times(&self) -> Result<([f64; 2], Option<f64>), Usage> {
        let part = format!("[[figure]] `{}`", self.name);
        let at = match &self.at {
            None => None,
            Some(_) => Some(window(&part, &self.at, &None)?[0]),
        };
        Ok((window(&part, &self.from, &self.to)?, at))
    }

    /// `None` where the measures have none.
    fn of(&self, measures: &Series) -> Result<Option<f64>, Usage> {
        let ([from, to], at) = self.times()?;
        let window = measures.window(from, to);
        let value = |column: &str, of: Feature| match at {
            Some(at) => measures.at(column, at),
            None => of.of(&window, column),
        };
        let over = match &self.over {
            Some(column) => value(column, Feature::Mean),
            None => Some(1.0),
        };
        let value = value(&self.column, self.of);
        Ok(value.zip(over).map(|(value, over)| value / over))
    }
}

impl Study {
    /// Checks that the names in figures and curves exist.
    pub fn check_figures(&self) -> Result<(), String> {
        for figure in &self.figure {
            figure.times().map_err(|error| error.to_string())?;
            if figure.clock.is_some() && figure.reference.is_none() {
                let name = &figure.name;
                return Err(format!("[[figure]] `{name}`: clock goes with reference"));
            }
            if figure.at.is_some() && figure.of != Feature::default() {
                let name = &figure.name;
                return Err(format!("[[figure]] `{name}`: `at` goes without of"));
            }
            if figure.at.is_some() && (figure.from.is_some() || figure.to.is_some()) {
                let name = &figure.name;
                return Err(format!(
                    "[[figure]] `{name}`: `at` goes without from and to"
                ));
            }
        }
        let each = self.curves.iter().filter_map(|curves| curves.each.as_ref());
        for each in each {
            if !self.axis.iter().any(|axis| axis.name == *each) {
                let axes: Vec<&str> = self.axis.iter().map(|axis| axis.name.as_str()).collect();
                let axes = axes.join(", ");
                return Err(format!(
                    "[[curves]] each: `{each}` is not an axis; axes are {axes}"
                ));
            }
        }
        Ok(())
    }

    /// Columns of the measures of a point that figures and curves need.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        let of_figures = self
            .figure
            .iter()
            .flat_map(|f| [Some(&f.column), f.over.as_ref()]);
        let of_curves = self.curves.iter().map(|curves| Some(&curves.column));
        of_figures.chain(of_curves).flatten().map(String::as_str)
    }

    /// Tables that figures and curves name, with the columns that they need.
    pub fn tables_of_figures(&self) -> impl Iterator<Item = (&Path, &str)> {
        let of_figures = self.figure.iter().flat_map(|f| {
            let columns = [Some(&f.column), f.over.as_ref()];
            columns.map(|column| (&f.reference, column))
        });
        let of_curves = self.curves.iter().map(|c| (&c.reference, Some(&c.column)));
        let all = of_figures.chain(of_curves);
        all.filter_map(|(path, column)| Some((path.as_deref()?, column?.as_str())))
    }
}

/// The measures of each finished point, times from contact.
///
/// # Errors
/// If a scene cannot be read.
pub fn from_contact(trials: &[Trial], outcomes: &[Outcome]) -> Result<Vec<Option<Measured>>> {
    let points = trials.iter().zip(outcomes);
    points
        .map(|(trial, outcome)| {
            let Some(measures) = outcome.measures() else {
                return Ok(None);
            };
            let scene = trial.scene()?;
            let contact = contact_within(&scene);
            let domain = &scene.domain;
            Ok(Some(Measured {
                series: from(measures, contact.unwrap_or(0.0)),
                contact: contact.unwrap_or(0.0),
                meets: contact.is_some(),
                is_plane: scene.dimension == Dimension::Two && !domain.is_axial(),
            }))
        })
        .collect()
}

/// The figures of each point, NaN where it has none; `folder`: of the study file.
///
/// # Errors
/// A reference that cannot be read.
pub fn measure(
    study: &Study,
    measured: &[Option<Measured>],
    folder: &Path,
) -> Result<Vec<Vec<f64>>> {
    let mut rows = vec![Vec::new(); measured.len()];
    for figure in &study.figure {
        let reference = match &figure.reference {
            None => None,
            Some(path) => Some(Reference::read(&folder.join(path), figure.clock)?),
        };
        for (row, point) in rows.iter_mut().zip(measured) {
            let Some(Measured {
                series, contact, ..
            }) = point
            else {
                row.push(f64::NAN);
                continue;
            };
            let unit = match &reference {
                None => Some(1.0),
                Some(reference) => figure.of(&beside_point(reference, *contact))?,
            };
            // What a run that ended before has is of another window.
            let value = match reaches(series, figure.times()?.0[1]) {
                true => figure.of(series)?.zip(unit),
                false => None,
            };
            row.push(value.map_or(f64::NAN, |(value, unit)| value / unit));
        }
    }
    Ok(rows)
}

/// One row for each point, SI, as CSV.
pub fn table(
    study: &Study,
    trials: &[Trial],
    outcomes: &[Outcome],
    found: &[Vec<f64>],
) -> Result<Vec<u8>> {
    let mut file = csv::Writer::from_writer(Vec::new());
    let axes = study.axis.iter().map(|axis| axis.name.as_str());
    let names = study.figure.iter().map(|figure| figure.name.as_str());
    let head = ["point"].into_iter().chain(axes).chain(["status"]);
    file.write_record(cells(head.chain(names).chain(["cpu_s"])))?;
    for ((trial, outcome), found) in trials.iter().zip(outcomes).zip(found) {
        let mut row = vec![trial.name.clone()];
        row.extend(trial.labels.iter().cloned());
        row.push(outcome.status().to_string());
        let cost = Cost::Cpu.of(outcome);
        row.extend(found.iter().chain([&cost]).map(|value| number(*value)));
        file.write_record(cells(row))?;
    }
    Ok(file.into_inner()?)
}

/// A row of a table without formulas for spreadsheets: labels come from study files.
pub fn cells<T: AsRef<str>>(row: impl IntoIterator<Item = T>) -> Vec<String> {
    let row = row.into_iter();
    row.map(|text| cell(text.as_ref()).into_owned()).collect()
}

/// A number for a table; empty for NaN.
pub fn number(value: f64) -> String {
    match value.is_finite() {
        true => format!("{value}"),
        false => String::new(),
    }
}

/// The table as a page.
pub fn page(study: &Study, trials: &[Trial], outcomes: &[Outcome], found: &[Vec<f64>]) -> String {
    let axes = study.axis.iter().map(|axis| axis.name.as_str());
    let names = study.figure.iter().map(|figure| figure.name.as_str());
    let heads: Vec<&str> = axes.chain(names).chain(["CPU time"]).collect();
    let mut page = format!("# {}\n\n{}", study.title, page::heads(&heads));
    for ((trial, outcome), found) in trials.iter().zip(outcomes).zip(found) {
        let mut cells = trial.labels.clone();
        cells.extend(found.iter().map(|value| match value.is_finite() {
            true => digits(*value),
            false => "-".to_string(),
        }));
        cells.push(match outcome {
            Outcome::Done { .. } => Cost::Cpu.short(Cost::Cpu.of(outcome)),
            Outcome::Failed { .. } => outcome.status().to_string(),
        });
        page += &page::row(cells);
    }
    page
}

/// The plots; further curves than there are colours are dashed.
///
/// # Errors
/// A reference that cannot be read.
pub fn plots(
    study: &Study,
    trials: &[Trial],
    measured: &[Option<Measured>],
    folder: &Path,
) -> Result<Vec<Plot>> {
    let mut plots = Vec::new();
    let any = |is: fn(&Measured) -> bool| measured.iter().flatten().any(is);
    let x = match any(|point| point.meets) {
        true => "time after contact (ms)",
        false => "time (ms)",
    };
    for curves in &study.curves {
        let axis = study
            .axis
            .iter()
            .position(|axis| Some(&axis.name) == curves.each.as_ref());
        let reference = match &curves.reference {
            None => None,
            Some(path) => Some(Reference::read(&folder.join(path), curves.clock)?),
        };
        let shown = Readable::of(&curves.column, most(measured, &curves.column));
        let shown = match any(|point| point.is_plane) {
            true => shown.in_two(),
            false => shown,
        };
        for label in labels_on(axis, trials) {
            let own = trials.iter().zip(measured);
            let own = own.filter(|(trial, _)| axis.map(|axis| &trial.labels[axis]) == label);
            let references = references(reference.as_ref(), own.clone().map(|(_, point)| point));
            let known = own.filter_map(|(trial, measures)| {
                let others = trial.labels.iter().enumerate();
                let others = others.filter(|(k, _)| Some(*k) != axis);
                let name: Vec<&str> = others.map(|(_, label)| label.as_str()).collect();
                let name = match name.is_empty() {
                    true => trial.title.clone(),
                    false => name.join(", "),
                };
                Some((name, &measures.as_ref()?.series))
            });
            let drawn = known.enumerate().map(|(k, (name, measures))| Curve {
                label: name,
                points: points(measures, &curves.column, shown.factor),
                line: [Line::Solid, Line::Dashed][(k / PALETTE.len()).min(1)],
                colour: PALETTE[k % PALETTE.len()],
            });
            let beside = references.iter().map(|table| Curve {
                label: "reference".to_string(),
                points: points(table, &curves.column, shown.factor),
                line: Line::Dashed,
                colour: REFERENCE[0],
            });
            plots.push(Plot {
                title: match label {
                    Some(label) => format!("{} {label}", shown.words),
                    None => shown.words.clone(),
                },
                x: x.to_string(),
                y: shown.label(),
                curves: drawn.chain(beside).collect(),
                from_zero: true,
            });
        }
    }
    Ok(plots)
}

/// The labels of the points on an axis, each once; one without a label if there is no axis.
fn labels_on(axis: Option<usize>, trials: &[Trial]) -> Vec<Option<&String>> {
    let mut labels = Vec::new();
    for trial in trials {
        let label = axis.map(|axis| &trial.labels[axis]);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    labels
}

/// The reference beside some points: once for each time of contact if it counts from the start.
fn references<'a>(
    reference: Option<&Reference>,
    points: impl Iterator<Item = &'a Option<Measured>>,
) -> Vec<Series> {
    let mut instants: Vec<f64> = Vec::new();
    let Some(reference) = reference else {
        return Vec::new();
    };
    for point in points.flatten() {
        let instant = point.contact - reference.shift(point.contact);
        if !instants.contains(&instant) {
            instants.push(instant);
        }
    }
    let table = |instant: &f64| from(&reference.table, *instant);
    instants.iter().map(table).collect()
}

/// The largest absolute value of a column in all points.
fn most(measured: &[Option<Measured>], column: &str) -> f64 {
    let points = measured.iter().flatten();
    let values = points
        .filter_map(|point| point.series.column(column))
        .flatten();
    let known = values.filter(|value| value.is_finite());
    known.fold(0.0, |most, value| most.max(value.abs()))
}

/// Times in ms and values of a column, times `factor`.
fn points(table: &Series, column: &str, factor: f64) -> Vec<[f64; 2]> {
    let values = table.column(column).unwrap_or(&[]);
    let times = table.time().iter().map(|time| 1e3 * time);
    times.zip(values).map(|(t, v)| [t, factor * v]).collect()
}
