//! The angle that a contact line has, theta_d: with hysteresis the surface goes on into the wall at
//! that, so that a line at rest feels no kink.
//!
//! Going on at one angle, as it does without hysteresis, it has a kink at any other, which pulls on
//! other particles than friction holds: a drop on an incline crept (docs/results/wetting.md).
//! (1) cos theta_d = SUM y cos theta_b W / SUM y W about the face of the wall, y = g |T_b|
//!     |SUM grad W over the wall| sin theta_b, g = z - 0.8 H above that height, else 0,
//! theta_b from n of liquid particles, which sees the wall's colours less the higher they are. So
//! the colours are found for the mean angle, and then twice more: on a straight surface at 120
//! degrees and a mean of 90 the first is 4 degrees off, the second below 1 (what is left of the
//! force: tests/engine/effect_wedge.rs).
//!
//! On a drop it is the angle about one H above the foot; what Young's force then has at the foot,
//! (5) of [`super`], is not in it.

use super::mean::Means;
use crate::effect::surface::Surface;
use crate::kernel::Kernel;

/// How often angles are measured in an update.
pub const TIMES: usize = 2;

/// Height in H below which n sees too much of the wall.
const LOW: f64 = 0.8;

/// Angles of the lines: y and y cos theta of all points.
#[derive(Clone, Debug, Default)]
pub struct Lines(Means);

impl Lines {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.0.memory()
    }

    pub fn clear(&mut self, flow: &Surface) {
        self.0.clear(flow);
    }

    /// Counts particle `i` at `height`, in H, with `stress`, |T| |SUM grad W| in any unit.
    pub fn add(&mut self, i: usize, height: f64, stress: f64, cosine: f64) {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let weight = stress * sine * (height - LOW).max(0.0);
        self.0.set(i, [weight as f32, (weight * cosine) as f32]);
    }

    /// (1) of the points `feet`, within `within`, where there is a line in reach; `length`:
    /// smoothing length, m.
    pub fn measure<K: Kernel>(
        &mut self,
        flow: &Surface,
        feet: (&[Vec<f64>; 3], &[u32]),
        length: f64,
        within: [f64; 2],
        cosines: &mut [f64],
    ) {
        let sums = self.0.sum::<K>(flow, feet, length);
        for (&j, [all, part]) in feet.1.iter().zip(sums) {
            if *all > 0.0 {
                cosines[j as usize] = ((part / all) as f64).clamp(within[0], within[1]);
            }
        }
    }
}
