//! The setup records of a log: bodies, walls, scales, provenance.

use std::collections::BTreeMap;

use crate::particle::Wall;
use crate::scene::{Colouring, Dimension, Frames, Motion, Problem};

/// One body of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogBody {
    /// Its topic is `/body/NAME`.
    pub name: String,
    /// RGB.
    pub colour: [u8; 3],
}

/// Facts that a log states once, at its beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct LogSetup {
    /// In the order of `Frame::body`.
    pub bodies: Vec<LogBody>,
    /// Positions of the wall particles, m.
    pub wall: [Vec<f64>; 3],
    /// Particle spacing, m.
    pub spacing: f64,
    /// Number of space dimensions.
    pub dimension: Dimension,
    /// Log time = simulated time x this.
    pub time_scale: f64,
    /// Time of contact of the drop, s from the start of the run; `None` if nothing meets.
    pub contact: Option<f64>,
    /// What the colour of a particle shows.
    pub colour: Colouring,
    /// Speed at the top of the colour map, m/s.
    pub speed_scale: f64,
    /// Pressure at the top of the colour map, Pa.
    pub pressure_scale: f64,
    /// Text of the pipeline file.
    pub scene_text: String,
    /// Names and values: keys, versions, settings.
    pub provenance: Vec<(String, String)>,
}

impl LogSetup {
    /// Setup of the log of a problem. The colour maps reach to the largest initial speed U (that of
    /// falling through the box at rest) and to rho U^2 plus the hydrostatic pressure of the box.
    /// Without a time of contact.
    pub fn new(
        problem: &Problem,
        frames: &Frames,
        wall: &Wall,
        scene_text: String,
        provenance: Vec<(String, String)>,
    ) -> Self {
        let size = problem.domain.size;
        let forces = problem.effects.body_forces().into_iter();
        let gravity = forces.map(norm).fold(0.0, f64::max);
        let fall = (2.0 * gravity * size[2]).sqrt();
        let fastest = problem.bodies.iter().map(|body| match body.motion {
            Motion::Uniform(velocity) => norm(velocity),
            Motion::TaylorGreen { speed } => speed.abs(),
            Motion::Stretch { rate } => rate.abs() * size[2],
        });
        let fastest = fastest.fold(0.0, f64::max);
        let speed = if fastest > 0.0 { fastest } else { fall };
        let pressure = problem.density * (speed * speed + gravity * size[2]);
        let body = |body: &crate::scene::Body| LogBody {
            name: body.name.clone(),
            colour: body.colour,
        };
        LogSetup {
            bodies: problem.bodies.iter().map(body).collect(),
            wall: wall.position.clone(),
            spacing: problem.spacing,
            dimension: problem.dimension,
            time_scale: frames.time_scale,
            contact: None,
            colour: frames.colour,
            speed_scale: if speed > 0.0 { speed } else { 1.0 },
            pressure_scale: if pressure > 0.0 { pressure } else { 1.0 },
            scene_text,
            provenance,
        }
    }

    /// Metadata records, in the order in which they are written.
    pub(super) fn metadata(&self) -> Vec<(&'static str, BTreeMap<String, String>)> {
        let facts = [
            ("format", "1".to_string()),
            ("spacing_m", self.spacing.to_string()),
            ("dimension", self.dimension.count().to_string()),
            ("time_scale", self.time_scale.to_string()),
        ];
        let contact = self.contact.map(|time| ("contact_s", time.to_string()));
        let facts = facts.into_iter().chain(contact);
        let facts = facts.map(|(name, value)| (name.to_string(), value));
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| {
            let [r, g, b] = body.colour;
            let value = format!("#{r:02x}{g:02x}{b:02x} {}", body.name);
            (format!("{index:03}"), value)
        });
        vec![
            ("coronet", facts.collect()),
            ("bodies", bodies.collect()),
            ("provenance", self.provenance.iter().cloned().collect()),
        ]
    }
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}
