//! `[effects]`: effects on the liquid. An absent table turns its effect off.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Dimension;
use super::error::SceneError;
use super::schema::{by_preset, positive};
use super::tree::Tree;
use super::unit::{self, Acceleration, Angle, Maybe, One, Vector};
use super::wetting::Wetting;

/// Effects in the scene. `None`: absent, without cost, array or key.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Effects {
    /// Acceleration vector, m/s^2.
    pub gravity: Option<[f64; 3]>,
    /// Viscous stress of the liquid.
    pub viscosity: Option<Viscosity>,
    /// Surface tension of the liquid.
    pub tension: Option<SurfaceTension>,
    /// Contact angle on the walls.
    pub wetting: Option<Wetting>,
}

impl Effects {
    /// Dynamic viscosity, Pa s.
    pub fn mu(&self) -> Option<f64> {
        self.viscosity.map(|viscosity| viscosity.dynamic)
    }

    /// Surface tension coefficient, N/m.
    pub fn sigma(&self) -> Option<f64> {
        self.tension.map(|tension| tension.coefficient)
    }

    /// Effects on a relaxing body; on a free body neither gravity nor walls.
    pub fn at_rest(&self, is_free: bool) -> Effects {
        let mut effects = self.clone();
        if is_free {
            effects.gravity = None;
            effects.wetting = None;
        }
        effects
    }

    /// Uniform accelerations of all particles, m/s^2; empty without one.
    pub fn body_forces(&self) -> Vec<[f64; 3]> {
        self.gravity.into_iter().collect()
    }

    /// Whether the tension has this form.
    pub fn has_tension(&self, form: TensionForm) -> bool {
        self.tension.is_some_and(|tension| tension.form == form)
    }
}

/// Effects, one table each; an absent table turns its effect off.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct EffectTables {
    /// A constant acceleration.
    pub gravity: Option<Gravity>,
    /// Newtonian viscosity.
    pub viscosity: Option<Viscosity>,
    /// Surface tension.
    pub tension: Option<SurfaceTension>,
    /// Contact angle on the walls; needs tension.
    pub wetting: Option<ContactAngle>,
}

impl EffectTables {
    /// The tables that describe effects, in canonical form.
    pub fn of(effects: &Effects, dimension: Dimension) -> EffectTables {
        let gravity = effects.gravity.map(|vector| match vector {
            [0.0, 0.0, z] if z < 0.0 => Gravity {
                acceleration: -z,
                direction: None,
            },
            // The direction keeps its length: the vector contains the magnitude.
            vector => Gravity {
                acceleration: 1.0,
                direction: Some(dimension.components(vector)),
            },
        });
        EffectTables {
            gravity,
            viscosity: effects.viscosity,
            tension: effects.tension,
            wetting: effects.wetting.map(|wetting| ContactAngle::of(&wetting)),
        }
    }

    /// # Errors
    /// If a direction is zero or contact angles contradict each other.
    pub fn effects(&self, dimension: Dimension, tree: &Tree<'_>) -> Result<Effects, SceneError> {
        let gravity = self.gravity.as_ref();
        let wetting = self.wetting.as_ref();
        Ok(Effects {
            gravity: gravity.map(|g| g.vector(dimension, tree)).transpose()?,
            viscosity: self.viscosity,
            tension: self.tension,
            wetting: wetting.map(|angle| angle.wetting(tree)).transpose()?,
        })
    }
}

/// A constant acceleration.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Gravity {
    /// Magnitude.
    #[serde(with = "Acceleration")]
    #[schemars(transform = positive)]
    pub acceleration: f64,
    /// Direction, of any length; downward if left out.
    #[serde(default)]
    pub direction: Option<Vector<One>>,
}

impl Gravity {
    fn vector(&self, dimension: Dimension, tree: &Tree<'_>) -> Result<[f64; 3], SceneError> {
        let Some(direction) = &self.direction else {
            return Ok([0.0, 0.0, -self.acceleration]);
        };
        let key = "effects.gravity.direction";
        let vector = dimension.vector(direction, key, tree)?;
        let length = vector.iter().map(|each| each * each).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return Err(tree.fault(key, "has no direction", "give a vector that is not zero"));
        }
        // + 0.0 turns -0 into 0.
        Ok(vector.map(|each| self.acceleration * (each / length) + 0.0))
    }
}

/// Form of the viscous term.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ViscosityForm {
    /// Nishio Eq. 6 as printed: (d+3)/(d+2) too strong.
    TwoTerm,
    /// Nishio Eq. 6 multiplied by (d+2)/(d+3).
    TwoTermExact,
    /// Morris, Fox & Zhu 1997.
    Morris,
    /// Kuri Eq. 1 with zeta = d + 2: keeps angular momentum.
    Cleary,
}

/// Newtonian viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Viscosity {
    /// Dynamic viscosity.
    #[serde(with = "unit::Viscosity")]
    #[schemars(transform = positive)]
    pub dynamic: f64,
    /// Form of the viscous term, in place of the preset's.
    #[schemars(transform = by_preset)]
    pub form: ViscosityForm,
}

