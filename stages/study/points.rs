//! A study file and its points.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use coronet::measure::series::{Series, SeriesError};
use coronet::scene::numbers::count;
use coronet::scene::{Clock, file, schema};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::fault::Usage;
use crate::study::cost::Cost;
use crate::study::promise::{self, Case, Ending};
use crate::study::target::{self, Feature, Target};
use crate::study::trial::{Trial, source};

/// Largest size of a study file, bytes.
const LONGEST: u64 = 16 << 20;

/// A study file: an `error` to measure, `figure`s to compute, or `case`s with promises.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Study {
    pub title: String,
    /// Pipeline file, relative to the study file; a case may name another.
    pipeline: Option<PathBuf>,
    /// Overrides for every point, as after `--set`.
    #[serde(default)]
    set: Vec<String>,
    #[serde(default)]
    pub axis: Vec<Axis>,
    #[serde(default)]
    pub cost: Cost,
    /// Points to leave out, by their labels: `"0.5 mm, corrected"`.
    #[serde(default)]
    except: Vec<String>,
    pub error: Option<Target>,
    #[serde(default)]
    pub figure: Vec<Figure>,
    #[serde(default)]
    pub curves: Vec<Curves>,
    #[serde(default)]
    pub case: Vec<Case>,
}

/// Either `key` with `values`, or `points`.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Axis {
    pub name: String,
    key: Option<String>,
    /// Numbers, or texts with a unit.
    #[serde(default)]
    #[schemars(with = "Vec<serde_json::Value>")]
    values: Vec<toml::Value>,
    #[serde(default)]
    points: Vec<Choice>,
    /// Its points are repeats, as with other seeds: the worst counts.
    #[serde(default)]
    repeat: bool,
}

#[derive(Clone, Debug, Deserialize, JsonSchema)]
pub struct Choice {
    label: String,
    #[serde(default)]
    set: Vec<String>,
}

/// A number from the measures of every point. Times count from contact, if there is one.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Figure {
    /// Head of its column.
    pub name: String,
    pub column: String,
    #[serde(default)]
    pub of: Feature,
    pub from: Option<String>,
    /// A run that ends before has no value.
    pub to: Option<String>,
    /// The value at this time, in place of `of` between the two.
    pub at: Option<String>,
    /// Divided by this column: its mean between the two, or its value at that time.
    pub over: Option<String>,
    /// Divided by the value of this table, relative to the study file.
    pub reference: Option<PathBuf>,
    /// Zero of its times; left out: from the name of its column of times.
    pub clock: Option<Clock>,
}

/// One plot of a column of the measures for each label of an axis, one curve a point.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Curves {
    pub column: String,
    /// The axis; without it one plot has all points.
    pub each: Option<String>,
    /// A table for one more curve, relative to the study file.
    pub reference: Option<PathBuf>,
    /// Zero of its times; left out: from the name of its column of times.
    pub clock: Option<Clock>,
}

/// Labels and overrides of a point.
type Point = (Vec<String>, Vec<String>);

/// JSON Schema 2020-12 of study files, as shipped in `docs/study.schema.json`.
pub fn schema() -> String {
    format!("{:#}\n", schema::of::<Study>("Coronet study").to_value())
}

/// The study and its points, each checked against the format of scenes before a run. With cases,
/// the points of each case in turn, without those that the case excludes.
pub fn load(path: &Path) -> Result<(Study, Vec<Trial>)> {
    let wrong = |what: String| Usage(format!("{}: {what}", path.display()));
    let content = match coronet::file::read(path, LONGEST) {
        Err(error) if error.is_not_found() => bail!(Usage(error.to_string())),
        other => other?,
    };
    let text = String::from_utf8(content).map_err(|error| wrong(error.to_string()))?;
    let study: Study = file::parse(&text, path)?;
    study.check().map_err(wrong)?;
    study.check_tables(path)?;
    let points = study.points().map_err(wrong)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut trials = Vec::new();
    let cases: Vec<Option<usize>> = match study.case.len() {
        0 => vec![None],
        count => (0..count).map(Some).collect(),
    };
    for case in cases {
        for (labels, sets) in &points {
            let label = labels.join(", ");
            if study.except.contains(&label)
                || case.is_some_and(|case| !study.case[case].covers(&label))
            {
                continue;
            }
            let name = format!("{stem}-{:02}", trials.len() + 1);
            trials.push(study.trial(path, name, case, labels, sets)?);
        }
    }
    Ok((study, trials))
}

