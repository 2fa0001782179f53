//! Settings of ISPH.

use super::super::{Closure, Gradient, Isph};
use super::List;
use super::projection::{solution, source};

/// All but those that every method has.
pub(super) fn settings(list: &mut List, settings: &Isph) {
    source(list, "isph", &settings.projection);
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
    solution(list, "isph", &settings.projection);
}
