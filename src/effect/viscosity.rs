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
//! (4) central: d/m2 mu (1/rho_a^2 + 1/rho_b^2) (v . r) grad W, m2 = INT W r^2 dV: (3) without its
//!     1/r^2, for INT F r^4 dV = -(d+2) m2. The weight that (3) gives to near pairs takes 7 to 11 %
//!     of it where liquid is sheared along a lattice (h = 1.5 s0), here 0.4 %.
//!
//! At a free surface, where neighbours are missing, each form has the condition of its own power.
//! That of (2) goes with |v_ab|^2, in the limit with mu |grad v|^2: the surface has mu dv/dn = 0 in
//! place of no shear stress, a disc that turns like a solid body comes to rest, and viscous drops
//! become round up to twice as fast. That of (3) and (4) goes with (v_ab . r)^2, in the limit with
//! 2 mu S : S, S = (grad v + grad v^T) / 2: no stress at the surface (Colagrossi, Antuono,
//! Souto-Iglesias & Le Touze 2011), and none in what turns. (2) conserves linear momentum only, (3)
//! and (4) angular momentum too.
//!
//! Time step: 0.125 h^2 / nu (Morris, Fox & Zhu 1997), less where the largest eigenvalue of a form
//! on a lattice asks for it ([`Method::stiffness`]): 7 nu / h^2 in (2), 18 in (3), 11 to 15 in (4),
//! of two particles that pass each other.
//! Tests: tests/engine/effect_viscosity.rs, effect_select.rs and method_operator.rs.
//!
//! [`Method::stiffness`]: crate::scene::Method::stiffness

use super::Effect;
use crate::kernel::Kernel;
use crate::scene::limit;
use crate::space::lane::{Real, dot};
use std::f64::consts::PI;

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

/// (4).
#[derive(Clone, Copy, Debug)]
pub struct Central {
    /// d/m2 mu / h, Pa s/m, with m2 in h^2.
    pub factor: f32,
}

impl Central {
    /// In `d` dimensions, with the kernel `K`; `unit`: mu / h, Pa s/m.
    pub fn of<K: Kernel>(d: usize, unit: f64) -> Self {
        const CELLS: usize = 1000;
        let step = 2.0 / CELLS as f64;
        let sphere = if d == 3 { 4.0 * PI } else { 2.0 * PI };
        let shell = |k: usize| {
            let q = (k as f64 + 0.5) * step;
            K::norm(d) * K::w(q) * sphere * q.powi(d as i32 + 1) * step
        };
        let moment: f64 = (0..CELLS).map(shell).sum();
        Central {
            factor: (d as f64 / moment * unit) as f32,
        }
    }
}

impl PairViscosity for Central {
    const PRESENT: bool = true;
    #[inline(always)]
    fn add<F: Real>(&self, slope: F, _: F, d: [F; 3], v: [F; 3], weight: F, sum: &mut [F; 3]) {
        let f = slope * weight * self.factor * dot(v, d); // (4)
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
