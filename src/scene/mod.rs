//! The resolved scene: what is to be simulated, in SI units, defaults filled in. No numerics.
//!
//! [`file`] contains the file format; all later modules use only these types.
//! Axes: x and y are lateral, z is up. A 2-D scene is the x-z plane: y is zero everywhere.

mod body;
mod check;
mod conform;
mod domain;
pub mod driven;
mod effects;
pub mod error;
pub mod file;
pub mod input;
pub mod key;
pub mod lamella;
pub mod limit;
mod method;
pub mod numbers;
pub mod preset;
mod problem;
pub mod quantity;
pub mod reference;
mod rule;
pub mod sanity;
pub mod schema;
mod shape;
mod spelling;
mod stage;
mod symmetry;
mod tree;
mod unit;
pub mod variant;
mod wetting;
mod width;

use std::borrow::Cow;
use std::ops::{Deref, DerefMut};

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

pub use body::{Body, Motion, Shape};
pub use domain::{AXES, Domain, ENDS, Rings, Side};
pub use effects::{
    Effects, SurfaceTension, TensionForm, TensionLevel, TensionStrength, Viscosity, ViscosityForm,
};
use error::SceneError;
pub use method::{
    Closure, Density, Gradient, Isph, KernelName, Mass, Method, MethodName, Mps, MpsClosure,
    MpsGradient, MpsPressure, Pairs, PoissonSource, Precision, Preconditioner, Preset, Pressure,
    Projection, SoundSpeed, SpeedOf, Sph, TensionIn, TimeStepping, WallPressure, Wcsph,
};
pub use problem::Problem;
pub use stage::{
    Arrangement, Clock, Colouring, FigureStyle, Frames, Impact, LONGEST_REFERENCE, Packing, Post,
    Reference, Relax, StopWhen,
};
use tree::Tree;
pub use unit::Rgb;
pub use wetting::Wetting;

/// Number of space dimensions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub enum Dimension {
    /// The x-z plane.
    Two,
    /// x, y and z.
    #[default]
    Three,
}

impl TryFrom<u8> for Dimension {
    type Error = &'static str;
    fn try_from(count: u8) -> Result<Self, Self::Error> {
        match count {
            2 => Ok(Dimension::Two),
            3 => Ok(Dimension::Three),
            _ => Err("write 2 or 3"),
        }
    }
}

impl From<Dimension> for u8 {
    fn from(dimension: Dimension) -> u8 {
        dimension.count() as u8
    }
}

impl JsonSchema for Dimension {
    fn schema_name() -> Cow<'static, str> {
        "Dimension".into()
    }
    fn inline_schema() -> bool {
        true
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "enum": [2, 3] })
    }
}

impl Dimension {
    /// 2 or 3.
    pub fn count(self) -> usize {
        match self {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }

    /// Axes that exist: x and z, or x, y and z.
    pub fn axes(self) -> &'static [usize] {
        match self {
            Dimension::Two => &[0, 2],
            Dimension::Three => &[0, 1, 2],
        }
    }

    /// The components along these axes: x, z in 2-D.
    fn components<U: unit::Dimension>(self, vector: [f64; 3]) -> unit::Vector<U> {
        let axes = self.axes().iter();
        unit::Vector::new(axes.map(|&axis| vector[axis]).collect())
    }

    /// [x, y, z], or [x, 0, z] of two components.
    ///
    /// # Errors
    /// If their number is another one; `key` is their place in the file.
    fn vector<U: unit::Dimension>(
        self,
        vector: &unit::Vector<U>,
        key: &str,
        tree: &Tree<'_>,
    ) -> Result<[f64; 3], SceneError> {
        match (self, vector.components.as_slice()) {
            (Dimension::Two, &[x, z]) => Ok([x, 0.0, z]),
            (Dimension::Three, &[x, y, z]) => Ok([x, y, z]),
            (_, components) => {
                let d = self.count();
                let problem = format!("has {} components in a {d}-D scene", components.len());
                let remedy = match self {
                    Dimension::Two => "give 2: x and z",
                    Dimension::Three => "give 3: x, y and z",
                };
                Err(tree.fault(key, &problem, remedy))
            }
        }
    }
}

/// A resolved scene: a problem, and the settings of the stages.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Stem of the name of the scene file.
    pub name: String,
    /// Title of the plots and the report.
    pub title: String,
    /// The physical and numerical problem.
    pub problem: Problem,
    /// How bodies are filled with particles.
    pub pack: Packing,
    /// `None`: bodies go to the impact as packed.
    pub relax: Option<Relax>,
    /// When the run ends, and how often it writes a checkpoint.
    pub impact: Impact,
    /// When frames are recorded, and their colours.
    pub frames: Frames,
    /// Instants of pictures, and reference curves.
    pub post: Post,
}

impl Deref for Scene {
    type Target = Problem;
    fn deref(&self) -> &Problem {
        &self.problem
    }
}

impl DerefMut for Scene {
    fn deref_mut(&mut self) -> &mut Problem {
        &mut self.problem
    }
}
