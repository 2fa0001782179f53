//! Rows of some targets over a long support, for several sums: targets that lie together share a
//! list of candidates, and a row holds the places of its neighbours in it. A sum copies the
//! candidates of a block into the nearest cache and gathers from there.

use super::block::{Block, Bounds};
use super::stage::{STAGED, Stage};
use super::{FAR, Field, Pass, Payload, splat, total};
use crate::space::column::Columns;
use crate::space::grid::WIDE;
use crate::space::lane::{self, Half, Job, Lanes, WIDTH, dot};
use crate::space::parallel::{Parts, chunk, each_mut, each_part};
use crate::space::row::{CHUNK, Near, Search, count_points, separation};

/// See the [module](self).
#[derive(Default)]
pub struct Kept {
    targets: Vec<u32>,
    chunks: Vec<Chunk>,
    /// All points, without words: copied at one stroke.
    points: Vec<Half>,
}

/// Up to [`CHUNK`] targets.
#[derive(Default)]
struct Chunk {
    /// How many targets and candidates each block has.
    blocks: Vec<[u32; 2]>,
    candidates: Vec<u32>,
    /// How many neighbours each target has; their places, each row padded to eight.
    count: Vec<u32>,
    place: Vec<u16>,
    /// The candidates of a block, for a sum; then for the building.
    copied: Vec<Half>,
    near: Near,
    row: Vec<u32>,
}

impl Kept {
    /// Whose rows there are.
    pub fn targets(&self) -> &[u32] {
        &self.targets
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let of = |c: &Chunk| {
            8 * c.blocks.capacity()
                + 4 * (c.candidates.capacity() + c.count.capacity() + c.row.capacity())
                + 2 * c.place.capacity()
                + 16 * (c.copied.capacity() + c.near.index.capacity())
        };
        4 * self.targets.capacity()
            + 16 * self.points.capacity()
            + self.chunks.iter().map(of).sum::<usize>()
    }

    /// Finds who is within `cutoff` m of each target. `choose` fills in the targets, which are best
    /// in the order of blocks of cells; `search.cutoff`: the longest, m; `position`: of the
    /// targets, m.
    ///
    /// # Panics
    /// If a block of cells and what is about it hold 65536 points, or if the sources are not all
    /// among the points of `search`.
    pub fn build(
        &mut self,
        search: Search,
        position: &[Vec<f64>; 3],
        cutoff: impl Fn(usize) -> f64 + Sync,
        choose: impl FnOnce(&mut Vec<u32>),
    ) {
        choose(&mut self.targets);
        count_points(search.at, search.sources);
        let chunks = self.targets.len().div_ceil(CHUNK);
        self.chunks.resize_with(chunks, Chunk::default);
        let targets = &self.targets;
        each_part(&mut self.chunks[..], |c, found| {
            lane::run_mixed(Filling {
                search,
                position,
                cutoff: &cutoff,
                targets: &targets[chunk(c, CHUNK, targets.len())],
                chunk: found,
            });
        });
    }

    /// Takes over where the points are now, in fixed point.
    pub fn place(&mut self, [x, y, z]: &[Vec<i32>; 3]) {
        self.points.resize(x.len(), Half([0; 4]));
        each_mut(&mut self.points[..], |i, point| {
            *point = Half([x[i] as u32, y[i] as u32, z[i] as u32, 0])
        });
    }

    /// Sums over the neighbours, where [`Kept::place`] has seen them; `out[k]` belongs to target
    /// `k`. Of `field` what the points and the targets carry, and the scale; a point carries one
    /// word at most.
    pub fn sum<const N: usize, const W: usize, const O: usize, P: Pass<N>>(
        &mut self,
        field: Field<W, O>,
        pass: &P,
        out: &mut [P::Out],
    ) {
        const { assert!(W <= 1) };
        Field::<W, O>::check::<P::Payload>();
        assert_eq!(out.len(), self.targets.len());
        let (points, targets) = (self.points.as_slice(), &self.targets);
        let chunks = (&mut self.chunks[..], Parts::of(out, CHUNK));
        each_part(chunks, |c, (of, out)| {
            let job = Summing {
                field,
                points,
                pass,
                targets: &targets[chunk(c, CHUNK, targets.len())],
                chunk: of,
                out,
            };
            lane::run(field.scale.precision, job);
        });
    }
}

/// Some targets of [`Kept::build`].
struct Filling<'a, C> {
    search: Search<'a>,
    position: &'a [Vec<f64>; 3],
    cutoff: &'a C,
    targets: &'a [u32],
    chunk: &'a mut Chunk,
}

impl<C: Fn(usize) -> f64> Job for Filling<'_, C> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (search, chunk) = (self.search, self.chunk);
        chunk.blocks.clear();
        chunk.candidates.clear();
        chunk.count.clear();
        chunk.place.clear();
        let mut columns = Columns::new(search.grid, search.cutoff, WIDE);
        let mut targets = self.targets;
        while !targets.is_empty() {
            let (block, [low, high]) = Block::of(self.position, &columns, targets);
            let (own, rest) = targets.split_at(block.count);
            let mut longest: f64 = 0.0;
            for &i in own {
                longest = longest.max((self.cutoff)(i as usize));
            }
            let found = columns.about(&low, &high, longest);
            // SAFETY: `build` has counted the points of the search.
            let count = unsafe { chunk.near.gather(search, found) };
            let bounds = block.bounds(lanes, search.grid, longest);
            let count = chunk.gather(lanes, count, &bounds);
            for &i in own {
                let cutoff = (self.cutoff)(i as usize);
                chunk.add_row(lanes, search, (i as usize, cutoff), count);
            }
            chunk.blocks.push([own.len() as u32, count as u32]);
            targets = rest;
        }
    }
}

