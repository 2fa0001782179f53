//! Poisson-disk sampling of a region to an exact number of particles.
//!
//! Bridson, "Fast Poisson disk sampling in arbitrary dimensions" (SIGGRAPH sketches 2007): random
//! points at least r apart, grown from one point until no gap has room for another. A saturated
//! sample has about 0.70 r^-d points per volume, so r = 0.89 (3-D) or 0.83 (2-D) mean spacings
//! gives about the required number; filling the widest gaps or thinning the closest pairs gives it
//! exactly. Lengths are in units of the particle spacing. One thread only: the random numbers form
//! a sequence.

use super::shape::Region;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use rayon::prelude::*;

/// Candidates that a point tries before it becomes inactive.
const TRIES: usize = 24;
/// Inset of the sampled region from its surface: particles are centres of cells of unit width.
const INSET: f64 = 0.35;
/// No point.
const NONE: u32 = u32::MAX;

/// `count` points in `region`, equal for equal `seed` on every machine.
pub fn sample(region: &Region, count: usize, seed: u64) -> [Vec<f64>; 3] {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let mut random = Random(ChaCha8Rng::from_seed(bytes));
    let dimension = region.axes().len();
    let mean = (inner_volume(region) / count as f64).powf(1.0 / dimension as f64);
    let radius = if dimension == 3 { 0.89 } else { 0.83 } * mean;
    let mut disks = Disks::new(region, radius);
    disks.grow(&mut random);
    while disks.point.len() < count {
        disks.fill_gaps(count);
    }
    while disks.point.len() > count {
        disks.thin(count);
    }
    [0, 1, 2].map(|k| disks.point.iter().map(|x| x[k]).collect())
}

/// Volume of the region that is sampled.
fn inner_volume(region: &Region) -> f64 {
    use super::shape::{Face, Form};
    if region.cut.iter().any(Option::is_some) {
        return cut_volume(region);
    }
    let inner = match &region.form {
        Form::Ellipsoid { semi_axes } => Form::Ellipsoid {
            semi_axes: semi_axes.map(|a| (a - INSET).max(1e-3 * a)),
        },
        Form::Block { low, high, face } => {
            let margin = |k: usize, side: usize| match face[k][side] {
                Face::Periodic => 0.0,
                Face::Free | Face::Wall | Face::Mirror => INSET.min(0.49 * (high[k] - low[k])),
            };
            Form::Block {
                low: [0, 1, 2].map(|k| low[k] + margin(k, 0)),
                high: [0, 1, 2].map(|k| high[k] - margin(k, 1)),
                face: *face,
            }
        }
    };
    Region {
        dimension: region.dimension,
        form: inner,
        cut: region.cut,
    }
    .volume()
}

/// The sampled volume of a cut ellipsoid, counted by points: planes and surface are inset.
fn cut_volume(region: &Region) -> f64 {
    const POINTS: usize = 48;
    let (low, high) = region.bounds();
    let axes = region.axes();
    let count = POINTS.pow(axes.len() as u32);
    let inside = |index: &usize| {
        let (mut x, mut rest) = ([0.0; 3], *index);
        for &k in axes {
            let part = ((rest % POINTS) as f64 + 0.5) / POINTS as f64;
            x[k] = low[k] + part * (high[k] - low[k]);
            rest /= POINTS;
        }
        region.contains(x, INSET)
    };
    let found = (0..count).filter(inside).count() as f64;
    let whole: f64 = axes.iter().map(|&k| high[k] - low[k]).product();
    whole * found.max(1.0) / count as f64
}

/// The cell of a box that a cell is or repeats; most are of the box, which needs no division.
fn turned(cell: i64, count: i64) -> usize {
    match (0..count).contains(&cell) {
        true => cell as usize,
        false => cell.rem_euclid(count) as usize,
    }
}

/// A few cell coordinates along an axis with squared distances to them.
#[derive(Default)]
struct Slabs {
    slab: [(usize, f64); 12],
    count: usize,
}

impl Slabs {
    fn push(&mut self, cell: usize, square: f64) {
        self.slab[self.count] = (cell, square);
        self.count += 1;
    }

    fn iter(&self) -> impl Iterator<Item = &(usize, f64)> {
        self.slab[..self.count].iter()
    }
}

struct Random(ChaCha8Rng);

