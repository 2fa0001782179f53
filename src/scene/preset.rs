//! Presets of the methods: each gathers the deviations from a paper as named settings.
//!
//! `paper` is what is printed, `corrected` the same method with its known errors removed, `modern`
//! what a specialist would run today. A scene overrides single settings of its preset.

use super::cursor::Cursor;
use super::error::SceneError;
use super::quantity::Unit;
use super::{
    Density, KernelName, Mass, Method, Pairs, Precision, Pressure, SoundSpeed, Sph, TensionForm,
    TensionLevel, TensionStrength, TimeStepping, ViscosityForm, WallPressure, Wcsph, WettingForm,
};
pub use isph::{isph_corrected, isph_modern, isph_paper};
pub use mps::{mps_corrected, mps_modern, mps_paper};

mod isph;
mod mps;
mod projection;

/// Nishio et al. 2010, Int. J. Numer. Meth. Fluids 63, 1435-1447, as printed.
pub fn wcsph_paper() -> Wcsph {
    Wcsph {
        sph: Sph {
            kernel: KernelName::CubicSpline,               // Eq. 3
            smoothing: 1.3,                                // with Eq. 3
            mass: Mass::Nominal, // rho0 s0^3; the lattice sum of Eq. 4 is 0.997 rho0
            viscosity_form: ViscosityForm::TwoTerm, // Eq. 6: 6/5 too viscous in 3-D, 5/4 in 2-D
            tension_form: TensionForm::NormalisedColour, // Eqs. 9-13
            tension_strength: TensionStrength::Fixed(4.5), // with Eq. 10
            tension_smoothing: 1.5, // with Eq. 4: H = 1.5 h
            tension_level: TensionLevel::Inside,
            wetting_form: WettingForm::Young,
        },
        density: Density::Summation, // Eq. 4
        pressure: Pressure::Clipped, // text after Eq. 7
        exponent: 7.0,               // Eq. 7
        sound_speed_factor: 10.0,    // Eq. 8
        sound_speed: SoundSpeed::Constant,
        reference_speed: None, // Eq. 8 leaves V open: U0 whenever that is the largest
        wall_pressure: WallPressure::Summation, // not described; walls take part in every sum
        shifting: 0.0,
        time_stepping: TimeStepping::Fixed { step: 1e-6 }, // Section 2
    }
}

/// The same method, its known errors removed.
pub fn wcsph_corrected() -> Wcsph {
    let paper = wcsph_paper();
    Wcsph {
        sph: Sph {
            mass: Mass::LatticeSum,                      // a lattice has the density rho0
            viscosity_form: ViscosityForm::TwoTermExact, // (d+2)/(d+3) of Eq. 6
            tension_strength: TensionStrength::Virial,   // alpha depends on the arrangement
            ..paper.sph
        },
        time_stepping: TimeStepping::Adaptive {
            safety: 1.0,
            holds: false,
        },
        ..paper
    }
}

/// What SPH is today, whatever gives the pressure.
fn sph_modern() -> Sph {
    Sph {
        kernel: KernelName::WendlandC2,        // no pairing: Dehnen & Aly 2012
        smoothing: 1.5, // on a lattice SUM V x . grad W is then 1 within 0.3 %; at 1.3 it is 0.976
        mass: Mass::Nominal, // neither continuity nor divergence see the lattice sum
        viscosity_form: ViscosityForm::Morris, // Morris, Fox & Zhu 1997
        tension_form: TensionForm::RawColour, // depends little on the arrangement
        tension_strength: TensionStrength::Virial,
        tension_smoothing: 1.75, // a static drop keeps currents of Ca 0.002, with 1.3 h 0.03
        tension_level: TensionLevel::Surface, // a drop of R = 20 s0: else +16 %
        wetting_form: WettingForm::Young, // Huber et al. 2016
    }
}

