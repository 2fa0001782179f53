//! MPS of rings about an axis: a ring is a row of particles a spacing apart, and the sum of a
//! weight over them is its mean over the angle times their number, which is the mass of the ring.

use super::Lattice;
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

/// What [`kernels`] was asked for: r_e of gradients and of the Laplacian, core, spacing, in h.
type Asked = [f64; 4];

/// What was made so far.
static MADE: Mutex<Vec<(Asked, [Rings; 2])>> = Mutex::new(Vec::new());

/// Kernels of the weights of gradients, w / q^2, and of the Laplacian, w.
pub(super) fn kernels(asked: Asked) -> [Rings; 2] {
    let mut made = MADE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if let Some((_, found)) = made.iter().find(|(known, _)| *known == asked) {
        return *found;
    }
    let [gradient, laplacian, core, apart] = asked;
    let steep = |q: f64| weight(q, gradient, core) / q.max(core).powi(2);
    let plain = |q: f64| weight(q, laplacian, NEAREST as f64);
    let kernels = [
        Rings::of_weight(steep, apart),
        Rings::of_weight(plain, apart),
    ];
    made.push((asked, kernels));
    kernels
}

impl Lattice {
    /// That of rings far from the axis: rows along y in the columns of a lattice. Numbers that make
    /// a gradient in the half-plane exact, and its Laplacian.
    pub fn of_rings(radius: f64) -> Self {
        let reach = radius.ceil() as i64;
        let step = radius / POINTS as f64;
        let (mut number, mut spread) = (0.0, 0.0);
        let columns = (-reach..=reach).flat_map(|x| (-reach..=reach).map(move |z| [x, z]));
        for square in columns.map(|[x, z]| (x * x + z * z) as f64) {
            for k in 0..POINTS {
                let along = (k as f64 + 0.5) * step;
                let distance = (square + along * along).sqrt();
                let sum = 3.0 * square * step * weight(distance, radius, 1.0);
                number += sum / (distance * distance);
                spread += sum;
            }
        }
        Lattice { number, spread }
    }
}
