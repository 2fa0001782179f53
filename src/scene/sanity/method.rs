//! Settings of a method that a preset does not combine, with what was seen.

use super::Warning;
use crate::scene::{Closure, Density, Method, MpsClosure, PoissonSource, Scene, WallPressure};

/// Walls that leak, and surfaces that a source without the density does not keep.
pub(super) fn all(scene: &Scene) -> Option<Warning> {
    let is_divergence = |source| source != PoissonSource::Density;
    match &scene.method {
        Method::Wcsph(wcsph)
            if wcsph.wall_pressure == WallPressure::Summation
                && wcsph.density != Density::Summation
                && scene.has_wall() =>
        {
            Some(Warning::new(
                "method.wcsph.wall_pressure",
                "summation".into(),
                "walls leak where the density of the liquid is not summed: a pool at rest lost two \
                 thirds of its height",
                "set it to `extrapolated`, or `density` to `summation`",
            ))
        }
        Method::Isph(isph)
            if isph.closure == Closure::Mirrored && is_divergence(isph.projection.source) =>
        {
            Some(surface("method.isph.closure", "mirrored"))
        }
        Method::Mps(mps)
            if mps.closure == MpsClosure::Threshold && is_divergence(mps.projection.source) =>
        {
            Some(surface("method.mps.closure", "threshold"))
        }
        _ => None,
    }
}

fn surface(key: &str, value: &str) -> Warning {
    let why = "splashes of a millimetre ended without a pressure after a millisecond: what is at \
               the surface for a moment is let go, and `source.divergence` does not bring it back";
    Warning::new(
        key,
        value.into(),
        why,
        "set it to `completed`, or `source` to `density`",
    )
}
