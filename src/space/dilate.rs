//! Largest values about each cell.

use super::grid::Grid;
use rayon::prelude::*;

/// Lines of cells that a thread takes at least.
const LINES: usize = 16;

/// Gives every cell the largest value within `reach` m of it, axis by axis.
pub fn dilate<T: Copy + PartialOrd + Default + Send + Sync>(
    values: &mut Vec<T>,
    scratch: &mut Vec<T>,
    grid: &Grid,
    reach: f64,
) {
    let count = grid.count;
    scratch.resize(values.len(), T::default());
    for axis in 0..3 {
        let n = count[axis];
        let r = ((reach / grid.edge[axis]).ceil() as usize).min(n - 1);
        if r == 0 {
            continue;
        }
        let periodic = grid.periodic[axis];
        let stride: usize = count[axis + 1..].iter().product();
        if stride == 1 {
            let lines = scratch.par_chunks_mut(n).zip(values.par_chunks(n));
            lines.with_min_len(LINES).for_each(|(out, line)| {
                out.copy_from_slice(line);
                for away in 1..=r {
                    raise(&mut out[away..], line);
                    raise(out, &line[away..]);
                    if periodic {
                        raise(out, &line[n - away..]);
                        raise(&mut out[n - away..], line);
                    }
                }
            });
        } else {
            // Of n + c: cells before the first and behind the last are others, or none.
            let near = move |at: usize| {
                (n + at - r..=n + at + r).filter_map(move |c| match periodic {
                    true => Some(c % n),
                    false => (n..2 * n).contains(&c).then(|| c - n),
                })
            };
            let lines = scratch.par_chunks_mut(stride).enumerate();
            lines.with_min_len(LINES).for_each(|(k, out)| {
                let at = k % n;
                let line = |c: usize| &values[(k - at + c) * stride..][..stride];
                out.copy_from_slice(line(at));
                near(at).for_each(|c| raise(out, line(c)));
            });
        }
        std::mem::swap(values, scratch);
    }
}

/// The larger of each pair, as far as both go.
fn raise<T: Copy + PartialOrd>(most: &mut [T], values: &[T]) {
    for (most, value) in most.iter_mut().zip(values) {
        *most = if *value > *most { *value } else { *most };
    }
}
