//! Fields of revolution: rings, summed in the half-plane beside their axis.
//!
//! A ring is its kernel in three dimensions, turned about the axis. Nothing is divided by the
//! distance from the axis, so that the surface is as smooth there as elsewhere:
//!
//! (1) `phi(r, z) = sum_j V_j / n sum_k W_j(T_k (r, 0, z))`, T_k: turned by `2 pi (k + 1/2) / n`
//!
//! with the kernels of [`blob`](super::blob). Their form follows from points around the axis, a
//! spacing apart, into which the neighbours of a ring are divided.

use std::f32::consts::PI;
use std::ops::Range;

use nalgebra::Vector3;
use rayon::prelude::*;

use super::blob::{Blob, EXTENT, REACH};
use super::near::Near;
use super::points::{Points, with_images};
use super::sum::kernel;
use super::{Field, LEVEL};
use crate::particle::{Frame, ring};
use crate::scene::Scene;

/// Nodes of the half-plane in a spacing: of pictures and meshes.
const NODES: f64 = 4.0;
/// Distance of the turned kernels of a ring, over their smoothing length along it.
const TURN: f32 = 0.5;
/// Variance of the kernel along an axis, `4 h^2 / 15` with h = 1.3, and of the mean of
/// [`smooth`](super::smooth), 1, over the latter, in squares of the spacing: what is added of the
/// difference between a mean and the mean of it, so that a curved surface stays at its place.
pub(super) const SHARPNESS: f32 = 1.45;
/// By how much the level of the surface may be moved to keep the volume.
const SHIFT: f32 = 0.15;

/// Rings and their images beyond walls.
struct Rings {
    /// Places in the half-plane, y = 0, and the particles.
    at: Vec<(Vector3<f32>, u32)>,
    /// Volumes in cubes of the spacing.
    volume: Vec<f32>,
}

impl Rings {
    fn new(part: &Scene, frame: &Frame) -> Rings {
        let spacing = part.spacing as f32;
        let margin = (EXTENT + REACH).min(8.0) * spacing;
        let mut at = with_images(&part.domain, &frame.position, margin);
        at.retain(|(p, _)| p.x >= 0.0);
        let volume = |(p, source): &(Vector3<f32>, u32)| {
            let i = *source as usize;
            // The image of a ring has the area of its section.
            let wider = p.x / frame.position[0][i];
            let own = frame.mass[i] / part.density as f32 / spacing.powi(3);
            if wider.is_finite() { own * wider } else { own }
        };
        Rings {
            volume: at.iter().map(volume).collect(),
            at,
        }
    }

    /// Points of all rings about the half-plane, as far as its rings reach.
    fn points(&self, spacing: f32) -> Points {
        let reach = REACH * spacing;
        let mut all = Vec::new();
        for (number, (p, _)) in self.at.iter().enumerate() {
            let count = ring::point_count(p.x, spacing);
            for k in 0..count {
                let (sin, cos) = (2.0 * PI * k as f32 / count as f32).sin_cos();
                if (p.x * sin).abs() <= reach && (cos > 0.0 || p.x <= reach) {
                    all.push((Vector3::new(p.x * cos, p.x * sin, p.z), number as u32));
                }
            }
        }
        Points::sorted(all, reach)
    }

    fn blobs(&self, spacing: f32) -> Vec<Blob> {
        let points = self.points(spacing);
        let part = |n: u32| {
            let n = n as usize;
            self.volume[n] / ring::point_count(self.at[n].0.x, spacing) as f32
        };
        let blob = |near: &mut Near, n: usize| {
            let at = self.at[n].0;
            let mut blob = Blob::new(near, &points, at, spacing, part);
            let along = 0.5 * blob.extent.y;
            blob.turns = ((PI * at.x / (TURN * along)).ceil() as usize).max(3);
            blob.strength *= self.volume[n] / blob.turns as f32;
            blob.extent.x = blob.extent.x.hypot(blob.extent.y);
            blob
        };
        (0..self.at.len())
            .into_par_iter()
            .map_init(Near::default, blob)
            .collect()
    }
}

impl Field {
    /// The field of a frame of an axial scene, which has the half-plane; `colours`: of particles,
    /// or none. The surface holds the volume of the rings.
    ///
    /// Particles that are not finite are left out. `None` if none is left.
    pub fn revolved(part: &Scene, frame: &Frame, colours: &[[f32; 3]]) -> Option<Field> {
        Field::turned_with(part, frame, colours, NODES)
    }

    /// The same with so many `nodes` in a spacing.
    pub fn turned_with(
        part: &Scene,
        frame: &Frame,
        colours: &[[f32; 3]],
        nodes: f64,
    ) -> Option<Field> {
        let rings = Rings::new(part, frame);
        let mut field = Field::empty(part, frame, part.spacing / nodes)?;
        field.axis = Some([part.domain.size[0] as f32; 2]);
        let source: Vec<u32> = rings.at.iter().map(|(_, source)| *source).collect();
        field.sum(&rings.blobs(field.spacing), &source, colours);
        field.smooth(SHARPNESS);
        field.keep_volume(mass(frame) / part.density);
        field.free = field.distances();
        Some(field)
    }

