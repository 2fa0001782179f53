//! Which columns of cells may hold what lies within a cutoff of a point.
//!
//! The distance to a lateral slab of cells is known per axis, so a column at lateral distance l is
//! looked at over +- sqrt(cutoff^2 - l^2) along z only. The same for a block of points in one cell.

use super::grid::{Grid, WIDE};

/// Most cells that a cutoff may reach to each side.
pub const REACH: usize = 8;
/// Slabs of cells of an axis in whole groups.
const SIDE: usize = (2 * REACH + WIDE).next_multiple_of(GROUP);
const MOST: usize = (2 * REACH + WIDE) * (2 * REACH + WIDE);

/// Slabs whose numbers are found together.
const GROUP: usize = 8;

/// Cells from a block of points, beyond any grid: so that numbers of cells fit into 32 bits.
const FARTHEST: f32 = 1e9;

/// A cell and a place in it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Which cell.
    pub cell: [usize; 3],
    /// In cells from the low side; outside 0..1 beyond the grid.
    pub part: [f32; 3],
}

/// The search about one point after another; points of the same column of cells share work.
pub struct Columns<'a> {
    grid: &'a Grid,
    cutoff: f64,
    /// Lateral cells of a block.
    wide: i32,
    /// Lateral cell for which the rest was made.
    at: [usize; 2],
    /// Per lateral axis: first offset in cells, how many, and whether all slabs are looked at.
    span: [(i32, usize, bool); 2],
    /// First cell of each column.
    base: [u32; MOST],
    found: [(u32, u32); 2 * MOST],
}

impl<'a> Columns<'a> {
    /// `wide`: how many cells to each side, at most [`WIDE`], the blocks have.
    ///
    /// # Panics
    /// If `cutoff`, m, reaches farther than [`REACH`] cells.
    pub fn new(grid: &'a Grid, cutoff: f64, wide: usize) -> Self {
        for a in 0..2 {
            assert!(cutoff <= REACH as f64 * grid.edge[a], "cells too small");
        }
        Columns {
            grid,
            cutoff,
            wide: wide as i32,
            at: [usize::MAX; 2],
            span: [(0, 0, false); 2],
            base: [0; MOST],
            found: [(0, 0); 2 * MOST],
        }
    }

    /// (First, last) cells of the columns that may hold anything within `cutoff` m (at most that of
    /// [`Columns::new`]) of any point between two places, `high` counted from the cell of `low`, in
    /// a fixed order, which is that of each point's own columns; no cell is in two of them.
    #[inline(always)]
    pub fn about(&mut self, low: &Place, high: &Place, cutoff: f64) -> &[(u32, u32)] {
        let grid = self.grid;
        let cell = low.cell;
        if self.at != [cell[0], cell[1]] {
            self.enter([cell[0], cell[1]]);
        }
        let gaps = [0, 1].map(|a| self.gaps(a, low.part[a], high.part[a]));
        // Room for the rounding of f32.
        let cutoff = (cutoff * 1.00001) as f32;
        let c2 = cutoff * cutoff;
        let per_edge = (1.0 / grid.edge[2]) as f32;
        let (z, n) = (cell[2] as i32, grid.count[2] as i32);
        let rows = self.span[1].1;
        let mut count = 0;
        for i in 0..self.span[0].1 {
            let left = c2 - gaps[0][i];
            let mut range = [(0i32, 0i32); SIDE];
            let groups = gaps[1].as_chunks::<GROUP>().0.iter();
            let ranges = range.as_chunks_mut::<GROUP>().0.iter_mut();
            for (gaps, ranges) in groups.zip(ranges).take(rows.div_ceil(GROUP)) {
                for j in 0..GROUP {
                    let r = (left - gaps[j]).max(0.0).sqrt() * per_edge;
                    let (first, last) = ((low.part[2] - r).floor(), (high.part[2] + r).floor());
                    #[expect(clippy::manual_clamp, reason = "`clamp` would keep what is no number")]
                    let (first, last) = (
                        first.max(-FARTHEST).min(FARTHEST),
                        last.min(FARTHEST).max(-FARTHEST),
                    );
                    // SAFETY: both are numbers, below 2^31.
                    ranges[j] = unsafe { (first.to_int_unchecked(), last.to_int_unchecked()) };
                }
            }
            for j in 0..rows {
                if left < gaps[1][j] {
                    continue;
                }
                let base = self.base[i * rows + j];
                let (low, high) = (z + range[j].0, z + range[j].1);
                if !grid.periodic[2] {
                    let (low, high) = (low.clamp(0, n - 1), high.clamp(0, n - 1));
                    self.found[count] = (base + low as u32, base + high as u32);
                    count += 1;
                } else {
                    count += wrapped(base, low, high, n, &mut self.found[count..]);
                }
            }
        }
        &self.found[..count]
    }

