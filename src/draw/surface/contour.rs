//! The outline of a field of revolution in the half-plane: marching squares.
//!
//! Around the grid, but not behind the axis, are nodes outside the liquid; points that come to lie
//! between them and the last nodes are put on the sides. So the outline is closed by the axis
//! alone, and flat at walls.

use std::collections::HashMap;

use super::Field;

/// Lines between points of the half-plane, the liquid to their left.
#[derive(Default)]
pub struct Contour {
    /// Distance from the axis and height, m.
    pub points: Vec<[f32; 2]>,
    /// From point to point.
    pub lines: Vec<[u32; 2]>,
}

impl Field {
    /// The outline of the surface.
    pub fn contour(&self, level: f32) -> Contour {
        let mut contour = Contour::default();
        let mut known = HashMap::new();
        self.lines(level, |line| {
            let [a, b] = line.map(|point| {
                *known.entry(point.map(f32::to_bits)).or_insert_with(|| {
                    contour.points.push(point);
                    contour.points.len() as u32 - 1
                })
            });
            if a != b {
                contour.lines.push([a, b]);
            }
        });
        contour
    }

    /// Volume of the body of revolution inside the surface at a level, m^3.
    pub(super) fn contour_volume(&self, level: f32) -> f64 {
        let mut sum = 0.0;
        self.lines(level, |line| {
            let [[r, z], [s, t]] = line.map(|point| point.map(f64::from));
            sum += (r * r + r * s + s * s) * (t - z);
        });
        std::f64::consts::PI / 3.0 * sum
    }

    /// Calls `found` for all lines of the outline.
    fn lines(&self, level: f32, mut found: impl FnMut([[f32; 2]; 2])) {
        let [columns, _, rows] = self.count;
        let value = |i: usize, k: usize| match i < columns && (1..=rows).contains(&k) {
            true => self.values[i * rows + k - 1] - level,
            false => -level,
        };
        for i in 0..columns {
            for k in 0..=rows {
                let corners = [[i, k], [i + 1, k], [i + 1, k + 1], [i, k + 1]];
                let values = corners.map(|[i, k]| value(i, k));
                let inside = values.iter().filter(|value| **value > 0.0).count();
                if inside == 0 || inside == 4 {
                    continue;
                }
                let point = |edge: usize| {
                    let next = (edge + 1) % 4;
                    self.crossing([corners[edge], corners[next]], [values[edge], values[next]])
                };
                let is_joined = values.iter().sum::<f32>() > 0.0;
                for edge in 0..4 {
                    if values[edge] > 0.0 && values[(edge + 1) % 4] <= 0.0 {
                        found([point(edge), point(entry(&values, edge, is_joined))]);
                    }
                }
            }
        }
    }

    /// Where the surface crosses an edge between two nodes; rows are counted from the one outside.
    fn crossing(&self, nodes: [[usize; 2]; 2], values: [f32; 2]) -> [f32; 2] {
        // The same bits from both cells of an edge.
        let (nodes, [from, to]) = match nodes[0] < nodes[1] {
            true => (nodes, values),
            false => ([nodes[1], nodes[0]], [values[1], values[0]]),
        };
        let part = from / (from - to);
        let last = [self.count[0], self.count[2]].map(|n| (n - 1) as f32);
        let place = |a: usize| {
            let [from, to] = nodes.map(|node| node[a] as f32 - a as f32);
            (from + part * (to - from)).clamp(0.0, last[a])
        };
        [place(0) * self.step.x, self.low.z + place(1) * self.step.z]
    }
}

/// The edge at which a line that leaves the liquid at `edge` ends: counter-clockwise the next one
/// into the liquid, or, where two corners of liquid are not joined, the one before.
fn entry(values: &[f32; 4], edge: usize, is_joined: bool) -> usize {
    let is_entry = |edge: usize| values[edge % 4] <= 0.0 && values[(edge + 1) % 4] > 0.0;
    let ahead = (edge + 1..edge + 4).find(|edge| is_entry(*edge));
    let behind = (edge + 1..edge + 4).rev().find(|edge| is_entry(*edge));
    let found = if is_joined { ahead } else { behind };
    found.unwrap_or(edge) % 4
}
