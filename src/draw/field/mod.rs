//! Pressure and velocity averaged about the axis, as in Figs. 8 and 9 of Nishio et al. 2010.
//!
//! Particles are distributed to bins of one spacing by their distance from the axis and height
//! (2-D: by |x|, left and right mirrored onto each other), each linearly to the four nearest bins,
//! so that rows of particles leave no gaps. A bin is liquid if it contains two fifths of the
//! particles that would fill it.

mod figure;

pub use figure::{Bounds, Scales};

use crate::measure::pool::Axis;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene, Side};

/// Means over one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// Number of particles.
    pub count: f64,
    /// Pa.
    pub pressure: f64,
    /// Radial (outward) and vertical, m/s.
    pub velocity: [f64; 2],
}

/// The four bins nearest to a position in bins, and their weights; axis and floor reflect.
fn shares(place: [f64; 2]) -> [([usize; 2], f64); 4] {
    let low = place.map(|x| (x - 0.5).floor());
    std::array::from_fn(|k| {
        let upper = [k & 1, k >> 1];
        let axis = |a: usize| {
            let part = (place[a] - 0.5) - low[a];
            let at = low[a] + upper[a] as f64;
            (at.max(0.0) as usize, [1.0 - part, part][upper[a]])
        };
        let ((r, a), (z, b)) = (axis(0), axis(1));
        ([r, z], a * b)
    })
}

/// A field of bins, r fastest.
pub struct Field {
    /// Caption.
    pub label: String,
    /// Bins along r and z.
    pub count: [usize; 2],
    /// Edge of a bin, m.
    pub edge: f64,
    bins: Vec<Option<Bin>>,
}

impl Field {
    /// Averages `frame` over the azimuth about `axis` (2-D: over both sides).
    pub fn new(scene: &Scene, frame: &Frame, axis: &Axis, label: String) -> Field {
        let edge = scene.spacing;
        let flat = scene.dimension == Dimension::Two;
        let size = scene.domain.size;
        let reach = 0.5 * if flat { size[0] } else { size[0].min(size[1]) };
        let finite = frame.position[2].iter().copied().filter(|z| z.is_finite());
        let top = f64::from(finite.fold(0.0, f32::max));
        let count = [(reach / edge) as usize, (top / edge) as usize + 1];
        let mut bins = vec![Bin::default(); count[0] * count[1]];
        for i in 0..frame.id.len() {
            let d = offset(scene, axis, frame, i);
            let r = d[0].hypot(d[1]);
            let place = [r / edge, f64::from(frame.position[2][i]) / edge];
            if !(place[0].is_finite() && place[1] >= 0.0) {
                continue;
            }
            let v = [0, 1, 2].map(|a| f64::from(frame.velocity[a][i]));
            let outward = if r > 0.0 {
                (d[0] * v[0] + d[1] * v[1]) / r
            } else {
                0.0
            };
            for ([r, z], share) in shares(place) {
                if r >= count[0] || z >= count[1] {
                    continue;
                }
                let bin = &mut bins[z * count[0] + r];
                bin.count += share;
                bin.pressure += share * f64::from(frame.pressure[i]);
                bin.velocity[0] += share * outward;
                bin.velocity[1] += share * v[2];
            }
        }
        let full = |i: usize| {
            let ring = std::f64::consts::PI * (2 * i + 1) as f64;
            if flat { 2.0 } else { ring }
        };
        let mean = |(place, bin): (usize, &Bin)| {
            let enough = bin.count >= 0.4 * full(place % count[0]);
            enough.then(|| Bin {
                count: bin.count,
                pressure: bin.pressure / bin.count,
                velocity: bin.velocity.map(|v| v / bin.count),
            })
        };
        let bins = bins.iter().enumerate().map(mean).collect();
        Field {
            label,
            count,
            edge,
            bins,
        }
    }

    /// Means of a bin, `None` in gas and outside.
    pub fn bin(&self, r: usize, z: usize) -> Option<Bin> {
        let inside = r < self.count[0] && z < self.count[1];
        if inside {
            self.bins[z * self.count[0] + r]
        } else {
            None
        }
    }

    /// Height that contains all but a thousandth of the liquid bins, m.
    pub fn top(&self) -> f64 {
        let rows = |z: usize| {
            (0..self.count[0])
                .filter(|&r| self.bin(r, z).is_some())
                .count()
        };
        let counts: Vec<usize> = (0..self.count[1]).map(rows).collect();
        let spare = counts.iter().sum::<usize>() / 1000;
        let mut above = 0;
        let last = (0..counts.len()).rev().find(|&z| {
            above += counts[z];
            above > spare
        });
        last.map_or(0.0, |z| (z + 1) as f64 * self.edge)
    }
}

fn offset(scene: &Scene, axis: &Axis, frame: &Frame, i: usize) -> [f64; 2] {
    [0, 1].map(|a| {
        if a == 1 && scene.dimension == Dimension::Two {
            return 0.0;
        }
        let d = f64::from(frame.position[a][i]) - axis.at[a];
        let length = scene.domain.size[a];
        match scene.domain.boundary[a][0] {
            Side::Periodic => d - length * (d / length).round(),
            _ => d,
        }
    })
}
