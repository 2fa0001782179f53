//! Walls beside a tension that is the derivative of an energy: the contact angle.
//!
//! (1) E of [`super::energy`] plus cos theta sigma A of what is dry of the walls, A measured as the
//!     liquid's own surface is: wall particles have the energy b cos theta e, with sums over liquid
//!     and walls, and b what relaxed surfaces have of their energy ([`super::energy::CARRIED`]).
//! A dry wall costs sigma cos theta more than a wet one, whatever e is: Young's law is where (1) is
//! least. At 90 degrees walls have no energy.
//!
//! With an advancing and a receding angle theta is, within these, that which the line has
//! ([`crate::effect::wetting::line`]), and friction resists its motion
//! ([`crate::effect::wetting::friction`]): y of a particle is the part along the wall of what walls
//! of cos theta = 1 do to it, which comes to sigma per length of line.
//!
//! Walls are as deep as a kernel reaches; their own part of the sums is that of endless ones.
//! Tests: tests/engine/effect_energy.rs.

use super::Tension;
use crate::effect::surface::Surface;
use crate::effect::wetting::friction::Hold;
use crate::effect::wetting::survey::{direction, nearest};
use crate::kernel::Kernel;
use crate::kernel::ring::{Rings, mean};
use crate::particle::ring;
use crate::particle::wall::{Lattice, is_wall};
use crate::scene::{Dimension, Domain};
use crate::space::lane::Real;
use crate::space::parallel::each_mut;
use crate::space::ranks::span::Span;
use crate::space::sweep::{self, Pair, Pass};
use std::collections::HashMap;

/// Walls with a contact angle, and scratch memory.
#[derive(Clone)]
pub struct Shore {
    /// Cosine of the contact angle; with hysteresis the mean one.
    pub cosine: f64,
    /// The box, which says where walls are.
    pub domain: Domain,
    /// Of the scene.
    pub dimension: Dimension,
    /// s0, m.
    pub spacing: f64,
    /// Per wall particle: SUM slope d and SUM w over other wall particles; empty before the first
    /// update.
    pub dry: Vec<[f32; 4]>,
    /// Of which walls: see [`Surface::wall_changes`].
    pub known: u64,
    /// e of those, of the whole of them.
    pub dry_energy: Vec<f32>,
    /// Masses of wall particles over the nominal one, where they are rings.
    pub weights: Vec<f64>,
    /// Wall particles near a surface; of rings all.
    pub near: Vec<u32>,
    /// The same, and all walls, for sums over those of all ranks.
    pub span: Span,
    /// See `span`.
    pub walls: Span,
    /// Whether each of the others is under liquid.
    pub under: Vec<bool>,
    /// Of those near: H n, then phi.
    pub sums: Vec<[f32; 4]>,
    /// What walls do to the liquid in reach: those of cos theta = 1, and of the angles of lines.
    pub pulls: [Vec<[f32; 3]>; 2],
}

