//! Particles that are being packed: sorted along cells, with their neighbours and the wall.
//!
//! Lengths are in units of the particle spacing.

use super::column::{Entry, Role, Visitor};
use super::migrate::Emigrate;
use super::shape::{Face, Form, Region};
use super::wall::Lattice;
use crate::scene::input::PackInput;
use crate::scene::{Domain, Side};
use crate::space::grid::{Grid, TooSmall};
use crate::space::lane::{Record, WIDTH};
use crate::space::mirror::{Mirror, Planes, Points};
use crate::space::parallel::{each_mut, three};
use crate::space::ranks::halo::{Halo, complete};
use crate::space::ranks::span::Span;
use crate::space::ranks::{Communicator, Ranks, collect};
use crate::space::row::{Rows, Search, Source};
use crate::space::sort::Cells;
use crate::space::sweep::{self, Pass, Payload, Records, words_of};
use rayon::prelude::*;
use std::sync::Arc;

/// Reach of neighbour lists beyond the support, so that a list is valid for several steps.
const SLACK: f64 = 0.3;

/// Shift of walls below which there is none, in spacings: lengths come from decimal texts.
const EQUAL: f64 = 1e-9;

/// Liquid and wall particles with neighbour rows of the liquid; of several ranks, the liquid of
/// this one. Records: liquid, wall, ghosts of other ranks, images.
pub struct Crowd {
    grid: Grid,
    cells: Cells,
    wall_cells: Cells,
    /// Liquid, sorted along the cells at the last rebuild.
    pub position: [Vec<f64>; 3],
    wall: [Vec<f64>; 3],
    /// Images of liquid and wall behind mirror planes, if the region has any.
    mirror: Option<Mirror>,
    /// The processes that pack together, and what is near of theirs.
    ranks: Option<Ranks>,
    halo: Halo,
    records: Records,
    /// Fixed-point coordinates in the order of the records, as of the last rebuild.
    fixed: [Vec<i32>; 3],
    rows: Rows,
    support: f64,
    /// Bound of the distance that a particle has moved since the last rebuild.
    moved: f64,
}

