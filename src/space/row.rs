//! Neighbour rows: for each target the indices of the records within a cutoff, each row padded to
//! eight with the target itself, so that lanes are always full and a padding pair is at distance 0.
//! A target may also be in its own row: sums leave out what is at distance 0.

use super::column::{Columns, Place};
use super::eights::{Eights, Groups};
use super::grid::Grid;
use super::lane::{self, Job, Lanes, Real, WIDTH, dot};
use super::parallel::{chunk, each_part};

/// Rows per chunk; fixed, so that nothing depends on the number of threads.
pub const CHUNK: usize = 1024;

/// Cells of a column whose targets look for neighbours together.
const BLOCK: usize = 2;

/// Room for the candidates of most blocks, so that it seldom grows.
const MOSTLY: usize = 640;

#[derive(Clone, Debug, Default)]
struct Chunk {
    /// First group of each row, and the number of all.
    start: Vec<u32>,
    groups: Eights,
    /// For the building.
    near: Near,
    row: Vec<u32>,
}

/// Neighbour rows of a contiguous range of targets.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    chunks: Vec<Chunk>,
    count: usize,
    /// Every index in a row is below this.
    bound: usize,
    /// First target: row k belongs to record `first + k`.
    pub first: usize,
}

/// Where candidates are: sorted points `offset..` of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// First of each cell, and the number of all.
    pub start: &'a [u32],
    /// Their first point.
    pub offset: usize,
}

impl Source<'_> {
    /// The points of the cells `first..=last` (one column): first and end; none if there are no
    /// such cells.
    #[inline(always)]
    pub(super) fn run(&self, (first, last): (u32, u32)) -> (usize, usize) {
        let begin = self.start[first as usize] as usize;
        let end = self.start[last as usize + 1] as usize;
        (begin + self.offset, end.max(begin) + self.offset)
    }
}

/// The number of points at `at`, without the spare ones.
///
/// # Panics
/// Unless eight coordinates of every axis can be read from each point of `sources` on, and from the
/// end of their cells on. The reads in [`Near`] and in the sweeps are not checked: they rely on
/// this, which is asked once per search.
pub(super) fn count_points(at: &[Vec<i32>; 3], sources: &[Source]) -> usize {
    let all = at[0].len();
    assert!(all >= WIDTH, "no spare coordinates");
    assert!(at.iter().all(|at| at.len() == all), "coordinates differ");
    let count = all - WIDTH;
    for source in sources {
        let last = source.start.last().map_or(0, |&last| last as usize);
        let fits = source.offset <= count && last <= count - source.offset;
        assert!(source.start.is_sorted() && fits, "cells of other points");
    }
    count
}

/// One to five sources.
pub struct Sources<'a>([Source<'a>; 5], usize);

impl<'a> Sources<'a> {
    /// Those of `some`: one to five.
    pub fn of(some: &[Source<'a>]) -> Self {
        let all = std::array::from_fn(|k| some[k.min(some.len() - 1)]);
        Sources(all, some.len())
    }
}

impl<'a> std::ops::Deref for Sources<'a> {
    type Target = [Source<'a>];
    fn deref(&self) -> &[Source<'a>] {
        &self.0[..self.1]
    }
}

/// What a build needs.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// The cells.
    pub grid: &'a Grid,
    /// Fixed-point coordinates of all points, with at least eight spare at the end.
    pub at: &'a [Vec<i32>; 3],
    /// Which of the points are looked at.
    pub sources: &'a [Source<'a>],
    /// Longest cutoff, m.
    pub cutoff: f64,
    /// Cutoff of every point, m; none if it is the same for all.
    pub each: &'a [f32],
}