impl Shore {
    /// Walls of which nothing is known yet; `spacing` in m.
    pub fn new(cosine: f64, domain: Domain, dimension: Dimension, spacing: f64) -> Self {
        Shore {
            cosine,
            domain,
            dimension,
            spacing,
            dry: Vec::new(),
            known: 0,
            dry_energy: Vec::new(),
            weights: Vec::new(),
            near: Vec::new(),
            span: 0.into(),
            walls: 0.into(),
            under: Vec::new(),
            sums: Vec::new(),
            pulls: Default::default(),
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        16 * (self.dry.capacity() + self.sums.capacity())
            + 8 * self.weights.capacity()
            + 4 * (self.near.capacity() + self.dry_energy.capacity())
            + 24 * self.pulls[0].capacity()
    }

    /// Forgets what it knows of other walls.
    pub fn meet(&mut self, flow: &Surface) {
        if self.known != flow.wall_changes {
            self.known = flow.wall_changes;
            self.dry.clear();
            self.dry_energy.clear();
        }
    }

    /// Finds the wall particles under liquid: one that is not near a surface is under liquid if the
    /// cell of the box before it is filled.
    pub fn see(&mut self, flow: &Surface) {
        let size = self.domain.size;
        let inside = |a: usize, x: f64| {
            let edge = 0.5 * self.spacing.min(size[a]);
            x.clamp(edge, size[a] - edge)
        };
        self.under.resize(flow.wall[0].len(), false);
        each_mut(&mut self.under[..flow.wall[0].len()], |j, under| {
            let x = [0, 1, 2].map(|a| inside(a, flow.wall[a][j]));
            *under = flow.is_filled(flow.grid.index(flow.grid.cell(x)));
        });
        self.walls = flow.wall_span();
        self.near
            .iter()
            .for_each(|&j| self.under[j as usize] = false);
    }

    /// Adds what walls add to the sums of `near`; `wall`: wall particles, `length`: H, m.
    pub fn add_walls<K: Kernel>(&mut self, wall: &[Vec<f64>; 3], length: f64) {
        if self.dry.len() != wall[0].len() {
            self.dry = self.alone::<K>(wall, length);
        }
        for (&j, sum) in self.near.iter().zip(&mut self.sums) {
            let dry = self.dry[j as usize];
            (0..4).for_each(|a| sum[a] += dry[a]);
        }
    }

    /// SUM slope d and SUM w of every wall particle over the others, in walls without a back.
    fn alone<K: Kernel>(&self, wall: &[Vec<f64>; 3], length: f64) -> Vec<[f32; 4]> {
        let lattice = Lattice::new(&self.domain, self.dimension, self.spacing);
        let count = lattice.count;
        let reach = [0, 1, 2].map(|a| lattice.within(a, 2.0 * length));
        // Away from corners all cells of a layer are alike.
        let class = |a: usize, i: i64| {
            let inside = i > reach[a] && i + reach[a] < count[a] - 1;
            if inside { count[a] / 2 } else { i }
        };
        let mut known = HashMap::new();
        let of = |j: usize| {
            let index = [0, 1, 2].map(|a| match lattice.pitch[a] {
                0.0 => 0,
                _ => class(a, lattice.index(a, wall[a][j])),
            });
            *known.entry(index).or_insert_with(|| {
                let mut sum = [0.0; 4];
                for k in 0..reach.iter().map(|r| 2 * r + 1).product::<i64>() {
                    let [nx, ny, _] = reach.map(|r| 2 * r + 1);
                    let step = [k % nx, k / nx % ny, k / nx / ny];
                    let away = [0, 1, 2].map(|a| step[a] - reach[a]);
                    let other = [0, 1, 2].map(|a| index[a] + away[a]);
                    let d = [0, 1, 2].map(|a| lattice.apart(a, index[a], other[a]) / length);
                    let q = d.iter().map(|d| d * d).sum::<f64>().sqrt();
                    if q == 0.0 || !is_wall(self.domain.boundary, other, count) {
                        continue;
                    }
                    (0..3).for_each(|a| sum[a] += K::slope(q) * d[a]);
                    sum[3] += K::w(q);
                }
                sum.map(|s| s as f32)
            })
        };
        (0..wall[0].len()).map(of).collect()
    }
}

impl Shore {
    /// SUM g and SUM w of every wall ring over the others, and over itself but for the kernel at
    /// its place in three dimensions, `own`, in walls without a back ([`super::ringed`]).
    pub fn rings_alone(&self, wall: &[Vec<f64>; 3], length: f64, own: f64) -> Vec<[f32; 4]> {
        let lattice = Lattice::new(&self.domain, self.dimension, self.spacing);
        let count = lattice.count;
        // Columns near the axis are moved by less than a cell.
        let reach = [0, 2].map(|a| lattice.within(a, 2.0 * length) + 1);
        let column = |i: i64| {
            let mut radius = lattice.middle(0, i);
            let mass = ring::settle(&mut radius, lattice.pitch[0], self.spacing);
            (radius / length, mass)
        };
        // Two rings see each other by their columns and by how far they are apart.
        let mut known = HashMap::new();
        let mut pair = |i: i64, other: i64, apart: f64| {
            *known
                .entry((i, other, apart.abs().to_bits()))
                .or_insert_with(|| {
                    let (own, other) = (column(i).0, column(other).0);
                    let [f, fy, fp, ..] = mean((own - other).hypot(apart), own * other);
                    [f, fy, fp]
                })
        };
        let of = |j: usize| {
            let [i, k] = [0, 2].map(|a| lattice.index(a, wall[a][j]));
            let (radius, mass) = column(i);
            let [value, turn, ..] = Rings::default().own(radius);
            let mut sum = [mass * radius * turn, 0.0, 0.0, mass * value - own];
            for other in (i - reach[0]).max(0)..=i + reach[0] {
                for layer in -reach[1]..=reach[1] {
                    let is_self = other == i && layer == 0;
                    let index = [other, 0, k + layer];
                    if is_self || !is_wall(self.domain.boundary, index, count) {
                        continue;
                    }
                    let (beside, mass) = column(other);
                    let down = lattice.apart(2, k, k + layer) / length;
                    let [f, fy, fp] = pair(i, other, down);
                    sum[0] += mass * (fp * beside + 2.0 * fy * (radius - beside));
                    sum[2] += mass * 2.0 * fy * down;
                    sum[3] += mass * f;
                }
            }
            sum.map(|s| s as f32)
        };
        (0..wall[0].len()).map(of).collect()
    }
}

/// What others do to a target that has nothing itself.
struct Others<'a, P>(&'a P);

