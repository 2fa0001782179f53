//! [`runs`] over targets of which other ranks have more, with the sums of one process.
//!
//! Targets that lie together look at the same candidates, and what is rounded depends on who looks
//! together. Where a block of targets goes on from one rank to the next, both sum over all of it,
//! and each keeps the sums of its own.

use super::block::{Block, MEMBERS};
use super::{Field, Pair, Pass, runs};
use crate::space::column::Columns;
use crate::space::grid::WIDE;
use crate::space::lane::Real;
use crate::space::ranks::span::Span;
use crate::space::ranks::{decoded, encoded, gather};
use crate::space::row::CHUNK;
use serde::{Deserialize, Serialize};

/// A target of another rank.
#[derive(Clone, Serialize, Deserialize)]
struct Guest {
    /// m.
    at: [f64; 3],
    /// What it carries, and what the pass knows of it.
    own: Vec<f32>,
    extra: [f32; 3],
}

impl Guest {
    fn of<const N: usize, const O: usize>(
        position: &[Vec<f64>; 3],
        own: &[Vec<f32>; O],
        pass: &impl Pass<N>,
        i: u32,
    ) -> Self {
        let extra = pass.extra(i as usize);
        let i = i as usize;
        Guest {
            at: [0, 1, 2].map(|a| position[a][i]),
            own: own.iter().map(|words| words[i]).collect(),
            extra,
        }
    }
}

/// Targets with guests behind them.
struct Hosts<const O: usize> {
    /// m.
    position: [Vec<f64>; 3],
    /// What they carry.
    own: [Vec<f32>; O],
    /// Target of the first guest.
    first: usize,
    /// Of the guests.
    extras: Vec<[f32; 3]>,
}

impl<const O: usize> Hosts<O> {
    fn of<const W: usize>(field: &Field<W, O>) -> Self {
        let (position, own) = (field.position.clone(), field.own.clone());
        // Words may be longer than positions: they are of all points.
        let first = position[0].len().max(own.first().map_or(0, Vec::len));
        let extras = Vec::new();
        Hosts {
            position,
            own,
            first,
            extras,
        }
    }

    /// Adds guests; their targets.
    fn add(&mut self, guests: &[Guest]) -> Vec<u32> {
        let mut index = Vec::new();
        for guest in guests {
            let place = self.first + self.extras.len();
            self.extras.push(guest.extra);
            for (x, at) in self.position.iter_mut().zip(guest.at) {
                x.resize(place, 0.0);
                x.push(at);
            }
            for (words, word) in self.own.iter_mut().zip(&guest.own) {
                words.resize(place, 0.0);
                words.push(*word);
            }
            index.push(place as u32);
        }
        index
    }
}

/// A pass that knows of guests what their rank knows; `first`: target of the first one.
struct Hosting<'a, P> {
    pass: &'a P,
    first: usize,
    extras: &'a [[f32; 3]],
}

impl<'a, P> Hosting<'a, P> {
    /// Without guests: the same code for a rank and for one process.
    fn alone(pass: &'a P) -> Self {
        Hosting {
            pass,
            first: usize::MAX,
            extras: &[],
        }
    }
}

impl<const N: usize, P: Pass<N>> Pass<N> for Hosting<'_, P> {
    type Payload = P::Payload;
    type Out = P::Out;
    const SKIPS_ZEROS: bool = P::SKIPS_ZEROS;
    #[inline(always)]
    fn own(&self, target: usize, payload: P::Payload) -> P::Payload {
        self.pass.own(target, payload)
    }
    #[inline(always)]
    fn extra(&self, target: usize) -> [f32; 3] {
        match target.checked_sub(self.first) {
            None => self.pass.extra(target),
            Some(guest) => self.extras[guest],
        }
    }
    #[inline(always)]
    fn weigh<F: Real>(&self, q2: F) -> [F; 2] {
        self.pass.weigh(q2)
    }
    #[inline(always)]
    fn pair<F: Real>(&self, pair: &Pair<F, P::Payload>, sum: &mut [F; N]) {
        self.pass.pair(pair, sum)
    }
    #[inline(always)]
    fn finish(&self, target: usize, sum: [f32; N], out: &mut P::Out) {
        self.pass.finish(target, sum, out)
    }
}

/// [`runs`]; `span`: `targets` in the list of all ranks. A pass must ask for nothing of a target
/// but what it carries, except for [`Pass::extra`].
pub fn runs_shared<const N: usize, const W: usize, const O: usize, P: Pass<N>>(
    field: Field<W, O>,
    span: &Span,
    targets: &[u32],
    pass: &P,
    out: &mut [P::Out],
) where
    P::Out: Copy + Default,
{
    let Some(with) = span.ranks() else {
        return runs(field, targets, &Hosting::alone(pass), out);
    };
    // What may go on in the last block of this rank.
    let heads = targets.iter().take(MEMBERS - 1);
    let heads: Vec<Guest> = heads
        .map(|&i| Guest::of(field.position, field.own, pass, i))
        .collect();
    let heads = gather(with, &heads).into_iter().skip(with.rank() + 1);
    let after: Vec<Guest> = heads.flatten().take(MEMBERS - 1).collect();
    let columns = Columns::new(field.grid, field.cutoff, WIDE);
    // The block that lower ranks have begun.
    let before: Vec<Guest> = match with.rank() {
        0 => Vec::new(),
        rank => decoded(&with.exchange(&[], &[rank - 1])[0]),
    };
    let mut hosts = Hosts::of(&field);
    let mut all = hosts.add(&before);
    all.extend_from_slice(targets);
    let first = span.first() - before.len();
    let last = hosts.add(&after);
    let Hosts {
        position,
        own,
        first: guests,
        extras,
    } = &hosts;
    let hosting = Hosting {
        pass,
        first: *guests,
        extras,
    };
    if with.rank() + 1 < with.size() {
        let count = begun(position, &columns, &all, first);
        let open = all[all.len() - count..].iter();
        let of = |&i: &u32| Guest::of(position, own, &hosting, i);
        let guests: Vec<Guest> = open.map(of).collect();
        with.exchange(&[(with.rank() + 1, encoded(&guests))], &[]);
    }
    all.extend(last);
    let mut sums = vec![P::Out::default(); all.len()];
    let field = Field {
        position,
        own,
        first,
        ..field
    };
    runs(field, &all, &hosting, &mut sums);
    let kept = &sums[before.len()..];
    out.copy_from_slice(&kept[..targets.len()]);
}

/// How many of the last targets are in a block to which others may be added; `first`: place of the
/// first target in the list of all.
fn begun(position: &[Vec<f64>; 3], columns: &Columns, all: &[u32], first: usize) -> usize {
    let end = first + all.len();
    if end.is_multiple_of(CHUNK) {
        return 0;
    }
    let mut begin = (end / CHUNK * CHUNK).max(first) - first;
    while begin < all.len() {
        let (block, _) = Block::of(position, columns, &all[begin..]);
        if begin + block.count == all.len() {
            return match block.count < MEMBERS {
                true => block.count,
                false => 0,
            };
        }
        begin += block.count;
    }
    0
}
