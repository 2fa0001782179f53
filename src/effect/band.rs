//! The particles near a surface, found by whole cells: what a long kernel has to look at.

use crate::space::dilate::dilate;
use crate::space::grid::Grid;
use crate::space::parallel::each_mut;
use crate::space::sort::Cells;

/// Marked cells of a grid.
#[derive(Clone, Debug, Default)]
pub struct Band {
    mark: Vec<bool>,
    scratch: Vec<bool>,
}

impl Band {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.mark.capacity() + self.scratch.capacity()
    }

    /// Marks the cells that hold a particle for which `is` holds.
    pub fn mark(&mut self, cells: &Cells, is: impl Fn(usize) -> bool + Sync) {
        self.mark_runs(&cells.start, is);
    }

    /// The same for particles of which `start` has the first of each cell, and the number of all.
    pub fn mark_runs(&mut self, start: &[u32], is: impl Fn(usize) -> bool + Sync) {
        let n = start.len() - 1;
        self.mark.resize(n, false);
        each_mut(&mut self.mark[..n], |cell, mark| {
            let mut run = start[cell] as usize..start[cell + 1] as usize;
            *mark = run.any(&is);
        });
    }

    /// The marks, for what joins those of several ranks.
    pub fn marks(&mut self) -> &mut [bool] {
        &mut self.mark
    }

    /// Marks the cells that hold anything; `start`: first of each cell, and the number of all.
    pub fn mark_filled(&mut self, start: &[u32]) {
        self.mark.clear();
        self.mark.extend(start.windows(2).map(|w| w[1] > w[0]));
    }

    /// Marks every cell within `reach` m of a marked one, axis by axis.
    pub fn grow(&mut self, grid: &Grid, reach: f64) {
        dilate(&mut self.mark, &mut self.scratch, grid, reach);
    }

    /// Whether each particle is in a marked cell.
    pub fn flags(&self, cells: &Cells, flags: &mut Vec<bool>) {
        let (mark, start) = (&self.mark, &cells.start);
        flags.resize(start[mark.len()] as usize, false);
        // Along the cells, as the particles are.
        each_mut(&mut flags[..], |i, flag| {
            let cell = start.partition_point(|first| *first as usize <= i) - 1;
            *flag = mark[cell];
        });
    }

    /// The particles of marked cells, those of a block of cells together.
    pub fn members(&self, grid: &Grid, cells: &Cells, members: &mut Vec<u32>) {
        self.members_of(grid, &cells.start, members);
    }

    /// The same for particles of which `start` has the first of each cell, and the number of all.
    pub fn members_of(&self, grid: &Grid, start: &[u32], members: &mut Vec<u32>) {
        members.clear();
        grid.blocks(|cell| {
            if self.mark[cell] {
                members.extend(start[cell]..start[cell + 1]);
            }
        });
    }
}