/// Delta-SPH with what has been learned since.
pub fn wcsph_modern() -> Wcsph {
    Wcsph {
        sph: Sph {
            tension_form: TensionForm::SurfaceEnergy, // its force is a derivative: no boiling
            ..sph_modern()
        },
        density: Density::Continuity {
            diffusion: 0.1,  // Antuono et al. 2010
            compaction: 1.1, // disorder of a splash reaches 1.08; a clump at a contact line 3
        },
        pressure: Pressure::Tearing, // signed, a splash lost a fifth of its energy to its sheets
        exponent: 1.0,               // linear: densities stay within 1 % of rho0
        sound_speed_factor: 10.0,
        sound_speed: SoundSpeed::Adaptive, // Mach 0.1 of what moves now
        reference_speed: None,
        wall_pressure: WallPressure::Extrapolated, // Adami, Hu & Adams 2012
        shifting: 4.0, // Taylor-Green: 2 leaves 8 % of excess decay, 4 leaves 3 %
        time_stepping: TimeStepping::Dual {
            advective: 0.25,
            acoustic: 0.6,
        }, // Zhang, Rezavand & Hu 2020
    }
}

/// The method of a scene: its preset, with the overrides of its table and of the effects' tables.
pub fn method(root: &Cursor<'_>) -> Result<Method, SceneError> {
    let method = root.need("method")?;
    Ok(match method.text_at("name")? {
        "isph" => Method::Isph(isph::isph(root)?),
        "mps" => Method::Mps(mps::mps(root)?),
        _ => Method::Wcsph(wcsph(root)?),
    })
}

/// What `[method]` says whatever the method is.
pub fn pairs(method: &Cursor<'_>) -> Result<Pairs, SceneError> {
    Ok(Pairs {
        precision: match method.text_at("precision")? {
            "single" => Precision::Single,
            "double" => Precision::Double,
            _ => Precision::Mixed,
        },
        slack: method.number_at("slack")?,
    })
}

/// One of three presets by the word in `[method]`.
fn choose<T>(method: &Cursor<'_>, presets: [fn() -> T; 3]) -> Result<T, SceneError> {
    let preset = method.need("preset")?;
    let words = ["paper", "corrected", "modern"];
    let text = preset.text()?;
    match words.iter().position(|word| *word == text) {
        Some(index) => Ok(presets[index]()),
        None => Err(preset.fault("is no preset", "use paper, corrected or modern")),
    }
}

fn wcsph(root: &Cursor<'_>) -> Result<Wcsph, SceneError> {
    let method = root.need("method")?;
    let mut settings = choose(&method, [wcsph_paper, wcsph_corrected, wcsph_modern])?;
    override_flow(&mut settings, &method.need("wcsph")?)?;
    let effects = root.need("effects")?;
    override_effects(&mut settings.sph, &effects)?;
    // Another form where that of `modern` is not served.
    let dual = matches!(settings.time_stepping, TimeStepping::Dual { .. });
    let served = dual && settings.sph.kernel == KernelName::WendlandC2;
    let form = effects
        .get("tension")
        .and_then(|tension| tension.get("form"));
    if settings.sph.tension_form == TensionForm::SurfaceEnergy && form.is_none() && !served {
        settings.sph.tension_form = TensionForm::RawColour;
    }
    Ok(settings)
}

