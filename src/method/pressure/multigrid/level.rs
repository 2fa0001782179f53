//! A regular grid of nodes with a stencil of 27 entries a node, and how it meets the next one.

use crate::space::parallel::{each_mut, each_part};

/// Over-relaxation of the smoother. With absolute row sums the eigenvalues of linear elements are
/// at most 3/4 and those of the upper half of the spectrum at least 1/4 (their stencil in 2-D and
/// 3-D): 4/3 brings them to 1/3 .. 1.
const RELAXATION: f64 = 4.0 / 3.0;

/// Sweeps before and after the next grid.
const SWEEPS: usize = 2;

/// One grid.
#[derive(Default)]
pub struct Level {
    pub count: [usize; 3],
    periodic: [bool; 3],
    /// Axes on which the next grid has every second node.
    halved: [bool; 3],
    /// Entry to the neighbour at offset (k / 9, k / 3 % 3, k % 3) - 1.
    pub stencil: Vec<[f64; 27]>,
    /// Relaxation over the sum of absolute entries.
    inverse: Vec<f64>,
    pub x: Vec<f64>,
    pub b: Vec<f64>,
    scratch: Vec<f64>,
}

impl Level {
    pub fn len(&self) -> usize {
        self.count.iter().product()
    }

    pub fn memory(&self) -> usize {
        self.stencil.capacity() * 216 + 32 * self.x.capacity()
    }

    /// Takes a shape; everything else is void after it.
    pub fn shape(&mut self, count: [usize; 3], periodic: [bool; 3]) {
        (self.count, self.periodic) = (count, periodic);
        let n = self.len();
        self.stencil.resize(n, [0.0; 27]);
        for v in [
            &mut self.inverse,
            &mut self.x,
            &mut self.b,
            &mut self.scratch,
        ] {
            v.resize(n, 0.0);
        }
    }

    #[inline(always)]
    pub fn index(&self, at: [usize; 3]) -> usize {
        (at[0] * self.count[1] + at[1]) * self.count[2] + at[2]
    }

    #[inline(always)]
    fn at(&self, node: usize) -> [usize; 3] {
        let z = node % self.count[2];
        let rest = node / self.count[2];
        [rest / self.count[1], rest % self.count[1], z]
    }

    /// The node at `at + offset`, if there is one.
    #[inline(always)]
    fn step(&self, at: [usize; 3], offset: [i64; 3]) -> Option<usize> {
        let mut to = [0; 3];
        for a in 0..3 {
            let n = self.count[a] as i64;
            let c = at[a] as i64 + offset[a];
            to[a] = if c >= 0 && c < n {
                c as usize
            } else if self.periodic[a] && n > 1 {
                c.rem_euclid(n) as usize
            } else {
                return None;
            };
        }
        Some(self.index(to))
    }

    /// Corner `corner` = 4 x + 2 y + z of a cell.
    #[inline(always)]
    pub fn node_of(&self, cell: usize, corner: usize) -> Option<usize> {
        let up = [corner >> 2, corner >> 1 & 1, corner & 1].map(|u| u as i64);
        self.step(self.at(cell), up)
    }

    /// The cell of which `node` is corner `corner`.
    #[inline(always)]
    pub fn cell_of(&self, node: usize, corner: usize) -> Option<usize> {
        let down = [corner >> 2, corner >> 1 & 1, corner & 1].map(|u| -(u as i64));
        self.step(self.at(node), down)
    }

    /// The stencil from the matrices of cells: `matrix(cell, corner, corner)`; its inverse is void.
    pub fn assemble(&mut self, matrix: impl Fn(usize, usize, usize) -> f64 + Sync) {
        let mut stencil = std::mem::take(&mut self.stencil);
        let grid = &*self;
        each_part(&mut stencil[..], |node, out| {
            *out = [0.0; 27];
            for own in 0..8usize {
                let Some(cell) = grid.cell_of(node, own) else {
                    continue;
                };
                for other in 0..8usize {
                    let along = |s: usize| (other >> s & 1) + 1 - (own >> s & 1);
                    out[9 * along(2) + 3 * along(1) + along(0)] += matrix(cell, own, other);
                }
            }
        });
        self.stencil = stencil;
    }

    /// Nodes without liquid get the inverse 0: they stay zero.
    pub fn set_inverse(&mut self) {
        let stencil = &self.stencil;
        each_mut(&mut self.inverse[..stencil.len()], |node, inverse| {
            let sum: f64 = stencil[node].iter().map(|e| e.abs()).sum();
            *inverse = if sum > 0.0 { RELAXATION / sum } else { 0.0 };
        });
    }

