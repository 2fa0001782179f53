//! Curvature from counted neighbours, Xie, Koshizuka & Oka (2007), Section 2.4 (after Nomura et al.
//! 2001), r_e = 2 H.
//!
//! `NumberDensity`, as printed:
//! (1) n1_a = SUM 1 over r < r_e                                                 Eq. 12
//! (2) n2_a = the same over those with n1_b > n1_a                               Eq. 13
//! (3) kappa = 2 cos theta / r_e, 2 theta = pi n2 / n0                           Eqs. 10, 11
//! (4) n = a / |a|, a: what n1 gains from l0 before to l0 behind, on each axis   Eqs. 14, 15
//! (5) kappa_a := (kappa_a + SUM w kappa_b / SUM w) / 2 at the surface, w = r_e / r - 1   Eq. 16
//! (6) a_s = sigma kappa n / (rho d), d = l0 / alpha, of particles at the surface
//!
//! Counts are whole numbers and often equal, so (2) rises smoothly over a difference of 2; n0 is
//! the mean of (2) at a disordered flat surface. Without its divisor (printed so) (5) would make
//! kappa three times as large. (3) takes the missing sector of a circle for its missing lens: it is
//! 2/3 of the curvature; in 3-D, with a cone, 4 (1 - n2 / n0) / r_e is 3/4 of it. "The normalised
//! thickness" in (6) is taken for one layer.
//!
//! `NumberDensityExact`, with what a liquid bounded by a circle or a sphere gives:
//! (7) n1_a = SUM W,  n2_a = SUM W s,  s = 1/2 + (n1_b - n1_a) / g in 0 .. 1,  g = what n1 gains
//!     over a spacing at a flat surface
//! (8) kappa = C (1 - n2 / n0),  n0 = SUM W / 2 on the lattice,  C = pi <1> / <r> in 2-D and
//!     4 <r> / <r^2> in 3-D (there the sum of both curvatures), <f> = INT W f r dr
//! (9) n along SUM grad W
//! Half of an own layer counts, so a flat surface has n2 = n0 however disordered it is.
//!
//! Walls count as deep liquid: they are wet, unless [`crate::effect::wetting::typed`] says
//! otherwise. Forces are not those of pairs: a drop may gain momentum.
//! Fails where liquid is thinner than 2 r_e (n1 of the far side hides which particle is deeper, so
//! that a film is squeezed), and, as printed, wherever curvature is not much more than 1 / n0 l0.
//! Time step: that of the tension. Test: tests/engine/effect_counted.rs.

use super::{FAINT, Tension};
use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::payload;
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::sweep::{self, Field, Pair, Pass};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::f64::consts::PI;
use std::marker::PhantomData;

/// What deep liquid and walls have for n1.
const DEEP: f32 = 1e9;

/// Nearer than this, in H, w of (5) is that at it.
const NEAREST: f32 = 0.15;

/// Half of the range of offsets, in spacings, that makes the flat surface of (2) disordered: from
/// 0.2 to 0.3 n0 is the same within 0.5 %.
const DISORDER: f64 = 0.2;

/// Scratch memory, and what is fixed once the spacing is known.
#[derive(Clone, Debug, Default)]
pub(super) struct Counted {
    fixed: Option<Fixed>,
    /// Per `near`: n1 and the vector along n.
    numbers: Vec<[f32; 4]>,
    /// Per particle at the surface: n2; SUM w kappa and SUM w.
    deeper: Vec<f32>,
    means: Vec<[f32; 2]>,
    /// n and kappa, 1/m.
    normal: Vec<[f64; 3]>,
    curvature: Vec<f64>,
}

/// n0, the sum of curvatures from 1 - n2 / n0, 1/m, and l0 in H; `gain`: g of (7), or 2 of (2).
#[derive(Clone, Copy, Debug)]
struct Fixed {
    flat: f64,
    scale: f64,
    spacing: f64,
    gain: f64,
}

