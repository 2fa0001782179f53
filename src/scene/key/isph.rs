//! Settings of ISPH.

use super::super::{Closure, Gradient, Isph, PoissonSource, Preconditioner};
use super::{List, Unit};

/// All but those that every method has.
pub(super) fn settings(list: &mut List, settings: &Isph) {
    match settings.source {
        PoissonSource::Density => list.word("method.isph.source", "density"),
        PoissonSource::Divergence { density } => {
            list.word("method.isph.source", "divergence");
            let name = "method.isph.source.divergence.density";
            list.number(name, density, Unit::One);
        }
    }
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
    let preconditioner = match settings.preconditioner {
        Preconditioner::None => "none",
        Preconditioner::Diagonal => "diagonal",
        Preconditioner::Ssor => "ssor",
        Preconditioner::Multigrid => "multigrid",
    };
    list.word("method.isph.preconditioner", preconditioner);
    list.number("method.isph.tolerance", settings.tolerance, Unit::One);
    list.count("method.isph.iterations", settings.iterations as u64);
    list.number("method.isph.shifting", settings.shifting, Unit::One);
    list.number("method.isph.courant", settings.courant, Unit::One);
    list.number("method.isph.shortest", settings.shortest, Unit::Time);
    if settings.longest.is_finite() {
        list.number("method.isph.longest", settings.longest, Unit::Time);
    }
}
