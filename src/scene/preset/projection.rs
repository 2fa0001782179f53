//! What the presets of ISPH and MPS share.

use crate::scene::cursor::Cursor;
use crate::scene::error::SceneError;
use crate::scene::quantity::Unit;
use crate::scene::{PoissonSource, Preconditioner, Projection};

/// The choices of today, for a source.
pub(super) fn projection_modern(source: PoissonSource) -> Projection {
    Projection {
        source,
        preconditioner: Preconditioner::Multigrid,
        tolerance: 1e-4, // with multigrid 1e-3 gives the same crater, column and drops
        iterations: 2000,
        shifting: 4.0, // Lind et al. 2012, as strong as in WCSPH
        theta: 0.6,    // see `method::projection`: implicit Euler takes energy from impacts
        courant: 0.25, // Shao & Lo 2003 use 0.1, Lind et al. 2012 up to 0.25
        shortest: 0.1e-6,
        longest: f64::INFINITY,
        cohesion: 1.0, // without it a contact line sheds 8 % of a drop in 4 ms, with it 2.5 %
    }
}

/// A setting that every projection method has; false if `key` is none.
pub(super) fn override_projection(
    settings: &mut Projection,
    key: &str,
    value: &Cursor<'_>,
) -> Result<bool, SceneError> {
    match key {
        "source" => {
            settings.source = match value.get("divergence") {
                Some(divergence) => PoissonSource::Divergence {
                    density: divergence.number_at("density")?,
                },
                None => PoissonSource::Density,
            }
        }
        "preconditioner" => {
            settings.preconditioner = match value.text()? {
                "none" => Preconditioner::None,
                "diagonal" => Preconditioner::Diagonal,
                "ssor" => Preconditioner::Ssor,
                _ => Preconditioner::Multigrid,
            }
        }
        "tolerance" => settings.tolerance = value.number()?,
        "iterations" => settings.iterations = value.count()? as usize,
        "shifting" => settings.shifting = value.number()?,
        "theta" => settings.theta = value.number()?,
        "courant" => settings.courant = value.number()?,
        "shortest" => settings.shortest = value.quantity(Unit::Time)?,
        "longest" => {
            settings.longest = match value.text() {
                Ok("none") => f64::INFINITY,
                _ => value.quantity(Unit::Time)?,
            }
        }
        "cohesion" => settings.cohesion = value.number()?,
        _ => return Ok(false),
    }
    Ok(true)
}
