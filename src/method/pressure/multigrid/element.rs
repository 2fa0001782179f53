//! From particles to the first grid and back: cells with linear shape functions.

use super::super::Equation;
use super::level::Level;
use crate::space::parallel::{each_mut, each_part, max};
use crate::space::ranks::halo::Carried;

/// Where grids are laid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Domain {
    /// Axes along which anything varies.
    pub active: [bool; 3],
    /// Axes along which the box is periodic.
    pub periodic: [bool; 3],
    /// Period of periodic axes, m.
    pub size: [f64; 3],
    /// Wanted distance of nodes, m.
    pub pitch: f64,
}

/// Cells of the first grid, each with the unknowns in it.
#[derive(Default)]
pub struct Elements {
    low: [f64; 3],
    pitch: [f64; 3],
    /// Cell and place in it of every unknown, each axis in 0..1.
    cell: Vec<u32>,
    part: Vec<[f32; 3]>,
    start: Vec<u32>,
    order: Vec<u32>,
    matrix: Vec<[f64; 36]>,
}

/// Fewest nodes of a periodic axis: each then has two different neighbours on each grid.
const LEAST: usize = 4;

/// Nodes lie at most so many times as far apart as is wanted: of [`halvable`].
pub const WIDEST: f64 = (LEAST + 1) as f64 / LEAST as f64;

/// m 2^k nodes, LEAST <= m < 2 LEAST, that lie at least `pitch` apart.
fn halvable(size: f64, pitch: f64) -> usize {
    let wanted = ((size / pitch) as usize).max(LEAST);
    let shift = (wanted / LEAST).ilog2();
    wanted >> shift << shift
}

/// N_i at `part` and its gradient in cells; node i = 4 x + 2 y + z.
#[inline(always)]
fn shape(part: [f32; 3]) -> ([f64; 8], [[f64; 3]; 8]) {
    let side = |a: usize, up: usize| {
        let t = part[a] as f64;
        if up == 1 { (t, 1.0) } else { (1.0 - t, -1.0) }
    };
    let (mut n, mut g) = ([0.0; 8], [[0.0; 3]; 8]);
    for i in 0..8 {
        let [x, y, z] = [side(0, i >> 2), side(1, i >> 1 & 1), side(2, i & 1)];
        n[i] = x.0 * y.0 * z.0;
        g[i] = [x.1 * y.0 * z.0, x.0 * y.1 * z.0, x.0 * y.0 * z.1];
    }
    (n, g)
}

impl Elements {
    pub fn memory(&self) -> usize {
        20 * self.cell.capacity() + 4 * self.start.capacity() + 288 * self.matrix.capacity()
    }

    /// Lays the first grid over the unknowns and gives it its matrix.
    pub fn lay(&mut self, equation: &Equation, domain: &Domain, level: &mut Level) {
        let n = equation.len();
        let mut count = [1; 3];
        for a in (0..3).filter(|a| domain.active[*a]) {
            let x = &equation.place[a];
            if domain.periodic[a] {
                count[a] = halvable(domain.size[a], domain.pitch);
                (self.low[a], self.pitch[a]) = (0.0, domain.size[a] / count[a] as f64);
            } else {
                let largest = |own: f64| match &equation.shared {
                    None => own,
                    Some(shared) => shared.largest(own),
                };
                let (low, high) = (-largest(max(n, |i| -x[i])), largest(max(n, |i| x[i])));
                count[a] = ((high - low) / domain.pitch) as usize + 2;
                (self.low[a], self.pitch[a]) = (low, domain.pitch);
            }
        }
        level.shape(count, domain.periodic);
        self.sort(equation, domain, level);
        self.integrate(equation, domain, level);
        let matrix = &self.matrix;
        level.assemble(|cell, i, j| matrix[cell][triangle(i, j)]);
        self.join(equation, level.count, &mut level.stencil);
        level.set_inverse();
    }

    /// Gives all ranks what each has found of the nodes in its slabs.
    pub fn join<T: Carried>(&self, equation: &Equation, count: [usize; 3], nodes: &mut [T]) {
        if let Some(shared) = &equation.shared {
            shared.join(count, (self.low[0], self.pitch[0]), nodes);
        }
    }

