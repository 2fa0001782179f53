//! Particles and their images beyond walls and periodic sides, sorted by cells.

use std::ops::Range;

use nalgebra::Vector3;

use crate::scene::{Domain, Side};
use crate::space::lane::WIDTH;

/// Points in the order of their cells.
pub(super) struct Points {
    /// Positions, m.
    pub at: Vec<Vector3<f32>>,
    /// Their x, y and z, and eight more numbers.
    pub planes: [Vec<f32>; 3],
    /// The particle that each is, or is an image of.
    pub source: Vec<u32>,
    start: Vec<u32>,
    low: Vector3<f32>,
    cell: f32,
    cells: [usize; 3],
}

impl Points {
    /// Images reach `margin` m beyond the sides; cells are `cell` m wide. Points that are NaN
    /// or far outside the box are left out.
    pub fn new(domain: &Domain, position: &[Vec<f32>; 3], margin: f32, cell: f32) -> Points {
        Points::sorted(with_images(domain, position, margin), cell)
    }

    /// These points, with the numbers of what they stem from; cells are `cell` m wide.
    pub fn sorted(all: Vec<(Vector3<f32>, u32)>, cell: f32) -> Points {
        let bound = |pick: fn(f32, f32) -> f32, start: f32| {
            let fold = |sum: Vector3<f32>, (p, _): &(Vector3<f32>, u32)| sum.zip_map(p, pick);
            all.iter().fold(Vector3::repeat(start), fold)
        };
        let (low, high) = match all.is_empty() {
            true => (Vector3::zeros(), Vector3::zeros()),
            false => (bound(f32::min, f32::MAX), bound(f32::max, f32::MIN)),
        };
        let size = high - low;
        let cells = [0, 1, 2].map(|a| (size[a] / cell) as usize + 1);
        let mut points = Points {
            at: vec![Vector3::zeros(); all.len()],
            planes: [0, 1, 2].map(|_| vec![0.0; all.len() + WIDTH]),
            source: vec![0; all.len()],
            start: vec![0; cells.iter().product::<usize>() + 1],
            low,
            cell,
            cells,
        };
        let places: Vec<usize> = all
            .iter()
            .map(|(p, _)| points.index(points.cell_of(p)))
            .collect();
        places.iter().for_each(|place| points.start[place + 1] += 1);
        for i in 1..points.start.len() {
            points.start[i] += points.start[i - 1];
        }
        let mut next = points.start.clone();
        for ((p, source), place) in all.into_iter().zip(places) {
            let slot = next[place] as usize;
            points.at[slot] = p;
            (0..3).for_each(|a| points.planes[a][slot] = p[a]);
            points.source[slot] = source;
            next[place] += 1;
        }
        points
    }

    /// By cell: whether it and those around it have at least `least` points each.
    pub fn crowded(&self, least: f32) -> Vec<bool> {
        let count = |cell: [usize; 3]| {
            let k = self.index(cell);
            self.start[k + 1] - self.start[k]
        };
        let [nx, ny, nz] = self.cells;
        let around = |x: usize, n: usize| x.saturating_sub(1)..(x + 2).min(n);
        let all = |[x, y, z]: [usize; 3]| {
            let is_inside = [(x, nx), (y, ny), (z, nz)]
                .iter()
                .all(|(x, n)| *x > 0 && x + 1 < *n);
            is_inside
                && around(x, nx).all(|i| {
                    around(y, ny).all(|j| around(z, nz).all(|k| count([i, j, k]) as f32 >= least))
                })
        };
        let cells = (0..nx * ny * nz).map(|k| [k / (ny * nz), k / nz % ny, k % nz]);
        cells.map(all).collect()
    }

    /// Number of the cell of a point.
    pub fn place(&self, p: &Vector3<f32>) -> usize {
        self.index(self.cell_of(p))
    }

    fn cell_of(&self, p: &Vector3<f32>) -> [usize; 3] {
        [0, 1, 2].map(|a| (((p[a] - self.low[a]) / self.cell) as usize).min(self.cells[a] - 1))
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.cells[1] + y) * self.cells[2] + z
    }

    /// The cell of `p` and those around it, along each axis.
    pub fn around(&self, p: &Vector3<f32>) -> [Range<usize>; 3] {
        let cell = self.cell_of(p);
        [0, 1, 2].map(|a| cell[a].saturating_sub(1)..(cell[a] + 2).min(self.cells[a]))
    }

    /// The points in cells that follow each other along z.
    pub fn within(&self, x: usize, y: usize, z: &Range<usize>) -> Range<usize> {
        let first = self.start[self.index([x, y, z.start])] as usize;
        let last = self.start[self.index([x, y, z.end - 1]) + 1] as usize;
        first..last
    }
}

/// Positions with the numbers of their particles. Walls mirror the liquid, so that it ends at them;
/// rings have no image behind the axis.
pub(super) fn with_images(
    domain: &Domain,
    position: &[Vec<f32>; 3],
    margin: f32,
) -> Vec<(Vector3<f32>, u32)> {
    let size = domain.size.map(|s| s as f32);
    let is_inside = |p: &Vector3<f32>| {
        (0..3).all(|a| size[a] == 0.0 || (p[a] >= -size[a] && p[a] <= 2.0 * size[a]))
    };
    let at = |i| Vector3::new(position[0][i], position[1][i], position[2][i]);
    let mut all: Vec<(Vector3<f32>, u32)> = (0..position[0].len())
        .map(|i| (at(i), i as u32))
        .filter(|(p, _)| is_inside(p))
        .collect();
    for axis in (0..3).filter(|&axis| size[axis] > 0.0) {
        let [low, high] = domain.boundary[axis];
        let size = size[axis];
        for i in 0..all.len() {
            let (p, source) = all[i];
            let x = p[axis];
            let mut add = |x: f32| {
                let mut image = p;
                image[axis] = x;
                all.push((image, source));
            };
            match low {
                Side::Open | Side::Axis => {}
                Side::Periodic if x < margin => add(x + size),
                _ if x < margin => add(-x),
                _ => {}
            }
            match high {
                Side::Open => {}
                Side::Periodic if x > size - margin => add(x - size),
                _ if x > size - margin => add(2.0 * size - x),
                _ => {}
            }
        }
    }
    all
}
