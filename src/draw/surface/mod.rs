//! The closed surface of the liquid of a frame.
//!
//! (1) `phi(x) = sum_j V_j(x)`
//!
//! with the kernels of [`blob`] on a grid, of half the particle spacing for pictures. The surface
//! is the level 1/2 inside the box of the grid, closed by its sides: the liquid ends exactly at a
//! wall, and is cut at a periodic side. Walls mirror the liquid, periodic sides repeat it. Each
//! slab of the grid sums in a fixed order: the result is independent of the number of threads. The
//! field of rings is that of their half-plane, a [field of revolution](Field::revolved).

mod blob;
mod coarse;
mod contour;
mod mesh;
mod points;
mod revolved;
mod smooth;

use nalgebra::Vector3;
use rayon::prelude::*;

pub use self::contour::Contour;

use self::blob::{Blob, EXTENT, REACH, blobs};
use self::points::Points;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene, Side};
use crate::space::lane::vectorised;

/// The level that is the surface.
pub const LEVEL: f32 = 0.5;
/// Nodes of a grid at most; a scene that needs more has a coarser grid.
const MOST: f64 = 2e8;
/// Layers of nodes that are summed together.
const SLAB: usize = 8;
/// Edge of a block of cells that a ray crosses at once.
pub(crate) const BLOCK: usize = 4;

/// The field (1), and colours.
pub struct Field {
    /// Position of the first node, m.
    pub low: Vector3<f32>,
    /// Distance of nodes, m.
    pub step: Vector3<f32>,
    /// Nodes along each axis; one along y in 2-D and in the half-plane.
    pub count: [usize; 3],
    /// x and y of the axis of a field of revolution, m; its nodes are in the half-plane beside it,
    /// whose x is the distance from it.
    pub axis: Option<[f32; 2]>,
    /// Particle spacing, m.
    pub spacing: f32,
    /// phi at nodes, z fastest, then y.
    pub values: Vec<f32>,
    /// Means of the colours of particles, likewise; empty if not required.
    pub colours: Vec<[f32; 3]>,
    /// Smallest and largest phi in each block of cells.
    pub(crate) bounds: Vec<[f32; 2]>,
    /// What a ray may go from each node without meeting the surface, m; of revolution only.
    free: Vec<f32>,
}

/// Extent of the grid along an axis: position of the first node, distance, number.
fn axis(scene: &Scene, axis: usize, [low, high]: [f32; 2], cell: f64) -> (f32, f32, usize) {
    let size = scene.domain.size[axis];
    if size == 0.0 {
        return (0.0, scene.spacing as f32, 1);
    }
    let cells = (size / cell).ceil().max(1.0);
    let step = size / cells;
    let margin = 2.8 * scene.spacing;
    let [first, last] = scene.domain.boundary[axis].map(|side| side == Side::Open);
    let mut start = ((f64::from(low) - margin) / step).floor();
    let mut end = ((f64::from(high) + margin) / step).ceil();
    if scene.domain.boundary[axis][0] == Side::Axis {
        start = 0.0;
    } else if !first {
        start = start.max(0.0);
    }
    if !last {
        end = end.min(cells);
    }
    let count = (end - start).max(1.0) as usize + 1;
    ((start * step) as f32, step as f32, count)
}

impl Field {
    /// The field of a frame of the whole scene; `colours`: of particles, or none.
    ///
    /// Particles that are not finite are left out. `None` if none is left.
    pub fn new(scene: &Scene, frame: &Frame, colours: &[[f32; 3]]) -> Option<Field> {
        Field::with_nodes(scene, frame, colours, 0.5 * scene.spacing)
    }

    /// The same with nodes `cell` m apart.
    pub fn with_nodes(
        scene: &Scene,
        frame: &Frame,
        colours: &[[f32; 3]],
        cell: f64,
    ) -> Option<Field> {
        let is_flat = scene.dimension == Dimension::Two;
        let spacing = scene.spacing as f32;
        let margin = (EXTENT + REACH).min(8.0) * spacing;
        let points = Points::new(&scene.domain, &frame.position, margin, REACH * spacing);
        let mut field = Field::empty(scene, frame, cell)?;
        let blobs = blobs(&points, &scene.domain, &frame.position, spacing, is_flat);
        field.sum(&blobs, &points.source, colours);
        field.smooth(0.0);
        field.bound();
        Some(field)
    }