    /// (A x) of a node.
    #[inline(always)]
    fn row(&self, node: usize, x: &[f64]) -> f64 {
        let (at, entry) = (self.at(node), &self.stencil[node]);
        let [nx, ny, nz] = self.count;
        let inner = |a: usize, n: usize| at[a] > 0 && at[a] + 1 < n;
        if inner(0, nx) && inner(1, ny) && inner(2, nz) {
            let mut sum = 0.0;
            for k in 0..9 {
                let from = node + (k / 3) * ny * nz + (k % 3) * nz - ny * nz - nz - 1;
                let x = &x[from..from + 3];
                sum += entry[3 * k] * x[0] + entry[3 * k + 1] * x[1] + entry[3 * k + 2] * x[2];
            }
            return sum;
        }
        let mut sum = 0.0;
        for (k, entry) in entry.iter().enumerate() {
            if *entry == 0.0 {
                continue;
            }
            if let Some(to) = self.step(at, offset(k)) {
                sum += entry * x[to];
            }
        }
        sum
    }

    /// Jacobi sweeps on A x = b, from x = 0 if `fresh`.
    pub fn smooth(&mut self, fresh: bool) {
        let mut x = std::mem::take(&mut self.x);
        let mut next = std::mem::take(&mut self.scratch);
        for sweep in 0..SWEEPS {
            let first = fresh && sweep == 0;
            let grid = &*self;
            each_mut(&mut next[..x.len()], |i, out| {
                let now = if first { 0.0 } else { x[i] };
                let image = if first { 0.0 } else { grid.row(i, &x) };
                *out = now + grid.inverse[i] * (grid.b[i] - image);
            });
            std::mem::swap(&mut x, &mut next);
        }
        (self.x, self.scratch) = (x, next);
    }

    /// Decides which axes the next grid halves; false if none can be.
    pub fn halve(&mut self) -> bool {
        for a in 0..3 {
            let n = self.count[a];
            self.halved[a] = if self.periodic[a] {
                n.is_multiple_of(2) && n >= 8
            } else {
                n > 3
            };
        }
        self.halved.contains(&true)
    }

    /// Nodes of the finer grid that `node` of this one is made of, with weights.
    #[inline(always)]
    fn children(&self, fine: &Level, node: usize, mut each: impl FnMut(usize, [usize; 3], f64)) {
        let at = self.at(node);
        let twice = [0, 1, 2].map(|a| if fine.halved[a] { 2 * at[a] } else { at[a] } as i64);
        for k in 0..27 {
            let o = offset(k);
            if (0..3).any(|a| o[a] != 0 && !fine.halved[a]) {
                continue;
            }
            let weight: f64 = o.iter().map(|o| if *o == 0 { 1.0 } else { 0.5 }).product();
            let mut to = [0; 3];
            let mut there = true;
            for a in 0..3 {
                let (c, n) = (twice[a] + o[a], fine.count[a] as i64);
                there &= fine.periodic[a] || (c >= 0 && c < n);
                to[a] = c.rem_euclid(n) as usize;
            }
            if there {
                each(fine.index(to), to, weight);
            }
        }
    }

    /// Nodes of this grid from which node `at` of the finer one is interpolated: up to two an axis.
    #[inline(always)]
    fn parents(&self, fine: &Level, at: [usize; 3]) -> [([usize; 2], usize); 3] {
        [0, 1, 2].map(|a| {
            if !fine.halved[a] {
                return ([at[a], 0], 1);
            }
            let low = at[a] / 2;
            match at[a] % 2 {
                0 => ([low, 0], 1),
                _ => ([low, (low + 1) % self.count[a]], 2),
            }
        })
    }

    /// Takes shape and matrix of every second node of `fine`.
    pub fn galerkin(&mut self, fine: &Level) {
        let count = [0, 1, 2].map(|a| match (fine.halved[a], fine.periodic[a]) {
            (false, _) => fine.count[a],
            (true, true) => fine.count[a] / 2,
            (true, false) => fine.count[a] / 2 + 1,
        });
        self.shape(count, fine.periodic);
        let mut stencil = std::mem::take(&mut self.stencil);
        let grid = &*self;
        each_part(&mut stencil[..], |node, out| {
            *out = [0.0; 27];
            let own = grid.at(node);
            grid.children(fine, node, |i, at, weight| {
                for (k, entry) in fine.stencil[i].iter().enumerate() {
                    if *entry == 0.0 {
                        continue;
                    }
                    let Some(j) = fine.step(at, offset(k)) else {
                        continue;
                    };
                    grid.spread(fine, own, fine.at(j), weight * entry, out);
                }
            });
        });
        self.stencil = stencil;
        self.set_inverse();
    }

