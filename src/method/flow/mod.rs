//! The moving arrays that every method shares: liquid and wall particles along cells, records for
//! the pair loops, neighbour rows, and the rule that says when rows must be found again.
//!
//! Records: liquid `0 .. liquid`, then wall `liquid .. liquid + walls`, then ghosts of other ranks,
//! then the images of all behind mirror planes, as far as there are any, then eight spare ones, so
//! that eight lanes can be loaded anywhere.

mod ahead;
mod find;
mod pack;
mod ranks;
mod rings;
pub(super) mod wall;

use crate::effect::surface::Extra;
use crate::particle::column::{Columns, Memory, Sort, Spare};
use crate::particle::{Particles, Wall};
use crate::scene::{Dimension, Domain, Pairs, Side};
use crate::space::column;
use crate::space::grid::{Grid, TooSmall};
use crate::space::lane::WIDTH;
use crate::space::larger::larger;
use crate::space::mirror::{Mirror, Planes};
use crate::space::parallel::{Parts, each_mut, each_part, largest_of, three};
use crate::space::ranks::Ranks;
use crate::space::ranks::halo::Halo;
use crate::space::room::resize;
use crate::space::row::Rows;
use crate::space::sort::Cells;
use crate::space::sweep::Records;

/// Least and largest extra reach of the rows, in units of that where nothing is known of speeds.
const LEAST: f64 = 0.25;
const MOST: f64 = 2.5;

/// How much farther than at its present speed a particle may go before rows are stale.
const HASTE: f64 = 1.5;

/// See [`Flow::build_walls`].
type WallSource = Box<dyn Fn(&dyn Fn(f64) -> bool) -> Wall + Send + Sync>;

/// Points that are placed together.
const PART: usize = 512;

/// Lengths that shape a flow, m.
#[derive(Clone, Copy, Debug)]
pub struct Lengths {
    /// Particle spacing.
    pub spacing: f64,
    /// Support radius of the pair sums (2 h).
    pub support: f64,
    /// Longest distance at which anything looks for neighbours (2 H with tension).
    pub longest: f64,
    /// A pair may be missing while it is this little inside the support (slope below 1e-3).
    pub late: f64,
    /// What a particle may cross while rows last, whatever the slack.
    pub farthest: f64,
    /// How deep in a wall a particle may be.
    pub deepest: f64,
}

impl Lengths {
    /// The most that a particle may move before rows are stale. `slack`: of [`Pairs`].
    fn most(&self, slack: f64) -> f64 {
        let usual = 0.5 * (slack * self.support + self.late);
        (MOST * usual).max(HASTE * self.farthest)
    }
}

/// Particles, cells, rows.
pub struct Flow {
    /// Of the scene.
    pub dimension: Dimension,
    /// The box.
    pub domain: Domain,
    /// Its cells.
    pub grid: Grid,
    /// Lengths that shape the rows.
    pub lengths: Lengths,
    /// Extra reach of the rows where nothing is known of speeds, as a fraction of the support.
    slack: f64,
    /// The liquid.
    pub particles: Particles,
    /// Sorted along cells, never moved. Of several ranks each has what is in and about its slabs.
    pub wall: Wall,
    /// What pair sums read: liquid, wall, images.
    pub records: Records,
    /// Fixed-point coordinates in that order, as of the last [`Flow::place`].
    pub at: [Vec<i32>; 3],
    /// Rows of the liquid: liquid and wall neighbours.
    pub rows: Rows,
    /// Rows of the wall: liquid neighbours only.
    pub wall_rows: Rows,
    /// Liquid particles by cell, as of the last sort.
    pub liquid_cells: Cells,
    /// Wall particles by cell.
    pub wall_cells: Cells,
    /// Images behind mirror planes, of a box that has them.
    pub mirror: Option<Mirror>,
    /// The processes that share the run, where there are several.
    pub ranks: Option<Ranks>,
    /// What is near of theirs.
    pub halo: Halo,
    /// How far they must see each other at least, m.
    pub far: f64,
    /// Of several ranks: makes the walls at certain x, m.
    pub build_walls: WallSource,
    /// Which cells have walls, on whichever rank; empty in one process.
    pub walled: Vec<bool>,
    /// How often this rank has got other walls.
    pub wall_changes: u64,
    /// For how long rows should last at the speeds of their making, s; 0: equal reach for all.
    pub lasting: f64,
    /// Fixed-point coordinates of the liquid when the rows were made.
    home: [Vec<i32>; 3],
    /// What each particle may move from there before a pair could be missed, m.
    allowed: Vec<f32>,
    /// Cutoff of the rows of each liquid and wall particle, m.
    reach: Vec<f32>,
    /// The longest of them, m.
    longest: f64,
    /// How often rows were found.
    pub sorted: u64,
    /// Whether the last [`Flow::confine`] put any particle of this rank back out of a wall.
    pub held_back: bool,
    /// Particles that the last [`Flow::confine`] reflected, and the axis of the plane.
    pub reflected: Vec<(u32, u8)>,
    /// Room for sorting columns.
    pub spare: Spare,
    /// Whether the rows of the wall list wall neighbours too.
    pub wall_sees_wall: bool,
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    /// Per cell: the largest allowance in and about it.
    peaks: Vec<f32>,
    dilated: Vec<f32>,
}

