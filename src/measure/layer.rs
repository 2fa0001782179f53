//! Regions of a horizontal layer of the raster, with their edge between its nodes.
//!
//! The region is the polygon through the points at which its edge lies between a node of it and
//! one outside (marching squares: Lorensen & Cline 1987, in two dimensions): its area has an error
//! of second order, where a count of nodes has one of first. Two nodes that meet at a corner are
//! apart. Tests: tests/engine/measure_layer.rs, `measure_pool.rs`, `measure_drop.rs`.

use super::raster::{LEVEL, Raster};
use crate::scene::Dimension;

/// Nodes of a layer, x fastest, and which of them are marked.
pub struct Layer {
    size: [usize; 2],
    /// Whether each node is marked.
    pub is_marked: Vec<bool>,
}

impl Layer {
    /// No node is marked.
    pub fn new(size: [usize; 2]) -> Layer {
        Layer {
            size,
            is_marked: vec![false; size[0] * size[1]],
        }
    }

    /// Marks a node, or not.
    pub fn mark(&mut self, [i, j]: [usize; 2], is_marked: bool) {
        self.is_marked[j * self.size[0] + i] = is_marked;
    }

    /// Which nodes are marked or enclosed by marked ones.
    pub fn enclosed(&self) -> Vec<bool> {
        let [nx, ny] = self.size;
        let mut is_shut = vec![true; nx * ny];
        let mut next = Vec::new();
        let mut open = |node: usize, next: &mut Vec<usize>| {
            if is_shut[node] && !self.is_marked[node] {
                is_shut[node] = false;
                next.push(node);
            }
        };
        for i in 0..nx {
            for j in 0..ny {
                if i == 0 || i + 1 == nx || ny > 1 && (j == 0 || j + 1 == ny) {
                    open(j * nx + i, &mut next);
                }
            }
        }
        while let Some(node) = next.pop() {
            let (i, j) = (node % nx, node / nx);
            let beside = [
                (i > 0).then(|| node - 1),
                (i + 1 < nx).then(|| node + 1),
                (j > 0).then(|| node - nx),
                (j + 1 < ny).then(|| node + nx),
            ];
            beside
                .into_iter()
                .flatten()
                .for_each(|node| open(node, &mut next));
        }
        is_shut
    }
}

/// Part of the way between nodes with φ = `from` and `to` at which φ is 1/2; the middle if it is
/// nowhere.
pub fn crossing(from: f32, to: f32) -> f64 {
    match (from < LEVEL) != (to < LEVEL) {
        true => f64::from((LEVEL - from) / (to - from)),
        false => 0.5,
    }
}

/// Diameter, m, of the circle with the area of the nodes `inside`; in two dimensions their width.
/// `edge`: part of the way from a node (i, j) inside to one beside it outside at which the edge is.
pub fn diameter(
    raster: &Raster,
    dimension: Dimension,
    inside: &[bool],
    edge: impl Fn([usize; 2], [usize; 2]) -> f64,
) -> f64 {
    let [nx, ny, _] = raster.count;
    let is_in = |[i, j]: [usize; 2]| inside[j * nx + i];
    let part = |a: [usize; 2], b: [usize; 2]| match (is_in(a), is_in(b)) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => edge(a, b),
        (false, true) => edge(b, a),
    };
    let mut area = 0.0;
    for (j, above, height) in neighbours(ny, raster.periodic[1]) {
        for (i, right, width) in neighbours(nx, raster.periodic[0]) {
            let corners = [[[i, j], [right, j]], [[i, above], [right, above]]];
            let inside = corners.map(|row| row.map(is_in));
            let along = corners.map(|[left, right]| part(left, right));
            let up = [0, 1].map(|k| part(corners[0][k], corners[1][k]));
            area += width * height * filled(inside, along, up);
        }
    }
    match dimension {
        Dimension::Two => area * raster.spacing[0],
        Dimension::Three => {
            let area = area * raster.spacing[0] * raster.spacing[1];
            2.0 * (area / std::f64::consts::PI).sqrt()
        }
    }
}

/// Nodes beside each other along an axis, and their distance in spacings; a wall is half a spacing
/// beyond the last one.
fn neighbours(count: usize, periodic: bool) -> impl Iterator<Item = (usize, usize, f64)> {
    let last = count - 1;
    let ends = match periodic {
        true => [Some((last, 0, 1.0)), None],
        false => [Some((0, 0, 0.5)), Some((last, last, 0.5))],
    };
    let inner = (0..last).map(|k| (k, k + 1, 1.0));
    inner.chain(ends.into_iter().flatten())
}

/// Part of a square that is inside. By row and column: whether its corners are, and of its edges
/// along a row and up a column the part that is.
fn filled(inside: [[bool; 2]; 2], along: [f64; 2], up: [f64; 2]) -> f64 {
    let sum = |parts: [f64; 2]| parts[0] + parts[1];
    let is_row = inside.iter().any(|row| row[0] && row[1]);
    let is_column = (0..2).any(|k| inside[0][k] && inside[1][k]);
    match inside.as_flattened().iter().filter(|one| **one).count() {
        0 => 0.0,
        1 => 0.5 * sum(along) * sum(up),
        2 if is_row => 0.5 * sum(up),
        2 if is_column => 0.5 * sum(along),
        2 => {
            let k = usize::from(inside[0][1]);
            0.5 * (along[0] * up[k] + along[1] * up[1 - k])
        }
        3 => 1.0 - 0.5 * (2.0 - sum(along)) * (2.0 - sum(up)),
        _ => 1.0,
    }
}