    /// [`Grid::fix3`].
    #[inline(always)]
    pub fn fix(&self, x: [f64; 3]) -> [i32; 3] {
        self.grid.fix3(x)
    }

    /// Where `x` m is.
    #[inline(always)]
    pub fn place(&self, x: [f64; 3]) -> Place {
        let (mut cell, mut part) = ([0; 3], [0.0; 3]);
        for a in 0..3 {
            let t = (x[a] - self.grid.low[a]) / self.grid.edge[a];
            let last = self.grid.count[a] as f64 - 1.0;
            let mut c = t.floor();
            if self.grid.periodic[a] {
                part[a] = (t - c) as f32;
                if c < 0.0 || c > last {
                    c = self.grid.bring(a, c as i64) as f64;
                }
            } else {
                c = c.max(0.0).min(last);
                part[a] = (t - c) as f32;
            }
            cell[a] = c as usize;
        }
        Place { cell, part }
    }

    /// Squared distances, m^2, from `low..high` to the slabs of a lateral axis.
    #[inline(always)]
    fn gaps(&self, axis: usize, low: f32, high: f32) -> [f32; SIDE] {
        let (first, _, all) = self.span[axis];
        let edge = self.grid.edge[axis];
        let edge = if edge.is_finite() && !all {
            edge as f32
        } else {
            0.0
        };
        let mut gaps = [0.0; SIDE];
        for (k, gap) in gaps.iter_mut().enumerate() {
            let offset = (first + k as i32) as f32;
            let away = (offset - high).max(low - offset - 1.0).max(0.0) * edge;
            *gap = if (0..self.wide).contains(&(first + k as i32)) {
                0.0
            } else {
                away * away
            };
        }
        gaps
    }

    /// Finds the columns about the lateral cell `at`.
    #[inline(never)]
    fn enter(&mut self, at: [usize; 2]) {
        let grid = self.grid;
        self.at = at;
        for a in 0..2 {
            let (n, c) = (grid.count[a] as i32, at[a] as i32);
            let reach = (self.cutoff / grid.edge[a]).ceil() as i32;
            let up = reach + self.wide - 1;
            self.span[a] = if grid.periodic[a] && reach + up + 1 >= n {
                (-c, n as usize, true)
            } else if grid.periodic[a] {
                (-reach, (reach + up) as usize + 1, false)
            } else {
                let (low, high) = ((c - reach).max(0), (c + up).min(n - 1));
                (low - c, (high - low) as usize + 1, false)
            };
        }
        let [xs, ys] = self.span;
        for i in 0..xs.1 {
            let x = grid.bring(0, at[0] as i64 + xs.0 as i64 + i as i64);
            for j in 0..ys.1 {
                let y = grid.bring(1, at[1] as i64 + ys.0 as i64 + j as i64);
                self.base[i * ys.1 + j] = grid.index([x, y, 0]) as u32;
            }
        }
    }
}

/// One or two runs of a periodic column.
#[inline(always)]
fn wrapped(base: u32, low: i32, high: i32, n: i32, out: &mut [(u32, u32)]) -> usize {
    let run = |a: i32, b: i32| (base + a as u32, base + b as u32);
    if high - low + 1 >= n {
        out[0] = run(0, n - 1);
        return 1;
    }
    // Less than n cells from a cell of the grid.
    let into = |c: i32| c + if c < 0 { n } else { 0 } - if c >= n { n } else { 0 };
    let (low, high) = (into(low), into(high));
    if low <= high {
        out[0] = run(low, high);
        return 1;
    }
    out[0] = run(0, high);
    out[1] = run(low, n - 1);
    2
}
