//! The way of a ray from block to block of a field.
//!
//! The next block is guessed from the side that the ray leaves by, so that it need not be waited
//! for; the guess is tested, and what it finds is always the block in which the ray is.

use rayon::prelude::*;

use super::trace::V;
use crate::draw::surface::{BLOCK, Field, LEVEL};

/// Numbers of the three axes, and of a fourth along which no ray moves: four make better code.
type Four = [f32; 4];

fn four(v: &V, fourth: f32) -> Four {
    [v.x, v.y, v.z, fourth]
}

/// The blocks of a field.
pub(super) struct Blocks {
    low: Four,
    /// Edges of a block, m, and one over them.
    size: Four,
    inverse: Four,
    count: Four,
    /// From the number of a block to that of the next along each axis; so small that it is exact.
    stride: Four,
    /// Blocks along y and z.
    rows: usize,
    row: usize,
    /// How far beyond a point the block at it is looked for, m.
    ahead: f32,
    /// Whether phi is nowhere above [`LEVEL`] in a block, and whether it is everywhere.
    plain: Vec<[bool; 2]>,
    /// The same of its cells, a bit each, where it is beyond doubt.
    sure: Vec<[u64; 2]>,
}

/// A ray.
pub(super) struct Ray {
    from: Four,
    along: Four,
    inverse: Four,
    /// From a block to the next one along each axis, and to the side between them.
    next: Four,
    side: Four,
}

/// The block in which a ray should be next.
#[derive(Clone, Copy)]
pub(super) struct Walk {
    /// Whole numbers; of none that there is at first.
    place: Four,
    /// Where the ray leaves the block by each axis, and the one behind that side.
    exit: Four,
    later: Four,
}

impl Ray {
    /// `inverse`: one over the direction.
    pub(super) fn new(from: &V, along: &V, inverse: &V) -> Ray {
        let is_up = |a: usize| along[a] > 0.0;
        let next = [0, 1, 2].map(|a| if is_up(a) { 1.0 } else { -1.0 });
        let side = [0, 1, 2].map(|a| if is_up(a) { 1.0 } else { 0.0 });
        Ray {
            from: four(from, 0.0),
            along: four(along, 0.0),
            inverse: four(inverse, f32::MAX),
            next: four(&next.into(), 0.0),
            side: four(&side.into(), 1.0),
        }
    }
}

impl Walk {
    pub(super) fn new() -> Walk {
        Walk {
            place: [-1.0; 4],
            exit: [0.0; 4],
            later: [0.0; 4],
        }
    }
}

impl Blocks {
    /// `step`: length of the steps of rays, m.
    pub(super) fn new(field: &Field, step: f32) -> Blocks {
        let size = field.step.map(|s| BLOCK as f32 * s);
        let blocks = field.blocks();
        let [_, rows, row] = blocks;
        let count = blocks.map(|count| count as f32);
        let all = (0..blocks.iter().product()).into_par_iter();
        let (plain, sure) = all.map(|block| plain_and_sure(field, block)).unzip();
        Blocks {
            low: four(&field.low, -0.5),
            size: four(&size, 1.0),
            inverse: four(&size.map(|s| 1.0 / s), 1.0),
            count: four(&count.into(), 1.0),
            stride: [count[1] * count[2], count[2], 1.0, 0.0],
            rows,
            row,
            ahead: 1e-3 * step,
            plain,
            sure,
        }
    }

    /// Whether a block is inside, or outside, as a whole.
    #[inline(always)]
    pub(super) fn is_plain(&self, block: usize, is_inside: bool) -> bool {
        self.plain[block][usize::from(is_inside)]
    }

    /// Whether a cell is, so that phi between its nodes need not be looked at.
    #[inline(always)]
    pub(super) fn is_sure(&self, [x, y, z]: [usize; 3], is_inside: bool) -> bool {
        let block = (x / BLOCK * self.rows + y / BLOCK) * self.row + z / BLOCK;
        let bit = (x % BLOCK * BLOCK + y % BLOCK) * BLOCK + z % BLOCK;
        self.sure[block][usize::from(is_inside)] >> bit & 1 == 1
    }