    /// A grid without liquid.
    pub fn nothing() -> Field {
        Field {
            low: Vector3::zeros(),
            step: Vector3::repeat(1e-3),
            count: [2; 3],
            axis: None,
            spacing: 1e-3,
            values: vec![0.0; 8],
            colours: Vec::new(),
            bounds: vec![[0.0; 2]],
            free: Vec::new(),
        }
    }

    /// A grid about the liquid, its nodes `cell` m apart.
    fn empty(scene: &Scene, frame: &Frame, mut cell: f64) -> Option<Field> {
        let range = |a: usize| {
            let size = scene.domain.size[a] as f32;
            let is_there =
                |x: &&f32| x.is_finite() && (size == 0.0 || (**x > -size && **x < 2.0 * size));
            let all = frame.position[a].iter().filter(is_there);
            all.fold([f32::MAX, f32::MIN], |[low, high], x| {
                [low.min(*x), high.max(*x)]
            })
        };
        let ranges = [0, 1, 2].map(range);
        if ranges.iter().any(|[low, high]| low > high) {
            return None;
        }
        loop {
            let axes = [0, 1, 2].map(|a| axis(scene, a, ranges[a], cell));
            let count = axes.map(|(_, _, count)| count);
            if count.iter().map(|c| *c as f64).product::<f64>() > MOST {
                cell *= 1.25;
                continue;
            }
            return Some(Field {
                low: axes.map(|(low, ..)| low).into(),
                step: axes.map(|(_, step, _)| step).into(),
                count,
                axis: None,
                spacing: scene.spacing as f32,
                values: vec![0.0; count.iter().product()],
                colours: Vec::new(),
                bounds: Vec::new(),
                free: Vec::new(),
            });
        }
    }

    /// (1) at all nodes.
    fn sum(&mut self, blobs: &[Blob], source: &[u32], colours: &[[f32; 3]]) {
        let slab = SLAB * self.count[1] * self.count[2];
        let slabs = self.count[0].div_ceil(SLAB);
        let mut lists = vec![Vec::new(); slabs];
        for (i, blob) in blobs.iter().enumerate() {
            let range = self.range(blob, 0);
            if !range.is_empty() {
                let touched = range.start / SLAB..=(range.end - 1) / SLAB;
                touched.for_each(|slab| lists[slab].push(i));
            }
        }
        let mut values = std::mem::take(&mut self.values);
        let mut sums = vec![[0.0f32; 3]; if colours.is_empty() { 0 } else { values.len() }];
        let mut empty = vec![[]; slabs];
        let parts: Vec<&mut [[f32; 3]]> = match colours.is_empty() {
            true => empty
                .iter_mut()
                .map(|e: &mut [[f32; 3]; 0]| &mut e[..])
                .collect(),
            false => sums.chunks_mut(slab).collect(),
        };
        let work = values
            .par_chunks_mut(slab)
            .zip(parts)
            .zip(&lists)
            .enumerate();
        work.for_each(|(n, ((out, sums), list))| {
            for &i in list {
                let colour = colours.get(source[i] as usize);
                let colour = colour.map(|c| (*c, &mut *sums));
                match blobs[i].turns {
                    0 => vectorised(|| self.add(&blobs[i], n * SLAB, out, colour)),
                    _ => vectorised(|| self.turn(&blobs[i], n * SLAB, out, colour)),
                }
            }
            for (sum, value) in sums.iter_mut().zip(out) {
                *sum = sum.map(|c| c / value.max(1e-6));
            }
        });
        self.values = values;
        self.colours = sums;
    }

