//! Ghosts: copies of what lies in the slabs beside those of a rank.
//!
//! Points of a rank: its own, the walls in and beside its slabs, then its ghosts, which are in the
//! order of all. A rank finds what the walls in its own slabs carry.

use super::Ranks;
use crate::space::grid::Grid;
use crate::space::lane::Record;
use crate::space::mirror::Mirror;
use crate::space::row::Source;
use crate::space::sort::Cells;
use crate::space::sweep::Records;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ops::Range;

/// What a point carries from rank to rank.
pub trait Carried: Copy + Serialize + DeserializeOwned {}

impl<T: Copy + Serialize + DeserializeOwned> Carried for T {}

/// See the [module](self).
#[derive(Clone, Default)]
pub struct Halo {
    /// First ghost of each cell, and the number of all.
    start: Vec<u32>,
    /// First ghost among the points.
    pub first: usize,
    /// By rank: what it gets from here, and what here comes from it.
    to: Vec<Share>,
    from: Vec<Share>,
    /// Own particles that no other rank needs, and whose sums need none of another rank.
    inner: Range<usize>,
}

/// Points that one rank has and another needs.
#[derive(Clone, Debug, Default)]
struct Share {
    liquid: Vec<Range<usize>>,
    wall: Vec<Range<usize>>,
}

impl Share {
    /// Its points, or those of walls alone.
    fn points(&self, walls_alone: bool) -> impl Iterator<Item = usize> {
        let liquid = self.liquid.iter().filter(move |_| !walls_alone);
        liquid.chain(&self.wall).cloned().flatten()
    }
}

/// The longest range of `n` particles that no other rank gets.
fn inner(to: &[Share], n: usize) -> Range<usize> {
    let mut needed: Vec<Range<usize>> = to.iter().flat_map(|share| share.liquid.clone()).collect();
    needed.push(n..n);
    needed.sort_by_key(|range| range.start);
    let (mut from, mut longest) = (0, 0..0);
    for range in needed {
        if range.start.saturating_sub(from) > longest.len() {
            longest = from..range.start;
        }
        from = from.max(range.end);
    }
    longest
}

/// How points get what those of other ranks have.
pub struct Copying<G, T> {
    /// Whether only walls have changed.
    pub walls_alone: bool,
    /// What a point has.
    pub give: G,
    /// Sets it.
    pub take: T,
}

/// The slabs within `reach` cells of those of a rank, its own left out.
pub fn beside(ranks: &Ranks, grid: &Grid, rank: usize, reach: usize) -> Vec<usize> {
    let (own, count) = (ranks.slabs(rank), grid.count[0]);
    if own.is_empty() {
        return Vec::new();
    }
    let near = |slab: &usize| {
        let ahead = (own.start + count - slab) % count;
        let behind = (slab + count - (own.end - 1)) % count;
        let within = |away: usize| away <= reach;
        match grid.periodic[0] {
            true => within(ahead) || within(behind),
            false => *slab + reach >= own.start && *slab < own.end + reach,
        }
    };
    (0..count)
        .filter(|slab| !own.contains(slab))
        .filter(near)
        .collect()
}

/// Cells of slabs.
fn cells_of<'a>(grid: &Grid, slabs: &'a [usize]) -> impl Iterator<Item = usize> + use<'a> {
    let cells = grid.count[1] * grid.count[2];
    slabs
        .iter()
        .flat_map(move |slab| slab * cells..(slab + 1) * cells)
}

/// Points of slabs, where `start` has the first of each cell.
fn points(grid: &Grid, start: &[u32], slabs: &[usize]) -> Vec<Range<usize>> {
    let cells = grid.count[1] * grid.count[2];
    let at = |slab: usize| start[slab * cells] as usize;
    let mut found: Vec<Range<usize>> = Vec::new();
    for &slab in slabs {
        let range = at(slab)..at(slab + 1);
        match found.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => found.push(range),
        }
    }
    found
}

