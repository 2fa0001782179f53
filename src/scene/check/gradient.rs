//! Requirements of the gradient of the pressure.

use super::super::error::SceneError;
use super::super::tree::Tree;
use super::super::{
    Closure, Gradient, Method, MpsClosure, MpsGradient, MpsPressure, PoissonSource, Scene,
};

/// The equation of the transposed gradient has no other source and no other surface.
pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let (name, settings, fits) = match &scene.method {
        Method::Isph(isph) if isph.gradient == Gradient::Transposed => {
            ("isph", &isph.projection, isph.closure == Closure::Completed)
        }
        Method::Mps(mps) if mps.gradient == MpsGradient::Transposed => {
            let fits = mps.closure == MpsClosure::Completed && mps.pressure == MpsPressure::Signed;
            ("mps", &mps.projection, fits)
        }
        _ => return Ok(()),
    };
    if fits && settings.source != PoissonSource::Density {
        return Ok(());
    }
    let signed = if name == "mps" {
        " and `pressure = \"signed\"`"
    } else {
        ""
    };
    let remedy = format!(
        "set `source.divergence`, `closure = \"completed\"`{signed} in [method.{name}], as preset \
         `modern` does"
    );
    let problem = "needs the source `divergence`, and liquid up to the free surface";
    Err(tree.fault(&format!("method.{name}.gradient"), problem, &remedy))
}