impl Counted {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        16 * self.numbers.capacity() + 44 * self.means.capacity()
    }
}

impl Fixed {
    /// `length`: H, m; `spacing`: l0, m.
    fn of<K: Kernel, const PRINTED: bool>(length: f64, spacing: f64, dimension: usize) -> Self {
        let radius = 2.0 * length / spacing;
        if PRINTED {
            return Fixed {
                flat: disordered(radius, dimension),
                scale: (dimension as f64 - 1.0) / length,
                spacing: spacing / length,
                gain: 2.0,
            };
        }
        let w = |square: i64| K::w(spacing / length * (square as f64).sqrt());
        let reach = radius.ceil() as i64;
        let depth = if dimension == 3 { reach } else { 0 };
        let (mut all, mut layer) = (-K::w(0.0), 0.0);
        for x in -reach..=reach {
            for y in -depth..=depth {
                layer += w(x * x + y * y);
                all += (-reach..=reach)
                    .map(|z| w(x * x + y * y + z * z))
                    .sum::<f64>();
            }
        }
        // By midpoints.
        const CELLS: usize = 2000;
        let moment = |power: i32| -> f64 {
            let middle = |k: usize| (k as f64 + 0.5) * 2.0 / CELLS as f64;
            (0..CELLS)
                .map(|k| K::w(middle(k)) * middle(k).powi(power))
                .sum()
        };
        let scale = match dimension {
            2 => PI * moment(1) / moment(2),
            _ => 4.0 * moment(2) / moment(3),
        };
        Fixed {
            flat: 0.5 * all,
            scale: scale / length,
            spacing: spacing / length,
            gain: layer,
        }
    }
}

/// n0 of (2) for r_e = `radius` spacings.
pub fn disordered(radius: f64, dimension: usize) -> f64 {
    let layers = 2 * radius.ceil() as usize + 2;
    let width = if dimension == 3 { layers } else { 8 * layers };
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut points = Vec::new();
    for layer in 0..layers {
        for x in 0..width {
            for y in 0..if dimension == 3 { width } else { 1 } {
                let mut beside =
                    || DISORDER * (2.0 * random.next_u32() as f64 / u32::MAX as f64 - 1.0);
                let across = if dimension == 3 { beside() } else { 0.0 };
                let (x, y, z) = (x as f64, y as f64 + across, -(layer as f64));
                points.push([x + beside(), y, z + beside()]);
            }
        }
    }
    let wide = width as f64;
    let apart = |a: &[f64; 3], b: &[f64; 3]| {
        let d = [0, 1].map(|k| a[k] - b[k] - wide * ((a[k] - b[k]) / wide).round());
        let square = d[0] * d[0] + d[1] * d[1] + (a[2] - b[2]).powi(2);
        square < radius * radius
    };
    let row = |(a, x): (usize, &[f64; 3])| -> Vec<usize> {
        let others = points.iter().enumerate();
        let near = others.filter(|(b, y)| *b != a && apart(x, y));
        near.map(|(b, _)| b).collect()
    };
    let rows: Vec<Vec<usize>> = points.iter().enumerate().map(row).collect();
    let count = |a: usize| rows[a].len() as f64;
    let top = points.len() / layers;
    let deeper = |a: usize| {
        let part = |b: &usize| smooth((count(*b) - count(a)) / 2.0);
        rows[a].iter().map(part).sum::<f64>()
    };
    (0..top).map(deeper).sum::<f64>() / top as f64
}

