//! Connected regions on the grid: the gas that is open above, and the largest body of liquid.

use super::raster::{LEVEL, Raster};
use crate::particle::Frame;

/// Region of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Gas connected with the topmost layer of the grid.
    Exterior,
    /// The largest connected liquid.
    Main,
    /// Mist, bubbles.
    Other,
}

/// Connected regions (across faces) of a raster.
pub struct Region<'a> {
    /// The raster that is divided.
    pub raster: &'a Raster,
    /// Class of each summed node, then of each uniform block.
    class: Vec<Class>,
}

impl<'a> Region<'a> {
    /// Finds the connected regions of a raster.
    pub fn new(raster: &'a Raster) -> Region<'a> {
        let mut forest = Forest::new(raster);
        forest.join_all();
        let class = forest.classes();
        Region { raster, class }
    }

    /// Class of a node.
    pub fn class(&self, node: [usize; 3]) -> Class {
        self.class[identity(self.raster, node)]
    }

    /// Level of the lowest exterior gas in a column, m above the floor, interpolated to φ = 1/2;
    /// 0 where the gas touches the floor, `None` if the column has none.
    pub fn column_low(&self, i: usize, j: usize) -> Option<f64> {
        let raster = self.raster;
        let mut k = 0;
        while k < raster.count[2] {
            let class = self.class([i, j, k]);
            if class == Class::Exterior {
                return Some(self.interface(i, j, k, false));
            }
            k = self.skip_up(i, j, k);
        }
        None
    }

    /// Level of the highest liquid of the main body in a column, m, interpolated; `None` if none.
    pub fn column_high(&self, i: usize, j: usize) -> Option<f64> {
        let raster = self.raster;
        let mut k = raster.count[2];
        while k > 0 {
            let (block, _) = raster.locate([i, j, k - 1]);
            if self.class([i, j, k - 1]) == Class::Main {
                return Some(self.interface(i, j, k - 1, true));
            }
            k = if raster.is_summed(block) {
                k - 1
            } else {
                (k - 1) / raster.edge[2] * raster.edge[2]
            };
        }
        None
    }

    /// Part of the mass that is detached from the main body: farther than a spacing from its
    /// inside. Particles at its surface belong to it, although φ < 1/2 there.
    pub fn detached(&self, frame: &Frame) -> f64 {
        let (mut all, mut off) = (0.0, 0.0);
        for i in 0..frame.id.len() {
            let mass = frame.mass.get(i).map_or(1.0, |mass| f64::from(*mass));
            all += mass;
            if !self.is_beside_main([0, 1, 2].map(|a| frame.position[a][i])) {
                off += mass;
            }
        }
        if all > 0.0 { off / all } else { 0.0 }
    }

    /// Whether a node within a spacing of a point, m, is in the main body.
    fn is_beside_main(&self, point: [f32; 3]) -> bool {
        let raster = self.raster;
        let near = |a: usize| {
            let (size, reach) = (raster.count[a] as i64, raster.particle_spacing);
            let place = |x: f64| (x / raster.spacing[a]).floor() as i64;
            let x = f64::from(point[a]);
            let (low, high) = (place(x - reach), place(x + reach));
            let inside = move |k: i64| match raster.periodic[a] {
                true => k.rem_euclid(size),
                false => k.clamp(0, size - 1),
            };
            (low..=high.min(low.saturating_add(size))).map(move |k| inside(k) as usize)
        };
        let at = [0, 1, 2].map(|a| {
            let place = (f64::from(point[a]) / raster.spacing[a]).max(0.0) as usize;
            place.min(raster.count[a] - 1)
        });
        let is_main = |node: [usize; 3]| self.class(node) == Class::Main;
        is_main(at) || near(2).any(|k| near(1).any(|j| near(0).any(|i| is_main([i, j, k]))))
    }

    fn skip_up(&self, i: usize, j: usize, k: usize) -> usize {
        let (block, _) = self.raster.locate([i, j, k]);
        if self.raster.is_summed(block) {
            k + 1
        } else {
            (k / self.raster.edge[2] + 1) * self.raster.edge[2]
        }
    }

    /// Crossing of φ = 1/2 between node k and the one below (or above).
    fn interface(&self, i: usize, j: usize, k: usize, above: bool) -> f64 {
        let raster = self.raster;
        let z = raster.coordinate(2, k);
        if above && k + 1 == raster.count[2] {
            return z + 0.5 * raster.spacing[2];
        }
        if !above && k == 0 {
            return 0.0;
        }
        let here = raster.value([i, j, k]);
        let next = raster.value([i, j, if above { k + 1 } else { k - 1 }]);
        let part = f64::from(((LEVEL - here) / (next - here)).clamp(0.0, 1.0));
        let step = part * raster.spacing[2];
        if above { z + step } else { z - step }
    }
}

/// Place of a node among the summed nodes and uniform blocks.
fn identity(raster: &Raster, node: [usize; 3]) -> usize {
    let (block, local) = raster.locate(node);
    let code = raster.code[block] as usize;
    let volume = raster.block_nodes();
    if code < raster.summed {
        code * volume + local
    } else {
        raster.summed * volume + (code - raster.summed)
    }
}

/// Disjoint sets of nodes and uniform blocks.
struct Forest<'a> {
    raster: &'a Raster,
    parent: Vec<u32>,
}

