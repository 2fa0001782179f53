//! What each stage reads, as one value: the material of keys and of reasons.
//!
//! An input holds exactly what can change the result of its stage, and the stage gets nothing else
//! of the scene. It is serialised in the words of the scene file, SI values with their units, so
//! that equal values are equal texts, however they were written. A setting of an absent effect is
//! in no input, nor are paths, thread counts, checkpoint cadence. A body that hangs free is packed
//! and relaxed alone: neither where it hangs, how fast it moves, gravity, the box nor other bodies
//! are in its inputs. Layers and blocks meet the sides of the box, so the box is in theirs.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::body::BodyTable;
use super::domain::BoxTable;
use super::key::KeyError;
use super::problem::Liquid;
use super::stage::{LONGEST_REFERENCE, Pack, Packing};
use super::unit::{Colour, List, Time};
use super::{
    Arrangement, Clock, Colouring, Dimension, Domain, Frames, Problem, Relax, Scene, Shape, Sph,
    TensionStrength,
};

/// What packing a body reads.
#[derive(Clone, Debug, PartialEq)]
pub struct PackInput {
    /// Of the body, for messages.
    pub name: String,
    pub dimension: Dimension,
    /// The box in which the body relaxes: see [`Problem::resting`].
    pub domain: Domain,
    /// Liquid density rho0, kg/m^3.
    pub density: f64,
    /// Particle spacing s0, m.
    pub spacing: f64,
    /// A lattice reads the kernel too: its particles are numbered along the kernel's cells.
    pub sph: Sph,
    pub shape: Shape,
    pub packing: Packing,
}

/// What the relaxation of a body reads, besides its packing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelaxInput {
    /// See [`Problem::resting`].
    #[serde(flatten)]
    pub problem: Problem,
    pub relax: Relax,
}

/// What the calibration of the tension strength reads, besides the bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrateInput {
    /// Each body at rest, without viscosity.
    pub bodies: Vec<Problem>,
}

/// What the impact reads, besides the bodies.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImpactInput {
    #[serde(flatten)]
    pub problem: Problem,
    pub start: Start,
    pub impact: End,
    pub frames: Frames,
    /// Names and, if particles are coloured by body, colours.
    pub labels: Vec<Label>,
}

/// What the bodies of an impact are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    Packed,
    Relaxed,
}

/// When a run ends.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct End {
    /// Simulated time to reach, s.
    #[serde(with = "Time")]
    pub end: f64,
}

/// What a body is called, and its colour.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Label {
    pub name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub colour: Option<Colour>,
}

/// What the evaluation reads, besides the log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PostInput {
    /// Of the scene file; stands where there is no title.
    #[serde(skip)]
    pub name: String,
    pub title: String,
    #[serde(flatten)]
    pub problem: Problem,
    pub impact: End,
    pub frames: Interval,
    pub labels: Vec<Label>,
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
    /// A scene with what the evaluation may read, and nothing else.
    pub fn scene(&self) -> Scene {
        let curve = |curve: &Curve| super::Reference {
            label: curve.label.clone(),
            path: curve.path.clone(),
            clock: curve.clock,
        };
        Scene {
            name: self.name.clone(),
            title: self.title.clone(),
            problem: self.problem.clone(),
            pack: Packing::default(),
            relax: None,
            impact: super::Impact {
                end: self.impact.end,
                checkpoint_every: f64::INFINITY,
            },
            frames: Frames {
                interval: self.frames.interval,
                time_scale: 1.0,
                colour: Colouring::Body,
            },
            post: super::Post {
                panels: self.post.panels.clone(),
                fields: self.post.fields.clone(),
                references: self.post.references.iter().map(curve).collect(),
            },
        }
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
    pub references: Vec<Curve>,
}

/// A reference curve, by what it contains, not by where it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    pub label: String,
    /// Where it lies, from the folder of the scene file.
    #[serde(skip)]
    pub path: PathBuf,
    /// SHA-256 of the file.
    pub content: String,
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
        // The box and the effects of bodies that hang free follow from their shapes and from those
        // of a body that stands in the box.
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
    /// What packing body number `body` reads.
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
            domain,
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

    /// What the relaxation of body number `body` reads; `None` if there is none.
    pub fn relax_input(&self, body: usize) -> Option<RelaxInput> {
        let relax = self.relax.clone()?;
        let problem = self.resting(body);
        Some(RelaxInput { problem, relax })
    }

    /// What the calibration of the tension strength reads; `None` if the scene has none.
    pub fn calibrate_input(&self) -> Option<CalibrateInput> {
        let tension = self.effects.tension?;
        (tension.strength == TensionStrength::Virial).then(|| CalibrateInput {
            bodies: (0..self.bodies.len()).map(|body| self.calm(body)).collect(),
        })
    }

    /// What the impact reads.
    pub fn impact_input(&self) -> ImpactInput {
        ImpactInput {
            problem: self.problem.clone(),
            start: match self.relax {
                None => Start::Packed,
                Some(_) => Start::Relaxed,
            },
            impact: End {
                end: self.impact.end,
            },
            frames: self.frames.clone(),
            labels: self.labels(self.frames.colour == Colouring::Body),
        }
    }

    /// What the evaluation reads. `folder` holds the scene file.
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
                clock: reference.clock,
            })
        };
        Ok(PostInput {
            name: self.name.clone(),
            title: self.title.clone(),
            problem: self.problem.clone(),
            impact: End {
                end: self.impact.end,
            },
            frames: Interval {
                interval: self.frames.interval,
            },
            labels: self.labels(true),
            post: Drawn {
                panels: self.post.panels.clone(),
                fields: self.post.fields.clone(),
                references: curves.map(curve).collect::<Result<_, _>>()?,
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
    /// A body at rest as the calibration of the tension sees it: without viscosity.
    pub fn calm(&self, body: usize) -> Problem {
        let mut problem = self.resting(body);
        problem.effects.viscosity = None;
        problem
    }
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
