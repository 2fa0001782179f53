//! `[method]`: the solver and its settings.
//!
//! A preset supplies the settings that a scene leaves out: see [`super::preset`].

mod isph;
mod mps;
mod projection;
mod sph;
mod wcsph;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::ViscosityForm;

pub use isph::{Closure, Gradient, Isph};
pub use mps::{Mps, MpsClosure, MpsGradient, MpsPressure};
pub use projection::{PoissonSource, Preconditioner, Projection};
pub use sph::{KernelName, Mass, Sph};
pub use wcsph::{
    Density, Pressure, SoundSpeed, SpeedOf, TensionIn, TimeStepping, WallPressure, Wcsph,
};

/// The solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Weakly compressible SPH (Nishio et al. 2010).
    #[default]
    Wcsph,
    /// Incompressible SPH (Kuri et al.).
    Isph,
    /// Moving particle semi-implicit (Xie et al. 2007).
    Mps,
}

impl MethodName {
    /// Name in the scene file.
    pub fn word(self) -> &'static str {
        match self {
            MethodName::Wcsph => "wcsph",
            MethodName::Isph => "isph",
            MethodName::Mps => "mps",
        }
    }
}

/// Source of the settings that the scene does not give.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// As printed.
    Paper,
    /// As printed, with known errors removed.
    Corrected,
    /// As a specialist would compute today.
    #[default]
    Modern,
}

/// Precision of the pair sums: positions, separations, kernels and sums.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// f32 throughout.
    Single,
    /// Separations from exact differences of positions, the rest in f32.
    #[default]
    Mixed,
    /// f64; inputs and results of a sum are f32.
    Double,
}

/// How pairs are found and summed, in every method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct Pairs {
    /// Precision of the pair sums: f32 throughout, f32 from the exact separations on, or f64.
    pub precision: Precision,
    /// Extra reach of neighbour rows over the support, as a fraction of it: more makes rows longer,
    /// and the search less frequent.
    #[schemars(range(min = 0.02, max = 0.5))]
    pub slack: f64,
}

impl Default for Pairs {
    fn default() -> Self {
        Pairs {
            precision: Precision::Mixed,
            slack: 0.1,
        }
    }
}

/// The solver and its settings.
#[derive(Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(default)]
pub struct MethodTable {
    /// The solver.
    pub name: MethodName,
    /// As printed; with known errors removed; as a specialist would compute today.
    pub preset: Preset,
    #[serde(flatten)]
    pub pairs: Pairs,
    /// Settings of WCSPH in place of the preset's.
    pub wcsph: Option<Wcsph>,
    /// Settings of ISPH in place of the preset's.
    pub isph: Option<Isph>,
    /// Settings of MPS in place of the preset's.
    pub mps: Option<Mps>,
}

/// The method and its settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Weakly compressible SPH.
    Wcsph(Wcsph),
    /// Incompressible SPH.
    Isph(Isph),
    /// Moving-particle semi-implicit method.
    Mps(Mps),
}

impl MethodTable {
    /// The named method, if its settings are complete.
    pub fn method(&self) -> Option<Method> {
        match self.name {
            MethodName::Wcsph => self.wcsph.clone().map(Method::Wcsph),
            MethodName::Isph => self.isph.clone().map(Method::Isph),
            MethodName::Mps => self.mps.clone().map(Method::Mps),
        }
    }
}

impl Method {
    /// Its name.
    pub fn word(&self) -> MethodName {
        match self {
            Method::Wcsph(_) => MethodName::Wcsph,
            Method::Isph(_) => MethodName::Isph,
            Method::Mps(_) => MethodName::Mps,
        }
    }

    /// Its name in a scene file.
    pub fn name(&self) -> &'static str {
        self.word().word()
    }

    /// Kernel, smoothing and mass.
    pub fn sph(&self) -> Sph {
        match self {
            Method::Wcsph(settings) => settings.sph,
            Method::Isph(settings) => settings.sph,
            Method::Mps(settings) => settings.sph(),
        }
    }

    /// The settings of a projection method.
    pub fn projection(&self) -> Option<&Projection> {
        match self {
            Method::Wcsph(_) => None,
            Method::Isph(settings) => Some(&settings.projection),
            Method::Mps(settings) => Some(&settings.projection),
        }
    }

    /// Strength of particle shifting, which single-rate steps of WCSPH do not have; 0 turns it off.
    pub fn shifting(&self) -> f64 {
        match self {
            Method::Wcsph(settings) if !settings.time_stepping.is_dual() => 0.0,
            Method::Wcsph(settings) => settings.shifting,
            Method::Isph(settings) => settings.projection.shifting,
            Method::Mps(settings) => settings.projection.shifting,
        }
    }

    /// By what the limit 0.125 h^2 / nu of a step is divided for a viscous form in `space`
    /// dimensions. The form of MPS has a radius of its own; `has_rings`: where it has not.
    pub fn stiffness(&self, form: ViscosityForm, space: usize, has_rings: bool) -> f64 {
        match self {
            Method::Wcsph(settings) if !settings.time_stepping.is_dual() => {
                form.single_rate_stiffness()
            }
            Method::Mps(settings) if !has_rings => {
                let wider = (settings.radius / settings.laplacian_radius).max(1.0);
                form.stiffness(space) * wider.powi(2)
            }
            _ => form.stiffness(space),
        }
    }

    /// H / h of the normals that shifting needs where there is no tension: as wide as the tension
    /// of preset `modern`.
    pub fn normals(&self) -> f64 {
        match self {
            Method::Wcsph(_) | Method::Isph(_) => 1.75,
            Method::Mps(_) => 1.7,
        }
    }
}
