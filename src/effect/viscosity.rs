//! Viscosity: the pair forms of nu lap v.
//!
//! With F = W'/r, SUM V (r . grad W) v_ab / r^2 -> lap v / 2 and
//! SUM V F (v_ab . r) r / r^2 -> (lap v + 2 grad div v) / (2 (d + 2)), so that
//!
//! (1) two-term (Nishio et al. 2010, Eq. 6): -> (d+3)/(d+2) nu lap v; exact after (d+2)/(d+3);
//! (2) Morris, Fox & Zhu 1997: mu (1/rho_a^2 + 1/rho_b^2) (r . grad W) / r^2 v_ab -> nu lap v; they
//!     print (mu_a + mu_b) / (rho_a rho_b), which differs by the square of a difference of density;
//! (3) Cleary & Ha 2002 (Kuri et al., Eq. 1): zeta mu (1/rho_a^2 + 1/rho_b^2) (v . r) / r^2 grad W
//!     -> zeta / (d+2) nu lap v; exact with zeta = d + 2, which is the printed 5 in 3-D;
//! (4) central: (3) without its eta, which takes 1 to 2 % of it.
//!
//! At a free surface, where neighbours are missing, each form has the condition of its own power.
//! That of (2) goes with |v_ab|^2, in the limit with mu |grad v|^2: the surface has mu dv/dn = 0 in
//! place of no shear stress, a disc that turns like a solid body comes to rest, and viscous drops
//! become round up to twice as fast. That of (3) and (4) goes with (v_ab . r)^2, in the limit with
//! 2 mu S : S, S = (grad v + grad v^T) / 2: no stress at the surface (Colagrossi, Antuono,
//! Souto-Iglesias & Le Touze 2011), and none in what turns. (2) conserves linear momentum only, (3)
//! and (4) angular momentum too.
//!
//! Time step: 0.125 h^2 / nu (Morris, Fox & Zhu 1997); (3) and (4) are (d+2)/d times as stiff, with
//! d + 2 times the force of a pair in one of d directions ([`Viscosity::stiff`]).
//! Tests: tests/engine/effect_viscosity.rs, effect_select.rs and method_operator.rs.
//!
//! [`Viscosity::stiff`]: crate::scene::Viscosity::stiff

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

/// (3), or (4).
#[derive(Clone, Copy, Debug)]
pub struct Cleary {
    /// zeta mu / h, Pa s/m.
    pub factor: f32,
    /// eta^2 / h^2: as printed 0.01.
    pub softening: f32,
}

/// Of (4): for particles at one place, where (v . r) r / r^2 has no value.
pub const TINY: f32 = 1e-6;

impl PairViscosity for Cleary {
    const PRESENT: bool = true;
    #[inline(always)]
    fn add<F: Real>(&self, slope: F, q2: F, d: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]) {
        let f = slope * weight * self.factor;
        let f = f / (q2 + self.softening) * dot(v, d); // (3)
        for a in 0..3 {
            sum[a] = f.mul_add(d[a], sum[a]);
        }
    }
}

/// What viscosity limits.
pub struct Newtonian {
    /// mu times the stiffness of its pairs, Pa s.
    pub stiff: f64,
}

impl Effect for Newtonian {
    fn limit(&self, h: f64, density: f64) -> Option<(&'static str, f64)> {
        Some(("viscous", limit::viscous(h, density, self.stiff)))
    }
}
