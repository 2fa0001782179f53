//! Shape, spread and front of liquid that is not a pool.
//!
//! Shape: semi-axes of the ellipsoid with the body's second moments,
//! `a = √((d + 2) (⟨x²⟩ + s0²/12))`: each particle represents a cube of side s0. The amplitude of
//! the n = 2 oscillation follows from `r = R (1 + ε P2)` in 3-D, `r = R (1 + ε cos 2θ)` in 2-D. Of
//! a body of revolution, of which there is the section, ⟨x²⟩ is half of ⟨r²⟩.
//!
//! Spread on a dry wall: diameter of the area within the outer contact line over the drop's; holes
//! in the film count as film. Front: dam break.

use super::layer::{self, Layer, crossing};
use super::region::{Class, Region};
use crate::particle::Frame;
use crate::scene::Dimension;
use std::ops::Range;

/// Centre and shape of all liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Centre of mass, m.
    pub centre: [f64; 3],
    /// Of the equivalent ellipsoid, m.
    pub semi_axes: [f64; 3],
}

impl Shape {
    /// `None` without particles. `is_revolved`: the frame is a section through an axis.
    pub fn new(
        frame: &Frame,
        dimension: Dimension,
        is_revolved: bool,
        particle_spacing: f64,
    ) -> Option<Shape> {
        let mass = |i: usize| frame.mass.get(i).map_or(1.0, |mass| f64::from(*mass));
        let n = (0..frame.id.len()).map(mass).sum::<f64>();
        if n <= 0.0 {
            return None;
        }
        let sides = if is_revolved { 3 } else { dimension.count() };
        let factor = sides as f64 + 2.0;
        let mut shape = Shape {
            centre: [0.0; 3],
            semi_axes: [0.0; 3],
        };
        for axis in 0..3 {
            let x = &frame.position[axis];
            let each = || x.iter().enumerate().map(|(i, &x)| (mass(i), f64::from(x)));
            let mean = each().fold(0.0, |sum, (m, x)| sum + m * x) / n;
            let square = each().fold(0.0, |sum, (m, x)| sum + m * (x - mean).powi(2)) / n;
            let square = match is_revolved && axis == 0 {
                true => 0.5 * square,
                false => square,
            };
            shape.centre[axis] = mean;
            if axis != 1 || dimension == Dimension::Three {
                let filled = square + particle_spacing.powi(2) / 12.0;
                shape.semi_axes[axis] = (factor * filled).sqrt();
            }
        }
        Some(shape)
    }

    /// Vertical over mean lateral semi-axis.
    pub fn aspect_ratio(&self, dimension: Dimension) -> f64 {
        self.semi_axes[2] / self.lateral(dimension)
    }

    /// Amplitude ε of the n = 2 mode in `space`, positive when upright; `dimension`: of the frame.
    pub fn amplitude(&self, dimension: Dimension, space: Dimension) -> f64 {
        let (a, b) = (self.semi_axes[2], self.lateral(dimension));
        match space {
            // a = R (1 + ε), b = R (1 − ε/2).
            Dimension::Three => 2.0 * (a - b) / (a + 2.0 * b),
            Dimension::Two => (a - b) / (a + b),
        }
    }

    /// Mean pressure of the particles within 0.6 radii of a round drop's centre, Pa; `radius` in m.
    /// `None` if there are none.
    pub fn core_pressure(&self, frame: &Frame, radius: f64) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0.0);
        for (i, p) in frame.pressure.iter().enumerate() {
            let off = |a: usize| f64::from(frame.position[a][i]) - self.centre[a];
            if off(0).hypot(off(1)).hypot(off(2)) < 0.6 * radius {
                (sum, count) = (sum + f64::from(*p), count + 1.0);
            }
        }
        (count > 0.0).then(|| sum / count)
    }

    fn lateral(&self, dimension: Dimension) -> f64 {
        match dimension {
            Dimension::Three => 0.5 * (self.semi_axes[0] + self.semi_axes[1]),
            Dimension::Two => self.semi_axes[0],
        }
    }
}

