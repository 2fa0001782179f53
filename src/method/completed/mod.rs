//! The density of liquid whose support ends at a free surface, its rate, and the force of pressure
//! that does the work of that rate.
//!
//! (1) n = C / F(h |grad C| / C), C = SUM V W: the density over rho0 that a half-space would have
//!     ([`Share`])
//! (2) dn/dt = n_C dC/dt + n_g . h d(grad C)/dt, n_C and n_g: derivatives of (1)
//! (3) m_a dv_a/dt = -SUM p_b V_b dn_b/dx_a: its work is that of (2)
//! With n = C a surface that is stretched along itself seems to expand: C does not tell missing
//! liquid from thin liquid. Its layer then becomes thinner than it should, and pressures in it take
//! part of the tension: a capillary wave of wave number k is too slow by 0.17 k H (and 1 % of
//! another origin), and the modes of drops and the breakup of threads with it. With (1), which is
//! exact for flat surfaces whatever their depth and density, by 0.11 (k H)^2 (docs/lab.md). Like C,
//! n is a function of where particles are: what is squeezed and released has its density back. A
//! divergence that is made exact by the inverse of a moment (Bonet & Lok 1999) is not the rate of
//! such a function; a drop that oscillated lost a quarter of its surface energy to that
//! (docs/lab.md).
//! The sums are those of the surface energy ([`crate::effect::tension::energy`]) with h in place of
//! H. Tests: tests/engine/method_completed.rs.
//!
//! [`Share`]: crate::method::projection::surface::Share

pub mod pass;
pub mod ring;

use super::projection::surface::Share;
use crate::effect::tension::pass::Energetic;
use crate::particle::column::Entry;
use serde::{Deserialize, Serialize};

/// n and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Completed {
    /// n; zero away from a surface.
    pub value: f32,
    /// n_C.
    pub slope: f32,
    /// n_g.
    pub along: [f32; 3],
}

impl Default for Completed {
    /// n = C.
    fn default() -> Self {
        Completed {
            value: 0.0,
            slope: 1.0,
            along: [0.0; 3],
        }
    }
}

impl Entry for Completed {}

impl Completed {
    /// From C and h grad C.
    pub fn of(share: &Share, sum: f64, gradient: [f64; 3]) -> Self {
        let size = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        let steepness = size / sum;
        let [part, by] = share.slope(steepness);
        let along = -by / (part * part) / size.max(f64::MIN_POSITIVE);
        Completed {
            value: (sum / part) as f32,
            slope: (1.0 / part + steepness * by / (part * part)) as f32,
            along: gradient.map(|g| (along * g) as f32),
        }
    }

    /// Its derivatives times a `pressure`.
    #[inline(always)]
    pub fn press(&self, pressure: f32) -> Energetic {
        Energetic {
            slope: pressure * self.slope,
            gradient: self.along.map(|along| pressure * along),
        }
    }
}
