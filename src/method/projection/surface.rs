//! How the pressure equation ends at a free surface.
//!
//! `mirrored` (Kuri Eq. 11, after Bockmann, Shipilova & Skeie 2012): a detected particle has each
//! of its neighbours mirrored in the air at p = 0, so its diagonal grows by SUM w. Detection in two
//! steps (Marrone, Colagrossi, Le Touze & Graziani 2010):
//! (1) lambda, least eigenvalue of B = SUM V (r_b - r_a) x grad W: <= 0.20 surface, >= 0.75 not;
//! (2) between, n = -L SUM V grad W normalised, T = r + h n, tau across n: no surface if any j has
//!     |r_jr| >= sqrt2 h and |r_jT| < h, or |r_jr| < sqrt2 h and, in 2-D,
//!     |n . r_jT| + |tau . r_jT| < h, in 3-D arccos(n . r_jr / |r_jr|) < pi / 4.
//!
//! `completed`, without flags (a diagonal that is completed: Nair & Tomar 2014): p = 0 in the plane
//! that lies z_a above the particle, along the normal n = -grad C / |grad C|, C = SUM V W. For a
//! pressure linear in depth SUM w (p_a - p_b) = -p_a / z_a n . M_a with M_a = SUM w (r_a - r_b), so
//! (3) s_a = t(F_a) n . M_a / z_a
//! makes every layer's equation exact for it: what is left over would be balanced by a divergence
//! of dt times that, which opens the layers below a surface at long steps. How much F_a of the
//! support is liquid, z_a and the density n_a follow from C and grad C alone: [`Share`]. t falls
//! from 1 at the F of the second layer of a flat lattice to 0 half way to a full support: without
//! it the noise of M (some per cent) would pin the pressure inside to zero. Where hardly anything
//! is near, in films one particle thick and spray, each missing neighbour is one of p = 0.
//! Tests: tests/engine/isph_operator.rs.

use super::correction::{least_eigenvalue, times};
use super::look::Local;
use crate::kernel::{self, Kernel};
use crate::scene::KernelName;
use crate::space::grid::Grid;
use crate::space::lane::Record;

/// Thresholds of (1).
const SPRAY: f64 = 0.20;
const INSIDE: f64 = 0.75;

/// Whether particle `own` of a row is at the surface by (1) and (2). `h` in m.
pub fn is_surface(
    local: &Local,
    own: usize,
    mut row: impl Iterator<Item = usize>,
    records: &[Record],
    (grid, h, planar): (&Grid, f64, bool),
) -> bool {
    let lambda = least_eigenvalue(&local.moment);
    if lambda <= SPRAY || lambda >= INSIDE {
        return lambda <= SPRAY;
    }
    let inverse = super::correction::inverse(&local.moment);
    let n = times(&inverse, local.slope.map(|s| -s as f64));
    let length = dot(n, n).sqrt();
    if length == 0.0 {
        return false;
    }
    let n = n.map(|n| n / length);
    let tau = [n[2], 0.0, -n[0]];
    let at = |i: usize, a: usize| records[i].at(a);
    !row.any(|j| {
        if j == own {
            return false;
        }
        let x: [f64; 3] =
            std::array::from_fn(|a| at(j, a).wrapping_sub(at(own, a)) as f64 * grid.unit[a]);
        let t: [f64; 3] = std::array::from_fn(|a| x[a] - h * n[a]);
        let far = dot(x, x).sqrt();
        if far >= std::f64::consts::SQRT_2 * h {
            dot(t, t).sqrt() < h
        } else if planar {
            dot(n, t).abs() + dot(tau, t).abs() < h
        } else {
            dot(n, x) > far * std::f64::consts::FRAC_1_SQRT_2
        }
    })
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// What C = SUM V W and its gradient say of a support.
///
/// At depth z under the flat surface of a liquid of density n rho0, C = n F(z) and
/// h |grad C| = n h F'(z), so that F and z are functions of h |grad C| / C alone, and n = C / F.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Share {
    /// F and z / h at equal distances of h |grad C| / C: as many entries above the surface, where
    /// tips and corners are, as below it.
    table: Vec<[f64; 2]>,
    step: f64,
}

