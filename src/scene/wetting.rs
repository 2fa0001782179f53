//! Contact angle on walls.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error::SceneError;
use super::schema::{by_preset, positive};
use super::tree::Tree;
use super::unit::{Angle, Maybe};

/// Smallest angle of the continued surface, degrees; the cosine of zero is 3 % larger.
const FLATTEST: f64 = 15.0;

/// Wetting of all walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wetting {
    /// Contact angle through the liquid, degrees; with hysteresis that of the mean cosine.
    pub angle: f64,
    /// Advancing and receding angle, degrees: between them a contact line rests.
    pub hysteresis: Option<[f64; 2]>,
    /// L1, L2 and L3 of the four types of particles of Xie Eq. 18, in spacings; `None`: Young's
    /// force.
    pub layers: Option<[f64; 3]>,
}

impl Wetting {
    /// One angle in both directions of the contact line, degrees, by Young's force.
    pub fn of(angle: f64) -> Self {
        Wetting {
            angle,
            hysteresis: None,
            layers: None,
        }
    }

    /// Advancing and receding angle, degrees, by Young's force.
    pub fn between(angles: [f64; 2]) -> Self {
        let [advancing, receding] = cosines(angles);
        Wetting {
            angle: (0.5 * (advancing + receding)).acos().to_degrees(),
            hysteresis: Some(angles),
            layers: None,
        }
    }

    /// The angle at which a contact line advances, degrees.
    pub fn advancing(&self) -> f64 {
        self.hysteresis
            .map_or(self.angle, |[advancing, _]| advancing)
    }

    /// Half the difference of the cosines of receding and advancing angle: the friction of a
    /// contact line over the tension.
    pub fn friction(&self) -> f64 {
        let [advancing, receding] = self.cosines();
        0.5 * (receding - advancing)
    }

    /// Advancing and receding angle; equal without hysteresis.
    pub fn cosines(&self) -> [f64; 2] {
        cosines(self.hysteresis.unwrap_or([self.angle; 2]))
    }

    /// cot(angle) of the surface that is continued into the wall at `angle`, degrees, at least
    /// [`FLATTEST`] from it: a smaller angle would continue it for many kernels. Young's force uses
    /// the angle itself.
    pub fn cotangent(angle: f64) -> f64 {
        let angle = angle.clamp(FLATTEST, 180.0 - FLATTEST);
        let (sine, cosine) = angle.to_radians().sin_cos();
        cosine / sine
    }

    /// The largest |cot| of the angles of a contact line.
    pub fn steepest(&self) -> f64 {
        let angles = self.hysteresis.unwrap_or([self.angle; 2]);
        let [advancing, receding] = angles.map(|angle| Self::cotangent(angle).abs());
        advancing.max(receding)
    }

    /// Largest ratio of a distance to its image under a shear by the largest |cot|: the shear's
    /// larger principal stretch, (|k| + sqrt(k^2 + 4)) / 2.
    pub fn stretch(&self) -> f64 {
        let shear = self.steepest();
        0.5 * (shear + (shear * shear + 4.0).sqrt())
    }
}

/// Of two angles in degrees.
fn cosines(angles: [f64; 2]) -> [f64; 2] {
    angles.map(|angle| angle.to_radians().cos())
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
    /// The canonical form.
    pub(super) fn of(wetting: &Wetting) -> ContactAngle {
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

    /// # Errors
    /// Angles or layers that contradict each other.
    pub(super) fn wetting(&self, tree: &Tree<'_>) -> Result<Wetting, SceneError> {
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
