//! A surface energy of which the force is the exact derivative.
//!
//! (1) E = alpha sigma / H SUM V e,
//!     e = kappa/2 (H |n| - 0.05)^2 + a2 c^2 + a3 c^3 + a4 c^4 + 7 d^2,
//!     c = 1 - phi - 0.02,  d = 1 - phi - 0.9 (H n)^2 - 0.03,
//!     phi = SUM V W^H,  n = SUM V grad W^H,  V = m / rho0;
//!     the bracket, c and d are zero where they would be negative; beyond c = 0.48 the terms in c
//!     are linear
//! (2) m a_a = -alpha sigma / H SUM V^2 ((e'_a + e'_b) grad W^H + (g_a - g_b) . grad grad W^H),
//!     e' = de/dphi, g = de/dn: minus the derivative of (1), so that the force does the work that E
//!     falls by; momentum is kept pair by pair, and E knows no direction: angular momentum too.
//! d is zero at a flat surface, where n goes with what is missing, and not where surfaces are near
//! each other and their normals cancel: sheets of 1, 2, 3, 4 and 6 layers have 1.05, 0.96, 0.85,
//! 0.92 and 0.98 of two surfaces (a test has them); without it 0.43, 0.55, 0.75, 0.91 and 0.98, and
//! a column of five spacings became a pipe.
//! Inside the liquid e is zero but beside voids. The coefficients make E of a flat surface
//! sigma times its area (quadrature over a continuous liquid) and leave the layer at the surface
//! almost without a load: a half-space is in equilibrium with pressures between -0.4 and 0.7
//! sigma / H in it, where c^2 alone needs 3.7, and a pair attraction 4.7. A load presses the layer
//! as long as density diffuses ([`LOAD`] is spared), and takes part of the tension where the
//! density of such a layer changes as it is stretched along itself ([`crate::method::completed`]).
//! What little is left points inwards and keeps particles from leaving. e grows with c to the end,
//! so that a lone particle costs most.
//! Liquid has to be stiff beside sigma / H ([`crate::scene::Scene::layer_speed`]).
//! Time: the force is taken where particles will be in the middle of the step that it is held over;
//! at its beginning it would feed energy in, omega^2 dt / 4 a second of a wave of omega.
//! Wall particles count as liquid and have no energy: 90 degrees; others: [`super::shore`].
//! Pressure forces must do the work that their divergence sees, as those of WCSPH do and of ISPH
//! and MPS with the transposed gradient.
//! Tests: tests/engine/effect_energy.rs.

use super::Tension;
use super::pass::Pull;
use super::shore::Shore;
use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::sweep::{self, Pair, Pass};
use std::marker::PhantomData;

/// What a normal, H |n|, and a lack of neighbours, 1 - phi, have from disorder alone.
const DISORDER: [f64; 2] = [0.05, 0.02];

/// Largest c in e of (1); a flat surface has 0.48.
const LINEAR: f64 = 0.48;

/// Tension at alpha = 1 over sigma, of which the strength is the inverse: E falls to 0.955 sigma A
/// as a surface relaxes, and that is the pressure in drops (a disc of 20 s0; 0.956 with WCSPH):
/// with MPS, and with the others because the density of the layer knows the surface
/// ([`crate::method::completed`]).
pub const CARRIED: f64 = 0.955;

/// Differences of pressure in sigma / H that hold the load of the layer at a surface: a flat
/// half-space has 1.1; as much again for disorder.
pub const LOAD: f64 = 2.0;

/// Of d in (1): its weight; the largest 1 - phi over (H n)^2 of a flat surface; disorder.
const THIN: f64 = 7.0;
const ARCH: f64 = 0.9;
const LOOSE: f64 = 0.03;

/// Depth in H to which e can differ from zero.
const DEEP: f64 = 2.0;

/// kappa, a2, a3, a4 of Wendland C2.
pub fn coefficients(dimension: usize) -> [f64; 4] {
    match dimension {
        2 => COEFFICIENTS_2,
        _ => COEFFICIENTS_3,
    }
}

const COEFFICIENTS_2: [f64; 4] = [4.86, 26.201, -79.971, 77.601];
const COEFFICIENTS_3: [f64; 4] = [4.74, 26.859, -82.178, 79.788];

/// e of (1) and its derivatives.
pub struct Density {
    /// e.
    pub energy: f64,
    /// By phi.
    pub slope: f64,
    /// By H n.
    pub gradient: [f64; 3],
}

/// e at a kernel sum and H n.
pub fn density(dimension: usize, phi: f64, n: [f64; 3]) -> Density {
    let [kappa, a2, a3, a4] = coefficients(dimension);
    let size = n.iter().map(|n| n * n).sum::<f64>().sqrt();
    let [faint, loose] = DISORDER;
    let steep = (size - faint).max(0.0);
    let lack = (1.0 - phi - loose).max(0.0);
    let c = lack.min(LINEAR);
    let slope = c * (2.0 * a2 + c * (3.0 * a3 + c * 4.0 * a4));
    let thin = (1.0 - phi - ARCH * size * size - LOOSE).max(0.0);
    let along = kappa * steep / size.max(f64::MIN_POSITIVE) - 4.0 * THIN * ARCH * thin;
    let of_lack = c * c * (a2 + c * (a3 + c * a4)) + slope * (lack - c);
    Density {
        energy: 0.5 * kappa * steep * steep + of_lack + THIN * thin * thin,
        slope: -slope - 2.0 * THIN * thin,
        gradient: n.map(|n| along * n),
    }
}