/// Form of the tension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TensionForm {
    /// Nishio Eqs. 9-13 as printed: normalised colour, difference gradient.
    NormalisedColour,
    /// Colour and normal from raw sums.
    RawColour,
    /// The derivative of an energy.
    SurfaceEnergy,
    /// Kuri Eqs. 1, 5-7: Cahn-Hilliard stress, force on the short kernel.
    CahnHilliard,
    /// Xie Eqs. 10-16: curvature from counted neighbours.
    NumberDensity,
    /// As number-density, with the curvature of a circle or a sphere, and smooth weights.
    NumberDensityExact,
}

impl TensionForm {
    /// Whether the force is curvature times normal, not the divergence of a stress.
    pub fn is_counted(self) -> bool {
        matches!(
            self,
            TensionForm::NumberDensity | TensionForm::NumberDensityExact
        )
    }
}

/// Strength alpha of the tension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TensionStrength {
    /// Calibrated by the virial identity on the arrangement of the particles.
    Virial,
    /// By the integral of the squared gradient across a flat interface (Kuri, after Eq. 6).
    Flat,
    /// This number.
    #[serde(untagged)]
    Fixed(#[schemars(transform = positive)] f64),
}

/// Where the tension of the surface stress equals sigma.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TensionLevel {
    /// At the depth at which the stress acts.
    Inside,
    /// At the surface of the liquid: corrected by the curvature (raw-colour).
    Surface,
}

/// Surface tension.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurfaceTension {
    /// Surface tension coefficient.
    #[serde(with = "unit::Tension")]
    #[schemars(transform = positive)]
    pub coefficient: f64,
    /// Form of the tension, in place of the preset's.
    #[schemars(transform = by_preset)]
    pub form: TensionForm,
    /// Factor alpha of the surface stress: a number, calibrated, or that of a flat interface.
    #[schemars(transform = by_preset)]
    pub strength: TensionStrength,
    /// Long smoothing length over the short one, H / h.
    #[schemars(transform = by_preset, range(min = 0.5, max = 3.0))]
    pub smoothing: f64,
    /// Where the tension equals sigma: where the stress acts, or at the surface.
    #[schemars(transform = by_preset)]
    pub level: TensionLevel,
}

impl SurfaceTension {
    /// Whether the tension is corrected to the surface; only the raw-colour form does this.
    pub fn is_lifted(&self) -> bool {
        self.level == TensionLevel::Surface && self.form == TensionForm::RawColour
    }
}

/// How a wall imposes a contact angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WettingForm {
    /// The liquid is continued into the wall at the angle; Young's force acts on the contact line.
    Young,
    /// Xie Eq. 18, four types of particles.
    ParticleTypes,
}

/// Contact angle on the walls; needs tension.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct ContactAngle {
    /// Contact angle, through the liquid.
    #[serde(default, with = "Maybe::<Angle>")]
    #[schemars(extend("minimum" = 0.0, "maximum" = 180.0))]
    pub angle: Option<f64>,
    /// How a wall imposes it, in place of the preset's.
    #[schemars(transform = by_preset)]
    pub form: WettingForm,
    /// L1, L2, L3 of particle-types, in spacings.
    #[serde(default)]
    #[schemars(transform = positive)]
    pub layers: Option<[f64; 3]>,
    /// In place of `angle`: the angle at which a contact line begins to advance.
    #[serde(default, with = "Maybe::<Angle>")]
    #[schemars(extend("minimum" = 0.0, "maximum" = 180.0))]
    pub advancing: Option<f64>,
    /// With `advancing`: the angle at which a contact line begins to recede.
    #[serde(default, with = "Maybe::<Angle>")]
    #[schemars(extend("minimum" = 0.0, "maximum" = 180.0))]
    pub receding: Option<f64>,
}

/// L1, L2, L3 of Xie et al. 2007, Section 2.5, in spacings.
const LAYERS: [f64; 3] = [2.1, 4.1, 4.1];

impl ContactAngle {
    fn of(wetting: &Wetting) -> ContactAngle {
        let angles = wetting.hysteresis;
        ContactAngle {
            angle: angles.is_none().then_some(wetting.angle),
            form: match wetting.layers {
                None => WettingForm::Young,
                Some(_) => WettingForm::ParticleTypes,
            },
            layers: wetting.layers,
            advancing: angles.map(|[advancing, _]| advancing),
            receding: angles.map(|[_, receding]| receding),
        }
    }

    fn wetting(&self, tree: &Tree<'_>) -> Result<Wetting, SceneError> {
        let wetting = match (self.angle, self.advancing, self.receding) {
            (Some(angle), None, None) => Wetting::of(angle),
            (None, Some(advancing), Some(receding)) if receding <= advancing => {
                Wetting::between([advancing, receding])
            }
            (None, Some(_), Some(_)) => {
                let remedy = "exchange the two angles";
                let key = "effects.wetting.receding";
                return Err(tree.fault(key, "is above the advancing angle", remedy));
            }
            _ => {
                let remedy = "give `angle` alone, or `advancing` and `receding`";
                let problem = "needs one contact angle or two";
                return Err(tree.fault("effects.wetting", problem, remedy));
            }
        };
        let layers = match (self.form, self.layers) {
            (WettingForm::Young, None) => None,
            (WettingForm::Young, Some(_)) => {
                let remedy = "remove it, or set `form = \"particle-types\"`";
                let problem = "has no effect with Young's force";
                return Err(tree.fault("effects.wetting.layers", problem, remedy));
            }
            (WettingForm::ParticleTypes, layers) => Some(layers.unwrap_or(LAYERS)),
        };
        Ok(Wetting { layers, ..wetting })
    }
}