/// A drop on a dry wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Diameter of the area within the outer contact line over d.
    pub wetted: f64,
    /// Part of that area that the main body does not wet.
    pub dry: f64,
    /// As `wetted`, for the liquid at any height.
    pub largest: f64,
    /// Highest liquid of the main body within 1.5 s0 of the axis, m above the wall.
    pub apex: Option<f64>,
}

impl Spread {
    /// `at`: axis; `diameter`: of the drop, m.
    pub fn new(region: &Region, at: [f64; 2], diameter: f64, dimension: Dimension) -> Spread {
        let raster = region.raster;
        let size = [raster.count[0], raster.count[1]];
        let (mut wet, mut covered) = (Layer::new(size), Layer::new(size));
        let mut apex: Option<f64> = None;
        for j in 0..size[1] {
            for i in 0..size[0] {
                wet.mark([i, j], region.class([i, j, 0]) == Class::Main);
                let high = region.column_high(i, j);
                covered.mark([i, j], high.is_some());
                let Some(high) = high else { continue };
                let dx = raster.coordinate(0, i) - at[0];
                let dy = if size[1] > 1 {
                    raster.coordinate(1, j) - at[1]
                } else {
                    0.0
                };
                if dx.hypot(dy) <= 1.5 * raster.particle_spacing {
                    apex = Some(apex.map_or(high, |old| old.max(high)));
                }
            }
        }
        let area = |nodes: &[bool]| {
            let some = nodes.iter().enumerate().filter(|(_, some)| **some);
            some.map(|(k, _)| raster.weight(k % size[0])).sum::<f64>()
        };
        let enclosed = wet.enclosed();
        let (all, wetted) = (area(&enclosed), area(&wet.is_marked));
        // Of the column's layers, that which reaches farthest.
        let reach = |layers: Range<usize>, [i, j]: [usize; 2], [x, y]: [usize; 2]| {
            let wet = layers.filter(|&k| region.class([i, j, k]) == Class::Main);
            let reach = wet.map(|k| crossing(raster.value([i, j, k]), raster.value([x, y, k])));
            reach.fold(0.0, f64::max)
        };
        let extent = |inside: &[bool], layers: Range<usize>| {
            let edge = |from, to| reach(layers.clone(), from, to);
            layer::diameter(raster, dimension, inside, edge) / diameter
        };
        Spread {
            wetted: extent(&enclosed, 0..1),
            dry: if all > 0.0 { (all - wetted) / all } else { 0.0 },
            largest: extent(&covered.enclosed(), 0..raster.count[2]),
            apex,
        }
    }
}

/// A collapsing column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Front {
    /// Farthest liquid of the main body along +x, m.
    pub reach: f64,
    /// Highest liquid of the main body, m.
    pub height: f64,
}

impl Front {
    /// `None` if the main body is empty.
    pub fn new(region: &Region) -> Option<Front> {
        let raster = region.raster;
        let mut front: Option<Front> = None;
        for j in 0..raster.count[1] {
            for i in 0..raster.count[0] {
                let Some(z) = region.column_high(i, j) else {
                    continue;
                };
                let f = front.get_or_insert_default();
                f.height = f.height.max(z);
                f.reach = f.reach.max(raster.coordinate(0, i));
            }
        }
        let front = front.as_mut()?;
        let column = (front.reach / raster.spacing[0] - 0.5).round() as usize;
        front.reach = refine(region, column);
        Some(*front)
    }
}

/// Crossing of φ = 1/2 beyond the last column with liquid, along x; the farthest of all rows.
fn refine(region: &Region, column: usize) -> f64 {
    let raster = region.raster;
    let x = raster.coordinate(0, column);
    if column + 1 == raster.count[0] {
        return x + 0.5 * raster.spacing[0];
    }
    let mut farthest = x;
    for k in 0..raster.count[2] {
        for j in 0..raster.count[1] {
            if region.class([column, j, k]) == Class::Main {
                let here = f64::from(raster.value([column, j, k]));
                let next = f64::from(raster.value([column + 1, j, k]));
                let part = ((0.5 - here) / (next - here)).clamp(0.0, 1.0);
                farthest = farthest.max(x + part * raster.spacing[0]);
            }
        }
    }
    farthest
}
