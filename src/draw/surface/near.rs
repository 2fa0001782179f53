//! The points within reach of a blob.

use nalgebra::Vector3;

use super::points::Points;
use crate::space::lane::{Job, Lanes, Real, WIDTH, run_mixed};

/// Finds the points within reach of one after the other; it keeps its memory.
#[derive(Default)]
pub(super) struct Near {
    /// Numbers of the points that may be within reach, and what is left of earlier ones.
    list: Vec<u32>,
    /// How many they are.
    count: usize,
    /// `(other - own) / reach` and V w of (1) in [`blob`](super::blob), of those within reach.
    pub found: Vec<(Vector3<f32>, f32)>,
}

/// Lists the points about one.
struct Listing<'a> {
    near: &'a mut Near,
    points: &'a Points,
    own: Vector3<f32>,
    /// Square of the distance.
    most: f32,
}

impl Near {
    /// Finds the points within `reach` of `own`; `volume`: of a point, by its source.
    pub fn find(
        &mut self,
        points: &Points,
        own: &Vector3<f32>,
        reach: f32,
        volume: impl Fn(u32) -> f32,
    ) {
        run_mixed(Listing {
            near: self,
            points,
            own: *own,
            // Most points are far: that is told without a division, with room for its rounding.
            most: 1.0001 * reach * reach,
        });
        self.found.clear();
        for &n in &self.list[..self.count] {
            let d = (points.at[n as usize] - own) / reach;
            let r = d.norm();
            if r < 1.0 {
                let w = volume(points.source[n as usize]) * (1.0 - r * r * r);
                self.found.push((d, w));
            }
        }
    }
}

impl Near {
    /// Lists those of eight points whose bit is set: without a branch, for there is no telling.
    #[inline(always)]
    fn add(&mut self, first: usize, mask: u32) {
        let Some(out) = self.list[self.count..].first_chunk_mut::<WIDTH>() else {
            return;
        };
        let mut place = 0;
        for k in 0..WIDTH {
            out[place % WIDTH] = (first + k) as u32;
            place += (mask >> k & 1) as usize;
        }
        self.count += place;
    }
}

impl Job for Listing<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let near = self.near;
        near.count = 0;
        let own = [self.own.x, self.own.y, self.own.z].map(|c| lanes.splat(c));
        let most = lanes.splat(self.most);
        let [x, y, z] = self.points.around(&self.own);
        for i in x {
            for j in y.clone() {
                let range = self.points.within(i, j, &z);
                let needed = near.count + range.len() + WIDTH;
                if near.list.len() < needed {
                    near.list.resize(needed, 0);
                }
                let mut first = range.start;
                while first < range.end {
                    let d = away(own, &self.points.planes, first);
                    let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                    let mut mask = square.less_mask(most);
                    if range.end - first < WIDTH {
                        mask &= (1 << (range.end - first)) - 1;
                    }
                    near.add(first, mask);
                    first += WIDTH;
                }
            }
        }
    }
}

/// Differences of eight points to one.
#[inline(always)]
fn away<F: Real>(own: [F; 3], planes: &[Vec<f32>; 3], first: usize) -> [F; 3] {
    let mut d = own;
    for a in 0..3 {
        if let Some(eight) = planes[a][first..].first_chunk::<WIDTH>() {
            d[a] = own[a].of_array(*eight) - own[a];
        }
    }
    d
}