    /// Nodes along an axis that a blob reaches.
    fn range(&self, blob: &Blob, axis: usize) -> std::ops::Range<usize> {
        if self.count[axis] == 1 {
            return 0..1;
        }
        let place = |x: f32| (x - self.low[axis]) / self.step[axis];
        let low = place(blob.centre[axis] - blob.extent[axis]).ceil().max(0.0) as usize;
        let high = place(blob.centre[axis] + blob.extent[axis]).floor();
        let end = ((high + 1.0).max(0.0) as usize).min(self.count[axis]);
        // The blob may lie beyond the last node.
        low.min(end)..end
    }

    /// Adds a blob to the layers of nodes from `first` on.
    #[inline(always)]
    fn add(
        &self,
        blob: &Blob,
        first: usize,
        out: &mut [f32],
        mut colour: Option<([f32; 3], &mut [[f32; 3]])>,
    ) {
        let [x, y, z] = [0, 1, 2].map(|a| self.range(blob, a));
        let layer = self.count[1] * self.count[2];
        let x = x.start.max(first)..x.end.min(first + out.len() / layer);
        let along = blob.inverse.column(2) * self.step[2];
        let c = along.norm_squared();
        for i in x {
            for j in y.clone() {
                let start = self.node([i, j, z.start]) - blob.centre;
                let base = blob.inverse * start;
                let (a, b) = (base.norm_squared(), 2.0 * base.dot(&along));
                let row = (i - first) * layer + j * self.count[2];
                let row = row + z.start..row + z.end;
                for (k, value) in out[row.clone()].iter_mut().enumerate() {
                    *value += kernel(blob.strength, a, b, c, k as f32);
                }
                if let Some((colour, sums)) = &mut colour {
                    for (k, sum) in sums[row].iter_mut().enumerate() {
                        let w = kernel(blob.strength, a, b, c, k as f32);
                        for (s, c) in sum.iter_mut().zip(*colour) {
                            *s += w * c;
                        }
                    }
                }
            }
        }
    }

    /// Position of a node, m; in 2-D y is 0.
    pub fn node(&self, node: [usize; 3]) -> Vector3<f32> {
        let at = Vector3::from(node.map(|n| n as f32));
        self.low + at.component_mul(&self.step)
    }

    /// Place of a node in `values`.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (x * self.count[1] + y) * self.count[2] + z
    }

    /// Position of the last node, m.
    pub fn high(&self) -> Vector3<f32> {
        self.node(self.count.map(|n| n - 1))
    }

    /// Blocks along each axis.
    pub(crate) fn blocks(&self) -> [usize; 3] {
        self.count.map(|n| (n - 1).div_ceil(BLOCK).max(1))
    }

    fn bound(&mut self) {
        let blocks = self.blocks();
        let all = (0..blocks.iter().product::<usize>()).into_par_iter();
        self.bounds = all.map(|index| self.bound_of(index)).collect();
    }

    fn bound_of(&self, index: usize) -> [f32; 2] {
        let [_, by, bz] = self.blocks();
        let block = [index / (by * bz), index / bz % by, index % bz];
        let [x, y, z] =
            [0, 1, 2].map(|a| block[a] * BLOCK..(block[a] * BLOCK + BLOCK + 1).min(self.count[a]));
        let mut bounds = [f32::MAX, f32::MIN];
        for i in x {
            for j in y.clone() {
                let row = self.index([i, j, z.start])..self.index([i, j, z.end - 1]) + 1;
                for value in &self.values[row] {
                    bounds = [bounds[0].min(*value), bounds[1].max(*value)];
                }
            }
        }
        bounds
    }
}

/// `strength (1 - q/2)^4 (1 + 2 q)` with `q^2 = a + b k + c k^2`.
#[inline(always)]
fn kernel(strength: f32, a: f32, b: f32, c: f32, k: f32) -> f32 {
    let q = (a + k * (b + k * c)).max(0.0).sqrt();
    let t = (1.0 - 0.5 * q).max(0.0);
    strength * (t * t) * (t * t) * (1.0 + 2.0 * q)
}