/// The first name that stood before.
fn twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let names: Vec<&str> = names.collect();
    (1..names.len())
        .find(|&k| names[..k].contains(&names[k]))
        .map(|k| names[k])
}

/// The key that an override changes.
fn key_of(set: &str) -> &str {
    set.split('=').next().unwrap_or_default().trim()
}

/// Whether one of two keys is the other, or holds it.
fn meet(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    let rest = long.strip_prefix(short);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

impl Axis {
    /// The keys that it changes.
    fn keys(&self) -> impl Iterator<Item = &str> {
        let sets = self.points.iter().flat_map(|point| &point.set);
        self.key
            .as_deref()
            .into_iter()
            .chain(sets.map(|set| key_of(set)))
    }
}

impl Study {
    /// Of two axes that change the same key one would lie about its points.
    fn check_axes(&self) -> Result<(), String> {
        for (k, axis) in self.axis.iter().enumerate() {
            let before = || self.axis[..k].iter().flat_map(Axis::keys);
            let mut pairs = axis
                .keys()
                .flat_map(|key| before().map(move |other| (key, other)));
            if let Some((key, other)) = pairs.find(|(key, other)| meet(key, other)) {
                let name = &axis.name;
                return Err(format!(
                    "axis `{name}` changes `{key}`, and another axis `{other}`; join the two to one"
                ));
            }
        }
        Ok(())
    }

    fn check(&self) -> Result<(), String> {
        match (&self.error, self.figure.is_empty(), self.case.is_empty()) {
            (Some(error), true, true) => {
                error.check().map_err(str::to_string)?;
                error.window().map_err(|error| error.to_string())?;
            }
            (None, false, true) | (None, true, false) => self.check_figures()?,
            _ => return Err("it needs just one of [error], [[figure]] and [[case]]".to_string()),
        }
        if self.figure.is_empty() && !self.curves.is_empty() {
            return Err("[[curves]] go with [[figure]], of which there is none".to_string());
        }
        let labels: Vec<String> = self.points()?.iter().map(|p| p.0.join(", ")).collect();
        if let Some(label) = twice(labels.iter().map(String::as_str)) {
            return Err(format!(
                "two points are `{label}`: give each value of an axis once"
            ));
        }
        for set in &self.set {
            let key = key_of(set);
            if self
                .axis
                .iter()
                .any(|axis| axis.key.as_deref() == Some(key))
            {
                return Err(format!(
                    "set: an axis changes `{key}`; remove one of the two"
                ));
            }
        }
        self.check_axes()?;
        let own: &[&str] = match (&self.error, self.case.is_empty()) {
            (Some(_), _) => &target::COLUMNS,
            (None, false) => &promise::COLUMNS,
            (None, true) => &["status", "cpu_s"],
        };
        let case = (!self.case.is_empty()).then_some("case");
        let names = ["point"].into_iter().chain(case).chain(own.iter().copied());
        let names = names.chain(self.axis.iter().map(|axis| axis.name.as_str()));
        let names = names.chain(self.figure.iter().map(|figure| figure.name.as_str()));
        if let Some(name) = twice(names) {
            return Err(format!(
                "two columns of the table would be `{name}`; rename an axis or a figure"
            ));
        }
        if let Some(name) = twice(self.case.iter().map(|case| case.name.as_str())) {
            return Err(format!("two cases are `{name}`; rename one"));
        }
        if !labels.is_empty() && labels.iter().all(|label| self.except.contains(label)) {
            return Err("except: no point is left; leave out fewer".to_string());
        }
        if let Some(label) = self.except.iter().find(|label| !labels.contains(label)) {
            let labels = labels.join("; ");
            return Err(format!(
                "except: `{label}` is not a point; points are {labels}"
            ));
        }
        for case in &self.case {
            case.check(&labels, self.pipeline.is_some())?;
        }
        if self.case.is_empty() && self.pipeline.is_none() {
            return Err("it needs `pipeline`, the file that all points change".to_string());
        }
        Ok(())
    }

    /// Checks that its tables can be read; `path`: of the study file.
    fn check_tables(&self, path: &Path) -> Result<()> {
        let wrong = |what: String| Usage(format!("{}: {what}", path.display()));
        let folder = path.parent().unwrap_or(Path::new("."));
        let of_error = self.error.iter().filter_map(Target::table);
        for (table, column) in of_error.chain(self.tables_of_figures()) {
            let read = match Series::read(&folder.join(table)) {
                Err(SeriesError::File(error)) if error.is_failure() => return Err(error.into()),
                read => read.map_err(|error| wrong(error.to_string()))?,
            };
            if read.column(column).is_none() {
                let names = read.names.join(", ");
                let table = table.display();
                bail!(wrong(format!(
                    "{table} has no column `{column}`; columns are {names}"
                )));
            }
        }
        Ok(())
    }

    /// The product of the axes.
    fn points(&self) -> Result<Vec<Point>, String> {
        let mut points = vec![(Vec::new(), Vec::new())];
        for axis in &self.axis {
            let choices = axis.choices()?;
            let extend = |(labels, sets): &Point| {
                let with = |choice: &Choice| {
                    let mut point = (labels.clone(), sets.clone());
                    point.0.push(choice.label.clone());
                    point.1.extend(choice.set.iter().cloned());
                    point
                };
                choices.iter().map(with).collect::<Vec<_>>()
            };
            points = points.iter().flat_map(extend).collect();
        }
        Ok(points)
    }

    fn trial(
        &self,
        path: &Path,
        name: String,
        case: Option<usize>,
        labels: &[String],
        sets: &[String],
    ) -> Result<Trial> {
        let own = case.map(|case| &self.case[case]);
        let pipeline = own.and_then(|case| case.pipeline.as_ref());
        let pipeline = pipeline.or(self.pipeline.as_ref()).expect("checked");
        let pipeline = path.parent().unwrap_or(Path::new(".")).join(pipeline);
        let mut all = self.set.clone();
        all.extend(own.into_iter().flat_map(|case| case.set.iter().cloned()));
        all.extend(sets.iter().cloned());
        let title = own.map(|case| case.name.clone());
        let title: Vec<String> = title.into_iter().chain(labels.iter().cloned()).collect();
        let mut trial = Trial {
            title: match title.is_empty() {
                true => name.clone(),
                false => title.join(", "),
            },
            name,
            source: match source(&pipeline) {
                Err(error) if error.is_not_found() => {
                    bail!(Usage(format!("{}: pipeline: {error}", path.display())))
                }
                found => found?,
            },
            pipeline,
            sets: all,
            case,
            labels: labels.to_vec(),
            repeats: self.axis.iter().map(|axis| axis.repeat).collect(),
            method: "",
            spacing: f64::NAN,
            count: f64::NAN,
        };
        if own.is_some_and(|case| case.ends == Ending::Refused) {
            return Ok(trial);
        }
        let point = || format!("{}, point {}", path.display(), trial.title);
        let scene = file::load(&trial.pipeline, &trial.sets)
            .with_context(point)?
            .scene;
        trial.method = scene.method.name();
        trial.spacing = scene.spacing;
        let particles = (0..scene.bodies.len()).map(|body| count(&scene, body) as f64);
        trial.count = particles.sum();
        Ok(trial)
    }
}

impl Axis {
    fn choices(&self) -> Result<Vec<Choice>, String> {
        let name = &self.name;
        match (&self.key, self.values.is_empty(), self.points.is_empty()) {
            (Some(key), false, true) => Ok(self
                .values
                .iter()
                .map(|value| {
                    let text = value.as_str().map_or(value.to_string(), str::to_string);
                    let set = vec![format!("{key}={text}")];
                    Choice { label: text, set }
                })
                .collect()),
            (None, true, false) => Ok(self.points.clone()),
            _ => Err(format!(
                "axis {name} needs either key and values, or points"
            )),
        }
    }
}