/// Ghosts, then images, get what they are copies of, where there are any; `meanwhile` writes
/// records of [`Halo::inner`].
pub fn complete(
    records: &mut Records,
    (ranks, halo): (Option<&Ranks>, &Halo),
    mirror: Option<&Mirror>,
    meanwhile: impl FnMut(&mut [Record]),
) {
    if let Some(ranks) = ranks {
        halo.fill_records(ranks, records, false, meanwhile);
    }
    if let Some(mirror) = mirror {
        mirror.copy(records);
    }
}

impl Halo {
    /// Finds the ghosts within `reach` m of the slabs of each rank. `liquid` and `wall`: cells of
    /// this rank's particles, and of the walls that it has.
    pub fn find(&mut self, ranks: &Ranks, grid: &Grid, liquid: &Cells, wall: &Cells, reach: f64) {
        let far = (reach / grid.edge[0]).ceil() as usize;
        let own = ranks.rank();
        let n = liquid.order.len();
        self.first = n + wall.order.len();
        let needs = |rank: usize| beside(ranks, grid, rank, far);
        let shared = |of: usize, needed: &[usize]| -> Vec<usize> {
            let range = ranks.slabs(of);
            let is = |slab: &usize| range.contains(slab);
            needed.iter().copied().filter(is).collect()
        };
        let of_wall = |slabs: &[usize]| {
            let ranges = points(grid, &wall.start, slabs).into_iter();
            ranges.map(|range| n + range.start..n + range.end).collect()
        };
        self.to.clear();
        let mut out = Vec::new();
        for rank in 0..ranks.size() {
            // Its own slabs are none that it needs.
            let mine = shared(own, &needs(rank));
            self.to.push(Share {
                liquid: points(grid, &liquid.start, &mine),
                wall: of_wall(&mine),
            });
            let count = |cell: usize| liquid.start[cell + 1] - liquid.start[cell];
            let counts: Vec<u32> = cells_of(grid, &mine).map(count).collect();
            out.push(super::encoded(&counts));
        }
        self.inner = inner(&self.to, n);
        let counted = ranks.trade(out);
        let needed = needs(own);
        self.start.clear();
        self.start.resize(grid.cells() + 1, 0);
        self.from.clear();
        let mut next = self.first;
        for (rank, bytes) in counted.iter().enumerate() {
            let theirs = shared(rank, &needed);
            let counts: Vec<u32> = super::decoded(bytes);
            let first = next;
            for (cell, count) in cells_of(grid, &theirs).zip(counts) {
                self.start[cell + 1] = count;
                next += count as usize;
            }
            let ghosts = first..next;
            self.from.push(Share {
                liquid: vec![ghosts],
                wall: of_wall(&theirs),
            });
        }
        for cell in 1..self.start.len() {
            self.start[cell] += self.start[cell - 1];
        }
    }

    /// How many ghosts there are.
    pub fn len(&self) -> usize {
        self.start.last().map_or(0, |&last| last as usize)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The ghosts as a source.
    pub fn source(&self) -> Source<'_> {
        Source {
            start: &self.start,
            offset: self.first,
        }
    }

    /// Own particles that no other rank needs, and whose sums need none of another rank.
    pub fn inner(&self) -> Range<usize> {
        self.inner.clone()
    }

    /// Ghosts and walls of other ranks get what those have; `points` of this rank.
    pub fn fill<T: Carried>(&self, ranks: &Ranks, points: &mut [T]) {
        let copying = Copying {
            walls_alone: false,
            give: |points: &[T], i: usize| points[i],
            take: |points: &mut [T], i: usize, value| points[i] = value,
        };
        self.copy(ranks, points, &copying, |_| ());
    }

    /// The same of three numbers of each point.
    pub fn fill_three<T: Carried>(&self, ranks: &Ranks, points: &mut [Vec<T>; 3]) {
        let copying = Copying {
            walls_alone: false,
            give: |points: &[Vec<T>; 3], i: usize| points.each_ref().map(|points| points[i]),
            take: |points: &mut [Vec<T>; 3], i: usize, values: [T; 3]| {
                let pairs = points.iter_mut().zip(values);
                pairs.for_each(|(points, value)| points[i] = value);
            },
        };
        self.copy(ranks, points, &copying, |_| ());
    }

