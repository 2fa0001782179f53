//! Settings that ISPH and MPS share. `method`: as in `method.NAME`.

use super::super::{PoissonSource, Preconditioner, Projection};
use super::{List, Unit};

/// The right-hand side of the pressure equation.
pub(super) fn source(list: &mut List, method: &str, settings: &Projection) {
    let name = format!("method.{method}.source");
    match settings.source {
        PoissonSource::Density => list.word(&name, "density"),
        PoissonSource::Divergence { density } => {
            list.word(&name, "divergence");
            let name = format!("{name}.divergence.density");
            list.number(&name, density, Unit::One);
        }
    }
}

/// All but the source.
pub(super) fn solution(list: &mut List, method: &str, settings: &Projection) {
    let name = |key: &str| format!("method.{method}.{key}");
    let word = match settings.preconditioner {
        Preconditioner::None => "none",
        Preconditioner::Diagonal => "diagonal",
        Preconditioner::Ssor => "ssor",
        Preconditioner::Multigrid => "multigrid",
    };
    list.word(&name("preconditioner"), word);
    list.number(&name("tolerance"), settings.tolerance, Unit::One);
    list.count(&name("iterations"), settings.iterations as u64);
    list.number(&name("shifting"), settings.shifting, Unit::One);
    list.number(&name("theta"), settings.theta, Unit::One);
    list.number(&name("courant"), settings.courant, Unit::One);
    list.number(&name("shortest"), settings.shortest, Unit::Time);
    if settings.longest.is_finite() {
        list.number(&name("longest"), settings.longest, Unit::Time);
    }
}
