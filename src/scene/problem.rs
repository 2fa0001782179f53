//! The physical and numerical problem: all that a solver reads.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};

use super::body::BodyTable;
use super::domain::BoxTable;
use super::effects::EffectTables;
use super::method::MethodName;
use super::schema::positive;
use super::{
    Body, Dimension, Domain, Effects, Method, Motion, MpsClosure, Pairs, Shape, Side, SpeedOf,
    Viscosity, unit,
};

/// Liquid in a box, the effects that act on it, and the method that computes its motion, SI.
///
/// It is serialised as the corresponding part of a scene file, from which its key is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Number of space dimensions.
    pub dimension: Dimension,
    /// The box and its boundaries.
    pub domain: Domain,
    /// Liquid density rho0, kg/m^3.
    pub density: f64,
    /// Particle spacing s0, m.
    pub spacing: f64,
    /// Forces besides pressure.
    pub effects: Effects,
    /// Bodies of liquid, in the order of the file.
    pub bodies: Vec<Body>,
    /// The particle method and its settings.
    pub method: Method,
    /// How sums over pairs are computed.
    pub pairs: Pairs,
}

impl Problem {
    /// The relaxation of one body: alone and at rest, in the box of the scene if it touches it,
    /// else in an open box around it, with the mirror planes that cut it, and without gravity.
    pub fn resting(&self, body: usize) -> Problem {
        let mut body = self.bodies[body].clone();
        let mut problem = Problem {
            domain: self.domain_around(&body),
            bodies: Vec::new(),
            method: at_rest(&self.method),
            ..self.clone()
        };
        body.motion = Motion::Uniform([0.0; 3]);
        if body.shape.is_free() {
            let home = problem.domain.home();
            body.shape.move_to(home);
        }
        problem.effects = self.effects.at_rest(body.shape.is_free());
        problem.bodies = vec![body];
        problem
    }

    fn domain_around(&self, body: &Body) -> Domain {
        let extent = match &body.shape {
            Shape::Sphere { radius, .. } => [*radius; 3],
            Shape::Ellipsoid { semi_axes, .. } => *semi_axes,
            _ => return self.domain.clone(),
        };
        let mut size = extent.map(|r| 4.0 * r + 8.0 * self.spacing);
        let mut boundary = [[Side::Open; 2]; 3];
        for (axis, side) in body.shape.cuts(&self.domain).into_iter().enumerate() {
            if let Some(side) = side {
                size[axis] *= 0.5;
                boundary[axis][side] = self.domain.boundary[axis][side];
            }
        }
        if self.dimension == Dimension::Two {
            size[1] = 0.0;
            boundary[1] = [Side::Periodic; 2];
        }
        Domain {
            size,
            boundary,
            wall_velocity: Default::default(),
            revolved: self.domain.revolved,
        }
    }

    /// Number of dimensions of the space that the liquid fills: 3 where particles are rings.
    pub fn space(&self) -> usize {
        match self.domain.is_revolved() {
            true => 3,
            false => self.dimension.count(),
        }
    }

    /// The dynamic viscosity that limits an explicit step, Pa s.
    pub fn stiff_viscosity(&self) -> Option<f64> {
        let Viscosity { dynamic, form } = self.effects.viscosity?;
        let method = &self.method;
        Some(dynamic * method.stiffness(form, self.space(), self.domain.is_axial()))
    }

    /// Depth of the deepest layer, m.
    pub fn pool_depth(&self) -> Option<f64> {
        let depths = self.bodies.iter().filter_map(|body| match body.shape {
            Shape::Layer { depth } => Some(depth),
            _ => None,
        });
        depths.reduce(f64::max)
    }

    /// Whether a side of the box is a wall.
    pub fn has_wall(&self) -> bool {
        self.domain.has_wall()
    }

    /// Whether a setting of this name is present and has no effect.
    pub(super) fn ignores(&self, name: &str) -> bool {
        let is_completed = match &self.method {
            Method::Mps(settings) => settings.closure == MpsClosure::Completed,
            _ => false,
        };
        let is_mps = matches!(self.method, Method::Mps(_));
        match name.rsplit('.').next().unwrap_or("") {
            "wall_pressure" => !self.has_wall(),
            "cohesion" => self.effects.tension.is_none(),
            "tension" => self.effects.tension.is_none(),
            "beta" => is_completed,
            "form" => is_mps && name.ends_with("viscosity.form"),
            _ => false,
        }
    }
}

/// A method without the settings that bodies at rest do not use: they have their own speed of
/// sound.
fn at_rest(method: &Method) -> Method {
    let mut method = method.clone();
    if let Method::Wcsph(settings) = &mut method {
        settings.sound_speed_factor = 10.0;
        settings.reference_speed = SpeedOf::Scene;
    }
    method
}

impl Domain {
    /// Centre of a relaxing body in this box, m: the middle, or in the mirror plane that cuts it.
    fn home(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| match self.fold(axis) {
            Some(side) => [0.0, self.size[axis]][side],
            None => 0.5 * self.size[axis],
        })
    }
}

/// The liquid of all bodies.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Liquid {
    /// Density at rest.
    #[serde(with = "unit::Density")]
    #[schemars(transform = positive)]
    pub density: f64,
}

/// The part of a scene file that describes a problem.
#[derive(Serialize)]
struct Fragment {
    dimension: Dimension,
    #[serde(rename = "box")]
    domain: BoxTable,
    liquid: Liquid,
    pack: Spacing,
    effects: EffectTables,
    body: Vec<BodyTable>,
    method: Settings,
}

#[derive(Serialize)]
struct Spacing {
    #[serde(with = "unit::Length")]
    spacing: f64,
}

#[derive(Serialize)]
struct Settings {
    name: MethodName,
    #[serde(flatten)]
    pairs: Pairs,
    #[serde(flatten)]
    method: Method,
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let bodies = self.bodies.iter();
        let fragment = Fragment {
            dimension: self.dimension,
            domain: BoxTable::of(&self.domain, self.dimension),
            liquid: Liquid {
                density: self.density,
            },
            pack: Spacing {
                spacing: self.spacing,
            },
            effects: EffectTables::of(&self.effects, self.dimension),
            body: bodies.map(|b| BodyTable::of(b, self.dimension)).collect(),
            method: Settings {
                name: self.method.word(),
                pairs: self.pairs,
                method: self.method.clone(),
            },
        };
        fragment.serialize(to)
    }
}