impl Random {
    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    /// Uniform in the shell between `radius` and twice it, along the axes of the region.
    fn shell(&mut self, axes: &[usize], radius: f64) -> [f64; 3] {
        loop {
            let mut x = [0.0; 3];
            for &k in axes {
                x[k] = 2.0 * (2.0 * self.unit() - 1.0);
            }
            let square: f64 = x.iter().map(|x| x * x).sum();
            if (1.0..4.0).contains(&square) {
                return x.map(|x| x * radius);
            }
        }
    }
}

/// Points in a grid of cells, each cell a chain of points.
struct Disks<'a> {
    region: &'a Region,
    radius: f64,
    low: [f64; 3],
    edge: [f64; 3],
    count: [usize; 3],
    period: [Option<f64>; 3],
    /// First point of a cell.
    head: Vec<u32>,
    /// Next point of the same cell.
    next: Vec<u32>,
    point: Vec<[f64; 3]>,
}

impl<'a> Disks<'a> {
    fn new(region: &'a Region, radius: f64) -> Self {
        let (low, high) = region.bounds();
        let largest = radius / (region.axes().len() as f64).sqrt();
        let (mut edge, mut count) = ([f64::INFINITY; 3], [1; 3]);
        for &k in region.axes() {
            let extent = high[k] - low[k];
            count[k] = (extent / largest).ceil().max(1.0) as usize;
            edge[k] = extent / count[k] as f64;
        }
        Disks {
            region,
            radius,
            low,
            edge,
            count,
            period: region.period(),
            head: vec![NONE; count.iter().product()],
            next: Vec::new(),
            point: Vec::new(),
        }
    }

    /// Bridson's loop.
    fn grow(&mut self, random: &mut Random) {
        let (low, high) = self.region.bounds();
        let first = loop {
            let x = [0, 1, 2].map(|k| low[k] + random.unit() * (high[k] - low[k]));
            if self.region.contains(x, INSET) {
                break x;
            }
        };
        self.insert(first);
        let mut active = vec![0];
        while !active.is_empty() {
            let chosen = random.below(active.len());
            let parent: [f64; 3] = self.point[active[chosen]];
            let found = (0..TRIES).find_map(|_| {
                let step = random.shell(self.region.axes(), self.radius);
                let x = self.wrap([0, 1, 2].map(|k| parent[k] + step[k]));
                let free = self.region.contains(x, INSET)
                    && self.nearest(x, NONE, self.radius, self.radius) >= self.radius;
                free.then_some(x)
            });
            match found {
                Some(x) => {
                    active.push(self.point.len());
                    self.insert(x);
                }
                None => {
                    active.swap_remove(chosen);
                }
            }
        }
    }

    /// Adds points in the widest gaps, widest first, until there are `count` or every known gap has
    /// changed.
    fn fill_gaps(&mut self, count: usize) {
        let (low, high) = self.region.bounds();
        let steps = [0, 1, 2].map(|k| ((high[k] - low[k]) * 2.0).ceil().max(1.0) as usize);
        let within = 2.0 * self.radius;
        let gap = |index: usize| {
            let i = [
                index % steps[0],
                index / steps[0] % steps[1],
                index / steps[0] / steps[1],
            ];
            let at = |k: usize| (i[k] as f64 + 0.5) / steps[k] as f64;
            let x = [0, 1, 2].map(|k| low[k] + at(k) * (high[k] - low[k]));
            let inside = self.region.contains(x, INSET);
            inside.then(|| (self.nearest(x, NONE, within, 0.0), x))
        };
        let mut gaps: Vec<(f64, [f64; 3])> = (0..steps.iter().product::<usize>())
            .into_par_iter()
            .filter_map(gap)
            .collect();
        gaps.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (width, x) in gaps {
            if self.point.len() < count && self.nearest(x, NONE, within, width) >= width {
                self.insert(x);
            }
        }
    }

    /// Removes one point of each closest pair, closest first, until there are `count` or every
    /// known pair has lost one.
    fn thin(&mut self, count: usize) {
        let within = 1.5 * self.radius;
        let mut pairs: Vec<(f64, u32)> = (0..self.point.len() as u32)
            .into_par_iter()
            .map(|i| (self.nearest(self.point[i as usize], i, within, 0.0), i))
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut surplus = self.point.len() - count;
        let mut kept = vec![true; self.point.len()];
        for (distance, i) in pairs {
            if surplus > 0 && self.nearest(self.point[i as usize], i, within, 0.0) <= distance {
                kept[i as usize] = false;
                self.unlink(i);
                surplus -= 1;
            }
        }
        let points = std::mem::take(&mut self.point);
        self.head.fill(NONE);
        self.next.clear();
        for (x, _) in points.into_iter().zip(kept).filter(|(_, kept)| *kept) {
            self.insert(x);
        }
    }

