//! The input of each stage as one value, from which keys and reasons are made.
//!
//! An input contains exactly what can change the result of its stage, and the stage gets nothing
//! else of the scene. It is serialised with the keys of the scene file, SI values with their units,
//! so that equal values are equal texts. Settings of absent effects, paths, thread counts and the
//! checkpoint interval are in no input. A free body is packed and relaxed alone: its position and
//! velocity, gravity, the box and other bodies are not in its inputs. Layers and blocks touch the
//! sides of the box, so their inputs contain the box.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::body::BodyTable;
use super::domain::BoxTable;
use super::key::KeyError;
use super::problem::Liquid;
use super::stage::{LONGEST_REFERENCE, Pack, Packing, StopWhen};
use super::unit::{Colour, List, Time};
use super::{
    Arrangement, Clock, Colouring, Dimension, Domain, Frames, Problem, Relax, Scene, Shape, Sph,
    TensionStrength,
};

/// Input of the packing of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct PackInput {
    /// Name of the body, for messages.
    pub name: String,
    /// Number of space dimensions.
    pub dimension: Dimension,
    /// The box in which the body relaxes: see [`Problem::resting`].
    pub domain: Domain,
    /// Liquid density rho0, kg/m^3.
    pub density: f64,
    /// Particle spacing s0, m.
    pub spacing: f64,
    /// A lattice reads the kernel too: its particles are numbered along the kernel's cells.
    pub sph: Sph,
    /// Region to fill with particles.
    pub shape: Shape,
    /// Arrangement and its parameters.
    pub packing: Packing,
}

/// Input of the relaxation of a body, besides its packing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelaxInput {
    /// See [`Problem::resting`].
    #[serde(flatten)]
    pub problem: Problem,
    /// When the relaxation ends.
    pub relax: Relax,
}

/// Input of the calibration of the tension strength, besides the particles.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateInput {
    /// Each body at rest, without viscosity.
    pub bodies: Vec<Problem>,
}

/// Input of the impact, besides the particles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImpactInput {
    /// The resolved physical and numerical problem.
    #[serde(flatten)]
    pub problem: Problem,
    /// State of the bodies at the start.
    pub start: Start,
    /// When the run ends.
    pub impact: End,
    /// When frames are recorded, and their colours.
    pub frames: Frames,
    /// Names and, if particles are coloured by body, colours.
    pub labels: Vec<Label>,
}

/// State of the bodies at the start of an impact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// As packed.
    Packed,
    /// As relaxed at rest.
    Relaxed,
}

/// When a run ends.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct End {
    /// Simulated time to reach, s.
    #[serde(with = "Time")]
    pub end: f64,
    /// What ends it before, each once, in the order of [`StopWhen::ALL`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stop_when: Vec<StopWhen>,
}

/// Name and colour of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Label {
    /// Name of the body.
    pub name: String,
    /// Colour of the body; `None` where particles are not coloured by body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
}

/// Input of the evaluation, besides the log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PostInput {
    /// Stem of the name of the scene file; replaces a missing title.
    #[serde(skip)]
    pub name: String,
    /// Title of the plots and the report.
    pub title: String,
    /// The resolved physical and numerical problem.
    #[serde(flatten)]
    pub problem: Problem,
    /// When the run ends.
    pub impact: End,
    /// Time between frames.
    pub frames: Interval,
    /// Names and colours of the bodies.
    pub labels: Vec<Label>,
    /// Instants of pictures, and reference curves.
    pub post: Drawn,
}

/// How often frames were taken.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Simulated time between frames, s.
    #[serde(with = "Time")]
    pub interval: f64,
}

impl PostInput {
    /// A scene that contains only what the evaluation may read.
    pub fn scene(&self) -> Scene {
        let curve = |curve: &Curve| super::Reference {
            label: curve.label.clone(),
            path: curve.path.clone(),
            clock: curve.clock,
        };
        Scene {
            name: self.name.clone(),
            title: self.title.clone(),
            post: super::Post {
                panels: self.post.panels.clone(),
                fields: self.post.fields.clone(),
                references: self.post.references.iter().map(curve).collect(),
                figures: self.post.figures,
            },
            ..bare(&self.problem, &self.impact, self.frames.interval)
        }
    }
}

impl ImpactInput {
    /// A scene that contains only what may be measured during an impact.
    pub fn scene(&self) -> Scene {
        bare(&self.problem, &self.impact, self.frames.interval)
    }
}

/// A scene without names and pictures; `interval`: time between frames, s.
fn bare(problem: &Problem, impact: &End, interval: f64) -> Scene {
    Scene {
        name: String::new(),
        title: String::new(),
        problem: problem.clone(),
        pack: Packing::default(),
        relax: None,
        impact: super::Impact {
            end: impact.end,
            stop_when: impact.stop_when.clone(),
            checkpoint_every: f64::INFINITY,
        },
        frames: Frames {
            interval,
            time_scale: 1.0,
            colour: Colouring::Body,
        },
        post: super::Post::default(),
    }
}

/// What is drawn and compared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drawn {
    /// Instants, s.
    #[serde(with = "List::<Time>")]
    pub panels: Vec<f64>,
    /// Instants, s.
    #[serde(with = "List::<Time>")]
    pub fields: Vec<f64>,
    /// Reference curves to compare with.
    pub references: Vec<Curve>,
    /// Size, letters and resolution.
    pub figures: super::FigureStyle,
}

