//! Settings of a method that do not go together: what was measured with them is no liquid.

use super::super::error::SceneError;
use super::super::tree::Tree;
use super::super::{Closure, Method, MpsClosure, MpsGradient, MpsPressure, Scene};

/// Least h / s0 that finds a free surface: at 1 a full support looks like one, at 1.1 a pool at
/// rest loses 3 % of its potential energy in 0.2 s.
const NARROWEST: f64 = 1.2;

/// Refuses what is unstable or has no effect.
pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let fault = |key: &str, problem: &str, remedy: &str| {
        let key = format!("method.{}.{key}", scene.method.name());
        Err(tree.fault(&key, problem, remedy))
    };
    let is_narrow = scene.method.sph().smoothing < NARROWEST;
    match &scene.method {
        Method::Wcsph(wcsph)
            if !wcsph.time_stepping.is_dual()
                && wcsph.shifting > 0.0
                && tree.get("method.wcsph.shifting").is_some() =>
        {
            let remedy = "set it to 0, or `time_stepping.dual`";
            fault("shifting", "has no effect with single-rate steps", remedy)
        }
        Method::Isph(isph) if isph.closure == Closure::Completed && is_narrow => {
            let remedy = "set it to 1.2 or above, as 1.5 of preset `modern`";
            fault("smoothing", "is too narrow to find a free surface", remedy)
        }
        Method::Mps(mps) if mps.closure == MpsClosure::Completed && is_narrow => {
            let remedy = "set it to 2.4 or above, as 3.1 of preset `modern`";
            fault(
                "laplacian_radius",
                "is too narrow to find a free surface",
                remedy,
            )
        }
        Method::Mps(mps)
            if mps.gradient == MpsGradient::Symmetric && mps.pressure == MpsPressure::Signed =>
        {
            let remedy = "set `pressure = \"clipped\"`, or `gradient = \"blended\"`";
            fault("gradient", "is unstable with negative pressure", remedy)
        }
        _ => Ok(()),
    }
}