/// e at the sums of [`Look`], which become H n and phi; `own`: W at the particle where they lack
/// that, `unit`: [`Tension::unit`].
fn complete(dimension: usize, unit: f64, own: f64, s: &mut [f32; 4]) -> Density {
    *s = s.map(|s| (unit * s as f64) as f32);
    s[3] += (unit * own) as f32;
    density(dimension, s[3] as f64, [0, 1, 2].map(|a| s[a] as f64))
}

/// Adds slope d and w of a pair, both given.
#[inline(always)]
pub fn look<F: Real>([w, slope]: [F; 2], d: [F; 3], sum: &mut [F; 4]) {
    for a in 0..3 {
        sum[a] = slope.mul_add(d[a], sum[a]);
    }
    sum[3] += w;
}

/// SUM slope d and SUM w: of particles `APART` from the target, or of all, the target among them,
/// so that two particles at one place see each other.
struct Look<K, const APART: bool>(PhantomData<K>);

impl<K: Kernel, const APART: bool> Pass<4> for Look<K, APART> {
    type Payload = ();
    type Out = [f32; 4];
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        match APART {
            true => K::both_lanes(q2),
            false => {
                let q = q2.sqrt();
                [K::w_lanes(q), K::slope_lanes(q)]
            }
        }
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 4]) {
        look(pair.weight, pair.d, sum);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 4], out: &mut [f32; 4]) {
        *out = sum;
    }
}

/// Scratch memory, and the walls.
#[derive(Default)]
pub struct Energy {
    /// Per particle near the surface: H n, then phi.
    pub(super) sums: Vec<[f32; 4]>,
    /// e' and g / H of each of them.
    derived: Vec<[f32; 4]>,
    /// e' per particle, wall particle and image.
    slope: Vec<f32>,
    /// Of rings: their masses over the nominal one.
    pub(super) masses: Vec<f32>,
    /// [`CARRIED`].
    pub carried: f64,
    pub(super) parts: Vec<[f64; 1]>,
    /// Of walls with a contact angle.
    pub shore: Option<Shore>,
}

impl Energy {
    /// Bytes held.
    pub(super) fn memory(&self) -> usize {
        16 * (self.sums.capacity() + self.derived.capacity())
            + 4 * (self.slope.capacity() + self.masses.capacity())
            + self.shore.as_ref().map_or(0, Shore::memory)
    }
}

