//! The angle that a contact line has, theta_d: with hysteresis the surface goes on into the wall at
//! that, so that a line at rest feels no kink.
//!
//! Going on at one angle, as it does without hysteresis, it has a kink at any other, which pulls on
//! other particles than friction holds: a drop on an incline crept (docs/validation.md).
//! (1) cos theta_d = SUM y cos theta_b W / SUM y W about the face of the wall, y = g |T_b|
//!     |SUM grad W over the wall| sin theta_b, g = z - 0.8 H above that height, else 0,
//! theta_b from n of liquid particles, which sees the wall's colours less the higher they are. So
//! the colours are found for the mean angle, and then twice more: on a straight surface at 120
//! degrees and a mean of 90 the first is 4 degrees off, the second below 1 (what is left of the
//! force: tests/engine/effect_wedge.rs).
//!
//! On a drop it is the angle about one H above the foot; what Young's force then has at the foot,
//! (5) of [`super`], is not in it.

use super::pass::Means;
use crate::effect::tension::Surface;
use crate::kernel::Kernel;
use crate::space::sweep::{self, Field};
use std::marker::PhantomData;

/// How often angles are measured in an update.
pub const TIMES: usize = 2;

/// Height in H below which n sees too much of the wall.
const LOW: f64 = 0.8;

/// Angles of the lines with what they are summed from.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// y and y cos theta of all points.
    words: [Vec<f32>; 2],
    sums: Vec<[f32; 2]>,
}

impl Lines {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        8 * (self.words[0].capacity() + self.sums.capacity())
    }

    pub fn clear(&mut self, flow: &Surface) {
        for words in &mut self.words {
            words.clear();
            words.resize(flow.at[0].len(), 0.0);
        }
    }

    /// Counts particle `i` at `height`, in H, with `stress`, |T| |SUM grad W| in any unit.
    pub fn add(&mut self, i: usize, height: f64, stress: f64, cosine: f64) {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let weight = stress * sine * (height - LOW).max(0.0);
        self.words[0][i] = weight as f32;
        self.words[1][i] = (weight * cosine) as f32;
    }

    /// (1) of the points `foot` of `targets`, within `within`, where there is a line in reach;
    /// `length`: smoothing length, m.
    pub fn measure<K: Kernel>(
        &mut self,
        flow: &Surface,
        (foot, targets): (&[Vec<f64>; 3], &[u32]),
        length: f64,
        within: [f64; 2],
        cosines: &mut [f64],
    ) {
        self.words.iter_mut().for_each(|words| flow.share(words));
        let field = Field {
            grid: flow.grid,
            at: flow.at,
            payload: &self.words,
            sources: flow.of_liquid(),
            position: foot,
            own: &self.words,
            cutoff: 2.0 * length + flow.slack,
            scale: flow.grid.scale(length),
        };
        self.sums.resize(targets.len(), [0.0; 2]);
        sweep::runs(field, targets, &Means::<K>(PhantomData), &mut self.sums);
        for (&j, [all, part]) in targets.iter().zip(&self.sums) {
            if *all > 0.0 {
                cosines[j as usize] = ((part / all) as f64).clamp(within[0], within[1]);
            }
        }
    }
}
