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
mod near;
mod points;
mod revolved;
mod smooth;
mod sum;

pub use self::contour::Contour;
use nalgebra::Vector3;

use self::blob::{EXTENT, REACH, blobs};
use self::points::Points;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene, Side};

/// The level that is the surface.
pub const LEVEL: f32 = 0.5;
/// Nodes of a grid at most; a scene that needs more has a coarser grid.
const MOST: f64 = 2e8;
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
                free: Vec::new(),
            });
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

    /// Smallest and largest phi in a block of cells.
    pub(crate) fn bounds(&self, block: usize) -> [f32; 2] {
        let [_, by, bz] = self.blocks();
        let block = [block / (by * bz), block / bz % by, block % bz];
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