impl<const N: usize, P: Pass<N, Out = [f32; 3]>> Pass<N> for Others<'_, P> {
    type Payload = P::Payload;
    type Out = [f32; 3];
    const SKIPS_ZEROS: bool = P::SKIPS_ZEROS;
    #[inline(always)]
    fn own(&self, _: usize, _: P::Payload) -> P::Payload {
        P::Payload::default()
    }
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        self.0.extra(target)
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        self.0.weigh(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, P::Payload>, sum: &mut [F; N]) {
        self.0.pair(pair, sum)
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; N], out: &mut [f32; 3]) {
        self.0.finish(target, sum, out);
    }
}

impl Tension {
    /// Friction of lines with hysteresis; then gives walls, so far of cos theta = 1, the angles
    /// that lines have. `words`: what `pull` reads, of which those of `scaled` go with the cosine;
    /// its sums times `factor` are accelerations.
    pub(super) fn hold_lines<const N: usize, P: Pass<N, Out = [f32; 3]>>(
        &mut self,
        flow: &Surface,
        (words, scaled): (&mut [Vec<f32>; 4], &[usize]),
        (pull, factor): (&P, f64),
    ) {
        let (Some(wetting), Some(shore)) = (&mut self.wetting, &mut self.energy.shore) else {
            return;
        };
        let (n, length, reached) = (flow.density.len(), self.length, &self.reached);
        let span = &self.spans[1];
        let look = |words: &[Vec<f32>; 4], sums: &mut Vec<[f32; 3]>| {
            sums.resize(reached.len(), [0.0; 3]);
            let field = flow.about(flow.position, flow.of_wall(), words, length);
            sweep::runs_shared(field, span, reached, &Others(pull), sums);
            let whole = |s: f32| (factor * s as f64) as f32;
            each_mut(&mut sums[..], |_, sum| *sum = sum.map(whole));
        };
        let [of_wet, of_lines] = &mut shore.pulls;
        look(words, of_wet);
        for &j in &shore.near {
            let cosine = wetting.cosines[j as usize] as f32;
            scaled
                .iter()
                .for_each(|&w| words[w][n + j as usize] *= cosine);
        }
        let [slope, vector @ ..] = &mut *words;
        flow.share(slope);
        flow.turn(vector);
        look(words, of_lines);
        let (middle, half) = (wetting.cosine, wetting.setting.angle.friction());
        self.lines.clear();
        wetting.friction.hold.clear();
        for ((&i, wet), line) in reached.iter().zip(of_wet).zip(of_lines) {
            if *wet == [0.0; 3] {
                continue;
            }
            let at = [0, 1, 2].map(|a| flow.position[a][i as usize]);
            let (normal, wall) = nearest(&wetting.setting.domain, at);
            let along = |a: usize, value: f32| if a == normal { 0.0 } else { value };
            let y = [0, 1, 2].map(|a| along(a, wet[a]));
            let most = half as f32 * y.iter().map(|y| y * y).sum::<f32>().sqrt();
            self.lines.push(i);
            wetting.friction.hold.push(Hold {
                most: [0, 1, 2].map(|a| along(a, most)),
                drive: [0, 1, 2].map(|a| middle as f32 * y[a] - along(a, line[a])),
                across: direction(wetting.setting.dimension, y),
                wall,
            });
        }
    }
}