impl Chunk {
    /// Keeps who of the first `count` near points is within reach of a box, and numbers them; how
    /// many.
    #[inline(always)]
    fn gather<L: Lanes>(&mut self, lanes: L, count: usize, bounds: &Bounds<L>) -> usize {
        assert!(count.div_ceil(WIDTH) <= self.near.index.len() / WIDTH);
        let (mut kept, mut j) = (0, 0);
        while j < count {
            // SAFETY: the arrays hold as many whole eights, as asserted; what is written is never
            // behind what was read.
            unsafe {
                let mask = bounds.hold(&self.near.at, j, count - j);
                for at in &mut self.near.at {
                    let at = at.as_mut_ptr() as *mut u32;
                    lanes.compress(mask, at.add(j), at.add(kept));
                }
                let index = self.near.index.as_mut_ptr();
                kept += lanes.compress(mask, index.add(j), index.add(kept));
            }
            j += WIDTH;
        }
        assert!(kept <= 1 << 16, "{kept} points about a block of cells");
        self.candidates.extend_from_slice(&self.near.index[..kept]);
        for (place, index) in self.near.index[..kept].iter_mut().enumerate() {
            *index = place as u32;
        }
        kept
    }

    /// Appends the row of point `own` among the first `count` candidates.
    #[inline(always)]
    fn add_row<L: Lanes>(&mut self, lanes: L, search: Search, own: (usize, f64), count: usize) {
        self.row.clear();
        self.near.within(lanes, search, own, count, &mut self.row);
        self.count.push(self.row.len() as u32);
        self.place
            .extend(self.row.iter().map(|&place| place as u16));
        let padded = self.place.len().next_multiple_of(WIDTH);
        self.place.resize(padded, 0);
    }
}

/// Some targets of [`Kept::sum`].
struct Summing<'a, const N: usize, const W: usize, const O: usize, P: Pass<N>> {
    field: Field<'a, W, O>,
    points: &'a [Half],
    pass: &'a P,
    targets: &'a [u32],
    chunk: &'a mut Chunk,
    out: &'a mut [P::Out],
}

impl<const N: usize, const W: usize, const O: usize, P: Pass<N>> Job for Summing<'_, N, W, O, P> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (field, pass, chunk) = (self.field, self.pass, self.chunk);
        let points = self.points;
        let scale = field.scale.lanes(lanes);
        let mut stage = Stage::<L::F, P::Payload>::new(lanes);
        let mut candidates = chunk.candidates.as_slice();
        let mut places = chunk.place.as_slice();
        let mut targets = self.targets.iter().zip(&chunk.count).zip(self.out);
        for &[own, near] in &chunk.blocks {
            let (here, rest) = candidates.split_at(near as usize);
            candidates = rest;
            chunk.copied.clear();
            chunk
                .copied
                .extend(here.iter().map(|&j| points[j as usize]));
            if let Some(words) = field.payload.first() {
                for (point, &j) in chunk.copied.iter_mut().zip(here) {
                    point.0[3] = words[j as usize].to_bits();
                }
            }
            for ((&target, &count), out) in targets.by_ref().take(own as usize) {
                let (i, count) = (target as usize, count as usize);
                let (row, rest) = places.split_at(count.next_multiple_of(WIDTH));
                places = rest;
                let [x, y, z, _] = points[i].0;
                let own = splat(lanes, field.own_of(pass, i), pass.extra(i));
                let at = [x as i32, y as i32, z as i32];
                let mut sum = [lanes.splat(0.0); N];
                let mut left = count;
                for part in row.chunks(STAGED * WIDTH) {
                    let candidates = chunk.copied.as_slice();
                    // SAFETY: a row holds places among the candidates of its block.
                    unsafe { gather(lanes, &mut stage, candidates, part, at, scale) };
                    let groups = part.len() / WIDTH;
                    if left < part.len() {
                        let last = stage.q2(groups - 1);
                        *last = lanes.first(left % WIDTH, *last, lanes.splat(FAR));
                    }
                    left = left.saturating_sub(part.len());
                    stage.add(groups, pass, own, &mut sum);
                }
                pass.finish(i, total(&sum), out);
            }
        }
    }
}

/// The pairs of a target and the candidates of `part`, at most [`STAGED`] times eight.
///
/// # Safety
/// All places of `part` are below the number of candidates.
#[inline(always)]
unsafe fn gather<L: Lanes, P: Payload>(
    lanes: L,
    stage: &mut Stage<L::F, P>,
    candidates: &[Half],
    part: &[u16],
    at: [i32; 3],
    scale: [L::F; 3],
) {
    let zero = lanes.splat(0.0);
    assert!(part.len() <= STAGED * WIDTH);
    for (k, places) in part.chunks_exact(WIDTH).enumerate() {
        // SAFETY: there are eight places, all of candidates.
        let (other, word) = unsafe { lanes.gather_halves(candidates.as_ptr(), places.as_ptr()) };
        let away = separation(lanes, at, other, scale);
        let words = [word, zero, zero, zero, zero, zero];
        stage.put(k, away, dot(away, away), words);
    }
}
