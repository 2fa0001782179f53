//! The figures that a scene is about: what a run comes down to at a glance. The report, the end of
//! a run and the tables that compare runs all tell these.
//!
//! Test: tests/pipeline/runs.rs.

use super::kind::{self, Kind, strikes_wall};
use super::moment::{LIKELY, moment};
use super::series::Series;
use super::summary::{digits, jet_crosses, leaves_wall, period};
use super::{conservation, loss};
use crate::scene::sanity::Warning;
use crate::scene::{Clock, Scene};

/// Shares below this are told as such: they are round-off.
const LEAST_SHARE: f64 = 1e-5;

/// What a value is, and so how it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// m, shown in mm.
    Length,
    /// s, shown in ms.
    Duration,
    /// A part of a whole, shown in per cent.
    Share,
    /// A number without a unit.
    Number,
}

/// One figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Its name for users.
    pub name: &'static str,
    /// What the value is.
    pub quantity: Quantity,
    /// The value in SI.
    pub value: f64,
    /// When, s from the start of the run; `None` for what belongs to the whole run.
    pub time: Option<f64>,
}

impl Quantity {
    /// Unit of the value in files.
    pub fn si(self) -> &'static str {
        match self {
            Quantity::Length => "m",
            Quantity::Duration => "s",
            Quantity::Share | Quantity::Number => "1",
        }
    }

    /// A value for people, with its unit.
    pub fn text(self, value: f64) -> String {
        match self {
            Quantity::Length => format!("{} mm", digits(1e3 * value)),
            Quantity::Duration => format!("{} ms", digits(1e3 * value)),
            Quantity::Share if value != 0.0 && value.abs() < LEAST_SHARE => {
                format!("below {} %", 100.0 * LEAST_SHARE)
            }
            Quantity::Share => format!("{} %", digits(100.0 * value)),
            Quantity::Number => digits(value),
        }
    }
}

impl Answer {
    /// The value for people, with its unit.
    pub fn text(&self) -> String {
        self.quantity.text(self.value)
    }

    /// When, ms after contact, for people; `shift`: time of contact, s.
    pub fn when(&self, shift: f64) -> Option<String> {
        let time = self.time?;
        Some(format!("at {}", moment(time - shift, LIKELY * time, 2)))
    }
}

/// What a run comes down to.
#[derive(Clone, Debug)]
pub struct Figures {
    /// The figures that the scene is about.
    pub answers: Vec<Answer>,
    /// Time of contact, s from the start; 0 where nothing meets.
    pub contact: f64,
    /// The same; `None` where nothing meets.
    meeting: Option<f64>,
    /// The measures that they are of.
    pub measures: Series,
    /// What makes them doubtful.
    pub warnings: Vec<Warning>,
}

impl Figures {
    /// Of a run of `scene` with these measures.
    pub fn new(scene: &Scene, measures: Series) -> Figures {
        let whole = scene.whole();
        let meeting = kind::contact(&whole);
        let contact = kind::contact_time(&whole);
        Figures {
            answers: of(&whole, Kind::new(&whole), &measures, contact),
            contact,
            meeting,
            warnings: loss::warnings(&whole, &measures, meeting),
            measures,
        }
    }

    /// The figure of that name.
    pub fn find(&self, name: &str) -> Option<&Answer> {
        self.answers.iter().find(|answer| answer.name == name)
    }

    /// Time of an answer after contact, s; `None` before it and where nothing meets.
    pub fn after_contact(&self, answer: &Answer) -> Option<f64> {
        Clock::after_contact(answer.time?, self.meeting)
    }
}

/// The names of all figures of some runs, in the order in which they come first.
pub fn names<'a>(figures: impl Iterator<Item = &'a Figures>) -> Vec<&'static str> {
    let mut names = Vec::new();
    for answer in figures.flat_map(|figures| &figures.answers) {
        if !names.contains(&answer.name) {
            names.push(answer.name);
        }
    }
    names
}

/// Name and value of each, for a table; `shift`: time of contact, s.
pub fn lines(answers: &[Answer], shift: f64) -> Vec<(String, String)> {
    let line = |answer: &Answer| {
        let when = answer.when(shift).map(|when| format!(" {when}"));
        let text = answer.text() + &when.unwrap_or_default();
        (answer.name.to_owned(), text)
    };
    answers.iter().map(line).collect()
}

