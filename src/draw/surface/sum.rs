//! The sum of all blobs at the nodes: slabs in parallel, rows of nodes eight at a time.

use std::ops::Range;

use rayon::prelude::*;

use super::Field;
use super::blob::Blob;
use crate::space::lane::{Job, Lanes, Real, WIDTH, run_mixed};

/// Layers of nodes that are summed together.
const SLAB: usize = 8;
/// Square of the distance, in smoothing lengths, from which a kernel is exactly 0 in spite of
/// rounding.
const BEYOND: f32 = 4.01;
/// Such a square where there is no node.
const FAR: f32 = 1e6;

/// Sums at the nodes of a slab, each with eight numbers more than there are nodes.
#[derive(Default)]
struct Sums {
    value: Vec<f32>,
    /// Of values times red, green and blue; empty if not required.
    colour: [Vec<f32>; 3],
    /// Of a round blob: [`Slab::add_round`].
    along: Vec<f32>,
}

impl Sums {
    fn clear(&mut self, nodes: usize, has_colour: bool) {
        let [red, green, blue] = &mut self.colour;
        let all = [(&mut self.value, true), (red, has_colour)];
        let rest = [(green, has_colour), (blue, has_colour)];
        for (sums, is_needed) in all.into_iter().chain(rest) {
            sums.clear();
            sums.resize(if is_needed { nodes + WIDTH } else { 0 }, 0.0);
        }
    }
}

/// Adds the blobs of a list to a slab.
struct Slab<'a> {
    field: &'a Field,
    blobs: &'a [Blob],
    list: &'a [usize],
    /// Of blobs, and the colours of sources.
    source: &'a [u32],
    colours: &'a [[f32; 3]],
    /// Its layers.
    layers: Range<usize>,
    sums: &'a mut Sums,
}

impl Field {
    /// (1) of the [module](super) at all nodes.
    pub(super) fn sum(&mut self, blobs: &[Blob], source: &[u32], colours: &[[f32; 3]]) {
        let slab = SLAB * self.count[1] * self.count[2];
        let slabs = self.count[0].div_ceil(SLAB);
        let mut lists = vec![Vec::new(); slabs];
        for (i, blob) in blobs.iter().enumerate() {
            let range = self.range(blob, 0);
            if !range.is_empty() {
                let touched = range.start / SLAB..=(range.end - 1) / SLAB;
                touched.for_each(|slab| lists[slab].push(i));
            }
        }
        let mut values = std::mem::take(&mut self.values);
        let has_colour = !colours.is_empty();
        let mut means = vec![[0.0f32; 3]; if has_colour { values.len() } else { 0 }];
        // Without colours each slab has an empty part of none.
        let mut parts: Vec<&mut [[f32; 3]]> = means.chunks_mut(slab).collect();
        parts.resize_with(slabs, Default::default);
        let work = values.par_chunks_mut(slab).zip(parts).zip(&lists);
        work.enumerate()
            .for_each_init(Sums::default, |sums, (n, ((out, means), list))| {
                sums.clear(out.len(), has_colour);
                let first = n * SLAB;
                run_mixed(Slab {
                    field: self,
                    blobs,
                    list,
                    source,
                    colours,
                    layers: first..first + out.len() / (self.count[1] * self.count[2]),
                    sums,
                });
                out.copy_from_slice(&sums.value[..out.len()]);
                let [red, green, blue] = &sums.colour;
                for (k, mean) in means.iter_mut().enumerate() {
                    *mean = [red[k], green[k], blue[k]].map(|c| c / out[k].max(1e-6));
                }
            });
        self.values = values;
        self.colours = means;
    }

    /// Nodes along an axis that a blob reaches.
    pub(super) fn range(&self, blob: &Blob, axis: usize) -> Range<usize> {
        if self.count[axis] == 1 {
            return 0..1;
        }
        let place = |x: f32| (x - self.low[axis]) / self.step[axis];
        let low = place(blob.centre[axis] - blob.extent[axis]).ceil().max(0.0) as usize;
        let high = place(blob.centre[axis] + blob.extent[axis]).floor();
        let end = ((high + 1.0).max(0.0) as usize).min(self.count[axis]);
        // The blob may lie beyond the last node.
        low.min(end)..end
    }
}

impl Job for Slab<'_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        for &i in self.list {
            let blob = &self.blobs[i];
            let colour = self.colours.get(self.source[i] as usize).copied();
            match blob.turns {
                0 => self.add(lanes, blob, colour),
                _ => {
                    let Sums {
                        value, colour: own, ..
                    } = &mut *self.sums;
                    let colour = colour.map(|colour| (colour, own));
                    self.field.turn(blob, &self.layers, value, colour);
                }
            }
        }
    }
}