/// 0 to 1, with a flat start and end.
fn smooth(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

impl Tension {
    /// (1) to (6), or with (7) to (9): `force` of the particles at the surface, `reached`.
    pub(super) fn count<K: Kernel, const PRINTED: bool>(
        &mut self,
        flow: &Surface,
        is_surface: impl Fn(usize) -> bool + Sync,
    ) {
        let d = self.dimension as i32;
        let spacing = (flow.mass / self.density).powf(1.0 / d as f64);
        let mut counted = std::mem::take(&mut self.counted);
        let made = || Fixed::of::<K, PRINTED>(self.length, spacing, self.dimension);
        let fixed = *counted.fixed.get_or_insert_with(made);
        let reach = self.support() + flow.slack;
        self.band.grow(flow.grid, reach);
        self.band.members(flow.grid, flow.liquid, &mut self.near);
        self.reached.clear();
        let surface = self.near.iter().filter(|i| is_surface(**i as usize));
        self.reached.extend(surface);
        let farther = if PRINTED { spacing } else { 0.0 };
        let field = Field {
            cutoff: reach + farther,
            ..self.field(flow, self.length)
        };
        counted.numbers.resize(self.near.len(), [0.0; 4]);
        let pass = Numbers::<K, PRINTED> {
            beside: fixed.spacing as f32,
            kernel: PhantomData,
        };
        sweep::runs(field, &self.near, &pass, &mut counted.numbers);
        self.payload[0].fill(DEEP);
        for (&i, number) in self.near.iter().zip(&counted.numbers) {
            self.payload[0][i as usize] = number[0];
        }
        flow.share(&mut self.payload[0]);
        let pass = Deeper::<K, PRINTED> {
            gain: (1.0 / fixed.gain) as f32,
            kernel: PhantomData,
        };
        counted.deeper.resize(self.reached.len(), 0.0);
        let field = self.field(flow, self.length);
        sweep::runs(field, &self.reached, &pass, &mut counted.deeper);
        self.bend_counted::<PRINTED>(flow, &mut counted, fixed);
        if let Some(typed) = &mut self.typed {
            let (normal, curvature) = (&mut counted.normal, &mut counted.curvature);
            typed.prescribe(flow, &is_surface, &self.reached, (normal, curvature));
        }
        let factor = self.strength * self.coefficient / (self.density * spacing);
        let pull = |(n, kappa): (&[f64; 3], &f64)| n.map(|n| (factor * kappa * n) as f32);
        self.force.clear();
        let curved = counted.normal.iter().zip(&counted.curvature);
        self.force.extend(curved.map(pull));
        self.clear(flow);
        // H grad n1 over n1 of a full support: what shifting knows a surface by.
        let unit = if PRINTED { 0.5 / fixed.spacing } else { 1.0 };
        let faint = FAINT * 2.0 * fixed.flat / unit;
        for (&i, [_, along @ ..]) in self.near.iter().zip(&counted.numbers) {
            if along.iter().map(|a| (*a as f64).powi(2)).sum::<f64>() > faint * faint {
                (0..3).for_each(|a| self.payload[a][i as usize] = along[a]);
            }
        }
        flow.turn(&mut self.payload);
        self.counted = counted;
    }

    /// (3) or (8), n, and (5).
    fn bend_counted<const PRINTED: bool>(
        &mut self,
        flow: &Surface,
        counted: &mut Counted,
        fixed: Fixed,
    ) {
        counted.normal.clear();
        counted.curvature.clear();
        let mut numbers = self.near.iter().zip(&counted.numbers);
        for (&i, &n2) in self.reached.iter().zip(&counted.deeper) {
            // Both lists are in one order.
            let [_, along @ ..] = numbers.find(|(j, _)| **j == i).map_or([0.0; 4], |n| *n.1);
            let along = along.map(f64::from);
            let size = along.iter().map(|a| a * a).sum::<f64>().sqrt();
            counted
                .normal
                .push(along.map(|a| a / size.max(f64::MIN_POSITIVE)));
            let part = n2 as f64 / fixed.flat;
            let bent = match PRINTED && self.dimension == 2 {
                true => (0.5 * PI * part).cos(),
                false => 1.0 - part,
            };
            counted.curvature.push(fixed.scale * bent);
        }
        self.clear(flow);
        for (&i, &kappa) in self.reached.iter().zip(&counted.curvature) {
            self.payload[0][i as usize] = kappa as f32;
            self.payload[1][i as usize] = 1.0;
        }
        self.payload.iter_mut().for_each(|words| flow.share(words));
        counted.means.resize(self.reached.len(), [0.0; 2]);
        let field = self.field(flow, self.length);
        sweep::runs(field, &self.reached, &Means, &mut counted.means);
        let means = &counted.means;
        each_mut(&mut counted.curvature[..means.len()], |k, kappa| {
            let [sum, weight] = means[k].map(f64::from);
            if weight > 0.0 {
                *kappa = 0.5 * (*kappa + sum / weight);
            }
        });
    }
}

/// 1 for q < 2 of others.
#[inline(always)]
fn inside<F: Real>(q2: F) -> F {
    q2.splat(1.0).if_less(q2, q2.splat(4.0))
}

/// n1 and the vector along n.
struct Numbers<K, const PRINTED: bool> {
    /// l0 / H.
    beside: f32,
    kernel: PhantomData<K>,
}

impl<K: Kernel, const PRINTED: bool> Pass<4> for Numbers<K, PRINTED> {
    type Payload = ();
    type Out = [f32; 4];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, ()>, sum: &mut [F; 4]) {
        if !PRINTED {
            let q = pair.q2.sqrt();
            sum[0] += K::w_apart(q, pair.q2);
            let slope = K::slope_lanes(q);
            for a in 0..3 {
                sum[1 + a] = slope.mul_add(pair.d[a], sum[1 + a]);
            }
            return;
        }
        let other = inside(pair.q2).if_less(pair.q2.splat(0.0), pair.q2);
        sum[0] += other;
        let l0 = pair.q2.splat(self.beside);
        let square = l0.mul_add(l0, pair.q2);
        let twice = l0 + l0;
        for a in 0..3 {
            let shift = twice * pair.d[a];
            let ahead = inside(square + shift);
            let behind = inside(square - shift);
            sum[1 + a] += ahead - behind;
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 4], out: &mut [f32; 4]) {
        *out = sum;
    }
}

