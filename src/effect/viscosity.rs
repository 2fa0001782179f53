//! Viscosity: the pair forms of nu lap v.
//!
//! With F = W'/r, SUM V (r . grad W) v_ab / r^2 -> lap v / 2 and
//! SUM V F (v_ab . r) r / r^2 -> (lap v + 2 grad div v) / (2 (d + 2)), so that
//!
//! (1) two-term (Nishio et al. 2010, Eq. 6): -> (d+3)/(d+2) nu lap v; exact after (d+2)/(d+3);
//! (2) Morris, Fox & Zhu 1997: mu (1/rho_a^2 + 1/rho_b^2) (r . grad W) / r^2 v_ab -> nu lap v; they
//!     print (mu_a + mu_b) / (rho_a rho_b), which differs by the square of a difference of density;
//! (3) Cleary & Ha 2002 (Kuri et al., Eq. 1): zeta mu (1/rho_a^2 + 1/rho_b^2) (v . r) / r^2 grad W
//!     -> zeta / (d+2) nu lap v; exact with zeta = d + 2, which is the printed 5 in 3-D.
//!
//! Time step: 0.125 h^2 / nu (Morris, Fox & Zhu 1997). (2) conserves linear momentum only, (3)
//! angular momentum too. Tests: tests/engine/method_operator.rs, tests/engine/effect_select.rs.

use super::Effect;
use crate::scene::limit;
use crate::space::lane::{Real, dot};

/// The viscous part of a pair force, in units of m norm / h^(d+1).
pub trait PairViscosity: Sync + Send + Copy + 'static {
    /// Whether it adds anything.
    const PRESENT: bool;
    /// Adds the acceleration of the target. `d` = r_ab / h, `v` = v_ab, m/s,
    /// `weight` = 1/rho_a^2 + 1/rho_b^2.
    fn add<F: Real>(&self, slope: F, q2: F, d: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]);
}

/// Inviscid.
impl PairViscosity for () {
    const PRESENT: bool = false;
    #[inline(always)]
    fn add<F: Real>(&self, _: F, _: F, _: [F; 3], _: [F; 3], _: F, _: &mut [F; 3]) {}
}

/// (1), with eta^2 = 0.01 h^2 as printed.
#[derive(Clone, Copy, Debug)]
pub struct TwoTerm {
    /// mu / h, Pa s/m, times (d+2)/(d+3) in the exact form.
    pub factor: f32,
}

impl PairViscosity for TwoTerm {
    const PRESENT: bool = true;
    #[inline(always)]
    fn add<F: Real>(&self, slope: F, q2: F, d: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]) {
        let vd = dot(v, d);
        let f = slope * weight * self.factor;
        let f = f / (q2 + 0.01);
        for a in 0..3 {
            let term = v[a].mul_add(q2, d[a] * vd); // (1)
            sum[a] = f.mul_add(term, sum[a]);
        }
    }
}

/// (2), without eta: slope is finite at r = 0, so nothing needs it.
#[derive(Clone, Copy, Debug)]
pub struct Morris {
    /// mu / h, Pa s/m.
    pub factor: f32,
}

impl PairViscosity for Morris {
    const PRESENT: bool = true;
    #[inline(always)]
    fn add<F: Real>(&self, slope: F, _: F, _: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]) {
        let f = slope * weight * self.factor; // (2)
        for a in 0..3 {
            sum[a] = f.mul_add(v[a], sum[a]);
        }
    }
}

/// (3), with eta^2 = 0.01 h^2 as printed.
#[derive(Clone, Copy, Debug)]
pub struct Cleary {
    /// zeta mu / h, Pa s/m.
    pub factor: f32,
}

impl PairViscosity for Cleary {
    const PRESENT: bool = true;
    #[inline(always)]
    fn add<F: Real>(&self, slope: F, q2: F, d: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]) {
        let f = slope * weight * self.factor;
        let f = f / (q2 + 0.01) * dot(v, d); // (3)
        for a in 0..3 {
            sum[a] = f.mul_add(d[a], sum[a]);
        }
    }
}

/// What viscosity limits, whatever the form of its pairs.
pub struct Newtonian {
    /// mu, Pa s.
    pub dynamic: f64,
}

impl Effect for Newtonian {
    fn limit(&self, h: f64, density: f64) -> Option<(&'static str, f64)> {
        Some(("viscous", limit::viscous(h, density, self.dynamic)))
    }
}
