//! One run on several processes ("ranks"), with the bits of one process.
//!
//! Cells are sorted by x first, so that a slab of cells is a contiguous part of the sort order.
//! Each rank owns consecutive slabs with all particles in them, and has copies ("ghosts") of what
//! lies in the slabs beside its own. Every sum over neighbours then has the terms of one process in
//! its order. A sum over all particles goes on from rank to rank inside a chunk, and adds up the
//! chunks in their order ([`span`]).
//!
//! [`Communicator`] is what a transport offers: [`local`] connects threads of one process.
//! Tests: tests/engine/method_ranks.rs.

pub mod halo;
pub mod load;
pub mod local;
pub mod span;

use super::grid::Grid;
use load::Load;
use serde::Serialize;
use serde::de::DeserializeOwned;
use span::Span;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// What connects the ranks of a run. All ranks make the same calls in the same order.
pub trait Communicator: Send + Sync {
    /// Which rank this is, from 0.
    fn rank(&self) -> usize;
    /// How many ranks there are.
    fn size(&self) -> usize;
    /// Sends bytes to other ranks, and returns what the ranks `from` have sent to this one, in
    /// this order. No rank twice, and not this one. Meanwhile this rank does other work, which
    /// needs nothing of it; only what is of a known length, bytes, is received beside it.
    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>>;
    /// The same without other work.
    fn exchange(&self, to: &[(usize, Vec<u8>)], from: &[usize]) -> Vec<Vec<u8>> {
        let from: Vec<_> = from.iter().map(|&rank| (rank, None)).collect();
        self.exchange_while(to, &from, &mut || ())
    }
}

const CODING: bincode::config::Configuration<
    bincode::config::LittleEndian,
    bincode::config::Fixint,
> = bincode::config::standard().with_fixed_int_encoding();

/// Bytes of a value.
///
/// # Panics
/// If the value cannot be written, which those of this crate can.
pub fn encoded(value: &impl Serialize) -> Vec<u8> {
    bincode::serde::encode_to_vec(value, CODING).expect("a value of plain numbers")
}

/// The value of bytes from [`encoded`].
///
/// # Panics
/// If they are not the bytes of such a value: then the ranks run different programs.
pub fn decoded<T: DeserializeOwned>(bytes: &[u8]) -> T {
    let (value, _) =
        bincode::serde::decode_from_slice(bytes, CODING).expect("all ranks run the same program");
    value
}

/// How the ranks of a run share its cells.
#[derive(Clone)]
pub struct Ranks {
    /// The other ranks.
    pub with: Arc<dyn Communicator>,
    /// First slab of each rank, and the number of slabs.
    pub cuts: Vec<usize>,
    /// First particle of each rank in the order of all, and their number.
    pub first: Arc<[usize]>,
    /// The same of the walls in their slabs, and the first of this rank among those that it has.
    walls: (Arc<[usize]>, usize),
    load: Load,
}

impl Ranks {
    /// All slabs of `grid` belong to rank 0, which has all `count` particles.
    pub fn new(with: Arc<dyn Communicator>, grid: &Grid, count: usize) -> Self {
        let mut cuts = vec![grid.count[0]; with.size() + 1];
        cuts[0] = 0;
        let load = Load::new(with);
        let mut ranks = Ranks {
            with: load.with(),
            cuts,
            first: Arc::new([]),
            walls: (Arc::new([]), 0),
            load,
        };
        ranks.count(count);
        ranks
    }

    /// This rank.
    pub fn rank(&self) -> usize {
        self.with.rank()
    }

    /// How many there are.
    pub fn size(&self) -> usize {
        self.with.size()
    }

    /// Particles of all ranks.
    pub fn total(&self) -> usize {
        self.first[self.size()]
    }

    /// Takes over that this rank has `count` particles.
    pub fn count(&mut self, count: usize) {
        self.first = span::starts(&*self.with, count);
    }

    /// The rank that owns a slab.
    pub fn owner(&self, slab: usize) -> usize {
        self.cuts[1..self.size()].partition_point(|&cut| cut <= slab)
    }

    /// Slabs of a rank.
    pub fn slabs(&self, rank: usize) -> std::ops::Range<usize> {
        self.cuts[rank]..self.cuts[rank + 1]
    }

    /// Takes over that walls are sorted into cells; `start`: the first of each cell.
    pub fn count_walls(&mut self, grid: &Grid, start: &[u32]) {
        let (slab, own) = (grid.count[1] * grid.count[2], self.slabs(self.rank()));
        let [begin, end] = [own.start, own.end].map(|cut| start[cut * slab] as usize);
        self.walls = (span::starts(&*self.with, end - begin), begin);
    }

    /// The walls in the slabs of each rank.
    pub fn wall_span(&self) -> Span {
        Span::shared(&self.with, &self.walls.0, self.walls.1)
    }

    /// Whether any rank has walls.
    pub fn has_walls(&self) -> bool {
        self.walls.0.last().is_some_and(|&count| count > 0)
    }

    /// Gives every rank slabs that take it about the same time: `x` are the positions of the
    /// particles of this rank, m; no rank begins outside of the slabs `within`. Call it at the
    /// start of a step. Whether slabs have moved.
    pub fn balance(
        &mut self,
        grid: &Grid,
        x: &[Vec<f64>; 3],
        within: &RangeInclusive<usize>,
    ) -> bool {
        let cost = self.load.lap(x[0].len());
        self.share_out(grid, x, within, cost)
    }