    /// Adds a turned blob to some layers of nodes, that is columns; to three sums of colours too.
    #[inline(always)]
    pub(super) fn turn(
        &self,
        blob: &Blob,
        layers: &Range<usize>,
        out: &mut [f32],
        mut colour: Option<([f32; 3], &mut [Vec<f32>; 3])>,
    ) {
        let (x, z) = (self.range(blob, 0), self.range(blob, 2));
        let row = self.count[2];
        let x = x.start.max(layers.start)..x.end.min(layers.end);
        let along = blob.inverse.column(2) * self.step.z;
        let c = along.norm_squared();
        let bottom = self.low.z + z.start as f32 * self.step.z;
        for i in x {
            let r = i as f32 * self.step.x;
            for n in 0..turns(blob, r) {
                let (sin, cos) = (PI * (n as f32 + 0.5) / blob.turns as f32).sin_cos();
                let start = Vector3::new(r * cos, -r * sin, bottom) - blob.centre;
                let base = blob.inverse * start;
                let (a, b) = (base.norm_squared(), 2.0 * base.dot(&along));
                // The nodes with q < 2.
                let square = 0.25 * b * b - c * (a - 4.0);
                if square <= 0.0 {
                    continue;
                }
                let [low, high] = [-1.0, 1.0].map(|s| (s * square.sqrt() - 0.5 * b) / c);
                let low = low.ceil().max(0.0) as usize;
                let high = ((high.floor() + 1.0).max(0.0) as usize).min(z.len());
                let first = (i - layers.start) * row + z.start;
                for k in low..high {
                    let w = kernel(blob.strength, a, b, c, k as f32);
                    out[first + k] += w;
                    if let Some((colour, sums)) = &mut colour {
                        for (sums, part) in sums.iter_mut().zip(*colour) {
                            sums[first + k] += w * part;
                        }
                    }
                }
            }
        }
    }

    /// Moves the level of the surface so that it encloses `volume` m^3.
    fn keep_volume(&mut self, volume: f64) {
        let [mut low, mut high] = [LEVEL - SHIFT, LEVEL + SHIFT];
        for _ in 0..12 {
            let level = 0.5 * (low + high);
            match self.contour_volume(level) > volume {
                true => low = level,
                false => high = level,
            }
        }
        let shift = LEVEL - 0.5 * (low + high);
        self.values.par_iter_mut().for_each(|value| *value += shift);
    }

    /// A distance from each node at which no cell is crossed by the surface, m, or less.
    fn distances(&self) -> Vec<f32> {
        let [columns, _, rows] = self.count;
        let step = self.step.x.min(self.step.z);
        let mut free = vec![f32::MAX; self.values.len()];
        let is_in = |n: usize| self.values[n] > LEVEL;
        for i in 1..columns {
            for k in 1..rows {
                let n = i * rows + k;
                let corners = [n, n - 1, n - rows, n - rows - 1];
                if corners.iter().any(|m| is_in(*m) != is_in(n)) {
                    corners.into_iter().for_each(|m| free[m] = 0.0);
                }
            }
        }
        // Steps along the axes and diagonals: at most 1.09 times the distance.
        let near = |free: &[f32], n: usize, i: usize, k: usize, back: bool| {
            let [side, up] = [rows, 1].map(|d| if back { n.wrapping_sub(d) } else { n + d });
            let has = |place: usize, last: usize| if back { place > 0 } else { place < last };
            let mut least = free[n];
            let (is_beside, is_above) = (has(i, columns - 1), has(k, rows - 1));
            if is_beside {
                least = least.min(free[side] + step);
                let [above, below] = [k + 1 < rows, k > 0];
                if above {
                    least = least.min(free[side + 1] + step * std::f32::consts::SQRT_2);
                }
                if below {
                    least = least.min(free[side - 1] + step * std::f32::consts::SQRT_2);
                }
            }
            if is_above {
                least = least.min(free[up] + step);
            }
            least
        };
        for n in 0..free.len() {
            free[n] = near(&free, n, n / rows, n % rows, true);
        }
        for n in (0..free.len()).rev() {
            free[n] = near(&free, n, n / rows, n % rows, false);
        }
        let widest = self.step.x.max(self.step.z);
        free.iter_mut()
            .for_each(|d| *d = (0.91 * *d - 2.5 * widest).max(0.0));
        free
    }

    /// phi of a field of revolution at a distance from the axis and a height, m, and how far a ray
    /// may go from there without meeting the surface, m. `inverse`: of the distances of nodes.
    #[inline]
    pub(crate) fn at(&self, r: f32, z: f32, inverse: &Vector3<f32>) -> (f32, f32) {
        let x = r * inverse.x;
        let y = ((z - self.low.z) * inverse.z).max(0.0);
        let i = (x as usize).min(self.count[0].saturating_sub(2));
        let k = (y as usize).min(self.count[2].saturating_sub(2));
        let (x, y) = ((x - i as f32).min(1.0), (y - k as f32).min(1.0));
        let start = i * self.count[2] + k;
        let (near, far) = (&self.values[start..], &self.values[start + self.count[2]..]);
        let a = near[0] + y * (near[1] - near[0]);
        let b = far[0] + y * (far[1] - far[0]);
        (a + x * (b - a), self.free[start])
    }
}

/// Turned kernels that reach a distance from the axis, of half a turn.
fn turns(blob: &Blob, r: f32) -> usize {
    let c = blob.centre.x;
    let chord = blob.extent.x.powi(2) - (r - c).powi(2);
    let sine = chord.max(0.0) / (4.0 * r * c);
    match sine < 1.0 {
        true => {
            let angle = 2.0 * sine.sqrt().asin();
            (angle / PI * blob.turns as f32 + 0.5).ceil() as usize
        }
        false => blob.turns,
    }
}

/// Mass of the liquid, kg.
fn mass(frame: &Frame) -> f64 {
    let rings = frame.mass.iter().map(|mass| f64::from(*mass));
    rings.filter(|mass| mass.is_finite()).sum()
}
