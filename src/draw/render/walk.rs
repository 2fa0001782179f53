//! The way of a ray from block to block of a field.
//!
//! The next block is guessed from the side that the ray leaves by, so that it need not be waited
//! for; the guess is tested, and what it finds is always the block in which the ray is.

use super::trace::V;
use crate::draw::surface::{BLOCK, Field};

/// The blocks of a field.
pub(super) struct Blocks {
    low: V,
    /// Edges of a block, m, and one over them.
    size: V,
    inverse: V,
    count: [i32; 3],
    /// How far beyond a point the block at it is looked for, m.
    ahead: f32,
}

/// A ray, and the block in which it should be next.
pub(super) struct Walk {
    from: V,
    along: V,
    inverse: V,
    place: [i32; 3],
    /// From a block to the next one along each axis, and to the side between them.
    next: [i32; 3],
    side: [i32; 3],
}

impl Walk {
    /// `inverse`: one over the direction.
    pub(super) fn new(from: &V, along: &V, inverse: &V) -> Walk {
        let is_up = [0, 1, 2].map(|a| along[a] > 0.0);
        Walk {
            from: *from,
            along: *along,
            inverse: *inverse,
            place: [-1; 3],
            next: is_up.map(|is_up| if is_up { 1 } else { -1 }),
            side: is_up.map(i32::from),
        }
    }
}

impl Blocks {
    /// `step`: length of the steps of rays, m.
    pub(super) fn new(field: &Field, step: f32) -> Blocks {
        let size = field.step.map(|s| BLOCK as f32 * s);
        Blocks {
            low: field.low,
            size,
            inverse: size.map(|s| 1.0 / s),
            count: field.blocks().map(|count| count as i32),
            ahead: 1e-3 * step,
        }
    }

    /// Where a ray leaves the block in which it is at `t`, and the number of that block.
    #[inline]
    pub(super) fn at(&self, walk: &mut Walk, t: f32) -> (f32, usize) {
        let p = walk.from + (t + self.ahead) * walk.along;
        let mut is_there = true;
        for a in 0..3 {
            let place = (p[a] - self.low[a]) * self.inverse[a];
            let part = place - walk.place[a] as f32;
            // Nearer to a side the quotient may differ from this product.
            let margin = 1e-6 * place;
            let is_block = (walk.place[a] as u32) < self.count[a] as u32;
            is_there &= is_block & (part > margin) & (part < 1.0 - margin);
        }
        if !is_there {
            for a in 0..3 {
                let place = ((p[a] - self.low[a]) / self.size[a]).max(0.0) as i32;
                walk.place[a] = place.min(self.count[a] - 1);
            }
        }
        let [x, y, z] = walk.place.map(|place| place as usize);
        let number = (x * self.count[1] as usize + y) * self.count[2] as usize + z;
        let exit = [0, 1, 2].map(|a| {
            let side = (walk.place[a] + walk.side[a]) as f32;
            let exit = (self.low[a] + side * self.size[a] - walk.from[a]) * walk.inverse[a];
            if exit > t { exit } else { f32::MAX }
        });
        let end = exit[0].min(exit[1]).min(exit[2]);
        for a in 0..3 {
            walk.place[a] += walk.next[a] * i32::from(exit[a] == end);
        }
        (end.max(t + self.ahead), number)
    }
}