    /// Adds `value`, an entry to node `to` of the finer grid, to the stencil of node `own`.
    #[inline(always)]
    fn spread(
        &self,
        fine: &Level,
        own: [usize; 3],
        to: [usize; 3],
        value: f64,
        out: &mut [f64; 27],
    ) {
        let parents = self.parents(fine, to);
        let part: f64 = parents.iter().map(|p| 1.0 / p.1 as f64).product();
        let along = |a: usize, c: usize| {
            let n = self.count[a] as i64;
            let mut d = c as i64 - own[a] as i64;
            if self.periodic[a] && n > 1 {
                d = (d + n / 2).rem_euclid(n) - n / 2;
            }
            (d + 1) as usize
        };
        for x in &parents[0].0[..parents[0].1] {
            for y in &parents[1].0[..parents[1].1] {
                for z in &parents[2].0[..parents[2].1] {
                    out[9 * along(0, *x) + 3 * along(1, *y) + along(2, *z)] += part * value;
                }
            }
        }
    }

    /// b of `coarse` = what is left here.
    pub fn restrict(&mut self, coarse: &mut Level) {
        let (b, x) = (&self.b, &self.x);
        let mut left = std::mem::take(&mut self.scratch);
        {
            let grid = &*self;
            each_mut(&mut left[..b.len()], |i, left| {
                *left = b[i] - grid.row(i, x)
            });
        }
        let mut b = std::mem::take(&mut coarse.b);
        let (fine, grid) = (&*self, &*coarse);
        each_part(&mut b[..], |node, b| {
            *b = 0.0;
            grid.children(fine, node, |i, _, weight| *b += weight * left[i]);
        });
        coarse.b = b;
        self.scratch = left;
    }

    /// x += what `coarse` found.
    pub fn prolong(&mut self, coarse: &Level) {
        let mut x = std::mem::take(&mut self.x);
        let fine = &*self;
        each_part(&mut x[..], |i, x| {
            let parents = coarse.parents(fine, fine.at(i));
            let part: f64 = parents.iter().map(|p| 1.0 / p.1 as f64).product();
            let mut sum = 0.0;
            for a in &parents[0].0[..parents[0].1] {
                for b in &parents[1].0[..parents[1].1] {
                    for c in &parents[2].0[..parents[2].1] {
                        sum += coarse.x[coarse.index([*a, *b, *c])];
                    }
                }
            }
            *x += part * sum;
        });
        self.x = x;
    }

    /// Cholesky factor of this grid's matrix; `enclosed`: with constants made regular.
    pub fn factorise(&self, factor: &mut Vec<f64>, enclosed: bool) {
        let n = self.len();
        factor.clear();
        factor.resize(n * (n + 1) / 2, 0.0);
        let place = |i: usize, j: usize| i * (i + 1) / 2 + j;
        let mut mean = 0.0;
        for i in 0..n {
            let at = self.at(i);
            for (k, entry) in self.stencil[i].iter().enumerate() {
                if let Some(j) = self.step(at, offset(k)).filter(|j| *j <= i) {
                    factor[place(i, j)] += entry;
                }
            }
            mean += factor[place(i, i)] / n as f64;
        }
        if enclosed {
            factor.iter_mut().for_each(|f| *f += mean / n as f64);
        }
        for i in 0..n {
            for j in 0..=i {
                let mut sum = factor[place(i, j)];
                for k in 0..j {
                    sum -= factor[place(i, k)] * factor[place(j, k)];
                }
                factor[place(i, j)] = if i != j {
                    sum / factor[place(j, j)]
                } else if sum > 1e-10 * mean {
                    sum.sqrt()
                } else {
                    // A node without liquid: its b is 0.
                    mean.max(f64::MIN_POSITIVE).sqrt()
                };
            }
        }
    }

    /// x = A^-1 b by `factor`.
    pub fn solve(&mut self, factor: &[f64]) {
        let n = self.len();
        let place = |i: usize, j: usize| i * (i + 1) / 2 + j;
        for i in 0..n {
            let mut sum = self.b[i];
            for k in 0..i {
                sum -= factor[place(i, k)] * self.x[k];
            }
            self.x[i] = sum / factor[place(i, i)];
        }
        for i in (0..n).rev() {
            let mut sum = self.x[i];
            for k in i + 1..n {
                sum -= factor[place(k, i)] * self.x[k];
            }
            self.x[i] = sum / factor[place(i, i)];
        }
    }
}

/// Offset of entry `k` of a stencil.
#[inline(always)]
fn offset(k: usize) -> [i64; 3] {
    [k / 9, k / 3 % 3, k % 3].map(|c| c as i64 - 1)
}
