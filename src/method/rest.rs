//! When a body that relaxes is at rest: kinetic energy and spread of density have been below their
//! limits for a part of the time that it may take. A body that has not begun to move is at rest,
//! too.

use super::Solver;
use crate::scene::Relax;

/// Part of the longest time for which the limits must be kept.
const CALM_PART: f64 = 0.1;

/// How still a body is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unrest {
    /// Kinetic energy, J/kg.
    pub energy: f64,
    /// Standard deviation of density, kg/m^3.
    pub spread: f64,
    /// Whether both are below their limits.
    pub is_calm: bool,
}

/// Watches a body that relaxes.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// Since when both limits have been kept, s; NaN: they are not.
    pub calm_since: f64,
}

impl Default for Rest {
    fn default() -> Self {
        Rest {
            calm_since: f64::NAN,
        }
    }
}

impl Rest {
    /// Looks at a body; the second value says whether its relaxation ends here. `mass`: of a
    /// particle on average, kg.
    pub fn look(&mut self, solver: &dyn Solver, mass: f64, relax: &Relax) -> (Unrest, bool) {
        let (energy, spread) = solver.unrest();
        let energy = energy / (solver.len() as f64 * mass);
        let is_calm = energy <= relax.kinetic_energy && spread <= relax.density_spread;
        let time = solver.time();
        self.calm_since = match is_calm {
            true if self.calm_since.is_nan() => time,
            true => self.calm_since,
            false => f64::NAN,
        };
        let unrest = Unrest {
            energy,
            spread,
            is_calm,
        };
        let is_long = time - self.calm_since >= CALM_PART * relax.time;
        (unrest, is_long || time >= relax.time)
    }
}
