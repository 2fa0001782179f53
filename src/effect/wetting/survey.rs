//! What is fixed of every wall particle: the wall it belongs to.

use super::Setting;
use crate::scene::{Domain, Side};

/// A wall particle.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Axis across which its wall lies; `None` behind two walls.
    pub axis: Option<usize>,
    /// 1 at the low side of the box, -1 at the high one.
    pub side: f64,
    /// Distance behind the face of its wall, m.
    pub depth: f64,
}

impl Place {
    /// Along `axis`, the point on the face of the wall right above wall particle `j`, m.
    pub fn face(&self, wall: &[Vec<f64>; 3], j: usize, axis: usize) -> f64 {
        let up = if self.axis == Some(axis) {
            self.side * self.depth
        } else {
            0.0
        };
        wall[axis][j] + up
    }
}

/// Surveys wall particles at `wall`, m.
pub fn survey(setting: &Setting, wall: &[Vec<f64>; 3]) -> Vec<Place> {
    let domain = &setting.domain;
    let behind = |axis: usize, x: f64| {
        let beyond = [-x, x - domain.size[axis]];
        [0, 1].map(|side| match domain.boundary[axis][side] {
            Side::Wall => beyond[side],
            _ => 0.0,
        })
    };
    let place = |i: usize| {
        let sides = (0..3).flat_map(|a| behind(a, wall[a][i]).map(|depth| (a, depth)));
        let mut deep = sides.filter(|(_, depth)| *depth > 0.0);
        let (axis, depth) = deep.next().unwrap_or((0, 0.0));
        Place {
            axis: (depth > 0.0 && deep.next().is_none()).then_some(axis),
            side: if wall[axis][i] < 0.0 { 1.0 } else { -1.0 },
            depth,
        }
    };
    (0..wall[0].len()).map(place).collect()
}

/// The axis across the wall whose face is nearest to `at`, m, and its velocity, m/s.
pub fn nearest(domain: &Domain, at: [f64; 3]) -> (usize, [f32; 3]) {
    let mut nearest = (f64::INFINITY, 2, [0.0; 3]);
    for (axis, sides) in domain.boundary.iter().enumerate() {
        let away = [at[axis], domain.size[axis] - at[axis]];
        for (end, (side, away)) in sides.iter().zip(away).enumerate() {
            if *side == Side::Wall && away < nearest.0 {
                let velocity = domain.wall_velocity[axis][end];
                nearest = (away, axis, velocity.map(|v| v as f32));
            }
        }
    }
    (nearest.1, nearest.2)
}

/// `y` over its length; zero in two dimensions, where all along a wall is across a line.
pub fn direction(dimension: usize, y: [f32; 3]) -> [f32; 3] {
    let length = y.iter().map(|y| y * y).sum::<f32>().sqrt();
    match dimension == 3 && length > 0.0 {
        true => y.map(|y| y / length),
        false => [0.0; 3],
    }
}
