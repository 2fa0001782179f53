//! Requirements of a scene of revolution, whose particles are rings.

use super::super::error::SceneError;
use super::super::tree::Tree;
use super::super::{
    Density, KernelName, Method, Motion, Problem, Scene, TensionForm, ViscosityForm, WallPressure,
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
    let Method::Wcsph(settings) = &scene.method else {
        return Some(("is for wcsph", "set `method.name = \"wcsph\"`"));
    };
    let spins = |motion: &Motion| matches!(motion, Motion::TaylorGreen { .. });
    if !settings.time_stepping.is_dual() {
        return Some(("needs dual stepping", modern));
    }
    if matches!(settings.density, Density::Summation) {
        return Some(("needs a density by its rate", modern));
    }
    if settings.wall_pressure == WallPressure::Summation {
        return Some(("needs the extrapolated pressure of walls", modern));
    }
    if settings.sph.kernel != KernelName::WendlandC2 {
        return Some(("needs the kernel `wendland-c2`", modern));
    }
    if scene.effects.tension.is_some() && !scene.effects.has_tension(TensionForm::SurfaceEnergy) {
        return Some(("needs the surface-energy form of the tension", modern));
    }
    let viscosity = scene.effects.viscosity;
    if viscosity.is_some_and(|viscosity| viscosity.form != ViscosityForm::Morris) {
        return Some(("needs the viscosity `morris`", modern));
    }
    let mut bodies = scene.bodies.iter();
    bodies
        .any(|body| spins(&body.motion))
        .then_some(("has no vortices", "remove `taylor_green`"))
}
