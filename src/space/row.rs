//! Neighbour rows: for each target the indices of the records within a cutoff, each row padded to
//! eight with the target itself, so that lanes are always full and a padding pair is at distance 0.
//! A target may also be in its own row: sums leave out what is at distance 0.

use super::column::Columns;
use super::grid::Grid;
use super::lane::{Lanes, Portable, WIDTH};
use rayon::prelude::*;

/// Rows per chunk; fixed, so that nothing depends on the number of threads.
pub const CHUNK: usize = 1024;

#[derive(Clone, Debug, Default)]
struct Chunk {
    start: Vec<u32>,
    index: Vec<u32>,
}

/// Neighbour rows of a contiguous range of targets.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    chunks: Vec<Chunk>,
    count: usize,
    /// First target: row k belongs to record `first + k`.
    pub first: usize,
}

/// Where candidates are: sorted points `offset..` of one kind.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// First of each cell, and the number of all.
    pub start: &'a [u32],
    pub offset: usize,
}

impl Source<'_> {
    /// The points of the cells `first..=last` (one column): first and end.
    #[inline(always)]
    pub(super) fn run(&self, (first, last): (u32, u32)) -> (usize, usize) {
        let begin = self.start[first as usize] as usize;
        let end = self.start[last as usize + 1] as usize;
        (begin + self.offset, end + self.offset)
    }
}

/// What a build needs.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    pub grid: &'a Grid,
    /// Fixed-point coordinates of all points, with at least eight spare at the end.
    pub at: &'a [Vec<i32>; 3],
    pub sources: &'a [Source<'a>],
    /// Longest cutoff, m.
    pub cutoff: f64,
    /// Cutoff of every point, m; none if it is the same for all.
    pub each: &'a [f32],
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.count
    }

    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The neighbours of target `first + k`, padding included.
    #[inline(always)]
    pub fn row(&self, k: usize) -> &[u32] {
        let chunk = &self.chunks[k / CHUNK];
        let k = k % CHUNK;
        &chunk.index[chunk.start[k] as usize..chunk.start[k + 1] as usize]
    }

    /// Entries, padding included.
    pub fn entries(&self) -> usize {
        self.chunks.iter().map(|c| c.index.len()).sum()
    }

    /// Finds the neighbours of the points `first .. first + position.len()`, which lie at
    /// `position` (m).
    pub fn build(&mut self, search: Search, first: usize, position: &[Vec<f64>; 3]) {
        self.first = first;
        self.count = position[0].len();
        self.chunks
            .resize_with(self.count.div_ceil(CHUNK), Chunk::default);
        let count = self.count;
        self.chunks
            .par_iter_mut()
            .enumerate()
            .for_each(|(c, chunk)| {
                let range = c * CHUNK..((c + 1) * CHUNK).min(count);
                #[cfg(target_arch = "x86_64")]
                if super::lane::wide() {
                    return unsafe { fill_avx2(search, first, position, range, chunk) };
                }
                unsafe { fill::<Portable>(search, first, position, range, chunk) }
            });
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt")]
unsafe fn fill_avx2(
    search: Search,
    first: usize,
    position: &[Vec<f64>; 3],
    range: std::ops::Range<usize>,
    chunk: &mut Chunk,
) {
    unsafe { fill::<super::lane::Avx2>(search, first, position, range, chunk) }
}

#[inline(always)]
unsafe fn fill<L: Lanes>(
    search: Search,
    first: usize,
    position: &[Vec<f64>; 3],
    range: std::ops::Range<usize>,
    chunk: &mut Chunk,
) {
    chunk.start.clear();
    chunk.index.clear();
    let mut columns = Columns::new(search.grid, search.cutoff);
    for k in range {
        chunk.start.push(chunk.index.len() as u32);
        let x = [position[0][k], position[1][k], position[2][k]];
        let cutoff = search
            .each
            .get(first + k)
            .map_or(search.cutoff, |&c| c as f64);
        let found = columns.around(x, cutoff);
        unsafe { neighbours::<L>(search, first + k, cutoff, found, &mut chunk.index) };
        while chunk.index.len() % WIDTH != 0 {
            chunk.index.push((first + k) as u32);
        }
    }
    chunk.start.push(chunk.index.len() as u32);
}

/// Appends the neighbours of point `own` in `columns`; it is its own neighbour at distance 0.
#[inline(always)]
unsafe fn neighbours<L: Lanes>(
    search: Search,
    own: usize,
    cutoff: f64,
    columns: &[(u32, u32)],
    index: &mut Vec<u32>,
) {
    unsafe {
        let scale = L::splat3(search.grid.scale(cutoff));
        let [x, y, z] = search.at;
        let at = [x[own], y[own], z[own]];
        let one = L::splat(1.0);
        for &column in columns {
            for source in search.sources {
                let (mut j, end) = source.run(column);
                if j == end {
                    continue;
                }
                index.reserve(end - j + WIDTH);
                let mut filled = index.len();
                while j < end {
                    let d = separation::<L>(at, L::load_at(search.at, j), scale);
                    let mut mask = L::less_mask(L::dot(d, d), one);
                    if end - j < WIDTH {
                        mask &= (1 << (end - j)) - 1;
                    }
                    filled += L::compress(mask, j as u32, index.as_mut_ptr().add(filled));
                    j += WIDTH;
                }
                index.set_len(filled);
            }
        }
    }
}

/// Own minus other, scaled.
#[inline(always)]
pub(super) unsafe fn separation<L: Lanes>(
    at: [i32; 3],
    other: [L::F; 3],
    scale: [L::F; 3],
) -> [L::F; 3] {
    unsafe {
        [
            L::mul(L::difference(at[0], other[0]), scale[0]),
            L::mul(L::difference(at[1], other[1]), scale[1]),
            L::mul(L::difference(at[2], other[2]), scale[2]),
        ]
    }
}