impl<'a> Forest<'a> {
    fn new(raster: &'a Raster) -> Forest<'a> {
        let count = raster.summed * raster.block_nodes() + raster.uniform.len();
        Forest {
            raster,
            parent: (0..count as u32).collect(),
        }
    }

    fn root(&mut self, mut item: u32) -> u32 {
        while self.parent[item as usize] != item {
            let up = self.parent[self.parent[item as usize] as usize];
            self.parent[item as usize] = up;
            item = up;
        }
        item
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a as u32), self.root(b as u32));
        // The smaller index is kept, so that the result does not depend on the order of joins.
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn join_all(&mut self) {
        let raster = self.raster;
        for block in 0..raster.code.len() {
            if raster.is_summed(block) {
                raster.for_nodes(block, |node| self.join_up(node));
            } else {
                let last = self.last_layers(block);
                for (axis, node) in last {
                    self.join_along(node, axis);
                }
            }
        }
        if raster.axis.is_some() {
            self.join_halves();
        }
    }

    /// Joins both halves of what goes round the axis of a section.
    fn join_halves(&mut self) {
        let raster = self.raster;
        for block in 0..raster.code.len() {
            let low = raster.block_at(block)[2] * raster.edge[2];
            raster.for_nodes(block, |node| {
                // All rows of a uniform block have the same neighbours across the axis or summed
                // ones, which come on their own.
                if raster.is_summed(block) || node[2] == low {
                    let across = [raster.count[0] - 1 - node[0], node[1], node[2]];
                    self.join_alike(node, across);
                }
            });
        }
    }

    /// Joins two nodes if both are liquid or both gas.
    fn join_alike(&mut self, node: [usize; 3], other: [usize; 3]) {
        let raster = self.raster;
        if (raster.value(node) >= LEVEL) == (raster.value(other) >= LEVEL) {
            self.join(identity(raster, node), identity(raster, other));
        }
    }

    fn join_up(&mut self, node: [usize; 3]) {
        for axis in 0..3 {
            self.join_along(node, axis);
        }
    }

    /// Joins a node with the next one along an axis if both are liquid or both gas.
    fn join_along(&mut self, node: [usize; 3], axis: usize) {
        let raster = self.raster;
        let count = raster.count[axis];
        if count == 1 || (node[axis] + 1 == count && !raster.periodic[axis]) {
            return;
        }
        let mut other = node;
        other[axis] = (node[axis] + 1) % count;
        self.join_alike(node, other);
    }

    /// Nodes of a uniform block that face the next block, by axis: one of each face if that block
    /// is also uniform.
    fn last_layers(&self, block: usize) -> Vec<(usize, [usize; 3])> {
        let raster = self.raster;
        let b = raster.block_at(block);
        let low = [0, 1, 2].map(|a| b[a] * raster.edge[a]);
        let high = [0, 1, 2].map(|a| (low[a] + raster.edge[a]).min(raster.count[a]));
        let mut nodes = Vec::new();
        for axis in 0..3 {
            let mut next = b;
            next[axis] = (b[axis] + 1) % raster.blocks[axis];
            let whole = !raster.is_summed(raster.block_index(next));
            let mut end = high;
            if whole {
                end = [0, 1, 2].map(|a| low[a] + 1);
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for p in low[u]..end[u] {
                for q in low[v]..end[v] {
                    let mut node = [0; 3];
                    node[axis] = high[axis] - 1;
                    node[u] = p;
                    node[v] = q;
                    nodes.push((axis, node));
                }
            }
        }
        nodes
    }

    fn classes(&mut self) -> Vec<Class> {
        let raster = self.raster;
        let roots: Vec<u32> = (0..self.parent.len() as u32)
            .map(|i| self.root(i))
            .collect();
        let mut size = vec![0.0; roots.len()];
        for block in 0..raster.code.len() {
            let mut first = true;
            raster.for_nodes(block, |node| {
                if raster.is_summed(block) {
                    if raster.value(node) >= LEVEL {
                        size[roots[identity(raster, node)] as usize] += raster.weight(node[0]);
                    }
                } else if first {
                    let item = identity(raster, node);
                    let liquid = raster.uniform[item - raster.summed * raster.block_nodes()];
                    if liquid {
                        let row = (0..raster.edge[0]).map(|i| raster.weight(node[0] + i));
                        let rows = raster.edge[1] * raster.edge[2];
                        size[roots[item] as usize] += row.sum::<f64>() * rows as f64;
                    }
                    first = false;
                }
            });
        }
        let mut main = 0;
        for (root, n) in size.iter().enumerate() {
            if *n > size[main] {
                main = root;
            }
        }
        let mut exterior = vec![false; roots.len()];
        let top = raster.count[2] - 1;
        for j in 0..raster.count[1] {
            for i in 0..raster.count[0] {
                if raster.value([i, j, top]) < LEVEL {
                    exterior[roots[identity(raster, [i, j, top])] as usize] = true;
                }
            }
        }
        let any = size[main] > 0.0;
        roots
            .iter()
            .map(|&root| match root as usize {
                r if exterior[r] => Class::Exterior,
                r if any && r == main => Class::Main,
                _ => Class::Other,
            })
            .collect()
    }
}
