//! Particles along cells: a stable counting sort.

use super::grid::Grid;
use super::parallel::each_mut;
use super::room::{make_room, resize};

/// Particles counted into cells.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// First particle of each cell; `start[cells]` is the number of particles.
    pub start: Vec<u32>,
    key: Vec<u32>,
    /// `order[new] = old` of the last sort.
    pub order: Vec<u32>,
}

impl Cells {
    /// Counts `position` into cells and finds the order along them (ties keep their order).
    pub fn sort(&mut self, grid: &Grid, position: &[Vec<f64>; 3]) {
        let n = position[0].len();
        resize(&mut self.key, n, 0);
        resize(&mut self.order, n, 0);
        self.start.clear();
        self.start.resize(grid.cells() + 1, 0);
        each_mut(&mut self.key[..n], |i, key| {
            let cell = grid.cell([position[0][i], position[1][i], position[2][i]]);
            *key = grid.index(cell) as u32;
        });
        for &key in &self.key {
            self.start[key as usize + 1] += 1;
        }
        for c in 1..self.start.len() {
            self.start[c] += self.start[c - 1];
        }
        // `start[c]` moves on to the end of cell c while filling; shift it back afterwards.
        for i in 0..n {
            let slot = &mut self.start[self.key[i] as usize];
            self.order[*slot as usize] = i as u32;
            *slot += 1;
        }
        for c in (1..self.start.len()).rev() {
            self.start[c] = self.start[c - 1];
        }
        self.start[0] = 0;
    }

    /// Puts `data` into the order of the last sort; `scratch` is swapped with it.
    pub fn permute<T: Copy + Send + Sync>(&self, data: &mut Vec<T>, scratch: &mut Vec<T>) {
        scratch.clear();
        let Some(&first) = data.first() else {
            return;
        };
        make_room(scratch, self.order.len());
        scratch.resize(self.order.len(), first);
        each_mut(&mut scratch[..], |i, item| {
            *item = data[self.order[i] as usize]
        });
        std::mem::swap(data, scratch);
    }
}