    /// Where a ray leaves the block in which it is at `t`, the number of that block, and the next.
    #[inline(always)]
    pub(super) fn at(&self, ray: &Ray, mut walk: Walk, t: f32) -> (f32, usize, Walk) {
        let ahead = t + self.ahead;
        let mut is_off = [0u32; 4];
        for a in 0..4 {
            let place = (ray.from[a] + ahead * ray.along[a] - self.low[a]) * self.inverse[a];
            let part = place - walk.place[a];
            // Nearer to a side the quotient may differ from this product.
            let margin = 1e-6 * place;
            let is_block = (walk.place[a] >= 0.0) & (walk.place[a] < self.count[a]);
            let is_there = (part > margin) & (part < 1.0 - margin) & (walk.exit[a] > t);
            is_off[a] = if is_block & is_there { 0 } else { 1 };
        }
        if is_off != [0; 4] {
            walk = self.find(ray, t);
        }
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let [x, y, z, w] = walk.exit;
        let end = least(least(x, y), least(z, w));
        let mut number = [0.0; 4];
        for a in 0..4 {
            number[a] = walk.place[a] * self.stride[a];
            let crosses = walk.exit[a] == end;
            walk.place[a] += if crosses { ray.next[a] } else { 0.0 };
            walk.exit[a] = if crosses { walk.later[a] } else { walk.exit[a] };
            walk.later[a] = self.exit(ray, a, walk.place[a] + ray.next[a]);
        }
        let number = (number[0] + number[1]) + (number[2] + number[3]);
        (end.max(ahead), number as i32 as usize, walk)
    }

    /// Finds the block of a ray anew.
    #[cold]
    #[inline(never)]
    fn find(&self, ray: &Ray, t: f32) -> Walk {
        let mut walk = Walk::new();
        for a in 0..4 {
            let p = ray.from[a] + (t + self.ahead) * ray.along[a];
            let place = ((p - self.low[a]) / self.size[a]).max(0.0) as i32 as f32;
            walk.place[a] = place.min(self.count[a] - 1.0);
            let exit = self.exit(ray, a, walk.place[a]);
            walk.exit[a] = if exit > t { exit } else { f32::MAX };
            walk.later[a] = self.exit(ray, a, walk.place[a] + ray.next[a]);
        }
        walk
    }

    /// Where a ray leaves blocks at a place along an axis.
    #[inline(always)]
    fn exit(&self, ray: &Ray, a: usize, place: f32) -> f32 {
        let side = place + ray.side[a];
        (self.low[a] + side * self.size[a] - ray.from[a]) * ray.inverse[a]
    }
}

/// Whether a block is outside, and inside, as a whole; else which of its cells are: they are so far
/// from the level that rounding does not matter.
fn plain_and_sure(field: &Field, block: usize) -> ([bool; 2], [u64; 2]) {
    let [low, high] = field.bounds(block);
    let plain = [high <= LEVEL, low > LEVEL];
    if plain != [false; 2] {
        return (plain, [0; 2]);
    }
    let margin = 1e-5 * high.max(-low).max(1.0);
    let [_, rows, row] = field.blocks();
    let place = [block / (rows * row), block / row % rows, block % row].map(|b| b * BLOCK);
    let count = [0, 1, 2].map(|a| BLOCK.min(field.count[a] - 1 - place[a]));
    let mut sure = [0; 2];
    for (x, y, z) in cells(count) {
        let first = field.index([place[0] + x, place[1] + y, place[2] + z]);
        let [line, layer] = [field.count[2], field.count[1] * field.count[2]];
        let (mut low, mut high) = (f32::MAX, f32::MIN);
        for start in [first, first + line, first + layer, first + layer + line] {
            for value in &field.values[start..start + 2] {
                (low, high) = (low.min(*value), high.max(*value));
            }
        }
        let bit = 1 << ((x * BLOCK + y) * BLOCK + z);
        if high < LEVEL - margin {
            sure[0] |= bit;
        } else if low > LEVEL + margin {
            sure[1] |= bit;
        }
    }
    (plain, sure)
}

/// Places of so many cells.
fn cells([x, y, z]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..x).flat_map(move |i| (0..y).flat_map(move |j| (0..z).map(move |k| (i, j, k))))
}