    /// Finds the cell of every unknown and sorts along cells.
    fn sort(&mut self, equation: &Equation, domain: &Domain, level: &Level) {
        let n = equation.columns();
        self.cell.resize(n, 0);
        self.part.resize(n, [0.0; 3]);
        let (low, pitch, count) = (self.low, self.pitch, level.count);
        each_mut(
            (&mut self.cell[..n], &mut self.part[..n]),
            |i, (cell, part)| {
                let (mut at, mut t) = ([0; 3], [0.0f32; 3]);
                for a in (0..3).filter(|a| domain.active[*a]) {
                    let x = (equation.place[a][i] - low[a]) / pitch[a];
                    let c = x.floor();
                    t[a] = (x - c) as f32;
                    at[a] = (c as i64).rem_euclid(count[a] as i64) as usize;
                }
                *cell = level.index(at) as u32;
                *part = t;
            },
        );
        self.order.resize(n, 0);
        self.start.clear();
        self.start.resize(level.len() + 1, 0);
        self.cell
            .iter()
            .for_each(|c| self.start[*c as usize + 1] += 1);
        for c in 1..self.start.len() {
            self.start[c] += self.start[c - 1];
        }
        // As in `space::sort`: `start[c]` moves to the end of its cell while filling.
        let mut place = |i: usize| {
            let slot = &mut self.start[self.cell[i] as usize];
            self.order[*slot as usize] = i as u32;
            *slot += 1;
        };
        match &equation.shared {
            None => (0..n).for_each(place),
            Some(shared) => shared.order.iter().for_each(|&i| place(i as usize)),
        }
        for c in (1..self.start.len()).rev() {
            self.start[c] = self.start[c - 1];
        }
        self.start[0] = 0;
    }

    #[inline(always)]
    fn members(&self, cell: usize) -> &[u32] {
        &self.order[self.start[cell] as usize..self.start[cell + 1] as usize]
    }

    /// (1) of every cell.
    fn integrate(&mut self, equation: &Equation, domain: &Domain, level: &Level) {
        let mut matrix = std::mem::take(&mut self.matrix);
        matrix.resize(level.len(), [0.0; 36]);
        let scale = [0, 1, 2].map(|a| match domain.active[a] {
            true => 1.0 / (self.pitch[a] * self.pitch[a]),
            false => 0.0,
        });
        each_part(&mut matrix[..], |cell, out| {
            *out = [0.0; 36];
            for &u in self.members(cell) {
                let u = u as usize;
                let (share, surface) = (equation.share[u], equation.surface[u]);
                let (n, g) = shape(self.part[u]);
                let mut k = 0;
                for i in 0..8 {
                    let h = [0, 1, 2].map(|a| share * scale[a] * g[i][a]);
                    let own = surface * n[i];
                    for j in 0..=i {
                        out[k] += h[0] * g[j][0] + h[1] * g[j][1] + h[2] * g[j][2] + own * n[j];
                        k += 1;
                    }
                }
            }
        });
        self.matrix = matrix;
    }

    /// b of the grid = N^T r.
    pub fn restrict(&self, r: &[f64], level: &mut Level) {
        let mut b = std::mem::take(&mut level.b);
        let grid = &*level;
        each_part(&mut b[..], |node, b| {
            *b = 0.0;
            for corner in 0..8 {
                let Some(cell) = grid.cell_of(node, corner) else {
                    continue;
                };
                for &u in self.members(cell) {
                    *b += weight(self.part[u as usize], corner) * r[u as usize];
                }
            }
        });
        level.b = b;
    }

    /// z += N x of the grid.
    pub fn prolong(&self, level: &Level, z: &mut [f64]) {
        let n = z.len();
        each_mut(&mut z[..n], |u, z| {
            let mut sum = 0.0;
            for corner in 0..8 {
                if let Some(node) = level.node_of(self.cell[u] as usize, corner) {
                    sum += weight(self.part[u], corner) * level.x[node];
                }
            }
            *z += sum;
        });
    }
}

/// N of one corner.
#[inline(always)]
fn weight(part: [f32; 3], corner: usize) -> f64 {
    let side = |a: usize, up: usize| {
        let t = part[a] as f64;
        if up == 1 { t } else { 1.0 - t }
    };
    side(0, corner >> 2) * side(1, corner >> 1 & 1) * side(2, corner & 1)
}

/// Place of entry (i, j) in a lower triangle.
#[inline(always)]
fn triangle(i: usize, j: usize) -> usize {
    let (i, j) = (i.max(j), i.min(j));
    i * (i + 1) / 2 + j
}
