//! Columns that follow their particles from rank to rank.

use super::column::{Entry, Role, Visitor};
use crate::space::grid::Grid;
use crate::space::ranks::{Ranks, decoded, encoded};
use crate::space::room::make_room;

/// Takes entries of particles to other ranks, column by column.
pub struct Emigrate {
    /// By rank: which particles; those of this rank stay.
    lists: Vec<Vec<u32>>,
    own: usize,
    /// By rank: bytes of each column.
    out: Vec<Vec<Vec<u8>>>,
}

impl Emigrate {
    /// To the ranks that own the slabs of `grid` in which particles are; `x`: positions, m.
    pub fn new(ranks: &Ranks, grid: &Grid, x: &[Vec<f64>; 3]) -> Self {
        let mut lists = vec![Vec::new(); ranks.size()];
        for i in 0..x[0].len() {
            let slab = grid.cell([x[0][i], x[1][i], x[2][i]])[0];
            lists[ranks.owner(slab)].push(i as u32);
        }
        Emigrate {
            out: vec![Vec::new(); lists.len()],
            lists,
            own: ranks.rank(),
        }
    }

    /// Trades what was visited; the same columns then take in what has come.
    pub fn trade(mut self, ranks: &Ranks) -> Immigrate {
        let all = ranks.trade(self.out.iter().map(encoded).collect());
        Immigrate {
            kept: std::mem::take(&mut self.lists[self.own]),
            all: all.into_iter().map(|bytes| decoded(&bytes)).collect(),
            own: self.own,
            next: 0,
        }
    }
}

impl Visitor for Emigrate {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role == Role::Scratch {
            return;
        }
        for (rank, (list, out)) in self.lists.iter().zip(&mut self.out).enumerate() {
            let goes = rank != self.own && !column.is_empty();
            let entries = list.iter().filter(|_| goes);
            let entries: Vec<T> = entries.map(|&i| column[i as usize]).collect();
            out.push(encoded(&entries));
        }
    }
}

/// Brings entries of particles from other ranks, in the order of all: from lower ranks, then what
/// has stayed, then from higher ones.
pub struct Immigrate {
    /// Which particles have stayed.
    kept: Vec<u32>,
    /// By rank: bytes of each column.
    all: Vec<Vec<Vec<u8>>>,
    own: usize,
    next: usize,
}

impl Visitor for Immigrate {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role == Role::Scratch {
            return;
        }
        let (before, own) = (std::mem::take(column), self.own);
        let others = self.all.iter().enumerate().filter(|(rank, _)| *rank != own);
        let mut coming: Vec<Vec<T>> = others
            .map(|(_, columns)| decoded(&columns[self.next]))
            .collect();
        let kept = match before.is_empty() {
            true => Vec::new(),
            false => self.kept.iter().map(|&i| before[i as usize]).collect(),
        };
        drop(before);
        coming.insert(own, kept);
        make_room(column, coming.iter().map(Vec::len).sum());
        coming.iter().for_each(|part| column.extend(part));
        self.next += 1;
    }
}
