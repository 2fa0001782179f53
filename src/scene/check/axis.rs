//! Requirements of a scene of revolution, whose particles are rings.

use super::super::error::SceneError;
use super::super::tree::Tree;
use super::super::{
    Closure, Density, Gradient, KernelName, Method, Motion, MpsClosure, MpsGradient, PoissonSource,
    Problem, Scene, TensionForm, ViscosityForm, WallPressure, Wcsph,
};

const KEY: &str = "box.symmetry";

pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    if !scene.domain.is_axial() {
        return Ok(());
    }
    let (problem, remedy) = match unfit(scene) {
        Some(fault) => fault,
        None => return Ok(()),
    };
    let problem = format!("\"axis\" {problem}");
    Err(tree.fault(KEY, &problem, &format!("{remedy}, or write \"quarter\"")))
}

/// What rings do not have, and a remedy.
fn unfit(scene: &Problem) -> Option<(&'static str, &'static str)> {
    let modern = "leave the settings of preset `modern` as they are";
    let spins = |motion: &Motion| matches!(motion, Motion::TaylorGreen { .. });
    let lacking = match &scene.method {
        Method::Wcsph(settings) => lacks_of_wcsph(settings),
        Method::Isph(settings) => lacks_of_projection(
            settings.gradient == Gradient::Transposed,
            settings.projection.source,
            settings.closure == Closure::Completed,
        ),
        Method::Mps(settings) => lacks_of_projection(
            settings.gradient == MpsGradient::Transposed,
            settings.projection.source,
            settings.closure == MpsClosure::Completed,
        ),
    };
    if let Some(lacking) = lacking {
        return Some((lacking, modern));
    }
    if scene.method.sph().kernel != KernelName::WendlandC2 {
        return Some(("needs the kernel `wendland-c2`", modern));
    }
    if scene.effects.tension.is_some() && !scene.effects.has_tension(TensionForm::SurfaceEnergy) {
        return Some(("needs the surface-energy form of the tension", modern));
    }
    let viscosity = scene.effects.viscosity;
    if viscosity.is_some_and(|viscosity| viscosity.form != ViscosityForm::Central) {
        return Some(("needs the viscosity `central`", modern));
    }
    let mut bodies = scene.bodies.iter();
    bodies
        .any(|body| spins(&body.motion))
        .then_some(("has no vortices", "remove `taylor_green`"))
}

/// What settings of WCSPH must have for rings and do not.
fn lacks_of_wcsph(settings: &Wcsph) -> Option<&'static str> {
    if !settings.time_stepping.is_dual() {
        return Some("needs dual stepping");
    }
    if matches!(settings.density, Density::Summation) {
        return Some("needs a density by its rate");
    }
    let is_extrapolated = settings.wall_pressure != WallPressure::Summation;
    (!is_extrapolated).then_some("needs the extrapolated pressure of walls")
}

/// The same of ISPH and MPS.
fn lacks_of_projection(
    is_transposed: bool,
    source: PoissonSource,
    is_completed: bool,
) -> Option<&'static str> {
    if !is_transposed {
        return Some("needs the gradient `transposed`");
    }
    if source == PoissonSource::Density {
        return Some("needs a divergence as the source of the pressure equation");
    }
    (!is_completed).then_some("needs the closure `completed`")
}
