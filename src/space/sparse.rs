//! A symmetric matrix of pair couplings: row i holds the neighbours of unknown i, with weights.
//!
//! Rows are laid out in fixed chunks and every row is summed by one thread in one order, so that a
//! product has the same bits for any number of threads. Weights are f32 (half the memory traffic,
//! which is all that a product costs), sums are f64.

use super::eights::{Eights, Group, Groups};
use super::grid::Scale;
use super::lane::{self, Job, Lanes, Real, WIDTH};
use super::parallel::{Parts, each_part};
use super::room::make_room;
use super::row::{CHUNK, Rows};
use super::sweep::{Pair, Payload, Records, STAGED, Stage, TOO_FEW, carried, splat};
use num_traits::AsPrimitive;

/// What couples a pair, and what else is summed along the row.
pub trait Couple<const N: usize>: Sync {
    /// What the points carry.
    type Payload: Payload;
    /// What is known of record `target` beside its payload.
    #[inline(always)]
    fn extra(&self, _target: usize) -> [f32; 3] {
        [0.0; 3]
    }
    /// See [`super::sweep::Pass::weigh`].
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        let q = q2.sqrt();
        [q, q]
    }
    /// Weights of eight pairs: zero for padding (d = 0) and beyond the support.
    fn pair<F: Real>(&self, pair: &Pair<F, Self::Payload>, sum: &mut [F; N]) -> F;
}

#[derive(Clone, Debug, Default)]
struct Chunk {
    /// First group of each row, and the number of all.
    start: Vec<u32>,
    /// Couplings of each row: the rest of its last group has no weight, and is left out.
    count: Vec<u32>,
    groups: Eights,
    weight: Vec<f32>,
    /// Indices of a row, for the building.
    row: Vec<u32>,
}

/// Off-diagonal weights of a symmetric matrix.
#[derive(Clone, Debug, Default)]
pub struct Sparse {
    chunks: Vec<Chunk>,
    count: usize,
    /// Every index in a row is below this.
    bound: usize,
}

/// Where rows come from: unknown i < `liquid.len()` is a liquid particle; each group of wall
/// particles is one more unknown, whose row is that of all its members. Those of ghosts follow.
#[derive(Clone, Copy)]
pub struct Layout<'a> {
    /// All records: liquid, wall, ghosts, images.
    pub records: &'a Records,
    /// Rows of the liquid particles.
    pub liquid: &'a Rows,
    /// Rows of the wall particles.
    pub wall: &'a Rows,
    /// Members of group g: `member[start[g] .. start[g + 1]]`, wall indices.
    pub start: &'a [u32],
    /// See `start`.
    pub member: &'a [u32],
    /// Unknown of each wall particle, then of each ghost.
    pub unknown: &'a [u32],
    /// Unknowns with those of ghosts, which have no row.
    pub columns: usize,
    /// First image record, and the record that each is an image of: it has no unknown of its own.
    pub images: (usize, &'a [u32]),
    /// Fixed-point units to multiples of the smoothing length.
    pub scale: Scale,
}

impl Layout<'_> {
    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.liquid.len() + self.start.len().saturating_sub(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The record that record `j` is an image of, or itself.
    #[inline(always)]
    fn original(&self, j: usize) -> usize {
        let (first, source) = self.images;
        match j < first {
            true => j,
            false => source[j - first] as usize,
        }
    }
}

impl Chunk {
    /// Ends a row.
    fn close(&mut self) {
        self.count.push(self.row.len() as u32);
        let whole = self.row.len().next_multiple_of(WIDTH);
        let padding = self.row.last().copied().unwrap_or(0);
        self.weight
            .resize(self.weight.len() + whole - self.row.len(), 0.0);
        self.row.resize(whole, padding);
        self.groups.extend(&self.row);
        self.row.clear();
    }
}

impl Sparse {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Weights held.
    pub fn entries(&self) -> usize {
        let entries = |c: &Chunk| c.count.iter().map(|&count| count as usize).sum::<usize>();
        self.chunks.iter().map(entries).sum()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let words = |c: &Chunk| {
            c.start.capacity() + c.count.capacity() + c.weight.capacity() + c.row.capacity()
        };
        let bytes = |c: &Chunk| c.groups.memory() + 4 * words(c);
        self.chunks.iter().map(bytes).sum()
    }

