//! What every SPH method sets.

use super::{
    KernelName, Mass, Method, Scene, TensionForm, TensionStrength, ViscosityForm, Wetting,
    WettingForm,
};

/// Where the tension of the surface stress counts as sigma.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TensionLevel {
    /// At the depth at which the stress acts.
    Inside,
    /// At the surface of the liquid: carried there by the curvature.
    Surface,
}

/// What every SPH method sets: kernel, mass, and the forms of the effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sph {
    pub kernel: KernelName,
    /// h / s0.
    pub smoothing: f64,
    pub mass: Mass,
    pub viscosity_form: ViscosityForm,
    pub tension_form: TensionForm,
    pub tension_strength: TensionStrength,
    /// H / h of the long kernel.
    pub tension_smoothing: f64,
    pub tension_level: TensionLevel,
    pub wetting_form: WettingForm,
}

impl Sph {
    /// Whether the tension is carried to the surface: the raw colour alone knows how.
    pub fn lifts_tension(&self) -> bool {
        self.tension_level == TensionLevel::Surface && self.tension_form == TensionForm::RawColour
    }

    /// How far beside a particle its neighbours are counted, in 2 h (Xie et al., Eq. 14).
    fn beside(&self) -> f64 {
        match self.tension_form {
            TensionForm::NumberDensity => 0.5 / self.smoothing,
            _ => 0.0,
        }
    }
}

impl TensionForm {
    /// Whether the force is curvature times normal, and no divergence of a stress.
    pub fn is_counted(self) -> bool {
        matches!(
            self,
            TensionForm::NumberDensity | TensionForm::NumberDensityExact
        )
    }
}

impl Scene {
    /// sqrt(sigma / (rho H)), m/s, of a tension that derives from an energy: rho v^2 of it is what
    /// its layer may have to hold. At Mach 0.1 of it the layer gives way by 1 %.
    pub fn layer_speed(&self) -> f64 {
        let sph = self.method.sph();
        match (self.effects.tension, sph.tension_form) {
            (Some(tension), TensionForm::SurfaceEnergy) => {
                let length = sph.tension_smoothing * sph.smoothing * self.pack.spacing;
                (tension / (self.density * length)).sqrt()
            }
            _ => 0.0,
        }
    }

    /// Whether surfaces are followed into walls by sums that are sheared along them: for a stress,
    /// and for the angles that lines with hysteresis have.
    pub fn shears(&self, wetting: &Wetting) -> bool {
        let sph = self.method.sph();
        let has_energy = sph.tension_form == TensionForm::SurfaceEnergy;
        sph.wetting_form == WettingForm::Young && !(has_energy && wetting.hysteresis.is_none())
    }

    /// Support of the widest sum, m: of the tension, of the normals that shifting needs without it,
    /// or of the kernel.
    pub fn widest(&self) -> f64 {
        let sph = self.method.sph();
        let smoothing = sph.tension_smoothing.max(1.0);
        let wide = smoothing.max(sph.tension_smoothing + sph.beside());
        let over_kernel = match (self.effects.tension, self.effects.wetting) {
            (Some(_), Some(wetting)) if self.shears(&wetting) => smoothing * wetting.stretch(),
            (Some(_), _) => wide,
            _ if self.method.shifting() > 0.0 => smoothing,
            _ => 1.0,
        };
        2.0 * sph.smoothing * self.pack.spacing * over_kernel
    }
}

impl Method {
    /// Strength of particle shifting; 0 is none.
    pub fn shifting(&self) -> f64 {
        match self {
            Method::Wcsph(settings) => settings.shifting,
            Method::Isph(settings) => settings.projection.shifting,
            Method::Mps(settings) => settings.projection.shifting,
        }
    }
}
