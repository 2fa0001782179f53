//! Joins nodes and uniform blocks of a raster that hang together.

use super::raster::{LEVEL, Raster};
use super::region::Class;

/// Place of a node among the summed nodes and uniform blocks.
pub(super) fn identity(raster: &Raster, node: [usize; 3]) -> usize {
    let (block, local) = raster.locate(node);
    let code = raster.code[block] as usize;
    let volume = raster.block_nodes();
    if code < raster.summed {
        code * volume + local
    } else {
        raster.summed * volume + (code - raster.summed)
    }
}

/// Nodes of a block that follow each other along x.
struct Row<'a> {
    /// φ; empty in a uniform block.
    values: &'a [f32],
    is_liquid: bool,
    /// [`identity`] of the first.
    first: usize,
}

impl<'a> Row<'a> {
    /// From a node on, up to the end of its block.
    fn new(raster: &'a Raster, node: [usize; 3]) -> Row<'a> {
        let (block, local) = raster.locate(node);
        let left = raster.edge[0] - node[0] % raster.edge[0];
        let is_summed = raster.is_summed(block);
        Row {
            values: match is_summed {
                true => &raster.block_values(block)[local..local + left],
                false => &[],
            },
            is_liquid: !is_summed && raster.uniform[raster.code[block] as usize - raster.summed],
            first: identity(raster, node),
        }
    }

    fn is_liquid(&self, i: usize) -> bool {
        self.values
            .get(i)
            .map_or(self.is_liquid, |value| *value >= LEVEL)
    }

    /// [`identity`] of a node.
    fn item(&self, i: usize) -> usize {
        match self.values {
            [] => self.first,
            _ => self.first + i,
        }
    }
}

/// Disjoint sets of nodes and uniform blocks.
pub(super) struct Forest<'a> {
    raster: &'a Raster,
    parent: Vec<u32>,
}

impl<'a> Forest<'a> {
    pub(super) fn new(raster: &'a Raster) -> Forest<'a> {
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

    /// Joins all neighbours that are alike.
    pub(super) fn join_all(&mut self) {
        let raster = self.raster;
        self.join_runs();
        for block in 0..raster.code.len() {
            if raster.is_summed(block) {
                self.join_block(block);
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

    /// Joins nodes of summed blocks that follow each other along x, before all others.
    fn join_runs(&mut self) {
        let raster = self.raster;
        for block in (0..raster.code.len()).filter(|block| raster.is_summed(*block)) {
            raster.for_rows(block, |node, count| {
                let row = Row::new(raster, node);
                for i in 1..count {
                    if row.is_liquid(i) == row.is_liquid(i - 1) {
                        self.parent[row.item(i)] = self.parent[row.item(i - 1)];
                    }
                }
            });
        }
    }

    /// Joins the nodes of a summed block with those behind them.
    fn join_block(&mut self, block: usize) {
        let raster = self.raster;
        raster.for_rows(block, |node, count| {
            let row = Row::new(raster, node);
            for axis in 1..3 {
                if let Some(next) = self.next(node, axis) {
                    self.join_rows(&row, &Row::new(raster, next), count);
                }
            }
            self.join_along([node[0] + count - 1, node[1], node[2]], 0);
        });
    }

    /// Joins nodes side by side in two rows if both are liquid or both gas. Runs are joined
    /// already: one pair of each two runs is enough.
    fn join_rows(&mut self, one: &Row, other: &Row, count: usize) {
        let mut before = None;
        for i in 0..count {
            let is_liquid = one.is_liquid(i);
            let is_alike = is_liquid == other.is_liquid(i);
            if is_alike && before != Some(is_liquid) {
                self.join(one.item(i), other.item(i));
            }
            before = is_alike.then_some(is_liquid);
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

    /// Joins a node with the next one along an axis if both are liquid or both gas.
    fn join_along(&mut self, node: [usize; 3], axis: usize) {
        if let Some(next) = self.next(node, axis) {
            self.join_alike(node, next);
        }
    }

    /// The next node along an axis; none behind the last one, unless the box is periodic.
    fn next(&self, node: [usize; 3], axis: usize) -> Option<[usize; 3]> {
        let raster = self.raster;
        let count = raster.count[axis];
        if count == 1 || (node[axis] + 1 == count && !raster.periodic[axis]) {
            return None;
        }
        let mut next = node;
        next[axis] = (node[axis] + 1) % count;
        Some(next)
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

    /// The class of each set, by [`identity`].
    pub(super) fn classes(&mut self) -> Vec<Class> {
        let raster = self.raster;
        let roots: Vec<u32> = (0..self.parent.len() as u32)
            .map(|i| self.root(i))
            .collect();
        let mut size = vec![0.0; roots.len()];
        for block in 0..raster.code.len() {
            if raster.is_summed(block) {
                raster.for_rows(block, |node, count| {
                    let row = Row::new(raster, node);
                    for i in (0..count).filter(|i| row.is_liquid(*i)) {
                        size[roots[row.item(i)] as usize] += raster.weight(node[0] + i);
                    }
                });
                continue;
            }
            let low = raster.block_at(block);
            let low = [0, 1, 2].map(|a| low[a] * raster.edge[a]);
            let row = Row::new(raster, low);
            if row.is_liquid(0) {
                let sum: f64 = (0..raster.edge[0]).map(|i| raster.weight(low[0] + i)).sum();
                let rows = raster.edge[1] * raster.edge[2];
                size[roots[row.item(0)] as usize] += sum * rows as f64;
            }
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
