//! Largest values about each cell.

use super::grid::Grid;
use super::parallel::{Slots, each};

/// Gives every cell the largest value within `reach` m of it, axis by axis.
pub fn dilate<T: Copy + PartialOrd + Default + Send + Sync>(
    values: &mut Vec<T>,
    scratch: &mut Vec<T>,
    grid: &Grid,
    reach: f64,
) {
    let count = grid.count;
    let stride = [count[1] * count[2], count[2], 1];
    scratch.resize(values.len(), T::default());
    for axis in 0..3 {
        let n = count[axis] as i64;
        let r = ((reach / grid.edge[axis]).ceil() as i64).min(n - 1);
        if r <= 0 {
            continue;
        }
        let largest = |cell: usize| {
            let at = ((cell / stride[axis]) % count[axis]) as i64;
            let base = cell - at as usize * stride[axis];
            let mut most = values[cell];
            for c in at - r..=at + r {
                let c = match (grid.periodic[axis], c) {
                    (true, c) if c < 0 => c + n,
                    (true, c) if c >= n => c - n,
                    (false, c) if c < 0 || c >= n => continue,
                    (_, c) => c,
                };
                let value = values[base + c as usize * stride[axis]];
                if value > most {
                    most = value;
                }
            }
            most
        };
        let out = Slots::new(scratch);
        each(values.len(), |cell| {
            *unsafe { out.at(cell) } = largest(cell)
        });
        std::mem::swap(values, scratch);
    }
}
