//! Candidates of a block of targets, found and copied together once.

use super::WORDS;
use super::block::Bounds;
use super::near::Field;
use crate::space::lane::{Lanes, Real, WIDTH};
use crate::space::row::{Source, separation};

/// Candidates that are looked at together.
const ROOM: usize = 1024;

/// Points that may be candidates, a run of each source after the other.
pub(super) struct Left<'a> {
    columns: &'a [(u32, u32)],
    sources: &'a [Source<'a>],
    /// Number of the next run.
    next: usize,
    /// What is left of the last one.
    run: (usize, usize),
}

impl<'a> Left<'a> {
    #[inline(always)]
    pub(super) fn of(columns: &'a [(u32, u32)], sources: &'a [Source<'a>]) -> Self {
        Left {
            columns,
            sources,
            next: 0,
            run: (0, 0),
        }
    }

    /// A point and how many follow in its run, itself among them.
    #[inline(always)]
    fn next(&mut self) -> Option<(usize, usize)> {
        let many = self.sources.len();
        while self.run.0 >= self.run.1 {
            if self.next == many * self.columns.len() {
                return None;
            }
            let (column, source) = (self.next / many, self.next % many);
            self.run = self.sources[source].run(self.columns[column]);
            self.next += 1;
        }
        let j = self.run.0;
        self.run.0 += WIDTH;
        Some((j, self.run.1 - j))
    }
}

/// Groups of eight candidates.
const GROUPS: usize = ROOM / WIDTH + 1;

/// The numbers of all groups.
pub(super) const EVERY: [u8; GROUPS] = {
    assert!(GROUPS <= 1 << u8::BITS);
    let (mut every, mut group) = ([0; GROUPS], 0);
    while group < GROUPS {
        every[group] = group as u8;
        group += 1;
    }
    every
};

/// Candidates, copied together.
pub(super) struct Near<L: Lanes, const W: usize> {
    pub(super) lanes: L,
    /// At most [`ROOM`].
    pub(super) count: usize,
    at: [[i32; ROOM + WIDTH]; 3],
    payload: [[f32; ROOM + WIDTH]; W],
    /// Centre of the block minus candidate, in units of the smoothing length.
    away: [[L::F; GROUPS]; 3],
    /// The groups in which a candidate carries something, the first `carriers`.
    pub(super) carrying: [u8; GROUPS],
    pub(super) carriers: usize,
}

impl<L: Lanes, const W: usize> Near<L, W> {
    #[inline(always)]
    pub(super) fn new(lanes: L) -> Self {
        Near {
            lanes,
            count: 0,
            at: [[0; ROOM + WIDTH]; 3],
            payload: [[0.0; ROOM + WIDTH]; W],
            away: [[lanes.splat(0.0); GROUPS]; 3],
            carrying: [0; GROUPS],
            carriers: 0,
        }
    }

    /// Finds the groups in which a candidate carries something.
    #[inline(always)]
    pub(super) fn find_carrying(&mut self) {
        let (zero, least) = (self.lanes.splat(0.0), self.lanes.splat(f32::from_bits(1)));
        self.carriers = 0;
        for group in 0..self.count.div_ceil(WIDTH) {
            let mut sum = zero;
            for word in &self.carried(group)[..W] {
                sum += word.abs();
            }
            self.carrying[self.carriers] = group as u8;
            // What is no number counts as something.
            self.carriers += usize::from(sum.less_mask(least) != (1 << WIDTH) - 1);
        }
    }

    /// Where the candidates are from the centre of their block.
    #[inline(always)]
    pub(super) fn place(&mut self, centre: [i32; 3], scale: [L::F; 3]) {
        let lanes = self.lanes;
        for group in 0..self.count.div_ceil(WIDTH) {
            // SAFETY: `count` is at most the room, so that eight words follow.
            let at = unsafe {
                let (from, [x, y, z]) = (group * WIDTH, &self.at);
                [
                    lanes.load_fixed(x.as_ptr().add(from)),
                    lanes.load_fixed(y.as_ptr().add(from)),
                    lanes.load_fixed(z.as_ptr().add(from)),
                ]
            };
            let away = separation(lanes, centre, at, scale);
            for (word, away) in self.away.iter_mut().zip(away) {
                word[group] = away;
            }
        }
    }

    /// Copies who of `left` is within `bounds`, as far as there is room: whether it is full.
    ///
    /// # Safety
    /// `field` has eight coordinates and payloads from each point of `left` on.
    #[inline(always)]
    pub(super) unsafe fn fill<const O: usize>(
        &mut self,
        field: &Field<W, O>,
        left: &mut Left,
        bounds: &Bounds<L>,
    ) -> bool {
        while self.count + WIDTH <= ROOM {
            let Some((j, many)) = left.next() else {
                return false;
            };
            // SAFETY: there are eight points, and there is room for eight.
            unsafe { self.take(field, j, many, bounds) };
        }
        true
    }

    /// Copies who of the points from `j` on, at least one and at most `left`, is within `bounds`.
    ///
    /// # Safety
    /// `field` has eight coordinates and payloads from `j` on, and here is room for eight more.
    #[inline(always)]
    unsafe fn take<const O: usize>(
        &mut self,
        field: &Field<W, O>,
        j: usize,
        left: usize,
        bounds: &Bounds<L>,
    ) {
        let (lanes, from, to) = (self.lanes, j, self.count);
        // SAFETY: eight words are read from `j` on, and eight are written where there is room.
        unsafe {
            let mask = bounds.hold(field.at, j, left);
            for (near, at) in self.at.iter_mut().zip(field.at) {
                let (at, near) = (at.as_ptr().add(from), near.as_mut_ptr().add(to));
                lanes.compress(mask, at as *const u32, near as *mut u32);
            }
            for (near, words) in self.payload.iter_mut().zip(field.payload) {
                let (words, near) = (words.as_ptr().add(from), near.as_mut_ptr().add(to));
                lanes.compress(mask, words as *const u32, near as *mut u32);
            }
            self.count += mask.count_ones() as usize;
        }
    }

    /// A target that is `away` from the centre minus a group of candidates.
    #[inline(always)]
    pub(super) fn away(&self, group: usize, away: [L::F; 3]) -> [L::F; 3] {
        [
            self.away[0][group] - away[0],
            self.away[1][group] - away[1],
            self.away[2][group] - away[2],
        ]
    }

    /// What a group of candidates carries.
    #[inline(always)]
    pub(super) fn carried(&self, group: usize) -> [L::F; WORDS] {
        assert!(group < GROUPS);
        let mut words = [self.lanes.splat(0.0); WORDS];
        for (word, payload) in words.iter_mut().zip(&self.payload) {
            // SAFETY: each of the groups has its eight words.
            *word = unsafe { self.lanes.load(payload.as_ptr().add(group * WIDTH)) };
        }
        words
    }
}