    /// The groups of row `i`, its weights, and how many couplings it has.
    #[inline(always)]
    fn groups(&self, i: usize) -> (Groups<'_>, &[[f32; WIDTH]], usize) {
        let chunk = &self.chunks[i / CHUNK];
        let k = i % CHUNK;
        let range = chunk.start[k] as usize..chunk.start[k + 1] as usize;
        let weight = &chunk.weight.as_chunks().0[range.clone()];
        (chunk.groups.groups(range), weight, chunk.count[k] as usize)
    }

    /// Neighbours and weights of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f32)> {
        let (groups, weight, count) = self.groups(i);
        let pairs = groups.indices().zip(weight.as_flattened().iter().copied());
        pairs.take(count)
    }

    /// SUM weight x over row `i`.
    ///
    /// # Panics
    /// If `x` is shorter than there are unknowns.
    #[inline(always)]
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        assert!(self.bound <= x.len(), "fewer values than unknowns");
        let (groups, weight, count) = self.groups(i);
        let (mut sum, whole) = ([0.0f64; 4], count / WIDTH);
        let mut pairs = groups.packed.iter().zip(weight);
        for (group, weight) in pairs.by_ref().take(whole) {
            // SAFETY: indices are below the bound, which is at most the length, as asserted, and a
            // base is one of them.
            unsafe {
                match groups.open(group) {
                    Group::Near(base, beyond) => {
                        add(&mut sum, x.get_unchecked(base as usize..), beyond, weight)
                    }
                    Group::Wide(index) => add(&mut sum, x, index, weight),
                }
            }
        }
        if let Some((group, weight)) = pairs.next() {
            let left = count % WIDTH;
            let four = left / 4 * 4;
            let index = groups.eight(group);
            for (k, (j, w)) in index.iter().zip(weight).take(left).enumerate() {
                sum[if k < four { k } else { 0 }] += *w as f64 * x[*j as usize];
            }
        }
        (sum[0] + sum[1]) + (sum[2] + sum[3])
    }

    /// Couples all unknowns; `degree[i]` becomes the sum of row i, `sums[i]` what else is summed.
    ///
    /// # Panics
    /// If rows were built for more points than there are records, if those carry what the pass does
    /// not read, or if a wall particle belongs to no unknown that there is.
    pub fn build<const N: usize, P: Couple<N>>(
        &mut self,
        layout: &Layout,
        pass: &P,
        degree: &mut Vec<f64>,
        sums: &mut Vec<[f32; N]>,
    ) {
        let (count, records) = (layout.len(), layout.records.len());
        let bound = layout.liquid.bound().max(layout.wall.bound());
        assert!(bound <= records, "{TOO_FEW}");
        layout.records.check::<P::Payload>();
        let known = layout
            .unknown
            .iter()
            .all(|&i| (i as usize) < layout.columns);
        assert!(known, "walls of unknowns that there are not");
        self.count = count;
        // Should this panic on the way, some rows are still those of the last time.
        self.bound = self.bound.max(layout.columns);
        self.chunks
            .resize_with(self.count.div_ceil(CHUNK), Chunk::default);
        degree.resize(self.count, 0.0);
        sums.resize(self.count, [0.0; N]);
        let out = (Parts::of(degree, CHUNK), Parts::of(sums, CHUNK));
        each_part((&mut self.chunks[..], out), |c, (chunk, (degree, sums))| {
            chunk.start.clear();
            chunk.count.clear();
            chunk.groups.clear();
            chunk.weight.clear();
            chunk.row.clear();
            let job = Filling {
                layout,
                pass,
                from: c * CHUNK,
                chunk,
                degree,
                sums,
            };
            lane::run(layout.scale.precision, job);
        });
        self.bound = layout.columns;
    }
}

/// Some unknowns of [`Sparse::build`].
struct Filling<'a, const N: usize, P> {
    layout: &'a Layout<'a>,
    pass: &'a P,
    from: usize,
    chunk: &'a mut Chunk,
    degree: &'a mut [f64],
    sums: &'a mut [[f32; N]],
}

