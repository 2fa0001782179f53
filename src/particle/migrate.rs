//! Columns that follow their particles from rank to rank.

use super::column::{Entry, Role, Visitor};
use crate::space::ranks::{decoded, encoded};
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
    /// `lists`: particles by the rank that gets them; `own`: this one.
    pub fn new(lists: Vec<Vec<u32>>, own: usize) -> Self {
        let out = vec![Vec::new(); lists.len()];
        Emigrate { lists, own, out }
    }

    /// Which particles stay; by rank, the bytes of each column.
    pub fn into_parts(mut self) -> (Vec<u32>, Vec<Vec<Vec<u8>>>) {
        (std::mem::take(&mut self.lists[self.own]), self.out)
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
    kept: Vec<u32>,
    /// By rank: bytes of each column.
    all: Vec<Vec<Vec<u8>>>,
    own: usize,
    next: usize,
}

impl Immigrate {
    /// `kept`: which particles stay; `all`: by rank, the bytes of each column; `own`: this rank.
    pub fn new(kept: Vec<u32>, all: Vec<Vec<Vec<u8>>>, own: usize) -> Self {
        Immigrate {
            kept,
            all,
            own,
            next: 0,
        }
    }
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
