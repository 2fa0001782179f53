//! MPS of rings about an axis: a ring is a row of particles a spacing apart, and the sum of a
//! weight over them is its mean over the angle times their number, which is the mass of the ring.

use super::pass::NEAREST;
use crate::kernel::ring::Rings;
use std::sync::Mutex;

/// Points of the sum along a row of a lattice.
const POINTS: usize = 4000;

/// w of `super` (1), not steeper than at `core`; all in one unit.
fn weight(distance: f64, reach: f64, core: f64) -> f64 {
    match distance < reach {
        true => reach / distance.max(core) - 1.0,
        false => 0.0,
    }
}

/// r_e and spacing, in h.
type Asked = [f64; 2];

/// What was made so far.
static MADE: Mutex<Vec<(Asked, Rings)>> = Mutex::new(Vec::new());

/// The kernel of the weight w of the Laplacian.
pub(super) fn kernel(asked: Asked) -> Rings {
    let mut made = MADE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some((_, found)) = made.iter().find(|(known, _)| *known == asked) {
        return *found;
    }
    let [reach, apart] = asked;
    let kernel = Rings::of_weight(|q| weight(q, reach, NEAREST as f64), apart);
    made.push((asked, kernel));
    kernel
}

/// n0 lambda of rings far from the axis, in squared spacings: rows along y in the columns of a
/// lattice, so that the Laplacian in the half-plane is exact.
pub(super) fn spread(radius: f64) -> f64 {
    let reach = radius.ceil() as i64;
    let step = radius / POINTS as f64;
    let columns = (-reach..=reach).flat_map(|x| (-reach..=reach).map(move |z| [x, z]));
    let squares = columns.map(|[x, z]| (x * x + z * z) as f64);
    let along = |square: f64| {
        let at = |k: usize| (square + ((k as f64 + 0.5) * step).powi(2)).sqrt();
        (0..POINTS).map(|k| weight(at(k), radius, 1.0)).sum::<f64>()
    };
    squares
        .map(|square| 3.0 * square * step * along(square))
        .sum()
}
