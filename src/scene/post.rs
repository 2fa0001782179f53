//! Settings of the evaluation.

/// Settings of the post stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Post {
    /// Instants of the snapshot panels, s.
    pub panels: Vec<f64>,
    /// Instants of the averaged pressure and velocity fields, s.
    pub fields: Vec<f64>,
    /// Reference curves to draw and compare with.
    pub references: Vec<Reference>,
}

/// A reference curve from a CSV file with the column names of `measures.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub label: String,
    /// As written in the file; relative to the pipeline file.
    pub path: std::path::PathBuf,
    /// `None`: as the name of its column of times says.
    pub clock: Option<Clock>,
}

/// From which instant the times of a table count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Clock {
    /// The start of the run, as in `measures.csv`.
    Start,
    /// The contact of the drop with pool or wall.
    Contact,
}

impl Clock {
    /// Names of the column of times, in seconds, that goes with each clock.
    pub const COLUMNS: [(&'static str, Clock); 2] = [
        ("time_s", Clock::Start),
        ("time_after_contact_s", Clock::Contact),
    ];
}
