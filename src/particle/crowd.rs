//! Particles that are being packed: sorted along cells, with their neighbours and the wall.
//!
//! Lengths are in units of the particle spacing.

use super::shape::{Face, Form, Region};
use crate::scene::{Domain, Side};
use crate::space::grid::{Grid, TooSmall};
use crate::space::lane::{Record, WIDTH};
use crate::space::mirror::{Mirror, Planes, Points};
use crate::space::parallel::{each_mut, three};
use crate::space::row::{Rows, Search, Source};
use crate::space::sort::Cells;
use crate::space::sweep::{self, Pass, Payload, Records, words_of};
use rayon::prelude::*;

/// Reach of neighbour lists beyond the support, so that a list is valid for several steps.
const SLACK: f64 = 0.3;

/// Liquid and wall particles with neighbour rows of the liquid.
#[derive(Debug)]
pub struct Crowd {
    grid: Grid,
    cells: Cells,
    wall_cells: Cells,
    /// Liquid, sorted along the cells at the last rebuild.
    pub position: [Vec<f64>; 3],
    wall: [Vec<f64>; 3],
    /// Images of liquid and wall behind mirror planes, if the region has any.
    mirror: Option<Mirror>,
    records: Records,
    /// Fixed-point coordinates in the order of the records, as of the last rebuild.
    fixed: [Vec<i32>; 3],
    rows: Rows,
    support: f64,
    /// Bound of the distance that a particle has moved since the last rebuild.
    moved: f64,
}

impl Crowd {
    /// `position` in any order; `wall` from [`wall_near`]; `support` is the radius of the kernel in
    /// use.
    ///
    /// # Errors
    /// If a periodic side is too short for the cells.
    pub fn new(
        region: &Region,
        position: [Vec<f64>; 3],
        wall: [Vec<f64>; 3],
        support: f64,
    ) -> Result<Self, TooSmall> {
        let grid = grid(region, support)?;
        let mut wall_cells = Cells::default();
        wall_cells.sort(&grid, &wall);
        let wall = wall.map(|mut x| {
            wall_cells.permute(&mut x, &mut Vec::new());
            x
        });
        let mirror = Planes::new(region.mirrors(), &grid).map(Mirror::new);
        let mut crowd = Crowd {
            grid,
            cells: Cells::default(),
            wall_cells,
            position,
            wall,
            mirror,
            records: Records::default(),
            fixed: Default::default(),
            rows: Rows::default(),
            support,
            moved: 0.0,
        };
        crowd.rebuild();
        Ok(crowd)
    }

    /// Number of liquid particles.
    pub fn len(&self) -> usize {
        self.position[0].len()
    }

    /// Whether there is no liquid particle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of liquid particle `i`.
    pub fn at(&self, i: usize) -> [f64; 3] {
        [0, 1, 2].map(|k| self.position[k][i])
    }

    /// Sets the payload of every liquid record; the payload of the wall stays zero.
    pub fn load<P: Payload>(&mut self, payload: impl Fn(usize) -> P + Sync) {
        let n = self.len();
        each_mut(&mut self.records.carry::<P>()[..n], |i, record| {
            for (word, value) in record.0[3..].iter_mut().zip(words_of(payload(i))) {
                *word = value.to_bits();
            }
        });
        if let Some(mirror) = &self.mirror {
            mirror.copy(&mut self.records);
        }
    }

    /// Pair sums of all liquid particles over liquid and wall, separations in units of `h`.
    pub fn sum<const N: usize, P: Pass<N>>(&self, h: f64, pass: &P, out: &mut [P::Out]) {
        sweep::rows(&self.records, &self.rows, self.grid.scale(h), pass, out);
    }

    /// Whether record `j` is liquid or an image of it.
    fn is_liquid(&self, j: usize) -> bool {
        let images = |m: &Mirror| m.first..m.first + m.liquid.len();
        let image = |m: &Mirror| images(m).contains(&j);
        j < self.len() || self.mirror.as_ref().is_some_and(image)
    }

    /// Calls `f` with the separation (own minus other) of every liquid neighbour of particle `i`
    /// that is in its row, images too.
    pub fn neighbours(&self, i: usize, mut f: impl FnMut([f64; 3])) {
        let own = self.records[i];
        for j in self.rows.row(i).indices() {
            if j != i && self.is_liquid(j) {
                let other = self.records[j];
                f([0, 1, 2]
                    .map(|k| own.at(k).wrapping_sub(other.at(k)) as f64 * self.grid.unit[k]));
            }
        }
    }