/// Range of the amplitude below which a drop is at rest: disorder changes the moments of a drop of
/// 20 spacings by less.
const STILL: f64 = 1e-3;

/// The figures of a run of the whole `scene`; `shift`: time of contact, s.
pub fn of(scene: &Scene, kind: Kind, series: &Series, shift: f64) -> Vec<Answer> {
    let mut answers = match kind {
        // Before, there are but ripples.
        Kind::Pool(_) if kind::contact_within(scene).is_none() => Vec::new(),
        Kind::Pool(_) => pool(&series.window(shift, f64::INFINITY)),
        Kind::Wall(_) => wall(scene, series, shift),
        Kind::Shape => shape(scene, series),
        Kind::Front => {
            let front = most(series, "front_m", "farthest front", Quantity::Length);
            let top = most(
                series,
                "column_height_m",
                "highest liquid",
                Quantity::Length,
            );
            front.into_iter().chain(top).collect()
        }
        Kind::Level | Kind::Bulk => Vec::new(),
    };
    answers.extend(mass_lost(series));
    answers.extend(unexplained(scene, series));
    answers
}

/// `series`: from contact on.
fn pool(series: &Series) -> Vec<Answer> {
    let depth = most(
        series,
        "crater_depth_m",
        "largest crater depth",
        Quantity::Length,
    );
    let then = depth.as_ref().and_then(|depth| depth.time);
    let diameter = then.and_then(|time| {
        Some(Answer {
            name: "crater diameter then",
            quantity: Quantity::Length,
            value: series.at("crater_diameter_m", time)?,
            time: Some(time),
        })
    });
    let crown = most(
        series,
        "crown_height_m",
        "largest crown height",
        Quantity::Length,
    );
    let jet = jet_crosses(series).and_then(|_| {
        most(
            series,
            "jet_height_m",
            "largest jet height",
            Quantity::Length,
        )
    });
    [depth, diameter, crown, jet]
        .into_iter()
        .flatten()
        .collect()
}

fn wall(scene: &Scene, series: &Series, shift: f64) -> Vec<Answer> {
    let spread = most(
        series,
        "spread_factor",
        "largest spread factor",
        Quantity::Number,
    );
    let off = leaves_wall(series).filter(|_| strikes_wall(scene));
    let contact = off.map(|time| Answer {
        name: "contact time",
        quantity: Quantity::Duration,
        value: time - shift,
        time: Some(time),
    });
    spread.into_iter().chain(contact).collect()
}

fn shape(scene: &Scene, series: &Series) -> Vec<Answer> {
    let aspect = most(
        series,
        "aspect_ratio",
        "largest aspect ratio",
        Quantity::Number,
    );
    let lone = scene.bodies.len() == 1;
    let swings = series.column("amplitude").is_some_and(|values| {
        let known = || values.iter().filter(|value| value.is_finite());
        let [low, high] = [f64::min, f64::max].map(|pick| known().copied().reduce(pick));
        high.zip(low).is_some_and(|(high, low)| high - low > STILL)
    });
    let period = period(series, "amplitude").filter(|_| lone && swings);
    let period = period.map(|value| Answer {
        name: "period of the n = 2 oscillation",
        quantity: Quantity::Duration,
        value,
        time: None,
    });
    aspect.into_iter().chain(period).collect()
}

fn mass_lost(series: &Series) -> Option<Answer> {
    let removed = *series.column("mass_removed_kg")?.last()?;
    let mass = *series.column("mass_kg")?.first()?;
    let value = removed / mass;
    value.is_finite().then_some(Answer {
        name: "mass lost",
        quantity: Quantity::Share,
        value,
        time: None,
    })
}

/// What came from nowhere or is missing at the end, of the energy at first.
fn unexplained(scene: &Scene, series: &Series) -> Option<Answer> {
    let mass = *series.column("mass_kg")?.first()?;
    let [_, value] = conservation::unexplained_part(scene, series, mass);
    value.is_finite().then_some(Answer {
        name: "energy unexplained",
        quantity: Quantity::Share,
        value,
        time: None,
    })
}

/// The maximum of a column, with its time.
fn most(series: &Series, column: &str, name: &'static str, quantity: Quantity) -> Option<Answer> {
    let (value, time) = series.maximum(column)?;
    Some(Answer {
        name,
        quantity,
        value,
        time: Some(time),
    })
}
