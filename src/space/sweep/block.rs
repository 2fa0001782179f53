//! Targets that lie together and look at the same candidates.

use crate::space::column::{Columns, Place};
use crate::space::grid::{Grid, WIDE};
use crate::space::lane::{Lanes, Real, WIDTH, dot};
use crate::space::row::separation;

/// Most targets of a block.
pub const MEMBERS: usize = 48;

/// Room for the rounding of what decides who is a candidate.
pub const MARGIN: f64 = 1.0001;

/// The targets of [`WIDE`] cells to each side: how many, and where, in fixed point.
pub struct Block {
    /// How many there are.
    pub count: usize,
    /// Where they are.
    pub at: [[i32; 3]; MEMBERS],
}

impl Block {
    /// The first of `targets`, and those after it that lie with it; where they are.
    #[inline(always)]
    pub fn of(position: &[Vec<f64>; 3], columns: &Columns, targets: &[u32]) -> (Block, [Place; 2]) {
        let [x, y, z] = position;
        let position = |i: usize| [x[i], y[i], z[i]];
        let first = columns.place(position(targets[0] as usize)).cell;
        let cell = first.map(|c| c - c % WIDE);
        let mut low = Place {
            cell,
            part: [f32::INFINITY; 3],
        };
        let mut high = Place {
            cell,
            part: [f32::NEG_INFINITY; 3],
        };
        let mut block = Block {
            count: 0,
            at: [[0; 3]; MEMBERS],
        };
        for &target in targets.iter().take(MEMBERS) {
            let i = target as usize;
            let place = columns.place(position(i));
            let up = [0, 1, 2].map(|a| place.cell[a].wrapping_sub(cell[a]));
            if up.iter().any(|&up| up >= WIDE) {
                break;
            }
            for a in 0..3 {
                let part = place.part[a] + up[a] as f32;
                low.part[a] = low.part[a].min(part);
                high.part[a] = high.part[a].max(part);
            }
            block.at[block.count] = columns.fix(position(i));
            block.count += 1;
        }
        (block, [low, high])
    }

    /// What is within `cutoff` m of the box about the targets.
    #[inline(always)]
    pub fn bounds<L: Lanes>(&self, lanes: L, grid: &Grid, cutoff: f64) -> Bounds<L> {
        let scale = grid.scale(MARGIN * cutoff);
        let (mut centre, mut half) = (self.at[0], [0.0; 3]);
        for a in 0..3 {
            let (mut low, mut high) = (0, 0);
            for at in &self.at[..self.count] {
                let away = at[a].wrapping_sub(self.at[0][a]);
                (low, high) = (away.min(low), away.max(high));
            }
            let middle = ((low as i64 + high as i64) / 2) as i32;
            centre[a] = centre[a].wrapping_add(middle);
            half[a] = (0.5 * (high as f64 - low as f64) * scale.factor[a]) as f32;
        }
        Bounds {
            lanes,
            centre,
            half: [
                lanes.splat(half[0]),
                lanes.splat(half[1]),
                lanes.splat(half[2]),
            ],
            scale: scale.lanes(lanes),
        }
    }
}

/// A box and a reach about it.
pub struct Bounds<L: Lanes> {
    lanes: L,
    /// In fixed point.
    pub centre: [i32; 3],
    /// Half the edges, in multiples of the reach.
    half: [L::F; 3],
    /// What makes distances such multiples.
    scale: [L::F; 3],
}

impl<L: Lanes> Bounds<L> {
    /// Who of the points from `j` on, at least one and at most `left`, is within: a bit each.
    ///
    /// # Safety
    /// `at` has eight coordinates of every axis from `j` on.
    #[inline(always)]
    pub unsafe fn hold(&self, at: &[Vec<i32>; 3], j: usize, left: usize) -> u32 {
        let lanes = self.lanes;
        // SAFETY: there are eight.
        let other = unsafe { lanes.load_fixed_at(at, j) };
        let mut d = separation(lanes, self.centre, other, self.scale);
        for a in 0..3 {
            d[a] = (d[a].abs() - self.half[a]).max(lanes.splat(0.0));
        }
        let mask = dot(d, d).less_mask(lanes.splat(1.0));
        mask & u32::MAX >> (u32::BITS as usize - left.min(WIDTH))
    }
}