    /// Distance from particle `i` to its nearest liquid neighbour; infinite if none is in reach.
    pub fn nearest(&self, i: usize) -> f64 {
        let mut least = f64::INFINITY;
        self.neighbours(i, |d| {
            least = least.min(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
        });
        least.sqrt()
    }

    /// Moves liquid particle `i` by `step(i)`, whose length is at most `longest`. The order of
    /// particles changes when neighbours are searched again; returns whether that happened.
    pub fn advance(&mut self, longest: f64, step: impl Fn(usize) -> [f64; 3] + Sync) -> bool {
        let n = self.len();
        let (grid, mirror) = (&self.grid, self.mirror.as_ref());
        each_mut(three(&mut self.position, n), |i, position| {
            for (k, dx) in step(i).into_iter().enumerate() {
                let x = &mut *position[k];
                *x = grid.wrap(k, *x + dx);
                if let Some(back) = mirror.and_then(|m| m.planes.back(k, *x)) {
                    *x = back;
                }
            }
        });
        self.moved += longest;
        let stale = 2.0 * self.moved > SLACK;
        if stale {
            self.rebuild();
        } else {
            self.place();
        }
        stale
    }

    /// Brings per-particle data into the order of the last rebuild.
    pub fn follow<T: Copy + Send + Sync>(&self, data: &mut Vec<T>) {
        self.cells.permute(data, &mut Vec::new());
    }

    fn rebuild(&mut self) {
        let mut scratch = Vec::new();
        self.cells.sort(&self.grid, &self.position);
        for x in &mut self.position {
            self.cells.permute(x, &mut scratch);
        }
        let (n, cutoff) = (self.len(), self.support + SLACK);
        if let Some(mirror) = &mut self.mirror {
            let count = n + self.wall[0].len();
            let own = (Points::of(&self.position), n);
            mirror.find(&self.grid, own, &self.wall, count, cutoff + SLACK);
        }
        let images = self.mirror.as_ref().map_or(0, Mirror::len);
        let count = n + self.wall[0].len() + images + WIDTH;
        let records = self.records.carry::<()>();
        records.clear();
        records.resize(count, Record::default());
        for j in 0..self.wall[0].len() {
            let x = [0, 1, 2].map(|k| self.wall[k][j]);
            records[n + j] = Record::new(self.grid.fix3(x), [0.0; 5]);
        }
        self.place();
        for (a, fixed) in self.fixed.iter_mut().enumerate() {
            self.records
                .par_iter()
                .map(|r| r.at(a))
                .collect_into_vec(fixed);
        }
        let own = Source {
            start: &self.cells.start,
            offset: 0,
        };
        let wall = Source {
            start: &self.wall_cells.start,
            offset: n,
        };
        let [liquid, walls] = self.mirror.as_ref().map_or([own, wall], Mirror::sources);
        let kinds = if self.mirror.is_some() { 4 } else { 2 };
        let search = Search {
            grid: &self.grid,
            at: &self.fixed,
            sources: &[own, wall, liquid, walls][..kinds],
            cutoff,
            each: &[],
        };
        self.rows.build(search, 0, &self.position);
        self.moved = 0.0;
    }

    /// Writes positions into the records.
    fn place(&mut self) {
        let (grid, position) = (&self.grid, &self.position);
        each_mut(
            &mut self.records.carrying::<()>()[..position[0].len()],
            |i, records| {
                let at = grid.fix3([0, 1, 2].map(|k| position[k][i]));
                let record = records;
                for (word, at) in record.0.iter_mut().zip(at) {
                    *word = at as u32;
                }
            },
        );
        if let Some(mirror) = &self.mirror {
            mirror.copy(&mut self.records);
        }
    }
}

/// Cells over the region and the wall about it.
fn grid(region: &Region, support: f64) -> Result<Grid, TooSmall> {
    let (low, high) = region.bounds();
    let period = region.period();
    let side = |k: usize| match period[k] {
        Some(_) => [Side::Periodic; 2],
        None => [Side::Open; 2],
    };
    let domain = Domain {
        size: [0, 1, 2].map(|k| high[k] - low[k]),
        boundary: [0, 1, 2].map(side),
        wall_velocity: [[[0.0; 3]; 2]; 3],
        revolved: None,
    };
    let cutoff = support + SLACK;
    let mut grid = Grid::new(
        &domain,
        region.dimension,
        0.5 * cutoff,
        cutoff + 1.0,
        cutoff,
    )?;
    for k in 0..3 {
        grid.low[k] += low[k];
    }
    Ok(grid)
}

/// The wall particles that touch the region: within `reach` of it and not behind a free face,
/// where the completion replaces them.
pub fn wall_near(region: &Region, wall: &[Vec<f64>; 3], reach: f64) -> [Vec<f64>; 3] {
    let Form::Block { low, high, face } = &region.form else {
        return Default::default();
    };
    let near = |i: usize| {
        region.axes().iter().all(|&k| {
            let x = wall[k][i];
            let margin = |side: usize| {
                if face[k][side] == Face::Wall {
                    reach
                } else {
                    0.0
                }
            };
            x > low[k] - margin(0) && x < high[k] + margin(1)
        })
    };
    let chosen: Vec<usize> = (0..wall[0].len()).filter(|&i| near(i)).collect();
    [0, 1, 2].map(|k| chosen.iter().map(|&i| wall[k][i]).collect())
}
