//! Requirements of the forms of tension and contact angle.

use super::super::error::SceneError;
use super::super::tree::Tree;
use super::super::{
    Density, Dimension, Gradient, KernelName, Method, MpsGradient, Pressure, Scene,
};
use super::super::{TensionForm, WallPressure};

pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    wetting(scene, tree)?;
    surface_energy(scene, tree)
}

/// Contact angles need surface tension, a wall, and a stress that includes walls.
fn wetting(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let Some(wetting) = scene.effects.wetting else {
        return Ok(());
    };
    let key = "effects.wetting";
    let (problem, remedy) = if scene.effects.tension.is_none() {
        ("needs surface tension", "add the table [effects.tension]")
    } else if !scene.has_wall() {
        let remedy = "make a side of the box a wall, as in `box.z = [\"wall\", \"open\"]`";
        ("needs a wall", remedy)
    } else if wetting.layers.is_some() {
        return typed(scene, tree);
    } else if ![TensionForm::RawColour, TensionForm::SurfaceEnergy]
        .into_iter()
        .any(|form| scene.effects.has_tension(form))
    {
        let remedy = "set `effects.tension.form` to `surface-energy` or `raw-colour`, one of which \
                      preset `modern` has";
        (
            "needs the surface-energy or raw-colour form of the tension",
            remedy,
        )
    } else {
        return Ok(());
    };
    Err(tree.fault(key, problem, remedy))
}

/// The energy form needs dual stepping, a density that follows from its rate, Wendland's kernel and
/// a pressure force that does the work of that rate.
fn surface_energy(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let sph = scene.method.sph();
    if !scene.effects.has_tension(TensionForm::SurfaceEnergy) {
        return Ok(());
    }
    let (problem, remedy) = match &scene.method {
        Method::Wcsph(settings) if !settings.time_stepping.is_dual() => {
            let remedy = "set `method.wcsph.time_stepping.dual`, as preset `modern` does";
            ("needs dual stepping", remedy)
        }
        Method::Wcsph(settings) if matches!(settings.density, Density::Summation) => {
            let remedy = "set `method.wcsph.density = { continuity = {} }`";
            ("needs a density that follows from its rate", remedy)
        }
        Method::Wcsph(settings) if settings.wall_pressure == WallPressure::Summation => {
            let remedy = "set `method.wcsph.wall_pressure = \"extrapolated\"`";
            ("needs walls without a density of their own", remedy)
        }
        Method::Wcsph(settings) if settings.pressure == Pressure::Controlled => {
            let remedy = "set `method.wcsph.pressure = \"signed\"`";
            ("needs one pressure for each particle", remedy)
        }
        Method::Isph(settings) if settings.gradient != Gradient::Transposed => {
            let remedy = "set `method.isph.gradient = \"transposed\"`";
            ("needs the transposed gradient of the pressure", remedy)
        }
        Method::Mps(settings) if settings.gradient != MpsGradient::Transposed => {
            let remedy = "set `method.mps.gradient = \"transposed\"`";
            ("needs the transposed gradient of the pressure", remedy)
        }
        _ if sph.kernel != KernelName::WendlandC2 => {
            let remedy = "set the kernel to `wendland-c2`, as preset `modern` does";
            ("needs Wendland's kernel", remedy)
        }
        _ => return Ok(()),
    };
    Err(tree.fault("effects.tension.form", problem, remedy))
}

/// Particle types exist in two dimensions, for a tension with a curvature.
fn typed(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let remedy = "set `effects.wetting.form = \"young\"`, as preset `modern` does";
    let key = "effects.wetting";
    if scene.dimension == Dimension::Three {
        let problem = "with particle types is for two dimensions";
        return Err(tree.fault(key, problem, remedy));
    }
    let tension = scene.effects.tension;
    if !tension.is_some_and(|tension| tension.form.is_counted()) {
        let problem = "with particle types needs a number-density form of the tension";
        return Err(tree.fault(key, problem, remedy));
    }
    Ok(())
}
