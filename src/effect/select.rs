//! The only place where a scene becomes types. An absent effect becomes `()` or `None`.

use super::Effect;
use super::active::ActiveEffects;
use super::gravity::Gravity;
use super::tension::Tension;
use super::tension::shore::Shore;
use super::vibration::Vibration;
use super::viscosity::{Central, Cleary, Morris, Newtonian, PairViscosity, TwoTerm};
use super::wetting::typed::Typed;
use super::wetting::{Setting, Wetting};
use crate::kernel::{self, CubicSpline, Kernel, WendlandC2};
use crate::scene::{Dimension, Domain, Effects, KernelName, Sph, TensionForm, ViscosityForm};

/// What is done with the chosen types.
pub trait Visitor {
    /// What the visit returns.
    type Out;
    /// Takes the chosen kernel and viscosity; `()` for none.
    fn visit<K: Kernel, V: PairViscosity>(self, viscosity: V) -> Self::Out;
}

/// Calls `visitor` with the kernel and the viscosity that the scene requires. `h` in m.
pub fn pair<R: Visitor>(
    effects: &Effects,
    settings: &Sph,
    dimension: usize,
    h: f64,
    visitor: R,
) -> R::Out {
    match settings.kernel {
        KernelName::CubicSpline => viscosity::<CubicSpline, R>(effects, dimension, h, visitor),
        KernelName::WendlandC2 => viscosity::<WendlandC2, R>(effects, dimension, h, visitor),
    }
}

fn viscosity<K: Kernel, R: Visitor>(
    effects: &Effects,
    dimension: usize,
    h: f64,
    visitor: R,
) -> R::Out {
    let Some(viscosity) = effects.viscosity else {
        return visitor.visit::<K, ()>(());
    };
    let factor = (viscosity.dynamic / h) as f32;
    // (d+2)/(d+3): see `super::viscosity` (1).
    let exact = (dimension as f32 + 2.0) / (dimension as f32 + 3.0);
    match viscosity.form {
        ViscosityForm::Morris => visitor.visit::<K, _>(Morris { factor }),
        ViscosityForm::TwoTerm => visitor.visit::<K, _>(TwoTerm { factor }),
        ViscosityForm::Cleary => visitor.visit::<K, _>(Cleary {
            factor: (dimension as f32 + 2.0) * factor,
        }),
        ViscosityForm::Central => {
            visitor.visit::<K, _>(Central::of::<K>(dimension, viscosity.dynamic / h))
        }
        ViscosityForm::TwoTermExact => visitor.visit::<K, _>(TwoTerm {
            factor: exact * factor,
        }),
    }
}

/// alpha of a flat interface, 1 / (H INT |grad phi|^2 dn) over the liquid's side: grad phi is the
/// kernel summed across the plane, W1, so alpha = 1 / (H INT_0^2H W1^2 dz) whatever H is.
pub fn flat_strength(settings: &Sph, dimension: usize) -> f64 {
    const CELLS: usize = 400;
    let step = 2.0 / CELLS as f64;
    let square = |k: usize| {
        let z = (k as f64 + 0.5) * step;
        kernel::plane(settings.kernel, dimension, z).powi(2) * step
    };
    1.0 / (0..CELLS).map(square).sum::<f64>()
}

/// The effects of a scene as a solver calls them; `stiff`: [`Problem::stiff_viscosity`], Pa s;
/// `tension`: that of [`tension`], or normals.
///
/// [`Problem::stiff_viscosity`]: crate::scene::Problem::stiff_viscosity
pub fn active(effects: &Effects, stiff: Option<f64>, tension: Option<Tension>) -> ActiveEffects {
    let mut others: Vec<Box<dyn Effect>> = Vec::new();
    if let Some(gravity) = effects.gravity {
        others.push(Box::new(Gravity(gravity)));
    }
    if let Some(stiff) = stiff {
        others.push(Box::new(Newtonian { stiff }));
    }
    if let Some(vibration) = effects.vibration {
        others.push(Box::new(Vibration {
            amplitude: vibration.amplitude,
            frequency: vibration.frequency,
        }));
    }
    ActiveEffects {
        others,
        tension,
        ..ActiveEffects::default()
    }
}

/// The tension that the scene requires, with strength `alpha`. `h` in m, `density` in kg/m^3.
pub fn tension(
    effects: &Effects,
    settings: &Sph,
    dimension: usize,
    h: f64,
    density: f64,
    alpha: f64,
) -> Option<Tension> {
    let asked = effects.tension?;
    let mut tension = Tension::new(
        asked.form,
        settings.kernel,
        [asked.smoothing * h, h],
        asked.coefficient,
        alpha,
        dimension,
        density,
    );
    tension.lifted = asked.is_lifted();
    Some(tension)
}

/// The contact angle that the scene requires. `spacing` and `length` (H) in m, `density` in kg/m^3.
pub fn wetting(
    effects: &Effects,
    settings: &Sph,
    domain: &Domain,
    dimension: usize,
    [spacing, length]: [f64; 2],
    density: f64,
) -> Option<Wetting> {
    let angle = effects.wetting?;
    // Without hysteresis the energy of walls does it all.
    let energetic = effects.has_tension(TensionForm::SurfaceEnergy);
    let needless = energetic && angle.hysteresis.is_none();
    if angle.layers.is_some() || needless {
        return None;
    }
    let setting = Setting {
        angle,
        domain: domain.clone(),
        kernel: settings.kernel,
        dimension,
        spacing,
        length,
        density,
    };
    Some(Wetting::new(setting))
}

/// The same for a tension that is the derivative of an energy.
pub fn shore(
    effects: &Effects,
    domain: &Domain,
    dimension: Dimension,
    spacing: f64,
) -> Option<Shore> {
    let angle = effects.wetting?.angle.to_radians();
    let is = effects.has_tension(TensionForm::SurfaceEnergy);
    is.then(|| Shore::new(angle.cos(), domain.clone(), dimension, spacing))
}

/// The same by types of particles. `spacing` in m.
pub fn typed(effects: &Effects, domain: &Domain, spacing: f64) -> Option<Typed> {
    let angle = effects.wetting?;
    Some(Typed {
        angle,
        domain: domain.clone(),
        lengths: angle.layers?.map(|length| length * spacing),
        here: Vec::new(),
    })
}
