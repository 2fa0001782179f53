//! The volume fraction of liquid on a grid of half the particle spacing.
//!
//! (1) `φ(x) = Σ_j V_j W(x − x_j)`, `V_j = s0^d`; of rings the area in the half-plane ([`area`])
//!
//! The surface is the level φ = 1/2. W is Wendland's C2 kernel with h = 1.3 s0 for every method, so
//! that all methods are measured in the same way: a flat lattice has its level exactly half a
//! spacing above the top layer, and a single sheet of particles (peak 0.58) still counts as liquid.
//! V is the nominal volume: the density of a method may be deficient at a surface, its mass is not.
//! The area of a ring changes with its radius, down to half of a cell and up to root 2 cells.
//!
//! Liquid is mirrored at walls and repeated at periodic sides. Only blocks of nodes near a surface
//! are summed; a block deep in the liquid or far from it has one value. Every node sums in a fixed
//! order: the result is independent of the number of threads.

mod sorted;

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::particle::Frame;
use crate::scene::{Dimension, Scene, Side};
use crate::space::lane::{Job, Lanes, Real, WIDTH, run_mixed};
use sorted::{Sorted, with_images};

/// Nodes along an edge of a block.
const EDGE: usize = WIDTH;
/// Smoothing length over spacing.
const SMOOTHING: f64 = 1.3;
/// The level that is the surface.
pub const LEVEL: f32 = 0.5;

/// The grid: node `(i, j, k)` lies at `((i + 1/2) dx, (j + 1/2) dy, (k + 1/2) dz)`, m.
pub struct Raster {
    /// Nodes along each axis; one along y in 2-D.
    pub count: [usize; 3],
    /// Distance of nodes, m, about s0 / 2 (exact divisions of the box where it is periodic).
    pub spacing: [f64; 3],
    /// Whether each axis is periodic.
    pub periodic: [bool; 3],
    /// Particle spacing s0, m.
    pub particle_spacing: f64,
    /// Where the axis of revolution is along x, m, if this is a section through one.
    pub(super) axis: Option<f64>,
    /// Nodes of a block along each axis.
    pub(super) edge: [usize; 3],
    /// Blocks along each axis.
    pub(super) blocks: [usize; 3],
    /// For each block: its place among the summed ones, or `summed +` its place in `uniform`.
    pub(super) code: Vec<u32>,
    pub(super) summed: usize,
    /// Whether a block that is not summed is liquid.
    pub(super) uniform: Vec<bool>,
    values: Vec<f32>,
}

impl Raster {
    /// Sums (1) for the particles of a frame of the whole; particles that are not finite or are
    /// outside the box are ignored.
    pub fn new(scene: &Scene, frame: &Frame) -> Raster {
        let domain = &scene.domain;
        let mut raster = Raster::empty(scene, &frame.position);
        let block = raster.block_size();
        let images = with_images(domain, &raster, points(scene, frame));
        let sorted = Sorted::new(&images, block, raster.blocks, raster.edge[1] == 1);
        drop(images);
        let kind = raster.classify(&sorted);
        let mut band = Vec::new();
        raster.code = vec![0; kind.len()];
        for (index, what) in kind.iter().enumerate() {
            if what.is_none() {
                raster.code[index] = band.len() as u32;
                band.push(index);
            }
        }
        raster.summed = band.len();
        for (index, what) in kind.iter().enumerate() {
            if let Some(liquid) = what {
                raster.code[index] = (raster.summed + raster.uniform.len()) as u32;
                raster.uniform.push(*liquid);
            }
        }
        let volume = raster.block_nodes();
        let mut values = vec![0.0f32; raster.summed * volume];
        values
            .par_chunks_mut(volume)
            .zip(band.par_iter())
            .for_each(|(out, &index)| {
                run_mixed(Block {
                    raster: &raster,
                    sorted: &sorted,
                    index,
                    out,
                })
            });
        raster.values = values;
        raster
    }