impl<const N: usize, P: Couple<N>> Job for Filling<'_, N, P> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (layout, pass, from, chunk) = (self.layout, self.pass, self.from, self.chunk);
        let n = layout.liquid.len();
        let mut stage = Stage::<L::F, P::Payload>::new(lanes);
        for (k, (degree, sums)) in self.degree.iter_mut().zip(self.sums).enumerate() {
            chunk.start.push(chunk.groups.len() as u32);
            let mut eights = [lanes.splat(0.0); N];
            *degree = 0.0;
            let i = from + k;
            if i < n {
                let row = layout.liquid.row(i);
                // SAFETY: `build` has asserted that rows name records.
                *degree += unsafe {
                    append(
                        lanes,
                        layout,
                        pass,
                        (i, row),
                        &mut stage,
                        &mut eights,
                        chunk,
                    )
                };
            } else {
                let g = i - n;
                let members = layout.start[g] as usize..layout.start[g + 1] as usize;
                for &j in &layout.member[members] {
                    let (row, j) = (layout.wall.row(j as usize), n + j as usize);
                    // SAFETY: the same.
                    *degree += unsafe {
                        append(
                            lanes,
                            layout,
                            pass,
                            (j, row),
                            &mut stage,
                            &mut eights,
                            chunk,
                        )
                    };
                }
            }
            chunk.close();
            for (sum, eight) in sums.iter_mut().zip(eights) {
                *sum = eight.sum();
            }
        }
        chunk.start.push(chunk.groups.len() as u32);
    }
}

/// Adds weight times value, eight times.
///
/// # Safety
/// All indices are below the number of values.
#[inline(always)]
unsafe fn add<J: AsPrimitive<usize>>(
    sum: &mut [f64; 4],
    x: &[f64],
    index: &[J; WIDTH],
    weight: &[f32; WIDTH],
) {
    for k in 0..WIDTH {
        // SAFETY: the caller knows that there are so many values.
        sum[k % 4] += weight[k] as f64 * unsafe { *x.get_unchecked(index[k].as_()) };
    }
}

/// Appends the couplings of record `target`; their sum. Walls are not coupled to walls.
///
/// # Safety
/// All indices in `row` are below the number of records.
#[inline(always)]
unsafe fn append<L: Lanes, const N: usize, P: Couple<N>>(
    lanes: L,
    layout: &Layout,
    pass: &P,
    (target, row): (usize, Groups),
    stage: &mut Stage<L::F, P::Payload>,
    sum: &mut [L::F; N],
    chunk: &mut Chunk,
) -> f64 {
    let n = layout.liquid.len();
    let walls = n..n + layout.wall.len();
    let record = &layout.records[target];
    let at = [record.at(0), record.at(1), record.at(2)];
    let scale = layout.scale.lanes(lanes);
    let own = splat(lanes, carried::<P::Payload>(record), pass.extra(target));
    let mut degree = 0.0;
    make_room(&mut chunk.weight, WIDTH * row.len());
    chunk.row.reserve(WIDTH * row.len());
    let (from, mut kept) = (chunk.row.len(), 0);
    // SAFETY: those are the ends of what is written.
    let (indices, weights) = unsafe {
        let weights = chunk.weight.as_mut_ptr().add(chunk.weight.len());
        (chunk.row.as_mut_ptr().add(from), weights)
    };
    for part in row.chunks(STAGED) {
        // SAFETY: all indices are of records.
        let count = unsafe { stage.gather(lanes, layout.records, part, at, scale) };
        for k in 0..count {
            let weight = pass.weigh(*stage.q2(k));
            stage.weight(k, weight);
        }
        for (k, group) in part.packed.iter().enumerate() {
            let weight = pass.pair(&stage.pair(k, own), sum).to_array();
            // All are written, and those that count are passed: no branch that cannot be foretold.
            for (w, j) in weight.into_iter().zip(part.eight(group)) {
                let j = layout.original(j as usize);
                let w = match target >= n && walls.contains(&j) {
                    true => 0.0,
                    false => w,
                };
                let unknown = match j < n {
                    true => j as u32,
                    false => layout.unknown[j - n],
                };
                // SAFETY: there is room for the whole row, and no more was kept so far.
                unsafe {
                    *indices.add(kept) = unknown;
                    *weights.add(kept) = w;
                }
                kept += usize::from(w != 0.0);
                degree += w as f64;
            }
        }
    }
    // SAFETY: so many were written.
    unsafe {
        chunk.row.set_len(from + kept);
        chunk.weight.set_len(chunk.weight.len() + kept);
    }
    degree
}
