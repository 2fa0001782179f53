//! Items of which other ranks have more, and sums over all of them.

use super::{Communicator, decoded, encoded, gather, largest};
use std::ops::Range;
use std::sync::Arc;

/// The ranks, and the first item of each in the order of all, and their number.
type Shared = (Arc<dyn Communicator>, Arc<[usize]>);

/// A range of items. Made of a number, it is all that there is.
#[derive(Clone)]
pub struct Span {
    /// The items of this rank.
    pub own: Range<usize>,
    /// Of items that several ranks have.
    shared: Option<Shared>,
    /// First of each rank of items behind those of all ranks, and where in the room for them at the
    /// end of its own this rank's begin.
    behind: Option<(Arc<[usize]>, usize)>,
}

impl From<usize> for Span {
    fn from(count: usize) -> Self {
        Span {
            own: 0..count,
            shared: None,
            behind: None,
        }
    }
}

/// First item of each rank in the order of all, and their number, where this one has `count`.
pub fn starts(with: &dyn Communicator, count: usize) -> Arc<[usize]> {
    let mut sum = 0;
    let counts = gather(with, &(count as u64)).into_iter();
    let ends = counts.map(|count| {
        sum += count as usize;
        sum
    });
    std::iter::once(0).chain(ends).collect()
}

impl Span {
    /// Items of which every rank has those that `starts` says; those of this one begin at `begin`.
    pub fn shared(with: &Arc<dyn Communicator>, starts: &Arc<[usize]>, begin: usize) -> Self {
        let rank = with.rank();
        Span {
            own: begin..begin + starts[rank + 1] - starts[rank],
            shared: Some((with.clone(), starts.clone())),
            behind: None,
        }
    }

    /// With more items behind those of all ranks, of which every rank has those that `starts` says.
    /// It has `room` for some at the end of its own, counts those from `begin` on, and none of
    /// the others.
    pub fn with(mut self, starts: Arc<[usize]>, begin: usize, room: usize) -> Self {
        self.own.end += room;
        self.behind = Some((starts, begin));
        self
    }

    /// Of a list of which this rank has `count` items.
    pub fn of_list(with: &Arc<dyn Communicator>, count: usize) -> Self {
        Span::shared(with, &starts(&**with, count), 0)
    }

    /// How many items this rank has.
    pub fn len(&self) -> usize {
        self.own.len()
    }