impl Slab<'_> {
    /// Adds a blob.
    #[inline(always)]
    fn add<L: Lanes>(&mut self, lanes: L, blob: &Blob, colour: Option<[f32; 3]>) {
        let field = self.field;
        let [x, y, z] = [0, 1, 2].map(|a| field.range(blob, a));
        let layers = self.layers.clone();
        let x = x.start.max(layers.start)..x.end.min(layers.end);
        let turn = &blob.inverse;
        let is_round = [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)]
            .iter()
            .all(|place| turn[*place] == 0.0);
        if is_round {
            return self.add_round(lanes, blob, colour, [x, y, z]);
        }
        let along = turn.column(2) * field.step[2];
        let c = along.norm_squared();
        let inverse = 1.0 / c;
        for i in x {
            for j in y.clone() {
                let base = turn * (field.node([i, j, z.start]) - blob.centre);
                let (a, b) = (base.norm_squared(), 2.0 * base.dot(&along));
                let Some(reached) = reached([a, b, c], inverse, z.len()) else {
                    continue;
                };
                let row = self.row(i, j) + z.start;
                self.add_row(lanes, row, reached, [blob.strength, a, b, c], colour);
            }
        }
    }

    /// The same without products that are 0: the same bits come from less work.
    #[inline(always)]
    fn add_round<L: Lanes>(
        &mut self,
        lanes: L,
        blob: &Blob,
        colour: Option<[f32; 3]>,
        [x, y, z]: [Range<usize>; 3],
    ) {
        let (field, turn) = (self.field, &blob.inverse);
        let low = field.node([0, 0, z.start]) - blob.centre;
        let (up, along) = (turn[(2, 2)] * low.z, turn[(2, 2)] * field.step[2]);
        let (b, c) = (2.0 * (up * along), along * along);
        let inverse = 1.0 / c;
        // What all rows have in common, and nothing for the nodes behind them.
        self.sums.along.clear();
        let all = (0..z.len()).map(|k| k as f32 * (b + k as f32 * c));
        self.sums.along.extend(all.chain([FAR; WIDTH]));
        for i in x {
            let aside = turn[(0, 0)] * (field.node([i, 0, 0]).x - blob.centre.x);
            for j in y.clone() {
                let deep = turn[(1, 1)] * (field.node([0, j, 0]).y - blob.centre.y);
                let a = aside * aside + deep * deep + up * up;
                let Some(reached) = reached([a, b, c], inverse, z.len()) else {
                    continue;
                };
                let row = self.row(i, j) + z.start;
                let mut first = reached.start;
                while first < reached.end {
                    if let Some(eight) = self.sums.along[first..].first_chunk::<WIDTH>() {
                        let square = lanes.splat(0.0).of_array(*eight) + a;
                        self.put(row + first, weight(square, blob.strength), colour);
                    }
                    first += WIDTH;
                }
            }
        }
    }

    /// Place of a row of nodes.
    #[inline(always)]
    fn row(&self, i: usize, j: usize) -> usize {
        let count = self.field.count;
        ((i - self.layers.start) * count[1] + j) * count[2]
    }

    /// Adds to eight nodes.
    #[inline(always)]
    fn put<F: Real>(&mut self, place: usize, w: F, colour: Option<[f32; 3]>) {
        let sums = &mut *self.sums;
        add_to(&mut sums.value[place..], w);
        if let Some(colour) = colour {
            for (sums, part) in sums.colour.iter_mut().zip(colour) {
                add_to(&mut sums[place..], w * part);
            }
        }
    }

    /// Adds [`kernel`] at the nodes `reached` of the row that begins at `row`.
    #[inline(always)]
    fn add_row<L: Lanes>(
        &mut self,
        lanes: L,
        row: usize,
        reached: Range<usize>,
        [strength, a, b, c]: [f32; 4],
        colour: Option<[f32; 3]>,
    ) {
        let one = lanes.splat(1.0);
        let count = one.of_array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let end = one.splat(reached.end as f32);
        let [b, c] = [b, c].map(|x| one.splat(x));
        let mut first = reached.start;
        while first < reached.end {
            let k = count + first as f32;
            // Nothing for the nodes behind the row.
            let w = weight((k * (b + k * c)) + a, strength).if_less(k, end);
            self.put(row + first, w, colour);
            first += WIDTH;
        }
    }
}

/// Of a row of so many nodes those at which [`kernel`] may be more than 0. `inverse`: of c.
#[inline(always)]
fn reached([a, b, c]: [f32; 3], inverse: f32, count: usize) -> Option<Range<usize>> {
    let square = 0.25 * b * b - c * (a - BEYOND);
    if square < 0.0 {
        return None;
    }
    if count <= 2 * WIDTH {
        return Some(0..count);
    }
    let (middle, half) = (-0.5 * b * inverse, square.sqrt() * inverse);
    let low = (middle - half).max(0.0) as i32 as usize;
    let high = (middle + half).max(0.0) as i32 as usize;
    Some(low.min(count)..(high + 2).min(count))
}

/// [`kernel`] of the square of q.
#[inline(always)]
fn weight<F: Real>(square: F, strength: f32) -> F {
    let q = square.at_least(0.0).sqrt();
    let one = q.splat(1.0);
    let t = (one - q * 0.5).at_least(0.0);
    let square = t * t;
    one.splat(strength) * square * square * (q * 2.0 + 1.0)
}

/// Adds to the first eight numbers.
#[inline(always)]
fn add_to<F: Real>(sums: &mut [f32], w: F) {
    let Some(sums) = sums.first_chunk_mut::<WIDTH>() else {
        return;
    };
    *sums = (w.of_array(*sums) + w).to_array();
}

/// `strength (1 - q/2)^4 (1 + 2 q)` with `q^2 = a + b k + c k^2`.
#[inline(always)]
pub(super) fn kernel(strength: f32, a: f32, b: f32, c: f32, k: f32) -> f32 {
    let q = (a + k * (b + k * c)).max(0.0).sqrt();
    let t = (1.0 - 0.5 * q).max(0.0);
    strength * (t * t) * (t * t) * (1.0 + 2.0 * q)
}