impl Tension {
    /// The force (2); the band holds the marked cells of the surface.
    pub(super) fn pull_by_energy<K: Kernel>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
    ) {
        let near = std::mem::take(&mut self.near);
        self.near = self.within(flow, DEEP * self.length, near);
        self.spans[0] = flow.list(self.near.len());
        if let Some(mut wetting) = self.wetting.take() {
            self.find_lines::<K>(flow, is_surface, &mut wetting);
            self.clear(flow);
            self.wetting = Some(wetting);
        }
        let mut sums = std::mem::take(&mut self.energy.sums);
        sums.resize(self.near.len(), [0.0; 4]);
        match flow.weights {
            None if self.dimension == 2 => self.look::<K, false>(flow, &mut sums),
            None => self.look::<K, true>(flow, &mut sums),
            Some(weights) => self.look_at_rings(flow, weights, K::w(0.0), &mut sums),
        }
        self.derive::<K>(flow, &mut sums);
        self.energy.sums = sums;
        self.wet_shore::<K>(flow);

        let reached = std::mem::take(&mut self.reached);
        self.reached = self.within(flow, 2.0 * self.length, reached);
        self.spans[1] = flow.list(self.reached.len());
        let unit = self.strength * self.coefficient / self.length / self.density;
        let pass = Pull::<K> {
            factor: -unit * self.force_factor::<K>(flow.mass) / self.density,
            kernel: PhantomData,
        };
        let mut force = std::mem::take(&mut self.force);
        force.resize(self.reached.len(), [0.0; 3]);
        let [x, y, z] = std::mem::take(&mut self.payload);
        let mut words = [std::mem::take(&mut self.energy.slope), x, y, z];
        match flow.weights {
            None => {
                self.hold_lines(flow, (&mut words, &[0, 1, 2, 3]), (&pass, 1.0));
                let targets = (&self.reached[..], &self.spans[1], &pass);
                self.runs(flow, &words, targets, &mut force);
            }
            Some(weights) => self.pull_rings(flow, weights, &mut words, pass.factor, &mut force),
        }
        let [slope, x, y, z] = words;
        self.payload = [x, y, z];
        self.energy.slope = slope;
        self.force = force;
    }

    /// Whether e is found of all the liquid, which costs little in two dimensions, and not of a
    /// band beside surfaces alone. Where a flow stretches the liquid particles stand in columns;
    /// voids between these would get their energy from nowhere when they enter the band. Rings
    /// have few neighbours and unequal areas, so that e differs from zero inside the liquid too.
    fn counts_all(&self, flow: &Surface) -> bool {
        flow.weights.is_some() || self.dimension == 2
    }

    /// The particles within `reach` m more of the band, which grows by that, or all where all
    /// count; in the memory of `list`.
    fn within(&mut self, flow: &Surface, reach: f64, mut list: Vec<u32>) -> Vec<u32> {
        if self.counts_all(flow) {
            list.clear();
            list.extend(0..flow.density.len() as u32);
        } else {
            self.band.grow(flow.grid, reach + flow.slack);
            self.band.members(flow.grid, flow.liquid, &mut list);
        }
        list
    }

    fn look<K: Kernel, const APART: bool>(&mut self, flow: &Surface, sums: &mut [[f32; 4]]) {
        let pass = Look::<K, APART>(PhantomData);
        self.runs(flow, &[], (&self.near[..], &self.spans[0], &pass), sums);
    }

    /// What turns SUM w into phi and SUM slope d into H n.
    fn unit<K: Kernel>(&self, flow: &Surface) -> f64 {
        let d = self.dimension;
        K::norm(d) * flow.mass / self.density / self.length.powi(d as i32)
    }

    /// Fills e' and g of walls with a contact angle near the marked cells; times its cosine unless
    /// that depends on the line.
    fn wet_shore<K: Kernel>(&mut self, flow: &Surface) {
        let Some(wall) = flow.of_wall().first() else {
            return;
        };
        let (unit, n) = (self.unit::<K>(flow), flow.density.len());
        let Some(mut shore) = self.energy.shore.take() else {
            return;
        };
        shore.meet(flow);
        match flow.weights {
            None => {
                let own = flow.own_walls();
                if self.counts_all(flow) {
                    shore.near.clear();
                    shore.near.extend(own.map(|j| j as u32));
                } else {
                    self.band.members_of(flow.grid, wall.start, &mut shore.near);
                    shore.near.retain(|&j| own.contains(&(j as usize)));
                }
                shore.span = flow.list(shore.near.len());
                shore.sums.resize(shore.near.len(), [0.0; 4]);
                let field = flow.about(flow.wall, flow.of_liquid(), &[], self.length);
                let pass = Look::<K, true>(PhantomData);
                sweep::runs_shared(field, &shore.span, &shore.near, &pass, &mut shore.sums);
                shore.see(flow);
                shore.add_walls::<K>(flow.wall, self.length);
            }
            Some(weights) => self.look_from_walls(flow, weights, K::w(0.0), &mut shore),
        }
        if shore.dry_energy.len() != shore.dry.len() {
            let of = |dry: &[f32; 4]| {
                complete(self.dimension, unit, K::w(0.0), &mut dry.clone()).energy as f32
            };
            shore.dry_energy = shore.dry.iter().map(of).collect();
        }
        let cosine = match self.wetting {
            Some(_) => self.energy.carried,
            None => self.energy.carried * shore.cosine,
        };
        for (&j, s) in shore.near.iter().zip(&mut shore.sums) {
            let i = n + j as usize;
            let e = complete(self.dimension, unit, K::w(0.0), s);
            self.energy.slope[i] = (cosine * e.slope) as f32;
            (0..3).for_each(|a| self.payload[a][i] = (cosine * e.gradient[a]) as f32);
        }
        self.energy.shore = Some(shore);
        flow.share(&mut self.energy.slope);
        flow.turn(&mut self.payload);
    }

    /// Turns sums into H n and phi, and fills e' and g.
    fn derive<K: Kernel>(&mut self, flow: &Surface, sums: &mut [[f32; 4]]) {
        let (d, n) = (self.dimension, flow.at[0].len());
        let unit = self.unit::<K>(flow);
        // In two dimensions the target is among all.
        let own = if d == 2 { 0.0 } else { K::w(0.0) };
        self.energy.slope.clear();
        self.energy.slope.resize(n, 0.0);
        let (near, derived) = (&self.near, &mut self.energy.derived);
        derived.resize(near.len(), [0.0; 4]);
        each_mut(
            (&mut sums[..near.len()], &mut derived[..]),
            |_, (sums, out)| {
                let e = complete(d, unit, own, sums);
                let [x, y, z] = e.gradient;
                *out = [e.slope, x, y, z].map(|x| x as f32);
            },
        );
        for (i, [slope, gradient @ ..]) in near.iter().zip(derived) {
            let i = *i as usize;
            self.energy.slope[i] = *slope;
            (0..3).for_each(|a| self.payload[a][i] = gradient[a]);
        }
        flow.share(&mut self.energy.slope);
        flow.turn(&mut self.payload);
    }
}
