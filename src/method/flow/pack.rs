//! Writing of the records.

use super::{Flow, PART};
use crate::particle::{Particles, Wall};
use crate::space::grid::Grid;
use crate::space::lane::{Record, WIDTH};
use crate::space::parallel::{Parts, each_mut, each_part};
use crate::space::ranks::halo::complete;
use crate::space::room::resize;
use crate::space::sweep::{Payload, words_of};
use std::ops::Range;

impl Flow {
    /// Writes all records: current positions, payloads by liquid index and by wall index.
    pub fn pack<P: Payload>(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> P + Sync,
        wall: impl Fn(&Wall, usize) -> P + Sync,
    ) {
        let (n, m) = (self.liquid(), self.walls());
        let count = n + m + self.others() + WIDTH;
        let inner = self.inner();
        let records = self.records.carry::<P>();
        resize(records, count, Record::default());
        let (p, w) = (&self.particles, &self.wall);
        let (own, rest) = records.split_at_mut(n);
        let liquid = |part: Range<usize>, own: &mut [Record]| {
            write(&self.grid, &p.position, (part, own), |i| liquid(p, i));
        };
        liquid(0..inner.start, own);
        liquid(inner.end..n, own);
        write(&self.grid, &w.position, (0..m, rest), |i| wall(w, i));
        let others = (self.ranks.as_ref(), &self.halo);
        complete(&mut self.records, others, self.mirror.as_ref(), |records| {
            liquid(inner.clone(), records);
        });
    }

    /// [`Flow::pack`] when nothing has moved since.
    pub fn repack<P: Payload>(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> P + Sync,
        wall: impl Fn(&Wall, usize) -> P + Sync,
    ) {
        let (n, p, w) = (self.liquid(), &self.particles, &self.wall);
        let inner = self.inner();
        let (own, others) = self.records.carry::<P>().split_at_mut(n);
        let liquid = |part: Range<usize>, own: &mut [Record]| {
            let first = part.start;
            each_mut(&mut own[part], |i, record| {
                record.carry(words_of(liquid(p, first + i)))
            });
        };
        liquid(0..inner.start, own);
        liquid(inner.end..n, own);
        let of_wall = &mut others[..w.position[0].len()];
        each_mut(of_wall, |i, record| record.carry(words_of(wall(w, i))));
        let others = (self.ranks.as_ref(), &self.halo);
        complete(&mut self.records, others, self.mirror.as_ref(), |records| {
            liquid(inner.clone(), records);
        });
    }

    /// Rewrites the payloads of the wall records.
    ///
    /// # Panics
    /// If the records were packed with another payload.
    pub fn pack_wall<P: Payload>(&mut self, wall: impl Fn(usize) -> P + Sync) {
        let n = self.liquid();
        let of_wall = n..n + self.wall.position[0].len();
        let records = &mut self.records.carrying::<P>()[of_wall];
        each_mut(records, |i, record| record.carry(words_of(wall(i))));
        if let Some(ranks) = &self.ranks {
            self.halo
                .fill_records(ranks, &mut self.records, true, |_| ());
        }
        if let Some(mirror) = &self.mirror {
            mirror.copy_wall(&mut self.records);
        }
    }
}

/// Writes records of a part of the points at `position`, m.
fn write<P: Payload>(
    grid: &Grid,
    position: &[Vec<f64>; 3],
    (points, records): (Range<usize>, &mut [Record]),
    payload: impl Fn(usize) -> P + Sync,
) {
    let first = points.start;
    each_part(Parts::of(&mut records[points], PART), |part, records| {
        let from = first + part * PART;
        let mut at = [[0; PART]; 3];
        for (a, at) in at.iter_mut().enumerate() {
            let x = &position[a][from..from + records.len()];
            grid.fix_all(a, x, at);
        }
        for (k, record) in records.iter_mut().enumerate() {
            let at = [at[0][k], at[1][k], at[2][k]];
            *record = Record::new(at, words_of(payload(from + k)));
        }
    });
}