/// A setting that every SPH method has; false if `key` is none.
fn override_sph(settings: &mut Sph, key: &str, value: &Cursor<'_>) -> Result<bool, SceneError> {
    match key {
        "kernel" => {
            settings.kernel = match value.text()? {
                "cubic-spline" => KernelName::CubicSpline,
                _ => KernelName::WendlandC2,
            }
        }
        "smoothing" => settings.smoothing = value.number()?,
        "mass" => {
            settings.mass = match value.text()? {
                "nominal" => Mass::Nominal,
                _ => Mass::LatticeSum,
            }
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn override_flow(settings: &mut Wcsph, table: &Cursor<'_>) -> Result<(), SceneError> {
    for (key, value) in table.entries() {
        if override_sph(&mut settings.sph, key, &value)? {
            continue;
        }
        match key {
            "density" => settings.density = density(&value)?,
            "pressure" => {
                settings.pressure = match value.text()? {
                    "clipped" => Pressure::Clipped,
                    "controlled" => Pressure::Controlled,
                    "tearing" => Pressure::Tearing,
                    _ => Pressure::Signed,
                }
            }
            "exponent" => settings.exponent = value.number()?,
            "sound_speed_factor" => settings.sound_speed_factor = value.number()?,
            "sound_speed" => {
                settings.sound_speed = match value.text()? {
                    "adaptive" => SoundSpeed::Adaptive,
                    _ => SoundSpeed::Constant,
                }
            }
            "reference_speed" => {
                settings.reference_speed = match value.text() {
                    Ok("scene") => None,
                    _ => Some(value.quantity(Unit::Speed)?),
                }
            }
            "wall_pressure" => {
                settings.wall_pressure = match value.text()? {
                    "summation" => WallPressure::Summation,
                    _ => WallPressure::Extrapolated,
                }
            }
            "shifting" => settings.shifting = value.number()?,
            "time_stepping" => settings.time_stepping = stepping(&value)?,
            _ => return Err(value.fault("is not read by any method", "remove it")),
        }
    }
    Ok(())
}

fn density(value: &Cursor<'_>) -> Result<Density, SceneError> {
    match value.get("continuity") {
        Some(continuity) => {
            let compaction = continuity.need("compaction")?;
            Ok(Density::Continuity {
                diffusion: continuity.number_at("diffusion")?,
                compaction: match compaction.text() {
                    Ok(_) => f64::INFINITY,
                    Err(_) => compaction.number()?,
                },
            })
        }
        None => Ok(Density::Summation),
    }
}

fn stepping(value: &Cursor<'_>) -> Result<TimeStepping, SceneError> {
    if let Some(fixed) = value.get("fixed") {
        let step = fixed.quantity_at("step", Unit::Time)?;
        return Ok(TimeStepping::Fixed { step });
    }
    if let Some(adaptive) = value.get("adaptive") {
        let safety = adaptive.number_at("safety")?;
        let holds = adaptive.text_at("tension")? == "held";
        return Ok(TimeStepping::Adaptive { safety, holds });
    }
    let dual = value.need("dual")?;
    Ok(TimeStepping::Dual {
        advective: dual.number_at("advective")?,
        acoustic: dual.number_at("acoustic")?,
    })
}

fn override_effects(settings: &mut Sph, effects: &Cursor<'_>) -> Result<(), SceneError> {
    if let Some(form) = effects.get("viscosity").and_then(|table| table.get("form")) {
        settings.viscosity_form = match form.text()? {
            "two-term" => ViscosityForm::TwoTerm,
            "two-term-exact" => ViscosityForm::TwoTermExact,
            "cleary" => ViscosityForm::Cleary,
            _ => ViscosityForm::Morris,
        };
    }
    if let Some(wetting) = effects.get("wetting") {
        override_wetting(&mut settings.wetting_form, &wetting)?;
    }
    let Some(tension) = effects.get("tension") else {
        return Ok(());
    };
    if let Some(form) = tension.get("form") {
        settings.tension_form = match form.text()? {
            "normalised-colour" => TensionForm::NormalisedColour,
            "surface-energy" => TensionForm::SurfaceEnergy,
            "cahn-hilliard" => TensionForm::CahnHilliard,
            "number-density" => TensionForm::NumberDensity,
            "number-density-exact" => TensionForm::NumberDensityExact,
            _ => TensionForm::RawColour,
        };
    }
    if let Some(strength) = tension.get("strength") {
        settings.tension_strength = match strength.text() {
            Ok("flat") => TensionStrength::Flat,
            Ok(_) => TensionStrength::Virial,
            Err(_) => TensionStrength::Fixed(strength.number()?),
        };
    }
    if let Some(smoothing) = tension.get("smoothing") {
        settings.tension_smoothing = smoothing.number()?;
    }
    if let Some(level) = tension.get("level") {
        settings.tension_level = match level.text()? {
            "inside" => TensionLevel::Inside,
            _ => TensionLevel::Surface,
        };
    }
    Ok(())
}

/// L1, L2, L3 of Xie et al. 2007, Section 2.5, in spacings.
const LAYERS: [f64; 3] = [2.1, 4.1, 4.1];

fn override_wetting(form: &mut WettingForm, wetting: &Cursor<'_>) -> Result<(), SceneError> {
    if let Some(word) = wetting.get("form") {
        *form = match word.text()? {
            "particle-types" => WettingForm::ParticleTypes(LAYERS),
            _ => WettingForm::Young,
        };
    }
    match (wetting.get("layers"), form) {
        (None, _) => Ok(()),
        (Some(given), WettingForm::ParticleTypes(layers)) => {
            for (layer, value) in layers.iter_mut().zip(given.items()) {
                *layer = value.number()?;
            }
            Ok(())
        }
        (Some(given), _) => {
            let remedy = "remove it, or set `form = \"particle-types\"`";
            Err(given.fault("is of no use to Young's force", remedy))
        }
    }
}