impl Flow {
    /// Cells for a box; particles are not sorted yet.
    ///
    /// # Errors
    /// A periodic side that is shorter than a kernel support.
    pub fn new(
        dimension: Dimension,
        domain: &Domain,
        lengths: Lengths,
        pairs: Pairs,
        particles: Particles,
        wall: Wall,
    ) -> Result<Self, TooSmall> {
        let slack = pairs.slack;
        let reach = lengths.support * (1.0 + slack);
        let margin = lengths.longest + reach;
        let longest = reach.max(lengths.longest);
        let widest = lengths.support + 2.0 * lengths.most(slack);
        let edge = (0.5 * reach).max(margin.max(widest) / column::REACH as f64);
        let mut grid = Grid::new(domain, dimension, edge, margin, longest)?;
        grid.precision = pairs.precision;
        let (wall, wall_cells) = wall::sorted(&grid, wall);
        let places = [0, 1, 2].map(|a| domain.mirrors(a));
        let mirror = Planes::new(places, &grid).map(Mirror::new);
        Ok(Flow {
            dimension,
            domain: domain.clone(),
            grid,
            lengths,
            slack,
            particles,
            wall,
            records: Records::default(),
            at: Default::default(),
            rows: Rows::default(),
            wall_rows: Rows::default(),
            liquid_cells: Cells::default(),
            wall_cells,
            mirror,
            ranks: None,
            far: 0.0,
            build_walls: Box::new(|_| Wall::default()),
            walled: Vec::new(),
            wall_changes: 0,
            halo: Halo::default(),
            lasting: 0.0,
            home: Default::default(),
            allowed: Vec::new(),
            reach: Vec::new(),
            longest: 0.0,
            sorted: 0,
            held_back: false,
            reflected: Vec::new(),
            spare: Spare::default(),
            wall_sees_wall: false,
            scratch: Scratch::default(),
        })
    }

    /// Whether particles are rings about an axis.
    pub fn is_axial(&self) -> bool {
        self.domain.is_axial()
    }

    /// Liquid particles.
    pub fn liquid(&self) -> usize {
        self.particles.len()
    }

    /// Wall particles.
    pub fn walls(&self) -> usize {
        self.wall.position[0].len()
    }

    /// Image records.
    pub fn images(&self) -> usize {
        self.mirror.as_ref().map_or(0, Mirror::len)
    }

    /// First image record, and the record of which each is an image.
    pub fn image_sources(&self) -> (usize, &[u32]) {
        match &self.mirror {
            Some(mirror) => (mirror.first, &mirror.source),
            None => (usize::MAX, &[]),
        }
    }

    /// The record that record `i` is an image of, or itself.
    #[inline(always)]
    pub fn original(&self, i: usize) -> usize {
        match &self.mirror {
            Some(mirror) if i >= mirror.first => mirror.source[i - mirror.first] as usize,
            _ => i,
        }
    }

    /// Position of liquid particle `i`, m.
    #[inline(always)]
    pub fn position(&self, i: usize) -> [f64; 3] {
        let p = &self.particles.position;
        [p[0][i], p[1][i], p[2][i]]
    }

    /// Whether a pair could be missed after each particle moves by another `step(i)` m.
    pub fn stale(&self, step: impl Fn(usize) -> f64 + Sync) -> bool {
        self.most(|i, square| square.sqrt() + step(i) - self.allowed[i] as f64) > 0.0
    }

    /// The largest `f(i, d2)`, d2 the [`Flow::away_squared`] of particle `i`.
    fn most(&self, f: impl Fn(usize, f64) -> f64 + Sync) -> f64 {
        let n = self.home[0].len();
        let of_part = |part: usize| {
            let (first, count) = (part * PART, PART.min(n - part * PART));
            let (mut now, mut square) = ([0; PART], [0.0; PART]);
            for a in 0..3 {
                let here = &self.particles.position[a][first..first + count];
                self.grid.fix_all(a, here, &mut now);
                for ((square, now), home) in square.iter_mut().zip(now).zip(&self.home[a][first..])
                {
                    let d = now.wrapping_sub(*home) as f64 * self.grid.unit[a];
                    *square += d * d;
                }
            }
            (0..count).fold(f64::NEG_INFINITY, |most, k| {
                larger(f(first + k, square[k]), most)
            })
        };
        self.largest(largest_of(n.div_ceil(PART), &of_part))
    }

    #[inline(always)]
    fn away_squared(&self, i: usize) -> f64 {
        let mut square = 0.0;
        for a in 0..3 {
            let now = self.grid.fix(a, self.particles.position[a][i]);
            let d = now.wrapping_sub(self.home[a][i]) as f64 * self.grid.unit[a];
            square += d * d;
        }
        square
    }

