//! `[effects]`: effects on the liquid. An absent table turns its effect off.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Dimension;
use super::error::SceneError;
use super::schema::{by_preset, positive};
use super::tree::Tree;
use super::unit::{self, Acceleration, Length, One, Rate, Vector};
use super::wetting::{ContactAngle, Wetting};

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
    /// Harmonic motion of the box.
    pub vibration: Option<Vibration>,
}

/// A harmonic motion of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Amplitude of the displacement, m.
    pub amplitude: [f64; 3],
    /// 1/s.
    pub frequency: f64,
}

impl Vibration {
    /// Amplitude of the acceleration, m/s^2.
    fn acceleration(&self) -> [f64; 3] {
        let square = (TAU * self.frequency).powi(2);
        self.amplitude.map(|amplitude| square * amplitude)
    }
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

    /// Effects on a relaxing body, in a box at rest; on a free body neither gravity nor walls.
    pub fn at_rest(&self, is_free: bool) -> Effects {
        let mut effects = self.clone();
        effects.vibration = None;
        if is_free {
            effects.gravity = None;
            effects.wetting = None;
        }
        effects
    }

    /// Extremes of the uniform acceleration of all particles, m/s^2; empty without one.
    pub fn body_forces(&self) -> Vec<[f64; 3]> {
        let Some(vibration) = &self.vibration else {
            return self.gravity.into_iter().collect();
        };
        let (g, a) = (self.gravity.unwrap_or_default(), vibration.acceleration());
        let extreme = |sign: f64| std::array::from_fn(|axis| g[axis] + sign * a[axis]);
        vec![extreme(-1.0), extreme(1.0)]
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
    /// A harmonic motion of the box.
    pub vibration: Option<Shaking>,
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
            vibration: effects.vibration.map(|vibration| Shaking {
                // The length is that of the direction; the vector says both.
                amplitude: 1.0,
                frequency: vibration.frequency,
                direction: Some(dimension.components(vibration.amplitude)),
            }),
        }
    }

    /// # Errors
    /// If a direction is zero or contact angles contradict each other.
    pub fn effects(&self, dimension: Dimension, tree: &Tree<'_>) -> Result<Effects, SceneError> {
        let gravity = self.gravity.as_ref();
        let wetting = self.wetting.as_ref();
        let vibration = self.vibration.as_ref();
        Ok(Effects {
            gravity: gravity.map(|g| g.vector(dimension, tree)).transpose()?,
            viscosity: self.viscosity,
            tension: self.tension,
            wetting: wetting.map(|angle| angle.wetting(tree)).transpose()?,
            vibration: vibration
                .map(|v| v.vibration(dimension, tree))
                .transpose()?,
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
        along(
            direction,
            self.acceleration,
            "effects.gravity.direction",
            dimension,
            tree,
        )
    }
}

/// A vector of this length along a direction.
fn along(
    direction: &Vector<One>,
    size: f64,
    key: &str,
    dimension: Dimension,
    tree: &Tree<'_>,
) -> Result<[f64; 3], SceneError> {
    let vector = dimension.vector(direction, key, tree)?;
    let largest = vector
        .iter()
        .fold(0.0, |most: f64, each| most.max(each.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return Err(tree.fault(key, "has no direction", "give a vector that is not zero"));
    }
    // A power of two changes no digit: squares of the parts are neither 0 nor infinite then.
    let power = 2f64.powi(largest.log2().floor().clamp(-1000.0, 1000.0) as i32);
    let vector = vector.map(|each| each / power);
    let length = vector.iter().map(|each| each * each).sum::<f64>().sqrt();
    // + 0.0 turns -0 into 0.
    Ok(vector.map(|each| size * (each / length) + 0.0))
}

/// A harmonic motion of the box: in it particles have the acceleration A omega^2 sin(omega t).
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Shaking {
    /// Amplitude A of the displacement.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub amplitude: f64,
    /// Cycles in a second, omega / (2 pi).
    #[serde(with = "Rate")]
    #[schemars(transform = positive)]
    pub frequency: f64,
    /// Direction, of any length; upward if left out.
    #[serde(default)]
    pub direction: Option<Vector<One>>,
}

impl Shaking {
    fn vibration(&self, dimension: Dimension, tree: &Tree<'_>) -> Result<Vibration, SceneError> {
        let key = "effects.vibration.direction";
        let amplitude = match &self.direction {
            None => [0.0, 0.0, self.amplitude],
            Some(direction) => along(direction, self.amplitude, key, dimension, tree)?,
        };
        let frequency = self.frequency;
        Ok(Vibration {
            amplitude,
            frequency,
        })
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
    /// Morris, Fox & Zhu 1997; with MPS, Xie Eq. 9: a free surface exerts a torque.
    Morris,
    /// Kuri Eq. 1 with zeta = d + 2: up to 11 % too weak along a lattice.
    Cleary,
    /// Along the line of each pair, with weights that no lattice sees: keeps angular momentum, and
    /// a free surface has no shear stress.
    Central,
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

impl ViscosityForm {
    /// By what the limit 0.125 h^2 / nu is divided in `space` dimensions, so that the largest
    /// eigenvalue of the form times the step is below 2, the limit of Euler's method.
    pub fn stiffness(self, space: usize) -> f64 {
        let d = space as f64;
        match self {
            ViscosityForm::Cleary => (d + 2.0) / d,
            _ => 1.0,
        }
    }

    /// The same below 1, the limit of velocity Verlet whose forces see velocities that are half a
    /// step old: 1.1 times the eigenvalues on lattices of any h / s0, at most
    /// 0.87, 1.06, 1.32, 2.23 and 1.84 at 0.125 h^2 / nu in the order of the forms below.
    pub fn single_rate_stiffness(self) -> f64 {
        match self {
            ViscosityForm::Morris => 1.0,
            ViscosityForm::TwoTermExact => 1.2,
            ViscosityForm::TwoTerm => 1.5,
            ViscosityForm::Cleary => 2.5,
            ViscosityForm::Central => 2.1,
        }
    }
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
