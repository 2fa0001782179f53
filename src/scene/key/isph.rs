//! Settings of ISPH.

use super::super::{Closure, Gradient, Isph, PoissonSource, Preconditioner};
use super::{List, Unit};

/// All but those that every method has.
pub(super) fn settings(list: &mut List, settings: &Isph) {
    source(list, "isph", settings.source);
    let closure = match settings.closure {
        Closure::Mirrored => "mirrored",
        Closure::Completed => "completed",
    };
    list.word("method.isph.closure", closure);
    let gradient = match settings.gradient {
        Gradient::Symmetric => "symmetric",
        Gradient::Corrected => "corrected",
    };
    list.word("method.isph.gradient", gradient);
    let word = preconditioner(settings.preconditioner);
    list.word("method.isph.preconditioner", word);
    list.number("method.isph.tolerance", settings.tolerance, Unit::One);
    list.count("method.isph.iterations", settings.iterations as u64);
    list.number("method.isph.shifting", settings.shifting, Unit::One);
    list.number("method.isph.courant", settings.courant, Unit::One);
    list.number("method.isph.shortest", settings.shortest, Unit::Time);
    if settings.longest.is_finite() {
        list.number("method.isph.longest", settings.longest, Unit::Time);
    }
}

/// The right-hand side of the pressure equation of `method`.
pub(super) fn source(list: &mut List, method: &str, source: PoissonSource) {
    let name = format!("method.{method}.source");
    match source {
        PoissonSource::Density => list.word(&name, "density"),
        PoissonSource::Divergence { density } => {
            list.word(&name, "divergence");
            let name = format!("{name}.divergence.density");
            list.number(&name, density, Unit::One);
        }
    }
}

/// Its word in a scene file.
pub(super) fn preconditioner(preconditioner: Preconditioner) -> &'static str {
    match preconditioner {
        Preconditioner::None => "none",
        Preconditioner::Diagonal => "diagonal",
        Preconditioner::Ssor => "ssor",
        Preconditioner::Multigrid => "multigrid",
    }
}
