//! Presets of ISPH.

use super::projection::{override_projection, projection_modern};
use super::{choose, override_effects, override_sph, sph_modern};
use crate::scene::cursor::Cursor;
use crate::scene::error::SceneError;
use crate::scene::{
    Closure, Gradient, Isph, KernelName, Mass, PoissonSource, Preconditioner, Projection, Sph,
    TensionForm, TensionLevel, TensionStrength, ViscosityForm, WettingForm,
};

/// Kuri, Yamaguchi, Kagawa, Nakajima & Fujimura, Simulations of droplet impact onto a liquid
/// surface using incompressible smoothed particle hydrodynamics method, as printed.
pub fn isph_paper() -> Isph {
    Isph {
        sph: Sph {
            kernel: KernelName::CubicSpline,         // Eq. 3
            smoothing: 1.3,                          // with Eq. 4
            mass: Mass::Nominal,                     // not given; the total is exact
            viscosity_form: ViscosityForm::Cleary,   // Eq. 1, zeta = 5 = d + 2 in 3-D
            tension_form: TensionForm::CahnHilliard, // Eqs. 5-7
            tension_strength: TensionStrength::Flat, // text after Eq. 6
            tension_smoothing: 2.5,                  // text after Eq. 4: H = 2.5 h
            tension_level: TensionLevel::Inside,
            wetting_form: WettingForm::Young,
        },
        projection: Projection {
            source: PoissonSource::Density,           // Eq. 8
            preconditioner: Preconditioner::Diagonal, // PCG, its preconditioner not given
            tolerance: 1e-6,                          // not given
            iterations: 2000,
            shifting: 0.0,
            theta: 1.0,     // Eq. 9
            courant: 0.1,   // law not given: speeds of 1.25 to 5 m/s span
            shortest: 5e-6, // the steps of Section 3 at d0 = 0.25 mm
            longest: 20e-6,
            cohesion: 0.0,
        },
        closure: Closure::Mirrored,    // Eq. 11
        gradient: Gradient::Symmetric, // Eq. 9
    }
}

/// The same method, its known errors removed.
pub fn isph_corrected() -> Isph {
    let paper = isph_paper();
    Isph {
        sph: Sph {
            tension_strength: TensionStrength::Virial, // kappa depends on the arrangement
            tension_smoothing: 2.0,                    // 2.5 h is the radius of the drop
            ..paper.sph
        },
        projection: Projection {
            // Asai et al. 2012: the whole deviation at once is 100-700 Pa of noise for 0.1 %.
            source: PoissonSource::Divergence { density: 0.01 },
            ..paper.projection
        },
        closure: Closure::Completed, // Nair & Tomar 2014, without flags that flicker
        ..paper
    }
}

/// Incompressible SPH with what has been learned since.
pub fn isph_modern() -> Isph {
    Isph {
        sph: sph_modern(),
        gradient: Gradient::Corrected, // Bonet & Lok 1999
        projection: projection_modern(isph_corrected().projection.source),
        ..isph_corrected()
    }
}

pub(super) fn isph(root: &Cursor<'_>) -> Result<Isph, SceneError> {
    let method = root.need("method")?;
    let mut settings = choose(&method, [isph_paper, isph_corrected, isph_modern])?;
    override_flow(&mut settings, &method.need("isph")?)?;
    let effects = root.need("effects")?;
    override_effects(&mut settings.sph, &effects)?;
    // Pressure forces have to do the work that their divergence sees.
    let own = method.need("isph")?;
    let has_energy = settings.sph.tension_form == TensionForm::SurfaceEnergy;
    if has_energy && effects.get("tension").is_some() && own.get("gradient").is_none() {
        settings.gradient = Gradient::Symmetric;
    }
    Ok(settings)
}

fn override_flow(settings: &mut Isph, table: &Cursor<'_>) -> Result<(), SceneError> {
    for (key, value) in table.entries() {
        if override_sph(&mut settings.sph, key, &value)?
            || override_projection(&mut settings.projection, key, &value)?
        {
            continue;
        }
        match key {
            "closure" => {
                settings.closure = match value.text()? {
                    "mirrored" => Closure::Mirrored,
                    _ => Closure::Completed,
                }
            }
            "gradient" => {
                settings.gradient = match value.text()? {
                    "symmetric" => Gradient::Symmetric,
                    _ => Gradient::Corrected,
                }
            }
            _ => return Err(value.fault("is not read by any method", "remove it")),
        }
    }
    Ok(())
}
