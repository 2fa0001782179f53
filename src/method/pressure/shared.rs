//! One equation on several ranks.
//!
//! A rank has rows of its particles and of the groups of wall particles in its slabs. Groups of
//! others and ghosts have columns only: after every change of values they get those of the rank
//! that has the row ([`Shared::fill`]). Sums go over the particles of all ranks, then over the
//! groups; with the transposed gradient over particles alone, where what belongs to a wall is zero.
//! The grids of multigrid are the same on every rank; each finds the nodes in its slabs, and all
//! get all of them ([`Shared::join`]).
//! Test: tests/engine/method_ranks.rs.

use crate::space::grid::Grid;
use crate::space::ranks::halo::{Carried, Copying, Halo};
use crate::space::ranks::span::{self, Span};
use crate::space::ranks::{Ranks, largest};
use std::ops::Range;
use std::sync::Arc;

/// What a rank knows of the others.
pub struct Shared {
    ranks: Ranks,
    halo: Halo,
    grid: Grid,
    /// Particles of this rank.
    liquid: usize,
    /// Group of each wall particle; the wall particle of each group that stands for it.
    group: Vec<u32>,
    contact: Vec<u32>,
    /// The wall particles of this rank.
    walls: Range<usize>,
    /// First group of each rank, and their number; the first of this one among those that it has.
    groups: Arc<[usize]>,
    begin: usize,
    /// All columns in the order of all ranks.
    pub order: Vec<u32>,
    /// Whether constants are in the null space.
    pub is_enclosed: bool,
}

impl Shared {
    /// For `liquid` particles of this rank and groups of wall particles of which `walls` are its
    /// own.
    pub fn new(
        (ranks, halo, grid): (&Ranks, &Halo, &Grid),
        liquid: usize,
        (group, contact, walls): (&[u32], &[u32], Range<usize>),
    ) -> Self {
        let groups = contact.len() as u32;
        let first = liquid as u32 + groups;
        let records = halo.in_order(liquid, ranks.slabs(ranks.rank()).start, grid);
        let column = |&record: &u32| match (record as usize).checked_sub(halo.first) {
            None => record,
            Some(ghost) => first + ghost as u32,
        };
        let order = records.iter().map(column);
        let is_own = |contact: &&u32| walls.contains(&(**contact as usize));
        let own_groups = contact.iter().filter(is_own).count();
        let begin = contact.iter().position(|contact| is_own(&contact));
        Shared {
            begin: begin.unwrap_or(0),
            groups: span::starts(&*ranks.with, own_groups),
            ranks: ranks.clone(),
            halo: halo.clone(),
            grid: grid.clone(),
            liquid,
            group: group.to_vec(),
            contact: contact.to_vec(),
            walls,
            order: order.chain(liquid as u32..first).collect(),
            is_enclosed: false,
        }
    }

    /// Rows and columns.
    pub fn columns(&self) -> usize {
        self.order.len()
    }

    /// Particles, with or without groups of `walls`, for a sum over those of all ranks. Groups are
    /// numbered as their ranks are.
    pub fn span(&self, walls: bool) -> Span {
        let particles = Span::shared(&self.ranks.with, &self.ranks.first, 0);
        match walls {
            true => particles.with(self.groups.clone(), self.begin, self.contact.len()),
            false => particles,
        }
    }

    /// Whether this rank has the row of an unknown.
    pub fn has_row(&self, unknown: usize) -> bool {
        match unknown.checked_sub(self.liquid) {
            None => true,
            Some(group) => self.walls.contains(&(self.contact[group] as usize)),
        }
    }

    /// The largest of a number of each rank; NaN wins.
    pub fn largest(&self, own: f64) -> f64 {
        largest(&*self.ranks.with, own)
    }

    /// Rows without columns of other ranks.
    pub fn inner(&self) -> Range<usize> {
        self.halo.inner()
    }

    /// Gives the columns of other ranks the values that those have; `meanwhile` reads those of
    /// [`Shared::inner`].
    pub fn fill<T: Carried>(&self, values: &mut [T], mut meanwhile: impl FnMut(&[T])) {
        let ghosts = self.liquid + self.contact.len();
        let column = |point: usize| match point.checked_sub(self.halo.first) {
            Some(ghost) => ghosts + ghost,
            None if point < self.liquid => point,
            None => self.liquid + self.group[point - self.liquid] as usize,
        };
        let copying = Copying {
            walls_alone: false,
            give: |values: &[T], point| values[column(point)],
            take: |values: &mut [T], point, value| values[column(point)] = value,
        };
        let meanwhile = |values: &mut [T]| meanwhile(values);
        self.halo.copy(&self.ranks, values, &copying, meanwhile);
    }

    /// Gives all ranks the nodes that each has found, of a grid with `count` nodes to each side
    /// from `low` m on, `pitch` m apart along x.
    pub fn join<T: Carried>(&self, count: [usize; 3], (low, pitch): (f64, f64), nodes: &mut [T]) {
        let plane = count[1] * count[2];
        let owner = |x: usize| {
            let at = low + x as f64 * pitch;
            self.ranks.owner(self.grid.cell([at, 0.0, 0.0])[0])
        };
        let owners: Vec<usize> = (0..count[0]).map(owner).collect();
        let range = |rank: usize| {
            let first = owners.partition_point(|&owner| owner < rank);
            let end = owners.partition_point(|&owner| owner <= rank);
            first * plane..end * plane
        };
        let own = nodes[range(self.ranks.rank())].to_vec();
        for (rank, values) in self.ranks.gather(&own).into_iter().enumerate() {
            nodes[range(rank)].copy_from_slice(&values);
        }
    }
}