impl Search<'_> {
    /// Cutoff of point `i`, m.
    #[inline(always)]
    fn cutoff_of(&self, i: usize) -> f64 {
        self.each.get(i).map_or(self.cutoff, |&c| c as f64)
    }
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The neighbours of target `first + k`, padding included.
    #[inline(always)]
    pub fn row(&self, k: usize) -> Groups<'_> {
        let chunk = &self.chunks[k / CHUNK];
        let k = k % CHUNK;
        let range = chunk.start[k] as usize..chunk.start[k + 1] as usize;
        chunk.groups.groups(range)
    }

    /// Entries, padding included.
    pub fn entries(&self) -> usize {
        self.chunks.iter().map(|c| WIDTH * c.groups.len()).sum()
    }

    /// Bytes held for rows.
    pub fn memory(&self) -> usize {
        let bytes = |c: &Chunk| c.groups.memory() + 4 * c.start.capacity();
        self.chunks.iter().map(bytes).sum()
    }

    /// One more than the largest index that any row can hold.
    pub(super) fn bound(&self) -> usize {
        self.bound
    }

    /// Bytes held for building.
    pub fn scratch(&self) -> usize {
        self.chunks
            .iter()
            .map(|c| 16 * c.near.index.capacity() + 4 * c.row.capacity())
            .sum()
    }

    /// Finds the neighbours of the points `first .. first + position.len()`, which lie at
    /// `position` (m).
    ///
    /// # Panics
    /// If the sources or the targets are not all among the points of `search`.
    pub fn build(&mut self, search: Search, first: usize, position: &[Vec<f64>; 3]) {
        let (points, count) = (count_points(search.at, search.sources), position[0].len());
        let fits = first <= points && count <= points - first;
        assert!(fits, "targets that are no points");
        // Should this panic on the way, some rows are still those of the last time.
        self.bound = self.bound.max(points);
        (self.first, self.count) = (first, count);
        self.chunks
            .resize_with(count.div_ceil(CHUNK), Chunk::default);
        each_part(&mut self.chunks[..], |c, rows| {
            lane::run_mixed(Filling {
                search,
                first,
                position,
                range: chunk(c, CHUNK, count),
                chunk: rows,
            });
        });
        self.bound = points;
    }
}

/// Some rows of [`Rows::build`].
struct Filling<'a> {
    search: Search<'a>,
    first: usize,
    position: &'a [Vec<f64>; 3],
    range: std::ops::Range<usize>,
    chunk: &'a mut Chunk,
}

impl Job for Filling<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (search, first, position, chunk) = (self.search, self.first, self.position, self.chunk);
        chunk.start.clear();
        chunk.groups.clear();
        let mut columns = Columns::new(search.grid, search.cutoff, 1);
        let (mut k, stop) = (self.range.start, self.range.end);
        while k < stop {
            // Targets that lie together look at the same candidates.
            let mut cutoff = search.cutoff_of(first + k);
            let mut low = columns.place(point(position, k));
            let (mut high, mut end) = (low, k + 1);
            while end < stop && extend(&mut low, &mut high, columns.place(point(position, end))) {
                cutoff = cutoff.max(search.cutoff_of(first + end));
                end += 1;
            }
            let found = columns.about(&low, &high, cutoff);
            // SAFETY: `build` has counted the points of the search.
            let count = unsafe { chunk.near.gather(search, found) };
            for k in k..end {
                chunk.start.push(chunk.groups.len() as u32);
                let own = first + k;
                let cutoff = search.cutoff_of(own);
                let row = &mut chunk.row;
                row.clear();
                chunk.near.within(lanes, search, (own, cutoff), count, row);
                pad(row, own as u32);
                chunk.groups.extend(row);
            }
            k = end;
        }
        chunk.start.push(chunk.groups.len() as u32);
    }
}

/// Fills `row` up with `own` to whole eights. All eight are written: a loop would be mispredicted.
#[inline(always)]
fn pad(row: &mut Vec<u32>, own: u32) {
    row.reserve(WIDTH);
    let filled = row.len();
    // SAFETY: there is room for eight, of which fewer are kept.
    unsafe {
        let padding = row.as_mut_ptr().add(filled) as *mut [u32; WIDTH];
        padding.write_unaligned([own; WIDTH]);
        row.set_len(filled.next_multiple_of(WIDTH));
    }
}

#[inline(always)]
fn point(position: &[Vec<f64>; 3], k: usize) -> [f64; 3] {
    [position[0][k], position[1][k], position[2][k]]
}

/// Makes `low..high` reach to `place` if that is in the same block of cells, which `low` begins.
#[inline(always)]
fn extend(low: &mut Place, high: &mut Place, mut place: Place) -> bool {
    let up = place.cell[2].wrapping_sub(low.cell[2]);
    if place.cell[..2] != low.cell[..2] || up >= BLOCK {
        return false;
    }
    place.part[2] += up as f32;
    for a in 0..3 {
        low.part[a] = low.part[a].min(place.part[a]);
        high.part[a] = high.part[a].max(place.part[a]);
    }
    true
}

/// Candidates, copied together. `at` is as long as `index`.
#[derive(Clone, Debug, Default)]
pub(super) struct Near {
    pub at: [Vec<i32>; 3],
    pub index: Vec<u32>,
}