    /// Distance from `x` to the nearest point except `except`, at most `within`. Any distance below
    /// `enough` may be returned.
    fn nearest(&self, x: [f64; 3], except: u32, within: f64, enough: f64) -> f64 {
        let [xs, ys, zs] = [0, 1, 2].map(|k| self.slabs(k, x[k], within));
        let enough = enough * enough;
        let mut least = within * within;
        for &(z, dz) in zs.iter() {
            for &(y, dy) in ys.iter() {
                for &(x_cell, dx) in xs.iter() {
                    if dx + dy + dz >= least {
                        continue;
                    }
                    let mut i = self.head[(z * self.count[1] + y) * self.count[0] + x_cell];
                    while i != NONE {
                        if i != except {
                            least = least.min(self.square(x, self.point[i as usize]));
                        }
                        i = self.next[i as usize];
                    }
                    if least < enough {
                        return least.sqrt();
                    }
                }
            }
        }
        least.sqrt()
    }

    /// Slabs of cells along axis `k` within reach of `x`, each once, with the squared distance to
    /// them; the slab of `x` first.
    fn slabs(&self, k: usize, x: f64, within: f64) -> Slabs {
        let mut slabs = Slabs::default();
        let count = self.count[k] as i64;
        if count == 1 {
            slabs.push(0, 0.0);
            return slabs;
        }
        let u = (x - self.low[k]) / self.edge[k];
        let own = u.floor() as i64;
        slabs.push(turned(own, count), 0.0);
        let periodic = self.period[k].is_some();
        for step in 1..count {
            let below = (u - (own - step + 1) as f64) * self.edge[k];
            let above = ((own + step) as f64 - u) * self.edge[k];
            for (cell, gap) in [(own - step, below), (own + step, above)] {
                let seen = 2 * step > count || (2 * step == count && cell > own);
                if gap < within && !(periodic && seen) && (periodic || (0..count).contains(&cell)) {
                    // A slab opposite in a periodic box is near on both sides: it counts as
                    // touching.
                    let gap = if periodic && 2 * step >= count - 1 {
                        0.0
                    } else {
                        gap
                    };
                    slabs.push(turned(cell, count), gap * gap);
                }
            }
            if below.min(above) >= within {
                break;
            }
        }
        slabs
    }

    fn square(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let mut sum = 0.0;
        for k in 0..3 {
            let mut d = a[k] - b[k];
            // Within less than half a period nothing is taken away.
            if let Some(period) = self.period[k].filter(|period| d.abs() > 0.49 * period) {
                d -= period * (d / period).round();
            }
            sum += d * d;
        }
        sum
    }

    fn insert(&mut self, x: [f64; 3]) {
        let cell = self.index(self.cell(x));
        self.next.push(self.head[cell]);
        self.head[cell] = self.point.len() as u32;
        self.point.push(x);
    }

    fn unlink(&mut self, i: u32) {
        let cell = self.index(self.cell(self.point[i as usize]));
        if self.head[cell] == i {
            self.head[cell] = self.next[i as usize];
            return;
        }
        let mut j = self.head[cell];
        while self.next[j as usize] != i {
            j = self.next[j as usize];
        }
        self.next[j as usize] = self.next[i as usize];
    }

    fn cell(&self, x: [f64; 3]) -> [i64; 3] {
        [0, 1, 2].map(|k| ((x[k] - self.low[k]) / self.edge[k]).floor() as i64)
    }

    fn index(&self, cell: [i64; 3]) -> usize {
        let c = [0, 1, 2].map(|k| turned(cell[k], self.count[k] as i64));
        (c[2] * self.count[1] + c[1]) * self.count[0] + c[0]
    }

    fn wrap(&self, mut x: [f64; 3]) -> [f64; 3] {
        for k in 0..3 {
            // In the box there is nothing to take away.
            let is_outside = |period: &f64| !(0.0..0.99 * period).contains(&(x[k] - self.low[k]));
            if let Some(period) = self.period[k].filter(is_outside) {
                x[k] -= period * ((x[k] - self.low[k]) / period).floor();
            }
        }
        x
    }
}
