//! What forms of the tension and contact angles need.

use super::super::cursor::Cursor;
use super::super::error::SceneError;
use super::super::{
    Dimension, Gradient, KernelName, Method, Scene, Side, TensionForm, TimeStepping, WettingForm,
};

pub fn check(scene: &Scene, root: &Cursor<'_>) -> Result<(), SceneError> {
    wetting(scene, root)?;
    surface_energy(scene, root)
}

/// Contact angles need a surface with tension, a wall, and a stress that knows walls.
fn wetting(scene: &Scene, root: &Cursor<'_>) -> Result<(), SceneError> {
    if scene.effects.wetting.is_none() {
        return Ok(());
    }
    let place = root.nearest("effects.wetting");
    let mut sides = scene.domain.boundary.iter().flatten();
    let (problem, remedy) = if scene.effects.tension.is_none() {
        ("needs surface tension", "add the table [effects.tension]")
    } else if !sides.any(|side| *side == Side::Wall) {
        let remedy = "make a side of the box a wall, as in `box.z = [\"wall\", \"open\"]`";
        ("needs a wall", remedy)
    } else if scene.method.sph().wetting_form != WettingForm::Young {
        return typed(scene, &place);
    } else if !matches!(
        scene.method.sph().tension_form,
        TensionForm::RawColour | TensionForm::SurfaceEnergy
    ) {
        let remedy = "set `effects.tension.form` to `surface-energy` or `raw-colour`, one of which \
                      preset `modern` has";
        (
            "needs the surface-energy or raw-colour form of the tension",
            remedy,
        )
    } else {
        return Ok(());
    };
    Err(place.fault(problem, remedy))
}

/// The energy form needs steps, a kernel and pressure forces that do not work against it.
fn surface_energy(scene: &Scene, root: &Cursor<'_>) -> Result<(), SceneError> {
    let sph = scene.method.sph();
    if scene.effects.tension.is_none() || sph.tension_form != TensionForm::SurfaceEnergy {
        return Ok(());
    }
    let form = root.nearest("effects.tension.form");
    let (problem, remedy) = match &scene.method {
        Method::Wcsph(settings) if !matches!(settings.time_stepping, TimeStepping::Dual { .. }) => {
            let remedy = "set `method.wcsph.time_stepping.dual`, as preset `modern` does";
            ("needs dual stepping", remedy)
        }
        Method::Isph(settings) if settings.gradient != Gradient::Symmetric => {
            let remedy = "set `method.isph.gradient = \"symmetric\"`";
            ("needs the symmetric gradient of the pressure", remedy)
        }
        Method::Mps(_) => {
            let remedy = "leave the form out, or set `method.name` to `wcsph` or `isph`";
            ("is not there for method `mps`", remedy)
        }
        _ if sph.kernel != KernelName::WendlandC2 => {
            let remedy = "set the kernel to `wendland-c2`, as preset `modern` does";
            ("needs the kernel of Wendland", remedy)
        }
        _ => return Ok(()),
    };
    Err(form.fault(problem, remedy))
}

/// Types of particles know a plane and a curvature.
fn typed(scene: &Scene, place: &Cursor<'_>) -> Result<(), SceneError> {
    let remedy = "set `effects.wetting.form = \"young\"`, as preset `modern` does";
    if scene.dimension == Dimension::Three {
        return Err(place.fault("by types of particles is for two dimensions", remedy));
    }
    if !scene.method.sph().tension_form.is_counted() {
        let problem = "by types of particles needs a number-density form of the tension";
        return Err(place.fault(problem, remedy));
    }
    Ok(())
}
