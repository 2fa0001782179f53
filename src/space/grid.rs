//! Fixed-point coordinates and a grid of cells over the box.
//!
//! A coordinate is stored for the pair loops as a 32-bit integer in units of range / 2^32. The
//! range
//! of a periodic axis is its period, so that the wrapping difference of two coordinates *is* the
//! nearest image; differences are exact and are rounded once, when they become f32.
//! Other axes have a range four times the covered length, so that nothing wraps by accident.

use super::lane::Lanes;
use crate::scene::{Dimension, Domain, Precision, Side};

/// Most cells of a block to each side.
pub const WIDE: usize = 2;

/// Where the cells are.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Lower corner of the cells, m.
    pub low: [f64; 3],
    /// Metres per fixed-point unit.
    pub unit: [f64; 3],
    /// Cell edges, m.
    pub edge: [f64; 3],
    /// Cells per axis.
    pub count: [usize; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
    /// Period, or four times the covered length, m.
    range: [f64; 3],
    /// Of the pair sums.
    pub precision: Precision,
}

/// What makes fixed-point differences multiples of a length, and how exactly pairs are summed.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Multiples of the length in a fixed-point unit.
    pub factor: [f64; 3],
    /// Of the pair sums.
    pub precision: Precision,
}

impl Scale {
    /// The factors in all lanes.
    #[inline(always)]
    pub fn lanes<L: Lanes>(self, lanes: L) -> [L::F; 3] {
        let [x, y, z] = self.factor;
        [lanes.constant(x), lanes.constant(y), lanes.constant(z)]
    }

    /// The square of `length` m in that multiple.
    pub fn square(self, grid: &Grid, length: f64) -> f64 {
        (length * self.factor[0] / grid.unit[0]).powi(2)
    }
}

/// A scene that the cells cannot hold.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "the box is {size:.4e} m along periodic axis {axis}, but a kernel support needs {need:.4e} m; \
     make the box larger or the spacing smaller"
)]
pub struct TooSmall {
    /// Which axis: 0, 1 or 2.
    pub axis: usize,
    /// Its length, m.
    pub size: f64,
    /// The least length that would do, m.
    pub need: f64,
}

impl Grid {
    /// Cells of about `edge` over the box plus `margin` beyond its non-periodic sides.
    /// `cutoff`: the longest pair distance that will be asked for, m.
    pub fn new(
        domain: &Domain,
        dimension: Dimension,
        edge: f64,
        margin: f64,
        cutoff: f64,
    ) -> Result<Self, TooSmall> {
        let mut grid = Grid {
            low: [0.0; 3],
            unit: [0.0; 3],
            edge: [f64::INFINITY; 3],
            count: [1; 3],
            periodic: [false; 3],
            range: [1.0; 3],
            precision: Precision::Mixed,
        };
        for axis in 0..3 {
            if axis == 1 && dimension == Dimension::Two {
                continue;
            }
            let size = domain.size[axis];
            grid.periodic[axis] = domain.boundary[axis][0] == Side::Periodic;
            let covered = if grid.periodic[axis] {
                if size < 2.0 * cutoff {
                    return Err(TooSmall {
                        axis,
                        size,
                        need: 2.0 * cutoff,
                    });
                }
                grid.range[axis] = size;
                size
            } else {
                grid.low[axis] = -margin;
                grid.range[axis] = 4.0 * (size + 2.0 * margin);
                size + 2.0 * margin
            };
            grid.count[axis] = ((covered / edge).floor() as usize).clamp(1, 1 << 12);
            grid.edge[axis] = covered / grid.count[axis] as f64;
            grid.unit[axis] = grid.range[axis] / 4294967296.0;
        }
        Ok(grid)
    }

    /// Calls `visit` for every cell, those of a block of [`WIDE`] to each side together.
    pub fn blocks(&self, mut visit: impl FnMut(usize)) {
        let blocks = |a: usize| (0..self.count[a]).step_by(WIDE);
        let within = |a: usize, low: usize| low..(low + WIDE).min(self.count[a]);
        for x in blocks(0) {
            for y in blocks(1) {
                for z in blocks(2) {
                    for i in within(0, x) {
                        for j in within(1, y) {
                            for k in within(2, z) {
                                visit(self.index([i, j, k]));
                            }
                        }
                    }
                }
            }
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.count.iter().product()
    }

    /// Fixed-point coordinate of `x` m; wraps.
    #[inline(always)]
    pub fn fix(&self, axis: usize, x: f64) -> i32 {
        if self.unit[axis] == 0.0 {
            return 0;
        }
        // The low 32 bits of the whole number of units are the place within the range.
        ((x - self.low[axis]) / self.unit[axis]) as i64 as i32
    }

    /// [`Grid::fix`] of many; the same for all that is less than 2^19 ranges away.
    pub fn fix_all(&self, axis: usize, x: &[f64], out: &mut [i32]) {
        #[cfg(target_arch = "x86_64")]
        if super::lane::wide() && self.unit[axis] != 0.0 {
            // SAFETY: `wide` has found AVX2 and FMA.
            return unsafe { fix_avx2(self.low[axis], self.unit[axis], x, out) };
        }
        for (out, x) in out.iter_mut().zip(x) {
            *out = self.fix(axis, *x);
        }
    }

    /// Fixed-point position.
    #[inline(always)]
    pub fn fix3(&self, x: [f64; 3]) -> [i32; 3] {
        [self.fix(0, x[0]), self.fix(1, x[1]), self.fix(2, x[2])]
    }

    /// Cell coordinates; positions outside are wrapped or count to the outermost cell.
    #[inline(always)]
    pub fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|a| {
            let c = ((x[a] - self.low[a]) / self.edge[a]).floor();
            if self.periodic[a] {
                return self.bring(a, c as i64);
            }
            (c.max(0.0) as usize).min(self.count[a] - 1)
        })
    }

    /// Linear index: z runs fastest, so that a column of cells along z is one run of particles and
    /// the working set of a shallow pool is small.
    #[inline(always)]
    pub fn index(&self, c: [usize; 3]) -> usize {
        (c[0] * self.count[1] + c[1]) * self.count[2] + c[2]
    }

    /// Scale from fixed-point differences to multiples of `length`.
    pub fn scale(&self, length: f64) -> Scale {
        Scale {
            factor: self.unit.map(|u| u / length),
            precision: self.precision,
        }
    }

    /// `wrap(x)` into the box on periodic axes.
    pub fn wrap(&self, axis: usize, x: f64) -> f64 {
        if !self.periodic[axis] {
            return x;
        }
        let turns = ((x - self.low[axis]) / self.range[axis]).floor();
        if turns == 0.0 {
            x
        } else {
            x - turns * self.range[axis]
        }
    }

    /// Wraps a cell coordinate of a periodic axis.
    #[inline(always)]
    pub(super) fn bring(&self, axis: usize, c: i64) -> usize {
        c.rem_euclid(self.count[axis] as i64) as usize
    }
}

/// The low 32 bits of the whole number of units, without a conversion to integers: 1.5 x 2^52 has
/// the ones place in its last bit.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn fix_avx2(low: f64, unit: f64, x: &[f64], out: &mut [i32]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out = (((x - low) / unit).trunc() + 6755399441055744.0).to_bits() as i32;
    }
}