payload! {
    /// n1.
    struct Number<F> { count: F }
}

/// n2.
struct Deeper<K, const PRINTED: bool> {
    /// 1 / g, or 1/2.
    gain: f32,
    kernel: PhantomData<K>,
}

impl<K: Kernel, const PRINTED: bool> Pass<1> for Deeper<K, PRINTED> {
    type Payload = Number;
    type Out = f32;
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Number>, sum: &mut [F; 1]) {
        let (zero, one) = (pair.q2.splat(0.0), pair.q2.splat(1.0));
        let more = (pair.other.count - pair.own.count) * self.gain;
        let part = if PRINTED {
            let x = more.max(zero).min(one);
            let rest = pair.q2.splat(-2.0).mul_add(x, pair.q2.splat(3.0));
            let counts = inside(pair.q2).if_less(zero, pair.q2);
            counts * (x * x * rest)
        } else {
            let x = (pair.q2.splat(0.5) + more).max(zero).min(one);
            K::w_apart(pair.q2.sqrt(), pair.q2) * x
        };
        sum[0] += part;
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 1], out: &mut f32) {
        *out = sum[0];
    }
}

payload! {
    /// kappa and 1 at the surface, else 0.
    struct Bent<F> { kappa: F, mark: F }
}

/// SUM w kappa and SUM w of (5).
struct Means;

impl Pass<2> for Means {
    type Payload = Bent;
    type Out = [f32; 2];
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, Bent>, sum: &mut [F; 2]) {
        let zero = pair.q2.splat(0.0);
        let q = pair.q2.sqrt().max(pair.q2.splat(NEAREST));
        let w = (pair.q2.splat(2.0) / q - 1.0).max(zero);
        let w = w.if_less(zero, pair.q2);
        sum[0] = w.mul_add(pair.other.kappa, sum[0]);
        sum[1] = w.mul_add(pair.other.mark, sum[1]);
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 2], out: &mut [f32; 2]) {
        *out = sum;
    }
}