impl Crowd {
    /// `position` in any order, on several ranks a part of all on each; `wall` from [`wall_near`];
    /// `support` is the radius of the kernel in use; `with`: the other ranks.
    ///
    /// # Errors
    /// If a periodic side is too short for the cells.
    pub fn new(
        region: &Region,
        position: [Vec<f64>; 3],
        wall: [Vec<f64>; 3],
        support: f64,
        with: Option<&Arc<dyn Communicator>>,
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
            cells: Cells::default(),
            wall_cells,
            ranks: with.map(|with| Ranks::new(with.clone(), &grid, position[0].len())),
            grid,
            position,
            wall,
            mirror,
            halo: Halo::default(),
            records: Records::default(),
            fixed: Default::default(),
            rows: Rows::default(),
            support,
            moved: 0.0,
        };
        crowd.rebuild(&mut Vec::<f32>::new());
        Ok(crowd)
    }

    /// The liquid, for a sum over that of all ranks.
    pub fn span(&self) -> Span {
        match &self.ranks {
            None => self.len().into(),
            Some(ranks) => Span::shared(&ranks.with, &ranks.first, 0),
        }
    }

    /// What all ranks have of their liquid, on the first one; nothing on the others.
    pub fn collect<T: Entry>(&self, own: Vec<T>) -> Option<Vec<T>> {
        match &self.ranks {
            None => Some(own),
            Some(ranks) => collect(&*ranks.with, own, |all, part| all.extend(part)),
        }
    }

    /// Number of liquid particles of this rank.
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
        self.copy();
    }

    /// Ghosts and images get what they are copies of.
    fn copy(&mut self) {
        let others = (self.ranks.as_ref(), &self.halo);
        complete(&mut self.records, others, self.mirror.as_ref(), |_| ());
    }

    /// Pair sums of all liquid particles over liquid and wall, separations in units of `h`.
    pub fn sum<const N: usize, P: Pass<N>>(&self, h: f64, pass: &P, out: &mut [P::Out]) {
        sweep::rows(&self.records, &self.rows, self.grid.scale(h), pass, out);
    }

    /// Whether record `j` is liquid, or a ghost or image of it.
    fn is_liquid(&self, j: usize) -> bool {
        let ghosts = self.halo.first..self.halo.first + self.halo.len();
        let images = |m: &Mirror| m.first..m.first + m.liquid.len();
        let image = |m: &Mirror| images(m).contains(&j);
        j < self.len() || ghosts.contains(&j) || self.mirror.as_ref().is_some_and(image)
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

    /// Moves liquid particle `i` by `step(i)`, whose length is at most `longest` on all ranks. Then
    /// [`Crowd::settle`].
    pub fn advance(&mut self, longest: f64, step: impl Fn(usize) -> [f64; 3] + Sync) {
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
    }

    /// Finds neighbours after particles have moved. Their order, and whose they are, may change;
    /// `held` is kept of each and follows it, if it is not empty.
    pub fn settle(&mut self, held: &mut Vec<impl Entry>) {
        match 2.0 * self.moved > SLACK {
            true => self.rebuild(held),
            false => self.place(),
        }
    }

    /// Gives particles to the ranks that own their slabs.
    fn migrate(&mut self, held: &mut Vec<impl Entry>) {
        let Some(ranks) = &mut self.ranks else {
            return;
        };
        let any = 0..=self.grid.count[0];
        ranks.balance(&self.grid, &self.position, &any);
        let mut leaving = Emigrate::new(ranks, &self.grid, &self.position);
        let columns = &mut self.position;
        columns
            .iter_mut()
            .for_each(|x| leaving.visit(Role::Held, x));
        leaving.visit(Role::Held, held);
        let mut coming = leaving.trade(ranks);
        columns.iter_mut().for_each(|x| coming.visit(Role::Held, x));
        coming.visit(Role::Held, held);
        ranks.count(self.position[0].len());
    }

    fn rebuild(&mut self, held: &mut Vec<impl Entry>) {
        self.migrate(held);
        let mut scratch = Vec::new();
        self.cells.sort(&self.grid, &self.position);
        for x in &mut self.position {
            self.cells.permute(x, &mut scratch);
        }
        self.cells.permute(held, &mut Vec::new());
        let (n, cutoff) = (self.len(), self.support + SLACK);
        self.find_ghosts(cutoff);
        let (ghosts, walls) = (self.halo.len(), self.wall[0].len());
        let images = self.mirror.as_ref().map_or(0, Mirror::len);
        let count = n + walls + ghosts + images + WIDTH;
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
        let mut sources = vec![own, wall];
        if self.ranks.is_some() {
            sources.insert(1, self.halo.source());
        }
        sources.extend(self.mirror.iter().flat_map(Mirror::sources));
        let search = Search {
            grid: &self.grid,
            at: &self.fixed,
            sources: &sources,
            cutoff,
            each: &[],
        };
        self.rows.build(search, 0, &self.position);
        self.moved = 0.0;
    }

    /// Finds copies of what is near of other ranks and behind planes, for rows of `cutoff`.
    fn find_ghosts(&mut self, cutoff: f64) {
        let reach = cutoff + SLACK;
        let all;
        let mut liquid = Points::of(&self.position);
        if let Some(ranks) = &self.ranks {
            let (own, walls) = (&self.cells, &self.wall_cells);
            self.halo.find(ranks, &self.grid, own, walls, reach);
            if self.mirror.is_some() {
                all = self.halo.with_ghosts(ranks, &self.grid, &self.position);
                liquid = Points {
                    position: &all.0,
                    index: &all.1,
                };
            }
        }
        let n = self.position[0].len();
        let first = n + self.wall[0].len() + self.halo.len();
        if let Some(mirror) = &mut self.mirror {
            mirror.find(&self.grid, (liquid, n), &self.wall, first, reach);
        }
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
        self.copy();
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

/// By how much the rows of the walls beside a body are moved along each axis, so that they end
/// where it ends, as what completes it has it; in spacings. 0 where they do, as where its length is
/// a multiple of the spacing.
pub fn wall_shift(input: &PackInput) -> [f64; 3] {
    let region = Region::new(input);
    let Form::Block { low, high, face } = &region.form else {
        return [0.0; 3];
    };
    let lattice = Lattice::new(&input.domain, input.dimension, input.spacing);
    std::array::from_fn(|k| {
        let beside = |&j: &usize| j != k && face[j].contains(&Face::Wall);
        let end = match face[k] {
            [_, Face::Free] => high[k],
            [Face::Free, _] => low[k],
            _ => return 0.0,
        };
        let shift = (end - (end / lattice.pitch[k]).round() * lattice.pitch[k]) / input.spacing;
        match region.axes().iter().any(beside) && shift.abs() > EQUAL {
            true => shift,
            false => 0.0,
        }
    })
}

/// The wall particles that touch the region: within `reach` of it and not behind a free face,
/// where the completion replaces them; those beside it moved by `shift`.
pub fn wall_near(
    region: &Region,
    wall: &[Vec<f64>; 3],
    shift: [f64; 3],
    reach: f64,
) -> [Vec<f64>; 3] {
    let Form::Block { low, high, face } = &region.form else {
        return Default::default();
    };
    let at = |i: usize, k: usize| {
        let out = |&j: &usize| j != k && (wall[j][i] < low[j] || wall[j][i] > high[j]);
        match region.axes().iter().any(out) {
            true => wall[k][i] + shift[k],
            false => wall[k][i],
        }
    };
    let near = |i: usize| {
        region.axes().iter().all(|&k| {
            let x = at(i, k);
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
    [0, 1, 2].map(|k| chosen.iter().map(|&i| at(i, k)).collect())
}
