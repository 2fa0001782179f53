//! Connected components of cells: bodies that no pair of particles connects.
//!
//! Filled cells of a column along z that lie within reach of each other are a run; runs of near
//! columns are joined where their ends come within reach (run-based labelling of connected
//! components: He, Chao & Suzuki 2008, IEEE Trans. Image Process. 17, 749-756). z runs fastest in
//! the order of cells, so that a run is one range of particles.
//! Tests: tests/engine/space_component.rs.

use super::grid::Grid;
use std::ops::Range;

/// See the [module](self). Keeps its memory from one [`Components::find`] to the next.
#[derive(Clone, Debug, Default)]
pub struct Components {
    /// First and last cell along z, and the cell where the column begins.
    runs: Vec<[u32; 3]>,
    /// First run of each column, and the number of all.
    first: Vec<u32>,
    /// A run of the same component with a lower index, or itself.
    parent: Vec<u32>,
}

impl Components {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        12 * self.runs.capacity() + 4 * (self.first.capacity() + self.parent.capacity())
    }

    /// Finds the components of all cells that hold particles. Particles up to `reach` m apart are
    /// connected.
    pub fn find(&mut self, grid: &Grid, reach: f64, is_filled: impl Fn(usize) -> bool) {
        let within = |a: usize| ((reach / grid.edge[a]).ceil() as usize).min(grid.count[a] - 1);
        let reach = [0, 1, 2].map(within);
        self.cut(grid, reach[2], is_filled);
        self.parent.clear();
        self.parent.extend(0..self.runs.len() as u32);
        let [nx, ny, _] = grid.count;
        for x in 0..nx {
            for y in 0..ny {
                let here = x * ny + y;
                if self.first[here] == self.first[here + 1] {
                    continue;
                }
                // Half of the columns about: the others come to this one.
                for right in 0..=reach[0] {
                    let Some(x) = beyond(grid, 0, x, right as i64) else {
                        continue;
                    };
                    let back = if right == 0 { 0 } else { reach[1] as i64 };
                    for up in -back..=reach[1] as i64 {
                        if let Some(y) = beyond(grid, 1, y, up) {
                            self.join([here, x * ny + y], grid, reach[2]);
                        }
                    }
                }
            }
        }
    }

    /// Cuts the columns into runs.
    fn cut(&mut self, grid: &Grid, reach: usize, is_filled: impl Fn(usize) -> bool) {
        let depth = grid.count[2];
        let columns = grid.cells() / depth;
        self.runs.clear();
        self.first.clear();
        for column in 0..columns {
            let first = self.runs.len();
            self.first.push(first as u32);
            let bottom = column * depth;
            for z in (0..depth).filter(|z| is_filled(bottom + z)) {
                match self.runs[first..].last_mut() {
                    Some(run) if z <= run[1] as usize + reach => run[1] = z as u32,
                    _ => self.runs.push([z as u32, z as u32, bottom as u32]),
                }
            }
        }
        self.first.push(self.runs.len() as u32);
    }

    /// Joins the runs of two columns that come within `reach` cells of each other.
    fn join(&mut self, columns: [usize; 2], grid: &Grid, reach: usize) {
        let [these, those] = columns.map(|c| self.first[c]..self.first[c + 1]);
        let turn = if grid.periodic[2] { grid.count[2] } else { 0 };
        for a in these {
            for b in those.clone() {
                let ([low, high, _], [start, end, _]) =
                    (self.runs[a as usize], self.runs[b as usize]);
                let near = |turn: i64| {
                    start as i64 + turn <= high as i64 + reach as i64
                        && low as i64 <= end as i64 + turn + reach as i64
                };
                if near(0) || turn > 0 && (near(turn as i64) || near(-(turn as i64))) {
                    let (a, b) = (self.root(a), self.root(b));
                    self.parent[a.max(b) as usize] = a.min(b);
                }
            }
        }
    }

    /// The least run of the component of `run`; shortens the way to it.
    fn root(&mut self, mut run: u32) -> u32 {
        while self.parent[run as usize] != run {
            let above = self.parent[self.parent[run as usize] as usize];
            self.parent[run as usize] = above;
            run = above;
        }
        run
    }

    /// The component of every run, by its number, below the number of runs; and its cells.
    pub fn runs(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        self.runs.iter().enumerate().map(|(run, cells)| {
            let mut root = run;
            while self.parent[root] as usize != root {
                root = self.parent[root] as usize;
            }
            let [low, high, bottom] = cells.map(|c| c as usize);
            (root, bottom + low..bottom + high + 1)
        })
    }

    /// The number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there are no runs.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }
}

/// The cell `away` cells on along an axis, if there is one.
fn beyond(grid: &Grid, axis: usize, at: usize, away: i64) -> Option<usize> {
    let to = at as i64 + away;
    match grid.periodic[axis] {
        true => Some(grid.bring(axis, to)),
        false => (0..grid.count[axis] as i64)
            .contains(&to)
            .then_some(to as usize),
    }
}