    /// The farthest that any particle is from where the rows were made, m.
    pub fn moved(&self) -> f64 {
        self.most(|_, square| square).max(0.0).sqrt()
    }

    /// Whether any particle is elsewhere than where the rows were made.
    pub fn has_moved(&self) -> bool {
        self.any((0..self.home[0].len()).any(|i| self.away_squared(i) > 0.0))
    }

    /// Search radius of cell columns that covers `support` in spite of what moved since the sort,
    /// m.
    pub fn cutoff(&self, support: f64) -> f64 {
        support + 2.0 * self.moved()
    }

    /// How much farther than the support each particle looks for neighbours.
    pub fn extra(&self) -> Extra<'_> {
        Extra {
            reach: &self.reach,
            support: self.lengths.support,
            most: self.longest - self.lengths.support,
        }
    }

    /// Whether liquid particle `i` is beyond a periodic side.
    pub fn crosses(&self, i: usize) -> bool {
        (0..2).any(|a| self.domain.is_crossed(a, self.particles.position[a][i]))
    }

    /// Wraps periodic axes, puts back what is behind the first layer of a wall or behind a mirror
    /// plane, and finds what left through open sides or is `doomed`: returns the indices of what
    /// is left if anything went.
    pub fn confine(&mut self, doomed: impl Fn(usize) -> bool + Sync) -> Option<Vec<u32>> {
        self.held_back = self.hold_back();
        self.fold_back();
        let (domain, grid) = (&self.domain, &self.grid);
        let n = self.particles.len();
        let outside = std::sync::atomic::AtomicBool::new(false);
        each_mut(three(&mut self.particles.position, n), |i, at| {
            for a in 0..3 {
                let x = &mut *at[a];
                let left = *x < 0.0 && domain.boundary[a][0] == Side::Open;
                let right = *x > domain.size[a] && domain.boundary[a][1] == Side::Open;
                if left || right || doomed(i) {
                    outside.store(true, std::sync::atomic::Ordering::Relaxed);
                }
                *x = grid.wrap(a, *x);
            }
        });
        outside.into_inner().then(|| self.inside(doomed))
    }

    fn inside(&self, doomed: impl Fn(usize) -> bool) -> Vec<u32> {
        let within = |i: usize, a: usize| {
            let (x, sides) = (self.particles.position[a][i], self.domain.boundary[a]);
            let left = x < 0.0 && sides[0] == Side::Open;
            let right = x > self.domain.size[a] && sides[1] == Side::Open;
            !left && !right
        };
        let is = |i: &usize| !doomed(*i) && (0..3).all(|a| within(*i, a));
        let kept = (0..self.particles.len()).filter(is);
        kept.map(|i| i as u32).collect()
    }

    /// Sorts the particles along cells; the caller sorts its own columns by `liquid_cells`.
    pub fn sort(&mut self) {
        self.liquid_cells.sort(&self.grid, &self.particles.position);
        self.particles.visit(&mut Sort {
            cells: &self.liquid_cells,
            spare: &mut self.spare,
        });
    }

    /// Brings `at` to the current positions.
    pub fn place(&mut self) {
        let (n, m, others) = (self.liquid(), self.walls(), self.others());
        for a in 0..3 {
            resize(&mut self.at[a], n + m + others + WIDTH, 0);
            let (liquid, wall) = (&self.particles.position[a], &self.wall.position[a]);
            let (own, rest) = self.at[a].split_at_mut(n);
            for (x, at) in [(liquid, own), (wall, &mut rest[..m])] {
                each_part(Parts::of(at, PART), |part, at| {
                    let from = part * PART;
                    self.grid.fix_all(a, &x[from..from + at.len()], at);
                });
            }
        }
        if let Some(ranks) = &self.ranks {
            self.halo.fill_three(ranks, &mut self.at);
        }
        if let Some(mirror) = &self.mirror {
            mirror.place(&mut self.at);
        }
    }

    /// Bytes held per liquid particle, without neighbour rows and with them.
    pub fn memory(&self) -> (f64, f64) {
        let n = self.liquid().max(1) as f64;
        let own =
            12 * self.home[0].capacity() + 4 * (self.allowed.capacity() + self.reach.capacity());
        let mut memory = Memory::default();
        self.particles.view(&mut memory);
        let p = (memory.bytes + own) as f64 / n;
        let records = (self.records.capacity() * 32 + self.at[0].capacity() * 12) as f64 / n;
        let cells = (self.liquid_cells.order.capacity() * 8
            + self.liquid_cells.start.capacity() * 4) as f64
            / n;
        let scratch = self.spare.memory() as f64 / n;
        let building = self.rows.scratch()
            + self.wall_rows.scratch()
            + self.mirror.as_ref().map_or(0, Mirror::memory)
            + self.halo.memory();
        let bare = p + records + cells + scratch + building as f64 / n;
        let rows = (self.rows.memory() + self.wall_rows.memory()) as f64 / n;
        (bare, bare + rows)
    }
}
