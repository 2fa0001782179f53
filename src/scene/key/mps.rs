//! Settings of MPS.

use super::super::{Mps, MpsClosure, MpsGradient, Pressure};
use super::projection::{solution, source};
use super::{List, Unit};

/// All but those that every method has.
pub(super) fn settings(list: &mut List, settings: &Mps) {
    list.number("method.mps.radius", settings.radius, Unit::One);
    let name = "method.mps.laplacian_radius";
    list.number(name, settings.laplacian_radius, Unit::One);
    // Results older than this setting stay fresh where nothing else has changed since.
    if settings.core > 0.0 || settings.projection.shifting > 0.0 {
        list.number("method.mps.core", settings.core, Unit::One);
    }
    source(list, "mps", &settings.projection);
    match settings.closure {
        MpsClosure::Threshold => {
            list.word("method.mps.closure", "threshold");
            list.number("method.mps.beta", settings.beta, Unit::One);
        }
        MpsClosure::Completed => list.word("method.mps.closure", "completed"),
    }
    let gradient = match settings.gradient {
        MpsGradient::Minimum => "minimum",
        MpsGradient::Symmetric => "symmetric",
        MpsGradient::Corrected => "corrected",
        MpsGradient::Blended => "blended",
    };
    list.word("method.mps.gradient", gradient);
    let pressure = match settings.pressure {
        Pressure::Clipped => "clipped",
        _ => "signed",
    };
    list.word("method.mps.pressure", pressure);
    solution(list, "mps", &settings.projection);
}
