//! Writing of the records.

use super::{Flow, PART};
use crate::particle::{Particles, Wall};
use crate::space::grid::Grid;
use crate::space::lane::{Record, WIDTH};
use crate::space::parallel::each_mut;
use rayon::prelude::*;

impl Flow {
    /// Writes all records: current positions, payloads by liquid index and by wall index. The
    /// first three payloads are a vector: images turn it.
    pub fn pack(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> [f32; 5] + Sync,
        wall: impl Fn(&Wall, usize) -> [f32; 5] + Sync,
    ) {
        self.write(liquid, wall, true);
    }

    /// The same for payloads without a vector.
    pub fn pack_scalars(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> [f32; 5] + Sync,
        wall: impl Fn(&Wall, usize) -> [f32; 5] + Sync,
    ) {
        self.write(liquid, wall, false);
    }

    fn write(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> [f32; 5] + Sync,
        wall: impl Fn(&Wall, usize) -> [f32; 5] + Sync,
        is_vector: bool,
    ) {
        let (n, m) = (self.liquid(), self.walls());
        let count = n + m + self.images() + WIDTH;
        self.records.resize(count, Record::default());
        let (p, w) = (&self.particles, &self.wall);
        let (own, rest) = self.records.split_at_mut(n);
        write(&self.grid, &p.position, own, |i| liquid(p, i));
        write(&self.grid, &w.position, &mut rest[..m], |i| wall(w, i));
        if let Some(mirror) = &self.mirror {
            mirror.copy(&mut self.records, is_vector);
        }
    }

    /// [`Flow::pack`] when nothing has moved since.
    pub fn repack(
        &mut self,
        liquid: impl Fn(&Particles, usize) -> [f32; 5] + Sync,
        wall: impl Fn(&Wall, usize) -> [f32; 5] + Sync,
    ) {
        let (n, p, w) = (self.liquid(), &self.particles, &self.wall);
        let (of_liquid, others) = self.records.split_at_mut(n);
        let of_wall = &mut others[..w.position[0].len()];
        each_mut(of_liquid, |i, record| record.carry(liquid(p, i)));
        each_mut(of_wall, |i, record| record.carry(wall(w, i)));
        if let Some(mirror) = &self.mirror {
            mirror.copy(&mut self.records, true);
        }
    }

    /// Rewrites the payloads of the wall records, vectors first.
    pub fn pack_wall(&mut self, wall: impl Fn(usize) -> [f32; 5] + Sync) {
        let n = self.liquid();
        let of_wall = n..n + self.wall.position[0].len();
        each_mut(&mut self.records[of_wall], |i, record| {
            record.carry(wall(i))
        });
        if let Some(mirror) = &self.mirror {
            mirror.copy_wall(&mut self.records);
        }
    }
}

/// Writes records of the points at `position`, m.
fn write(
    grid: &Grid,
    position: &[Vec<f64>; 3],
    records: &mut [Record],
    payload: impl Fn(usize) -> [f32; 5] + Sync,
) {
    let parts = records.par_chunks_mut(PART).enumerate();
    parts.for_each(|(part, records)| {
        let from = part * PART;
        let mut at = [[0; PART]; 3];
        for (a, at) in at.iter_mut().enumerate() {
            let x = &position[a][from..from + records.len()];
            grid.fix_all(a, x, at);
        }
        for (k, record) in records.iter_mut().enumerate() {
            let at = [at[0][k], at[1][k], at[2][k]];
            *record = Record::new(at, payload(from + k));
        }
    });
}