/// A reference curve, identified by its content, not by its path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Name of the curve in legends.
    pub label: String,
    /// Path, relative to the folder of the scene file.
    #[serde(skip)]
    pub path: PathBuf,
    /// SHA-256 of the file.
    pub content: String,
    /// The file: it may change while a run goes on.
    #[serde(skip)]
    pub bytes: Vec<u8>,
    /// Zero of its times; `None`: as its column of times is named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock: Option<Clock>,
}

impl Serialize for PackInput {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let fragment = PackFragment {
            dimension: self.dimension,
            domain: BoxTable::of(&self.domain, self.dimension),
            liquid: Liquid {
                density: self.density,
            },
            pack: Pack {
                spacing: self.spacing,
                packing: self.packing.clone(),
            },
            method: self.sph,
            body: [BodyTable::of_shape(&self.shape, self.dimension)],
        };
        fragment.serialize(to)
    }
}

#[derive(Serialize)]
struct PackFragment {
    dimension: Dimension,
    #[serde(rename = "box")]
    domain: BoxTable,
    liquid: Liquid,
    pack: Pack,
    method: Sph,
    body: [BodyTable; 1],
}

impl Serialize for CalibrateInput {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        // The box and the effects of free bodies follow from their shapes and from those of a body
        // that touches the box.
        let stands = |problem: &&Problem| !problem.bodies[0].shape.is_free();
        let lead = self.bodies.iter().find(stands).or(self.bodies.first());
        let bodies = self.bodies.iter().map(|problem| problem.bodies[0].clone());
        let whole = lead.map(|lead| Problem {
            bodies: bodies.collect(),
            ..lead.clone()
        });
        whole.serialize(to)
    }
}

impl Scene {
    /// Input of the packing of body number `body`.
    pub fn pack_input(&self, body: usize) -> PackInput {
        let Problem {
            dimension,
            domain,
            density,
            spacing,
            method,
            bodies,
            ..
        } = self.resting(body);
        PackInput {
            name: bodies[0].name.clone(),
            dimension,
            domain: domain.planar(),
            density,
            spacing,
            sph: method.sph(),
            shape: bodies[0].shape.clone(),
            packing: match self.pack.arrangement {
                Arrangement::Poisson => self.pack.clone(),
                // A lattice has no seed and no tolerance.
                Arrangement::Lattice => Packing {
                    arrangement: Arrangement::Lattice,
                    ..Packing::default()
                },
            },
        }
    }

    /// Input of the relaxation of body number `body`; `None` if there is none.
    pub fn relax_input(&self, body: usize) -> Option<RelaxInput> {
        let relax = self.relax.clone()?;
        let problem = self.resting(body);
        Some(RelaxInput { problem, relax })
    }

    /// Input of the calibration of the tension strength; `None` if the scene has none.
    pub fn calibrate_input(&self) -> Option<CalibrateInput> {
        let tension = self.effects.tension?;
        (tension.strength == TensionStrength::Virial).then(|| CalibrateInput {
            bodies: (0..self.bodies.len()).map(|body| self.calm(body)).collect(),
        })
    }

    /// Input of the impact.
    pub fn impact_input(&self) -> ImpactInput {
        let is_asked = |condition: &StopWhen| self.impact.stop_when.contains(condition);
        ImpactInput {
            problem: self.problem.clone(),
            start: match self.relax {
                None => Start::Packed,
                Some(_) => Start::Relaxed,
            },
            impact: End {
                end: self.impact.end,
                stop_when: StopWhen::ALL.into_iter().filter(is_asked).collect(),
            },
            frames: self.frames.clone(),
            labels: self.labels(self.frames.colour == Colouring::Body),
        }
    }

    /// Input of the evaluation. `folder` contains the scene file.
    ///
    /// # Errors
    /// [`KeyError::Reference`] if a reference curve cannot be read.
    pub fn post_input(&self, folder: &Path) -> Result<PostInput, KeyError> {
        let curves = self.post.references.iter().enumerate();
        let curve = |(index, reference): (usize, &super::Reference)| {
            let content = crate::file::read(&folder.join(&reference.path), LONGEST_REFERENCE);
            let content = content.map_err(|error| KeyError::Reference {
                name: format!("post.references[{index}].path"),
                problem: error.to_string(),
            })?;
            Ok(Curve {
                label: reference.label.clone(),
                path: reference.path.clone(),
                content: hex(&Sha256::digest(&content)),
                bytes: content,
                clock: reference.clock,
            })
        };
        Ok(PostInput {
            name: self.name.clone(),
            title: self.title.clone(),
            problem: self.problem.clone(),
            // What has ended a run is in its frames.
            impact: End {
                end: self.impact.end,
                stop_when: Vec::new(),
            },
            frames: Interval {
                interval: self.frames.interval,
            },
            labels: self.labels(true),
            post: Drawn {
                panels: self.post.panels.clone(),
                fields: self.post.fields.clone(),
                references: curves.map(curve).collect::<Result<_, _>>()?,
                figures: self.post.figures,
            },
        })
    }

    fn labels(&self, coloured: bool) -> Vec<Label> {
        let label = |body: &super::Body| Label {
            name: body.name.clone(),
            colour: coloured.then_some(Colour(body.colour)),
        };
        self.bodies.iter().map(label).collect()
    }
}

impl Problem {
    /// A body at rest for the calibration of the tension: without viscosity.
    pub fn calm(&self, body: usize) -> Problem {
        let mut problem = self.resting(body);
        problem.effects.viscosity = None;
        problem
    }
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