    /// The same where a particle takes `cost` s, infinite if that is not known.
    pub fn share_out(
        &mut self,
        grid: &Grid,
        x: &[Vec<f64>; 3],
        within: &RangeInclusive<usize>,
        cost: f64,
    ) -> bool {
        let mut counts = vec![0u32; grid.count[0]];
        for i in 0..x[0].len() {
            counts[grid.cell([x[0][i], x[1][i], x[2][i]])[0]] += 1;
        }
        let costs = load::costs(&self.gather(&(counts, cost)));
        let cuts = load::cuts(&costs, self.size(), within);
        let moves = load::is_worth(&costs, &self.cuts, &cuts);
        if moves {
            self.cuts = cuts;
        }
        moves
    }

    /// What every rank has, in their order.
    pub fn gather<T: Serialize + DeserializeOwned>(&self, own: &T) -> Vec<T> {
        gather(&*self.with, own)
    }

    /// The sum of a number that each rank has.
    pub fn sum(&self, own: u64) -> u64 {
        self.gather(&own).into_iter().sum()
    }

    /// Lets each rank in turn go on with what those before it have made of `value`, and gives all
    /// of them what the last one has.
    pub fn in_turn<T: Serialize + DeserializeOwned>(
        &self,
        value: T,
        go_on: impl FnOnce(&mut T),
    ) -> T {
        let (rank, last) = (self.rank(), self.size() - 1);
        let mut value = match rank.checked_sub(1) {
            None => value,
            Some(before) => decoded(&self.with.exchange(&[], &[before])[0]),
        };
        go_on(&mut value);
        if rank < last {
            self.with.exchange(&[(rank + 1, encoded(&value))], &[]);
        }
        broadcast(&*self.with, last, (rank == last).then_some(value))
    }

    /// [`trade`] with the other ranks.
    pub fn trade(&self, out: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
        trade(&*self.with, out)
    }
}

/// Gives every rank what the others have for it, in the order of the ranks; `out`: by rank.
pub fn trade(with: &dyn Communicator, out: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let mut to: Vec<(usize, Vec<u8>)> = out.into_iter().enumerate().collect();
    let (rank, own) = to.remove(with.rank());
    let others: Vec<usize> = to.iter().map(|(rank, _)| *rank).collect();
    let mut all = with.exchange(&to, &others);
    all.insert(rank, own);
    all
}

/// What every rank has, in their order; each sends as many messages as the number of ranks has
/// binary digits (Bruck, Ho, Kipnis, Upfal & Weathersby 1997).
pub fn gather<T: Serialize + DeserializeOwned>(with: &dyn Communicator, own: &T) -> Vec<T> {
    let (rank, size) = (with.rank(), with.size());
    // Of this rank and those behind it.
    let mut all = vec![encoded(own)];
    while all.len() < size {
        let (known, wanted) = (all.len(), all.len().min(size - all.len()));
        let to = (rank + size - known) % size;
        let bytes = bincode::encode_to_vec(&all[..wanted], CODING).expect("plain bytes");
        let more = with.exchange(&[(to, bytes)], &[(rank + known) % size]);
        let (more, _): (Vec<Vec<u8>>, _) =
            bincode::decode_from_slice(&more[0], CODING).expect("all ranks run the same program");
        all.extend(more);
    }
    all.rotate_right(rank);
    all.iter().map(|bytes| decoded(bytes)).collect()
}

/// What all ranks have, joined on rank 0, which holds one part at a time beside the whole; nothing
/// on the others. `join` appends a part; they come in the order of the ranks.
pub fn collect<T: Serialize + DeserializeOwned>(
    with: &dyn Communicator,
    own: T,
    mut join: impl FnMut(&mut T, T),
) -> Option<T> {
    if with.rank() > 0 {
        let bytes = encoded(&own);
        drop(own);
        with.exchange(&[(0, bytes)], &[]);
        return None;
    }
    let mut whole = own;
    for rank in 1..with.size() {
        let part = decoded(&with.exchange(&[], &[rank])[0]);
        join(&mut whole, part);
    }
    Some(whole)
}

/// Gives all ranks what the rank `from` has, which alone has a value. Those that have it pass it
/// on, twice as many each time.
pub fn broadcast<T: Serialize + DeserializeOwned>(
    with: &dyn Communicator,
    from: usize,
    value: Option<T>,
) -> T {
    let size = with.size();
    // Places count from the rank with the value.
    let place = (with.rank() + size - from) % size;
    let at = |place: usize| (place + from) % size;
    let bytes = match &value {
        Some(value) => encoded(value),
        None => with.exchange(&[], &[at(place & (place - 1))]).remove(0),
    };
    let step = |k: &u32| place & ((2 << k) - 1) == 0;
    let next = (0..usize::BITS - 1)
        .take_while(step)
        .map(|k| place + (1 << k));
    let to = next.take_while(|place| *place < size);
    let to: Vec<(usize, Vec<u8>)> = to.map(|place| (at(place), bytes.clone())).collect();
    with.exchange(&to, &[]);
    value.unwrap_or_else(|| decoded(&bytes))
}

/// The largest of a number that each rank has; NaN wins.
pub fn largest(with: &dyn Communicator, own: f64) -> f64 {
    let all = gather(with, &own).into_iter();
    all.fold(f64::NEG_INFINITY, super::larger::larger)
}
