//! What tension and contact lines read of a flow.

use crate::space::grid::Grid;
use crate::space::mirror::Mirror;
use crate::space::ranks::Ranks;
use crate::space::ranks::halo::Halo;
use crate::space::ranks::span::Span;
use crate::space::sort::Cells;
use crate::space::sweep::{Field, Source};

/// What the effect reads of a flow.
pub struct Surface<'a> {
    /// Cells of the box.
    pub grid: &'a Grid,
    /// Liquid particles by cell.
    pub liquid: &'a Cells,
    /// Fixed-point coordinates of liquid, wall and images, and eight spare ones.
    pub at: &'a [Vec<i32>; 3],
    /// Liquid, its images, wall, its images: those that there are.
    pub sources: &'a [Source<'a>],
    /// How many of them are liquid and its images: the first.
    pub liquid_sources: usize,
    /// Images behind mirror planes; `at` holds them after the wall.
    pub mirror: Option<&'a Mirror>,
    /// The processes that share the run, and what is near of theirs; `at` holds it likewise.
    pub ranks: Option<(&'a Ranks, &'a Halo)>,
    /// Positions of the liquid particles, m.
    pub position: &'a [Vec<f64>; 3],
    /// Positions of the wall particles, m.
    pub wall: &'a [Vec<f64>; 3],
    /// How often they were replaced by others.
    pub wall_changes: u64,
    /// Densities of the liquid particles, kg/m^3.
    pub density: &'a [f64],
    /// Mass of a particle, kg.
    pub mass: f64,
    /// Masses of liquid and of wall particles over that, where they are rings; else none.
    pub weights: Option<[&'a [f64]; 2]>,
    /// What two particles may have approached since the sort, m.
    pub slack: f64,
    /// How often particles were sorted.
    pub sorted: u64,
    /// How much farther than a support each particle has to look until the next sort, and any, m.
    pub extra: Extra<'a>,
}

/// See [`Surface::extra`].
#[derive(Clone, Copy)]
pub struct Extra<'a> {
    /// Reach of each particle's rows, m; none if it is the same for all.
    pub reach: &'a [f32],
    /// Their support, m.
    pub support: f64,
    /// What is added to it at most, m.
    pub most: f64,
}

impl Extra<'_> {
    /// Of particle `i`, m.
    #[inline(always)]
    pub fn of(&self, i: usize) -> f64 {
        let reach = self.reach.get(i);
        reach.map_or(self.most, |&reach| reach as f64 - self.support)
    }
}

impl<'a> Surface<'a> {
    /// The liquid and its images among the sources.
    pub fn of_liquid(&self) -> &'a [Source<'a>] {
        &self.sources[..self.liquid_sources]
    }

    /// The wall and its images among the sources.
    pub fn of_wall(&self) -> &'a [Source<'a>] {
        &self.sources[self.liquid_sources..]
    }

    /// Sums over `sources` about the points `position`, m, which carry the same words; `length`:
    /// smoothing length, m.
    pub fn about<const W: usize>(
        &'a self,
        position: &'a [Vec<f64>; 3],
        sources: &'a [Source<'a>],
        words: &'a [Vec<f32>; W],
        length: f64,
    ) -> Field<'a, W, W> {
        Field {
            grid: self.grid,
            at: self.at,
            payload: words,
            sources,
            position,
            own: words,
            cutoff: 2.0 * length + self.slack,
            scale: self.grid.scale(length),
            first: 0,
        }
    }

    /// Vectors of the images from those of the points.
    pub fn turn(&self, words: &mut [Vec<f32>; 3]) {
        if let Some((ranks, halo)) = self.ranks {
            halo.fill_three(ranks, words);
        }
        if let Some(mirror) = self.mirror {
            mirror.turn(words);
        }
    }

    /// The same for scalars.
    pub fn share(&self, words: &mut [f32]) {
        if let Some((ranks, halo)) = self.ranks {
            halo.fill(ranks, words);
        }
        if let Some(mirror) = self.mirror {
            mirror.share(words);
        }
    }

    /// A list of which this rank has `count` items.
    pub fn list(&self, count: usize) -> Span {
        match self.ranks {
            None => count.into(),
            Some((ranks, _)) => Span::of_list(&ranks.with, count),
        }
    }

    /// Marks of the cells of all ranks from those of each.
    pub fn join(&self, marks: &mut [bool]) {
        if let Some((ranks, halo)) = self.ranks {
            halo.join_cells(ranks, self.grid, marks);
        }
    }

    /// Whether liquid was in a cell when it was sorted.
    #[inline(always)]
    pub fn is_filled(&self, cell: usize) -> bool {
        let has = |start: &[u32]| start[cell + 1] > start[cell];
        has(&self.liquid.start) || self.ranks.is_some_and(|(_, halo)| has(halo.source().start))
    }

    /// The walls of which this rank says what they carry.
    pub fn own_walls(&self) -> std::ops::Range<usize> {
        self.wall_span().own
    }

    /// All walls, for a sum over those of all ranks.
    pub fn wall_span(&self) -> Span {
        match self.ranks {
            Some((ranks, _)) => ranks.wall_span(),
            None => self.wall[0].len().into(),
        }
    }
}