/// Entries of the table under the surface, and steps of the integral that it is made from.
const ENTRIES: usize = 128;
const STEPS: usize = 1000;

/// Bounds of n: beyond them a particle is spray, or a scene is not a liquid.
const LOOSEST: f64 = 0.5;
const DENSEST: f64 = 1.5;

impl Share {
    /// For a kernel, by quadrature over a half-space of liquid.
    pub fn of(kernel: KernelName, dimension: usize) -> Self {
        let dz = 2.0 / STEPS as f64;
        let (mut f, mut curve) = (0.5, Vec::with_capacity(2 * STEPS));
        for k in 0..STEPS {
            let z = k as f64 * dz;
            curve.push([kernel::plane(kernel, dimension, z), f, z]);
            f += kernel::plane(kernel, dimension, z + 0.5 * dz) * dz;
        }
        let above = curve[1..].iter().rev();
        let above = above.map(|&[slope, f, z]| [slope / (1.0 - f), 1.0 - f, -z]);
        let under = curve.iter().map(|&[slope, f, z]| [slope / f, f, z]);
        let step = curve[0][0] / curve[0][1] / (ENTRIES - 1) as f64;
        let curve: Vec<_> = above.chain(under).chain([[0.0, 1.0, 2.0]]).collect();
        let at = |x: f64| {
            let k = curve.partition_point(|c| c[0] >= x).max(1);
            let (a, b) = (curve[k - 1], curve[k.min(curve.len() - 1)]);
            let part = if a[0] == b[0] {
                0.0
            } else {
                (a[0] - x) / (a[0] - b[0])
            };
            [1, 2].map(|c| a[c] + (b[c] - a[c]) * part)
        };
        Share {
            table: (0..2 * ENTRIES).map(|k| at(k as f64 * step)).collect(),
            step,
        }
    }

    /// F and z / h; `steepness` = h |grad C| / C.
    #[inline(always)]
    pub fn at(&self, steepness: f64) -> [f64; 2] {
        let ([a, b], part) = self.beside(steepness, ENTRIES);
        [0, 1].map(|c| a[c] + (b[c] - a[c]) * part)
    }

    /// F, above the surface too, and its derivative, which is zero where the steepness is.
    #[inline(always)]
    pub fn slope(&self, steepness: f64) -> [f64; 2] {
        let ([[low, _], [high, _]], part) = self.beside(steepness, self.table.len());
        let rise = high - low;
        match steepness < self.step {
            true => [low + rise * part * part, 2.0 * rise * part / self.step],
            false => [low + rise * part, rise / self.step],
        }
    }

    /// The entries beside a steepness, of the first `count`, and how far it is from one to the
    /// other.
    #[inline(always)]
    fn beside(&self, steepness: f64, count: usize) -> ([[f64; 2]; 2], f64) {
        let x = (steepness / self.step)
            .min((count - 1) as f64 - 1e-9)
            .max(0.0);
        let k = x as usize;
        ([self.table[k], self.table[k + 1]], x - k as f64)
    }
}

/// (3) for one kernel and smoothing length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Completion {
    /// SUM w of a full support.
    full: f64,
    /// C of a full lattice, some per mille above 1.
    lattice: f64,
    /// F between which t falls from 1 to 0.
    from: f64,
    to: f64,
    /// Least z / h: a quarter of a spacing.
    least: f64,
    /// Least SUM w that spray lacks.
    spare: f64,
    /// What share of a support a surface leaves.
    pub share: Share,
}

/// Part of a full support that spray lacks at least: weights grow as particles come near, and with
/// their densities in spray, and can be more for a pair than for a full support; its equation would
/// be singular.
const SPARE: f64 = 0.1;

