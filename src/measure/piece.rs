//! Liquid that lies across a periodic side, in one piece.

use crate::particle::Frame;
use crate::scene::{Scene, Side};
use std::borrow::Cow;

/// Width of the bins in which a gap is looked for, in spacings: a lattice leaves none of them
/// empty.
const BIN: f64 = 2.0;

/// A frame whose liquid is in one piece, and how far it was moved along each axis, m.
pub struct Piece<'a> {
    /// The frame.
    pub frame: Cow<'a, Frame>,
    /// Zero where nothing lies at a periodic side, or where there is no gap.
    pub moved: [f64; 3],
}

impl<'a> Piece<'a> {
    /// Moves the liquid so that the periodic sides lie in the middle of its largest gap.
    pub fn of(scene: &Scene, frame: &'a Frame) -> Self {
        let mut piece = Piece {
            frame: Cow::Borrowed(frame),
            moved: [0.0; 3],
        };
        for &axis in scene.dimension.axes() {
            let size = scene.domain.size[axis];
            let is_periodic = scene.domain.boundary[axis] == [Side::Periodic; 2];
            let bin = BIN * scene.spacing;
            let gap = is_periodic.then(|| gap(&frame.position[axis], size, bin));
            let Some(middle) = gap.flatten() else {
                continue;
            };
            let x = &mut piece.frame.to_mut().position[axis];
            for x in x.iter_mut() {
                *x = (f64::from(*x) - middle).rem_euclid(size) as f32;
            }
            piece.moved[axis] = middle;
        }
        piece
    }

    /// Where a coordinate of the moved liquid is in the box, m.
    pub fn place(&self, scene: &Scene, axis: usize, x: f64) -> f64 {
        match self.moved[axis] {
            0.0 => x,
            moved => (x + moved).rem_euclid(scene.domain.size[axis]),
        }
    }

    /// Where a coordinate of the box is in the moved liquid, m.
    pub fn moved(&self, scene: &Scene, axis: usize, x: f64) -> f64 {
        match self.moved[axis] {
            0.0 => x,
            moved => (x - moved).rem_euclid(scene.domain.size[axis]),
        }
    }
}

/// The middle of the largest gap between the points `x`, m, if some are near an end of a periodic
/// range, so that the liquid reaches over it, and leave a gap; else 0 if some are beyond its ends:
/// a frame can have particles that have not yet come in again.
fn gap(x: &[f32], size: f64, bin: f64) -> Option<f64> {
    let count = ((size / bin) as usize).max(1);
    let mut is_filled = vec![false; count];
    let is_beyond = x.iter().any(|x| !(0.0..size).contains(&f64::from(*x)));
    for x in x {
        let place = f64::from(*x).rem_euclid(size) / size * count as f64;
        if place.is_finite() {
            is_filled[(place as usize).min(count - 1)] = true;
        }
    }
    if !(is_filled[0] || is_filled[count - 1]) {
        return is_beyond.then_some(0.0);
    }
    let runs = is_filled.chunk_by(|a, b| a == b);
    let (mut first, mut longest, mut middle) = (0, 0, None);
    for run in runs {
        if !run[0] && run.len() > longest {
            longest = run.len();
            middle = Some((first as f64 + 0.5 * run.len() as f64) / count as f64 * size);
        }
        first += run.len();
    }
    middle.or(is_beyond.then_some(0.0))
}