    fn empty(scene: &Scene, position: &[Vec<f32>; 3]) -> Raster {
        let (domain, particle_spacing) = (&scene.domain, scene.spacing);
        let flat = scene.dimension == Dimension::Two;
        let half = 0.5 * particle_spacing;
        let periodic = [0, 1, 2]
            .map(|axis| domain.boundary[axis][0] == Side::Periodic && !(axis == 1 && flat));
        // What is farther above an open box than its height has long left it.
        let highest = 2.0 * domain.size[2] as f32;
        let heights = position[2].iter().copied().filter(|z| *z < highest);
        let top = heights.fold(0.0f32, f32::max);
        let mut count = [1; 3];
        let mut spacing = [half; 3];
        for axis in 0..3 {
            if axis == 1 && flat {
                spacing[axis] = particle_spacing;
                continue;
            }
            let closed = axis < 2 || domain.boundary[2][1] != Side::Open;
            let length = if closed {
                domain.size[axis]
            } else {
                f64::from(top) + 4.0 * particle_spacing
            };
            count[axis] = ((length / half).round() as usize).max(2);
            spacing[axis] = if closed {
                length / count[axis] as f64
            } else {
                half
            };
        }
        let edge = [EDGE, if flat { 1 } else { EDGE }, EDGE];
        Raster {
            count,
            spacing,
            periodic,
            particle_spacing,
            axis: domain.is_revolved().then_some(0.5 * domain.size[0]),
            edge,
            blocks: [0, 1, 2].map(|axis| count[axis].div_ceil(edge[axis])),
            code: Vec::new(),
            summed: 0,
            uniform: Vec::new(),
            values: Vec::new(),
        }
    }

    /// φ at a node.
    pub fn value(&self, node: [usize; 3]) -> f32 {
        let (block, local) = self.locate(node);
        let code = self.code[block] as usize;
        if code < self.summed {
            self.values[code * self.block_nodes() + local]
        } else if self.uniform[code - self.summed] {
            1.0
        } else {
            0.0
        }
    }

    /// φ at the nodes of a summed block, in their order.
    pub(super) fn block_values(&self, block: usize) -> &[f32] {
        let nodes = self.block_nodes();
        &self.values[self.code[block] as usize * nodes..][..nodes]
    }

    /// What nodes at a place along x stand for: 1, or of a section the distance from its axis.
    pub(super) fn weight(&self, i: usize) -> f64 {
        self.axis
            .map_or(1.0, |axis| (self.coordinate(0, i) - axis).abs())
    }

    /// Centre of a node along one axis, m.
    pub fn coordinate(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.spacing[axis]
    }

    /// Calls `visit` for every node of a block that lies on the grid, x fastest.
    pub(super) fn for_nodes(&self, block: usize, mut visit: impl FnMut([usize; 3])) {
        self.for_rows(block, |[low, j, k], count| {
            (low..low + count).for_each(|i| visit([i, j, k]));
        });
    }

    /// Calls `visit` for every row of such nodes along x: with the first one, and their number.
    pub(super) fn for_rows(&self, block: usize, mut visit: impl FnMut([usize; 3], usize)) {
        let b = self.block_at(block);
        let low = [0, 1, 2].map(|a| b[a] * self.edge[a]);
        let high = [0, 1, 2].map(|a| (low[a] + self.edge[a]).min(self.count[a]));
        for k in low[2]..high[2] {
            for j in low[1]..high[1] {
                visit([low[0], j, k], high[0] - low[0]);
            }
        }
    }

    pub(super) fn is_summed(&self, block: usize) -> bool {
        (self.code[block] as usize) < self.summed
    }

    pub(super) fn block_nodes(&self) -> usize {
        self.edge[0] * self.edge[1] * self.edge[2]
    }

