//! Particles by blocks of the raster.

use super::Raster;
use crate::scene::{Domain, Side};
use rayon::prelude::*;

/// Particles with their images beyond the sides, sorted by block; one block of padding around.
pub struct Sorted {
    /// Places, m, and nominal volumes.
    pub position: Vec<[f32; 4]>,
    /// `start[bin] .. start[bin + 1]`.
    start: Vec<u32>,
    pub bins: [usize; 3],
}

impl Sorted {
    /// `flat`: whether there is no y, in which a box of one block still has padding.
    pub fn new(images: &[[f32; 4]], block: [f64; 3], blocks: [usize; 3], flat: bool) -> Sorted {
        let pad = |a: usize| usize::from(!(a == 1 && flat));
        let bins = [0, 1, 2].map(|a| blocks[a] + 2 * pad(a));
        let bin = |p: &[f32; 4]| -> Option<usize> {
            let mut c = [0; 3];
            for a in 0..3 {
                let place = (f64::from(p[a]) / block[a]).floor() + pad(a) as f64;
                if a == 1 && flat {
                    continue;
                }
                // NaN fails both comparisons.
                if !(place >= 0.0 && place < bins[a] as f64) {
                    return None;
                }
                c[a] = place as usize;
            }
            Some((c[2] * bins[1] + c[1]) * bins[0] + c[0])
        };
        let places: Vec<Option<usize>> = images.par_iter().map(bin).collect();
        let mut start = vec![0u32; bins[0] * bins[1] * bins[2] + 1];
        for place in places.iter().flatten() {
            start[place + 1] += 1;
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut next = start.clone();
        let mut position = vec![[0.0; 4]; start[start.len() - 1] as usize];
        for (p, place) in images.iter().zip(&places) {
            if let Some(place) = place {
                position[next[*place] as usize] = *p;
                next[*place] += 1;
            }
        }
        Sorted {
            position,
            start,
            bins,
        }
    }

    pub fn range(&self, bin: usize) -> std::ops::Range<usize> {
        self.start[bin] as usize..self.start[bin + 1] as usize
    }

    /// The bin of a block and those around it.
    pub fn around(&self, b: [usize; 3], flat: bool) -> impl Iterator<Item = usize> + use<'_> {
        let rows = if flat { 0..1 } else { b[1]..b[1] + 3 };
        (b[2]..b[2] + 3).flat_map(move |k| {
            rows.clone().flat_map(move |j| {
                (b[0]..b[0] + 3).map(move |i| (k * self.bins[1] + j) * self.bins[0] + i)
            })
        })
    }
}

/// Points, and their images within a block beyond periodic sides and walls.
pub fn with_images(domain: &Domain, raster: &Raster, points: Vec<[f32; 4]>) -> Vec<[f32; 4]> {
    let mut all = points;
    for axis in (0..3).filter(|&a| raster.edge[a] > 1) {
        let size = domain.size[axis] as f32;
        let reach = (raster.edge[axis] as f64 * raster.spacing[axis]) as f32;
        let [low, high] = domain.boundary[axis];
        for i in 0..all.len() {
            let mut image = all[i];
            let x = image[axis];
            if x < reach && low != Side::Open {
                image[axis] = if low == Side::Periodic { x + size } else { -x };
                all.push(image);
            }
            if x > size - reach && high != Side::Open {
                image[axis] = if high == Side::Periodic {
                    x - size
                } else {
                    2.0 * size - x
                };
                all.push(image);
            }
        }
    }
    all
}