    /// Records of `n` own particles and of the ghosts in the order of all; `slab`: the first own
    /// one.
    pub fn in_order(&self, n: usize, slab: usize, grid: &Grid) -> Vec<u32> {
        let before = self.start[slab * grid.count[1] * grid.count[2]];
        let first = self.first as u32;
        let ghosts = first..first + self.len() as u32;
        (first..first + before)
            .chain(0..n as u32)
            .chain(first + before..ghosts.end)
            .collect()
    }

    /// Positions of own particles, which are at `own`, m, and of ghosts in the order of all, and
    /// their records.
    pub fn with_ghosts(
        &self,
        ranks: &Ranks,
        grid: &Grid,
        own: &[Vec<f64>; 3],
    ) -> ([Vec<f64>; 3], Vec<u32>) {
        let slab = ranks.slabs(ranks.rank()).start;
        let index = self.in_order(own[0].len(), slab, grid);
        let mut all = own.each_ref().map(|own| {
            let mut points = own.clone();
            points.resize(self.first + self.len(), 0.0);
            points
        });
        self.fill_three(ranks, &mut all);
        let in_order = |points: Vec<f64>| index.iter().map(|&i| points[i as usize]).collect();
        (all.map(in_order), index)
    }

    /// [`Halo::fill`] of records, of those of walls or of all; `meanwhile` writes records of
    /// [`Halo::inner`].
    pub fn fill_records(
        &self,
        ranks: &Ranks,
        records: &mut Records,
        walls_alone: bool,
        meanwhile: impl FnMut(&mut [Record]),
    ) {
        let copying = Copying {
            walls_alone,
            give: |records: &[Record], i: usize| records[i].0,
            take: |records: &mut [Record], i: usize, words| records[i] = Record(words),
        };
        self.copy(ranks, records.all(), &copying, meanwhile);
    }

    /// Gives points what those of other ranks have; `meanwhile` goes on until it has come.
    pub fn copy<P: ?Sized, W: Carried>(
        &self,
        ranks: &Ranks,
        points: &mut P,
        copying: &Copying<impl Fn(&P, usize) -> W, impl Fn(&mut P, usize, W)>,
        mut meanwhile: impl FnMut(&mut P),
    ) {
        let Copying { give, take, .. } = copying;
        let alone = copying.walls_alone;
        let filled = |shares: &[Share]| -> Vec<(usize, usize)> {
            let counts = shares.iter().map(|share| share.points(alone).count());
            counts.enumerate().filter(|(_, count)| *count > 0).collect()
        };
        let values = |share: &Share, count| -> Vec<W> {
            let first = share.points(alone).take(count);
            first.map(|point| give(points, point)).collect()
        };
        let to = filled(&self.to).into_iter();
        let sent: Vec<(usize, Vec<u8>)> = to
            .map(|(rank, count)| (rank, super::encoded(&values(&self.to[rank], count))))
            .collect();
        // All values are of one length.
        let length = |&(rank, count): &(usize, usize)| {
            let [none, one] = [0, 1].map(|k| super::encoded(&values(&self.from[rank], k)).len());
            (rank, Some(none + count * (one - none)))
        };
        let wanted: Vec<(usize, Option<usize>)> = filled(&self.from).iter().map(length).collect();
        let work = &mut || meanwhile(points);
        let all = ranks.with.exchange_while(&sent, &wanted, work);
        for (bytes, (rank, _)) in all.iter().zip(&wanted) {
            let mut values = super::decoded::<Vec<W>>(bytes).into_iter();
            for point in self.from[*rank].points(alone) {
                take(
                    points,
                    point,
                    values.next().expect("a value of every point"),
                );
            }
        }
    }

    /// What every rank says of the cells in its slabs.
    pub fn join_cells<T: Carried>(&self, ranks: &Ranks, grid: &Grid, cells: &mut [T]) {
        let slab = grid.count[1] * grid.count[2];
        let of = |rank: usize| {
            let slabs = ranks.slabs(rank);
            slabs.start * slab..slabs.end * slab
        };
        let all = ranks.gather(&cells[of(ranks.rank())].to_vec());
        for (rank, values) in all.into_iter().enumerate() {
            cells[of(rank)].copy_from_slice(&values);
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        4 * self.start.capacity()
    }
}
