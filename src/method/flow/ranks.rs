//! What a flow shares with other ranks: ghosts, particles that change rank, counts and extremes.

use super::Flow;
use crate::particle::column::{Columns, Entry, Role, Visitor};
use crate::particle::migrate::Emigrate;
use crate::space::ranks::halo::Carried;
use crate::space::ranks::largest;
use crate::space::ranks::span::Span;
use std::ops::{Range, RangeInclusive};

impl Flow {
    /// Records beside those of this rank's particles and of walls: images or ghosts.
    pub(super) fn others(&self) -> usize {
        self.images() + self.halo.len()
    }

    /// The particles, for a sum over those of all ranks.
    pub fn span(&self) -> Span {
        match &self.ranks {
            None => self.liquid().into(),
            Some(ranks) => Span::shared(&ranks.with, &ranks.first, 0),
        }
    }

    /// The walls, likewise.
    pub fn wall_span(&self) -> Span {
        match &self.ranks {
            None => self.walls().into(),
            Some(ranks) => ranks.wall_span(),
        }
    }

    /// Particles of all ranks.
    pub fn total(&self) -> usize {
        self.ranks
            .as_ref()
            .map_or(self.liquid(), |ranks| ranks.total())
    }

    /// Mass of the particles of all ranks, kg.
    pub fn total_mass(&self) -> f64 {
        match self.is_axial() {
            true => self.particles.total_mass(),
            false => self.particles.mass * self.total() as f64,
        }
    }

    /// Mass of as many particles as are `gone`, kg; `before`: that of all before they went.
    pub fn lost(&self, gone: u64, before: f64) -> f64 {
        match self.is_axial() {
            true => before - self.total_mass(),
            false => gone as f64 * self.particles.mass,
        }
    }

    /// The largest of a number of each rank; NaN wins.
    pub fn largest(&self, own: f64) -> f64 {
        match &self.ranks {
            None => own,
            Some(ranks) => largest(&*ranks.with, own),
        }
    }

    /// Whether something holds on any rank.
    pub fn any(&self, own: bool) -> bool {
        self.largest(f64::from(u8::from(own))) > 0.0
    }

    /// Particles of all ranks that are not among the `kept`, the indices of what stays; `None`: all
    /// of this rank stay.
    pub fn gone(&self, kept: Option<&[u32]>) -> u64 {
        let own = kept.map_or(0, |kept| self.liquid() - kept.len()) as u64;
        self.ranks.as_ref().map_or(own, |ranks| ranks.sum(own))
    }

    /// Gives all ranks what each says of the cells in its slabs.
    pub fn join<T: Carried>(&self, cells: &mut [T]) {
        if let Some(ranks) = &self.ranks {
            self.halo.join_cells(ranks, &self.grid, cells);
        }
    }

    /// Which cells hold liquid, on whichever rank; empty in one process.
    pub fn filled(&self) -> Vec<bool> {
        if self.ranks.is_none() {
            return Vec::new();
        }
        let own = self.liquid_cells.start.windows(2);
        let mut filled: Vec<bool> = own.map(|cell| cell[0] < cell[1]).collect();
        self.join(&mut filled);
        filled
    }

    /// Takes over how many particles each rank has now.
    pub fn count(&mut self) {
        let count = self.liquid();
        if let Some(ranks) = &mut self.ranks {
            ranks.count(count);
        }
    }

    /// Gives every rank about the same work from the next sort on, and the walls for it; whether
    /// these are others than before. `first`: at the start of a run.
    pub fn balance(&mut self, first: bool) -> bool {
        let within = self.slabs_of_liquid();
        let Some(ranks) = &mut self.ranks else {
            return false;
        };
        let (grid, x) = (&self.grid, &self.particles.position);
        let moves = match first {
            true => ranks.share_out(grid, x, &within, f64::INFINITY),
            false => ranks.balance(grid, x, &within),
        };
        if moves || first {
            self.take_walls();
        }
        moves
    }

    /// Slabs at which a rank may begin: a group of wall particles behind each other belongs to one.
    pub(super) fn slabs_of_liquid(&self) -> RangeInclusive<usize> {
        let grid = &self.grid;
        let (low, edge) = (grid.low[0], grid.edge[0]);
        let slab = |x: f64| (x - low) / edge;
        match grid.periodic[0] {
            true => 0..=grid.count[0],
            false => slab(0.0).ceil() as usize..=slab(self.domain.size[0]).floor() as usize,
        }
    }

    /// Gives particles to the ranks that own their slabs, with `own` columns and what is `held`
    /// beside. They come in the order of all.
    pub fn migrate(&mut self, own: &mut impl Columns, held: &mut Vec<impl Entry>) {
        let Some(ranks) = &self.ranks else {
            return;
        };
        let mut leaving = Emigrate::new(ranks, &self.grid, &self.particles.position);
        self.particles.visit(&mut leaving);
        own.visit(&mut leaving);
        leaving.visit(Role::Held, held);
        let mut coming = leaving.trade(ranks);
        self.particles.visit(&mut coming);
        own.visit(&mut coming);
        coming.visit(Role::Held, held);
        self.count();
    }

    /// Positions of particles and ghosts in the order of all, m, and their records; nothing on one
    /// rank or without mirror planes.
    pub(super) fn with_ghosts(&self) -> ([Vec<f64>; 3], Vec<u32>) {
        let (Some(ranks), Some(_)) = (&self.ranks, &self.mirror) else {
            return Default::default();
        };
        let own = &self.particles.position;
        self.halo.with_ghosts(ranks, &self.grid, own)
    }

    /// Finds which particles and walls of other ranks are near.
    pub(super) fn find_ghosts(&mut self) {
        let Some(ranks) = &self.ranks else {
            return;
        };
        let (liquid, wall) = (&self.liquid_cells, &self.wall_cells);
        let reach = self.farthest_pair();
        self.halo.find(ranks, &self.grid, liquid, wall, reach);
    }

    /// How far a rank looks beyond its slabs, m.
    pub(super) fn farthest_pair(&self) -> f64 {
        let most = self.lengths.most(self.slack);
        let reach = (self.lengths.support + 2.0 * most).max(self.lengths.longest + 2.0 * most);
        reach.max(self.far + 2.0 * most) + most
    }

    /// Particles whose records can be written while others are on their way between ranks; none in
    /// one process.
    pub(super) fn inner(&self) -> Range<usize> {
        match &self.ranks {
            None => 0..0,
            Some(_) => self.halo.inner(),
        }
    }
}
