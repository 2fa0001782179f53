//! Presets of MPS.

use super::projection::{override_projection, projection_modern};
use super::{LAYERS, choose, override_effects, sph_modern};
use crate::scene::cursor::Cursor;
use crate::scene::error::SceneError;
use crate::scene::{
    Mps, MpsClosure, MpsGradient, PoissonSource, Preconditioner, Pressure, Projection, Sph,
    TensionForm, TensionStrength, WettingForm,
};

/// What serves Young's force, and MPS as it is today.
fn sph_young() -> Sph {
    Sph {
        tension_smoothing: 1.7, // H = 2.6 l0, as in the other methods
        ..sph_modern()
    }
}

/// Xie, Koshizuka & Oka 2007, Modeling the wetting effects in droplet impingement using particle
/// method, as printed.
pub fn mps_paper() -> Mps {
    let mps = Mps {
        sph: Sph {
            tension_form: TensionForm::NumberDensity,      // Eqs. 10-16
            tension_smoothing: 1.0,                        // r_e = 2 H = 3.1 l0
            tension_strength: TensionStrength::Fixed(1.0), // of one layer
            wetting_form: WettingForm::ParticleTypes(LAYERS), // Eq. 18
            ..sph_modern()
        },
        radius: 2.1,           // not given; usual
        laplacian_radius: 3.1, // not given; usual
        core: 0.0,
        beta: 0.97,                     // not given; Koshizuka & Oka 1996
        closure: MpsClosure::Threshold, // not described; Koshizuka & Oka 1996
        gradient: MpsGradient::Minimum, // Eq. 5 needs it: Koshizuka, Nobe & Oka 1998
        pressure: Pressure::Clipped,    // not described
        projection: Projection {
            source: PoissonSource::Density, // Eq. 8
            preconditioner: Preconditioner::Diagonal,
            tolerance: 1e-6, // not given
            iterations: 2000,
            shifting: 0.0,
            theta: 1.0,
            courant: 0.1, // not given
            shortest: 0.1e-6,
            longest: f64::INFINITY,
            cohesion: 0.0,
        },
    };
    mps.with_length()
}

/// The same method, its known errors removed.
pub fn mps_corrected() -> Mps {
    let paper = mps_paper();
    Mps {
        sph: Sph {
            tension_form: TensionForm::NumberDensityExact, // 2/3 of the curvature was missing
            tension_smoothing: 2.6,                        // r_e = 8.1 l0: counts are noise at 3.1
            wetting_form: WettingForm::Young,              // no film that cannot move
            ..paper.sph
        },
        // Nair & Tomar 2014, without flags: p = 0 where n is below beta, but for a moment, bursts a
        // splash once the source is no longer n alone.
        closure: MpsClosure::Completed,
        gradient: MpsGradient::Symmetric, // Tanaka & Masunaga 2010: Eq. 5 loses momentum
        projection: Projection {
            // Tanaka & Masunaga 2010: the whole deviation at once is noise of pressure.
            source: PoissonSource::Divergence { density: 0.01 },
            ..paper.projection
        },
        ..paper
    }
}

/// MPS with what has been learned since.
pub fn mps_modern() -> Mps {
    let corrected = mps_corrected();
    let mps = Mps {
        sph: sph_young(),
        radius: 3.1,
        core: 0.85, // below, two particles are pushed up to 4 times as far as Eq. 6 has it
        gradient: MpsGradient::Corrected, // Khayyer & Gotoh 2011; Tamai & Koshizuka 2014
        pressure: Pressure::Signed,
        projection: Projection {
            theta: 0.7, // 0.6 has eigenvalues down to -0.95: vortices of 80 spacings grow
            ..projection_modern(corrected.projection.source)
        },
        ..corrected
    };
    mps.with_length()
}

pub(super) fn mps(root: &Cursor<'_>) -> Result<Mps, SceneError> {
    let method = root.need("method")?;
    let mut settings = choose(&method, [mps_paper, mps_corrected, mps_modern])?;
    override_flow(&mut settings, &method.need("mps")?)?;
    let effects = root.need("effects")?;
    if let Some(form) = effects.get("viscosity").and_then(|table| table.get("form")) {
        return Err(form.fault("is not read by mps, which has Eq. 9", "remove it"));
    }
    let sph = &mut settings.sph;
    if effects.get("wetting").is_some() && sph.wetting_form == WettingForm::Young {
        // Young's force is made for that stress.
        *sph = sph_young();
    }
    override_effects(sph, &effects)?;
    Ok(settings.with_length())
}

fn override_flow(settings: &mut Mps, table: &Cursor<'_>) -> Result<(), SceneError> {
    for (key, value) in table.entries() {
        if override_projection(&mut settings.projection, key, &value)? {
            continue;
        }
        match key {
            "radius" => settings.radius = value.number()?,
            "laplacian_radius" => settings.laplacian_radius = value.number()?,
            "core" => settings.core = value.number()?,
            "beta" => settings.beta = value.number()?,
            "closure" => {
                settings.closure = match value.text()? {
                    "threshold" => MpsClosure::Threshold,
                    _ => MpsClosure::Completed,
                }
            }
            "gradient" => {
                settings.gradient = match value.text()? {
                    "minimum" => MpsGradient::Minimum,
                    "symmetric" => MpsGradient::Symmetric,
                    "blended" => MpsGradient::Blended,
                    _ => MpsGradient::Corrected,
                }
            }
            "pressure" => {
                settings.pressure = match value.text()? {
                    "clipped" => Pressure::Clipped,
                    _ => Pressure::Signed,
                }
            }
            _ => return Err(value.fault("is not read by any method", "remove it")),
        }
    }
    Ok(())
}