/// Kernel sums between which a particle counts as film or spray, from wholly to not at all: those
/// of MIST and LOOSE.
const ALONE: [f64; 2] = [0.4, 0.55];

impl Completion {
    /// For the kernel `K`, called `kernel`, in `dimension` dimensions; `smoothing` = h / s0.
    pub fn of<K: Kernel>(kernel: KernelName, dimension: usize, smoothing: f64) -> Self {
        let reach = (2.0 * smoothing).ceil() as i64;
        let depth = if dimension == 3 { reach } else { 0 };
        let norm = K::norm(dimension) / smoothing.powi(dimension as i32);
        let (mut full, mut lattice, mut sum, mut slope) = (0.0, 0.0, 0.0, 0.0);
        for x in -reach..=reach {
            for y in -depth..=depth {
                for m in -reach..=reach {
                    let q = ((x * x + y * y + m * m) as f64).sqrt() / smoothing;
                    if q > 0.0 && q < 2.0 {
                        full -= K::slope(q);
                    }
                    let w = if q < 2.0 { norm * K::w(q) } else { 0.0 };
                    lattice += w;
                    // The second layer of a flat lattice has one above it.
                    if m >= -1 && q < 2.0 {
                        sum += w;
                        slope -= norm * K::slope(q) * m as f64 / smoothing;
                    }
                }
            }
        }
        let share = Share::of(kernel, dimension);
        let [from, _] = share.at(slope / sum);
        Completion {
            full,
            lattice,
            from,
            to: 0.5 * (1.0 + from),
            least: 0.25 / smoothing,
            spare: SPARE * full,
            share,
        }
    }

    /// s_a of (3); `slope` = h grad C, `degree` = SUM w, `moment` = SUM w (r_a - r_b) / h.
    #[inline(always)]
    pub fn surface(&self, sum: f64, slope: [f64; 3], degree: f64, moment: [f64; 3]) -> f64 {
        let steep = dot(slope, slope).sqrt();
        let [share, depth] = self.share.at(steep / sum);
        let ramp = self.ramp(share);
        let outward = -dot(slope, moment) / steep.max(f64::MIN_POSITIVE);
        let alone = ((ALONE[1] - sum) / (ALONE[1] - ALONE[0])).clamp(0.0, 1.0);
        let lack = (self.full - degree).max(self.spare);
        ramp * outward.max(0.0) / depth.max(self.least) + alone * lack
    }

    /// t(F).
    #[inline(always)]
    fn ramp(&self, share: f64) -> f64 {
        ((self.to - share) / (self.to - self.from)).clamp(0.0, 1.0)
    }

    /// n = C / F over that of a lattice, within its bounds; `slope` = h grad C. Where t(F) is zero
    /// the support is full: disorder alone makes |grad C| some per cent, and n would be 0.8 % too
    /// large on average.
    #[inline(always)]
    pub fn density(&self, kernel_sum: f64, slope: [f64; 3]) -> f64 {
        let [share, _] = self.share.at(dot(slope, slope).sqrt() / kernel_sum);
        let lack = self.ramp(share) * (1.0 - share);
        (kernel_sum / (self.lattice * (1.0 - lack))).clamp(LOOSEST, DENSEST)
    }

    /// The same for particles of `volume` cells of the lattice.
    pub fn of_volume(self, volume: f64) -> Self {
        let lattice = volume * self.lattice;
        Completion { lattice, ..self }
    }

    /// The same for rings, whose sums at rest are those of a liquid without particles.
    pub fn of_rings(self) -> Self {
        Completion {
            lattice: 1.0,
            ..self
        }
    }

    /// The same for other weights w, with their sum over a full support.
    pub fn with_full(self, full: f64) -> Self {
        let spare = SPARE * full;
        Completion {
            full,
            spare,
            ..self
        }
    }

    /// C of a full lattice: what a liquid of density rho0 has.
    pub fn lattice(&self) -> f64 {
        self.lattice
    }

    /// SUM w of a full support.
    pub fn full(&self) -> f64 {
        self.full
    }
}