impl Near {
    /// Copies the points of `columns`; how many there are. If there are any, at least eight words
    /// more can be read.
    ///
    /// # Safety
    /// [`count_points`] has counted the points of `search`.
    #[inline(always)]
    pub unsafe fn gather(&mut self, search: Search, columns: &[(u32, u32)]) -> usize {
        let (mut count, last) = (0, search.at[0].len() - WIDTH);
        for &column in columns {
            for source in search.sources {
                let (begin, end) = source.run(column);
                let room = count + end - begin + 2 * WIDTH;
                if self.index.len() < room {
                    let room = (2 * room).max(MOSTLY);
                    self.at.iter_mut().for_each(|at| at.resize(room, 0));
                    self.index.resize(room, 0);
                }
                // Mostly two times eight or less: a loop would be mispredicted.
                // SAFETY: `begin` and `end` are at most `last`; there is room for all and for two
                // times eight more.
                unsafe {
                    self.copy(search.at, begin, count);
                    self.copy(search.at, (begin + WIDTH).min(last), count + WIDTH);
                }
                for j in (begin + 2 * WIDTH..end).step_by(WIDTH) {
                    // SAFETY: the same.
                    unsafe { self.copy(search.at, j, count + j - begin) };
                }
                count += end - begin;
            }
        }
        count
    }

    /// Appends to `row` the indices of those of the first `count` that are within `cutoff` m of
    /// point `own`, itself at distance 0 among them.
    #[inline(always)]
    pub fn within<L: Lanes>(
        &self,
        lanes: L,
        search: Search,
        (own, cutoff): (usize, f64),
        count: usize,
        row: &mut Vec<u32>,
    ) {
        assert!(count.div_ceil(WIDTH) <= self.index.len() / WIDTH);
        let scale = search.grid.scale(cutoff).lanes(lanes);
        let [x, y, z] = search.at;
        let at = [x[own], y[own], z[own]];
        let one = lanes.splat(1.0);
        row.reserve(count + 2 * WIDTH);
        let mut filled = row.len();
        let (out, words) = (row.as_mut_ptr(), self.index.as_ptr());
        let [x, y, z] = &self.at;
        let (x, y, z) = (x.as_ptr(), y.as_ptr(), z.as_ptr());
        let mut j = 0;
        while j < count {
            // SAFETY: the arrays hold as many whole eights, as asserted.
            let other = unsafe {
                [
                    lanes.load_fixed(x.add(j)),
                    lanes.load_fixed(y.add(j)),
                    lanes.load_fixed(z.add(j)),
                ]
            };
            let d = separation(lanes, at, other, scale);
            let mut mask = dot(d, d).less_mask(one);
            if count - j < WIDTH {
                mask &= (1 << (count - j)) - 1;
            }
            // SAFETY: the same; at most `j` were written, and there is room for more than `count`.
            filled += unsafe { lanes.compress(mask, words.add(j), out.add(filled)) };
            j += WIDTH;
        }
        // SAFETY: so many were written.
        unsafe { row.set_len(filled) };
    }

    /// Eight points from `j` on become those from `to` on.
    ///
    /// # Safety
    /// `at` has eight words from `j` on, and every array here has eight from `to` on.
    #[inline(always)]
    unsafe fn copy(&mut self, at: &[Vec<i32>; 3], j: usize, to: usize) {
        for (near, at) in self.at.iter_mut().zip(at) {
            debug_assert!(j + WIDTH <= at.len() && to + WIDTH <= near.len());
            // SAFETY: eight words are there and there.
            unsafe {
                let from = at.as_ptr().add(j) as *const [i32; WIDTH];
                let to = near.as_mut_ptr().add(to) as *mut [i32; WIDTH];
                to.write_unaligned(from.read_unaligned());
            }
        }
        let mut index = [0; WIDTH];
        for (k, index) in index.iter_mut().enumerate() {
            *index = (j + k) as u32;
        }
        // SAFETY: eight words are there.
        unsafe {
            let to = self.index.as_mut_ptr().add(to) as *mut [u32; WIDTH];
            to.write_unaligned(index);
        }
    }
}

/// Own minus other, scaled.
#[inline(always)]
pub(super) fn separation<L: Lanes>(
    lanes: L,
    at: [i32; 3],
    other: [L::I; 3],
    scale: [L::F; 3],
) -> [L::F; 3] {
    [
        lanes.difference(at[0], other[0]) * scale[0],
        lanes.difference(at[1], other[1]) * scale[1],
        lanes.difference(at[2], other[2]) * scale[2],
    ]
}
