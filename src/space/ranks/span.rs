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
}

impl From<usize> for Span {
    fn from(count: usize) -> Self {
        Span {
            own: 0..count,
            shared: None,
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
        }
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
        let all = |(_, starts): &Shared| starts.last().copied().unwrap_or(0);
        self.shared.as_ref().map_or(self.len(), all)
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

    /// The items of this rank in each chunk of `size` of the order of all; the first and the last
    /// may be parts of one.
    pub fn chunks(&self, size: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let (first, own) = (self.first(), self.own.clone());
        let count = match own.is_empty() {
            true => 0,
            false => (first + own.len()).div_ceil(size) - first / size,
        };
        (0..count).map(move |k| {
            let from = ((first / size + k) * size).max(first) - first;
            let to = ((first / size + k + 1) * size - first).min(own.len());
            own.start + from..own.start + to
        })
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
        let add = |mut a: [f64; K], b: &[f64]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let begin = self.own.start;
        let fold = |chunk: Range<usize>, sum: [f64; K]| {
            let values = &values[chunk.start - begin..chunk.end - begin];
            values.iter().fold(sum, |sum, value| add(sum, value))
        };
        let mut chunks: Vec<Range<usize>> = self.chunks(size).collect();
        let Some((with, starts)) = &self.shared else {
            let parts = chunks.into_iter().map(|chunk| fold(chunk, [0.0; K]));
            return parts.fold([0.0; K], |sum, part| add(sum, &part));
        };
        let (rank, first) = (with.rank(), self.first());
        let (end, last) = (first + self.len(), starts[with.size()]);
        let has_items = |r: &usize| starts[r + 1] > starts[*r];
        let before = (0..rank).rev().find(has_items);
        let after = (rank + 1..with.size()).find(has_items);
        let from = before.filter(|_| !self.is_empty() && !first.is_multiple_of(size));
        let to = after.filter(|_| !self.is_empty() && !end.is_multiple_of(size) && end < last);
        // The first chunk goes on from another rank, the last one may go on on another.
        let mut done: Vec<Vec<f64>> = Vec::new();
        let open = chunks.pop();
        let mut begun = from.map_or([0.0; K], |from| received(&**with, from));
        for chunk in chunks {
            done.push(fold(chunk, begun).to_vec());
            begun = [0.0; K];
        }
        let open = open.map(|chunk| fold(chunk, begun).to_vec());
        match (open, to) {
            (Some(sum), Some(to)) => {
                with.exchange(&[(to, encoded(&sum))], &[]);
            }
            (sum, _) => done.extend(sum),
        }
        let all = gather(&**with, &done);
        all.iter()
            .flatten()
            .fold([0.0; K], |sum, part| add(sum, part))
    }
}

fn received<const K: usize>(with: &dyn Communicator, from: usize) -> [f64; K] {
    let sum: Vec<f64> = decoded(&with.exchange(&[], &[from])[0]);
    sum.try_into().expect("all ranks run the same program")
}