    /// How many items all ranks have.
    pub fn total(&self) -> usize {
        let last = |starts: &Arc<[usize]>| starts.last().copied().unwrap_or(0);
        let all = self.shared.as_ref().map(|(_, starts)| last(starts));
        let behind = self.behind.as_ref().map(|(starts, _)| starts);
        all.map_or(self.len(), |all| all + behind.map_or(0, last))
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// Whether other ranks have more.
    pub fn is_shared(&self) -> bool {
        self.shared.is_some()
    }

    /// The ranks that have more, if there are any.
    pub fn ranks(&self) -> Option<&dyn Communicator> {
        let (with, _) = self.shared.as_ref()?;
        (with.size() > 1).then_some(&**with)
    }

    /// Place of this rank's first item in the order of all.
    pub fn first(&self) -> usize {
        let first = |(with, starts): &Shared| starts[with.rank()];
        self.shared.as_ref().map_or(0, first)
    }

    /// The largest of a number of each rank; NaN wins.
    pub fn max(&self, own: f64) -> f64 {
        match &self.shared {
            None => own,
            Some((with, _)) => largest(&**with, own),
        }
    }

    /// The sum over all ranks of what each of this rank's items has. Items are added one after the
    /// other in each chunk of `size`, whichever ranks have them, then the chunks.
    ///
    /// # Panics
    /// If there is not one value for every item.
    pub fn sum<const K: usize>(&self, size: usize, values: &[[f64; K]]) -> [f64; K] {
        assert_eq!(values.len(), self.len());
        let Some((with, starts)) = &self.shared else {
            let parts = chunks(0, values.len(), size).map(|chunk| fold([0.0; K], &values[chunk]));
            return parts.fold([0.0; K], |sum, part| fold(sum, &[part]));
        };
        let rank = with.rank();
        let own = starts[rank + 1] - starts[rank];
        let mut parts = chunk_sums(&**with, (starts, 0), size, (&values[..own], [0.0; K]));
        if let Some((behind, begin)) = self
            .behind
            .as_ref()
            .filter(|(behind, _)| behind[with.size()] > 0)
        {
            let before = starts[with.size()];
            let is_open = !before.is_multiple_of(size);
            let begun = parts.pop_if(|_| is_open).unwrap_or([0.0; K]);
            let first = own + begin;
            let values = &values[first..first + behind[rank + 1] - behind[rank]];
            parts.extend(chunk_sums(&**with, (behind, before), size, (values, begun)));
        }
        parts
            .into_iter()
            .fold([0.0; K], |sum, part| fold(sum, &[part]))
    }
}

/// Adds `values` to `sum`, one after the other.
fn fold<const K: usize>(sum: [f64; K], values: &[[f64; K]]) -> [f64; K] {
    values.iter().fold(sum, |mut sum, value| {
        sum.iter_mut().zip(value).for_each(|(a, b)| *a += b);
        sum
    })
}

/// `len` items cut at chunks of `size` of the order of all, where the first one is item `first`.
fn chunks(first: usize, len: usize, size: usize) -> impl Iterator<Item = Range<usize>> + use<> {
    let count = match len {
        0 => 0,
        _ => (first + len).div_ceil(size) - first / size,
    };
    (0..count).map(move |k| {
        let from = ((first / size + k) * size).max(first) - first;
        let to = ((first / size + k + 1) * size - first).min(len);
        from..to
    })
}

/// Sums over the chunks of items of which each rank has those that `starts` says, in the order of
/// all, where the first one is item `before`; `values`: of this rank's, and what the first chunk
/// has already.
fn chunk_sums<const K: usize>(
    with: &dyn Communicator,
    (starts, before): (&[usize], usize),
    size: usize,
    (values, begun): (&[[f64; K]], [f64; K]),
) -> Vec<[f64; K]> {
    let rank = with.rank();
    let at = |rank: usize| before + starts[rank];
    let (first, end, last) = (at(rank), at(rank + 1), at(with.size()));
    let has_items = |r: &usize| starts[r + 1] > starts[*r];
    let is_empty = !has_items(&rank);
    let earlier = (0..rank).rev().find(has_items);
    let later = (rank + 1..with.size()).find(has_items);
    let from = earlier.filter(|_| !is_empty && !first.is_multiple_of(size));
    let to = later.filter(|_| !is_empty && !end.is_multiple_of(size) && end < last);
    let mut chunks: Vec<Range<usize>> = chunks(first, values.len(), size).collect();
    // The first chunk goes on from another rank, the last one may go on on another: at once, if
    // they are not the same.
    let ahead = to.filter(|_| chunks.len() > 1).zip(chunks.last().cloned());
    let sent = ahead.map(|(to, chunk)| (to, encoded(&fold([0.0; K], &values[chunk]).to_vec())));
    chunks.truncate(chunks.len() - sent.iter().len());
    let come = with.exchange(sent.as_slice(), from.as_slice());
    let mut sum = match (come.first(), earlier) {
        (Some(bytes), _) => array(decoded(bytes)),
        (None, None) => begun,
        (None, Some(_)) => [0.0; K],
    };
    let mut done: Vec<Vec<f64>> = Vec::new();
    for chunk in chunks {
        done.push(fold(sum, &values[chunk]).to_vec());
        sum = [0.0; K];
    }
    if let (Some(to), None) = (to, sent) {
        let sum = done.pop().expect("this rank has items");
        with.exchange(&[(to, encoded(&sum))], &[]);
    }
    gather(with, &done)
        .into_iter()
        .flatten()
        .map(array)
        .collect()
}

fn array<const K: usize>(sum: Vec<f64>) -> [f64; K] {
    sum.try_into().expect("all ranks run the same program")
}