    /// Block of a node and the node's place in it.
    pub(super) fn locate(&self, node: [usize; 3]) -> (usize, usize) {
        // Edges are powers of two: shifts and masks, because this is the innermost lookup.
        let [ex, ey, ez] = self.edge;
        let b = [0, 1, 2].map(|a| node[a] >> self.edge[a].trailing_zeros());
        let l = [node[0] & (ex - 1), node[1] & (ey - 1), node[2] & (ez - 1)];
        (self.block_index(b), (l[2] * ey + l[1]) * ex + l[0])
    }

    pub(super) fn block_index(&self, b: [usize; 3]) -> usize {
        (b[2] * self.blocks[1] + b[1]) * self.blocks[0] + b[0]
    }

    pub(super) fn block_at(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.blocks;
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    fn block_size(&self) -> [f64; 3] {
        [0, 1, 2].map(|a| self.edge[a] as f64 * self.spacing[a])
    }

    /// For each block: `Some(true)` deep in liquid, `Some(false)` far from it, `None` to be summed.
    ///
    /// Particles are counted in half-blocks (2 s0 wide). A block is deep if all of its half-blocks
    /// and the ring around them contain five eighths of a lattice; far if all of them are empty.
    fn classify(&self, sorted: &Sorted) -> Vec<Option<bool>> {
        let size = self.block_size();
        let flat = self.edge[1] == 1;
        let halves = [2, if flat { 1 } else { 2 }, 2];
        let cells = [0, 1, 2].map(|a| sorted.bins[a] * halves[a]);
        let mut count = vec![0u16; cells[0] * cells[1] * cells[2]];
        for p in &sorted.position {
            let c = [0, 1, 2].map(|a| {
                let half = size[a] / halves[a] as f64;
                let pad = if a == 1 && flat { 0.0 } else { size[a] };
                (((f64::from(p[a]) + pad) / half) as usize).min(cells[a] - 1)
            });
            let place = &mut count[(c[2] * cells[1] + c[1]) * cells[0] + c[0]];
            *place = place.saturating_add(1);
        }
        let axes = if flat { 2 } else { 3 };
        let volume: f64 = (0..3)
            .filter(|&a| a != 1 || !flat)
            .map(|a| 0.5 * size[a])
            .product();
        let enough = 0.625 * volume / self.particle_spacing.powi(axes);
        (0..self.blocks.iter().product::<usize>())
            .into_par_iter()
            .map(|index| {
                let b = self.block_at(index);
                let (mut full, mut empty) = (true, true);
                let range = |a: usize| {
                    let low = if a == 1 && flat { 0 } else { (b[a] + 1) * 2 };
                    if a == 1 && flat {
                        0..1
                    } else {
                        low - 1..low + 3
                    }
                };
                for k in range(2) {
                    for j in range(1) {
                        for i in range(0) {
                            let n = count[(k * cells[1] + j) * cells[0] + i];
                            full &= f64::from(n) >= enough;
                            empty &= n == 0;
                        }
                    }
                }
                if full {
                    Some(true)
                } else {
                    empty.then_some(false)
                }
            })
            .collect()
    }

    /// (1) at the nodes of one block, in units of the nominal volume.
    #[inline(always)]
    fn sum<L: Lanes>(&self, lanes: L, sorted: &Sorted, index: usize, out: &mut [f32]) {
        let flat = self.edge[1] == 1;
        let b = self.block_at(index);
        let h = SMOOTHING * self.particle_spacing;
        let strength = if flat {
            7.0 / (4.0 * PI * SMOOTHING.powi(2))
        } else {
            21.0 / (16.0 * PI * SMOOTHING.powi(3))
        } as f32;
        let support = (2.0 * h) as f32;
        let step = self.spacing.map(|s| s as f32);
        let first = [0, 1, 2].map(|a| self.coordinate(a, b[a] * self.edge[a]) as f32);
        let inverse = 1.0 / (h * h) as f32;
        let [ex, ey, ez] = self.edge;
        let [width, depth] = [0, 1].map(|a| (self.edge[a] - 1) as f32 * step[a]);
        let one = lanes.splat(1.0);
        let count = one.of_array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        let (columns, rows) = (count * step[0], count * step[1]);
        let rows_there = (1 << ey) - 1;
        for bin in sorted.around(b, flat) {
            for p in &sorted.position[sorted.range(bin)] {
                let mut d = [0, 1, 2].map(|a| first[a] - p[a]);
                d[1] = if flat { 0.0 } else { d[1] };
                let is_far = |d: f32, size: f32| d > support || d + size < -support;
                if is_far(d[0], width) || is_far(d[1], depth) {
                    continue;
                }
                // Rows farther than this have exactly nothing of it, in spite of rounding.
                let beside = d[0].max(-width - d[0]).max(0.0);
                let most = (1.001 * support * support - beside * beside).min(support * support);
                let (x, y) = (columns + d[0], rows + d[1]);
                let (limit, y) = (one.splat(most), y * y);
                let squares = y.to_array();
                for k in 0..ez {
                    let dz = d[2] + k as f32 * step[2];
                    if dz.abs() >= support || dz * dz >= most {
                        continue;
                    }
                    // They are next to each other.
                    let near = (y + dz * dz).less_mask(limit) & rows_there;
                    let start = near.trailing_zeros() as usize;
                    for j in start..start + near.count_ones() as usize {
                        let row = &mut out[(k * ey + j) * ex..];
                        add_row(row, x, dz * dz + squares[j % WIDTH], inverse, p[3]);
                    }
                }
            }
        }
        for value in out {
            *value *= strength;
        }
    }
}

/// Places and nominal volumes, the latter in cells of a lattice.
fn points(scene: &Scene, frame: &Frame) -> Vec<[f32; 4]> {
    let (spacing, density) = (scene.spacing, scene.density);
    let are_rings = scene.domain.is_revolved() && !frame.mass.is_empty();
    let [x, y, z] = &frame.position;
    let volume = |i: usize| match are_rings {
        true => {
            let radius = (f64::from(x[i]) - 0.5 * scene.domain.size[0]).abs();
            // A section has both halves of a ring.
            let volume = 2.0 * f64::from(frame.mass[i]) / density;
            area(radius / spacing, volume / spacing.powi(3)) as f32
        }
        false => 1.0,
    };
    (0..x.len())
        .map(|i| [x[i], y[i], z[i], volume(i)])
        .collect()
}

/// Area of a ring in the half-plane, in spacings: its volume over 2 pi r; of one that is so near to
/// the axis that nothing fits inside it, the half of the disc that it fills, one spacing high.
fn area(radius: f64, volume: f64) -> f64 {
    let disc = (volume / PI).sqrt();
    // The centroid of half a disc lies at 2/3; the second column of a lattice at root 3/4.
    let (inner, outer) = (2.0 / 3.0, 0.75f64.sqrt());
    let place = radius / disc;
    let part = (place - inner) / (outer - inner);
    match part {
        _ if part <= 0.0 => disc,
        _ if part < 1.0 => disc * (1.0 - part * (1.0 - 0.5 / outer)),
        _ => 0.5 * disc / place,
    }
}

/// Adds `V (1 − q/2)^4 (1 + 2q)` at the nodes of a row, which are `d` from the particle along x.
#[inline(always)]
fn add_row<F: Real>(row: &mut [f32], d: F, across: f32, inverse: f32, volume: f32) {
    let Some(row) = row.first_chunk_mut::<EDGE>() else {
        return;
    };
    let one = d.splat(1.0);
    let q = ((d * d + across) * inverse).sqrt();
    let t = (one - q * 0.5).at_least(0.0);
    let square = t * t;
    let w = square * square * (q * 2.0 + 1.0) * volume;
    *row = (w.of_array(*row) + w).to_array();
}

/// The sum of one block.
struct Block<'a> {
    raster: &'a Raster,
    sorted: &'a Sorted,
    index: usize,
    out: &'a mut [f32],
}

impl Job for Block<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        self.raster.sum(lanes, self.sorted, self.index, self.out);
    }
}
