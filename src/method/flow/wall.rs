//! No particle gets through a wall or a mirror plane; which walls there are.

use super::Flow;
use crate::particle::Wall;
use crate::scene::Side;
use crate::space::grid::Grid;
use crate::space::parallel::each_mut;
use crate::space::ranks::halo::beside;
use crate::space::sort::Cells;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// How deep in a wall a particle may be, in spacings: there is the wall's first layer.
const BEHIND: f64 = 0.5;

/// Walls along cells.
pub(super) fn sorted(grid: &Grid, mut wall: Wall) -> (Wall, Cells) {
    let mut cells = Cells::default();
    cells.sort(grid, &wall.position);
    let mut scratch = Vec::new();
    for a in 0..3 {
        cells.permute(&mut wall.position[a], &mut scratch);
        cells.permute(&mut wall.velocity[a], &mut scratch);
    }
    if !wall.weight.is_empty() {
        cells.permute(&mut wall.weight, &mut scratch);
    }
    (wall, cells)
}

impl Flow {
    /// Whether there are walls, on this rank or another.
    pub fn has_walls(&self) -> bool {
        match &self.ranks {
            None => self.walls() > 0,
            Some(ranks) => ranks.has_walls(),
        }
    }

    /// Whether a cell has walls, on whichever rank.
    pub fn is_walled(&self, cell: usize) -> bool {
        match &self.ranks {
            None => self.wall_cells.start[cell] < self.wall_cells.start[cell + 1],
            Some(_) => self.walled[cell],
        }
    }

    /// Of several ranks: takes the walls in and about the slabs of this one. What else is known of
    /// walls is of no use then.
    pub(super) fn take_walls(&mut self) {
        let far = (self.farthest_pair() / self.grid.edge[0]).ceil() as usize;
        let within = self.slabs_of_liquid();
        let Some(ranks) = &mut self.ranks else {
            return;
        };
        let (grid, rank) = (&self.grid, ranks.rank());
        let mut wanted = vec![false; grid.count[0]];
        let slabs = beside(ranks, grid, rank, far).into_iter();
        slabs
            .chain(ranks.slabs(rank))
            .for_each(|slab| wanted[slab] = true);
        // Layers behind each other stay together.
        for layers in [0..*within.start(), *within.end()..grid.count[0]] {
            let any = wanted[layers.clone()].contains(&true);
            wanted[layers].fill(any);
        }
        let wall = (self.build_walls)(&|x| wanted[grid.cell([x, 0.0, 0.0])[0]]);
        (self.wall, self.wall_cells) = sorted(grid, wall);
        ranks.count_walls(grid, &self.wall_cells.start);
        let filled = self.wall_cells.start.windows(2);
        self.walled = filled.map(|cell| cell[0] < cell[1]).collect();
        self.halo.join_cells(ranks, grid, &mut self.walled);
        self.wall_changes += 1;
    }

    /// What is deeper than [`BEHIND`] in a wall, where its layers push every way and not only
    /// out, comes back to there and keeps the velocity along it: what is shot at the wall, and lone
    /// particles on a wall that attracts liquid. Not farther back: a surface costs less in a wall
    /// that counts as liquid, so that they would fall again, for ever. Returns whether any did.
    pub(super) fn hold_back(&mut self) -> bool {
        let (domain, n) = (&self.domain, self.particles.len());
        let deep = BEHIND * self.lengths.spacing;
        let any = AtomicBool::new(false);
        let p = &mut self.particles;
        for a in (0..3).filter(|&a| domain.boundary[a].contains(&Side::Wall)) {
            let [low, high] = domain.boundary[a].map(|side| side == Side::Wall);
            let size = domain.size[a];
            let both = (&mut p.position[a][..n], &mut p.velocity[a][..n]);
            each_mut(both, |_, (x, v)| {
                if low && *x < -deep {
                    (*x, *v) = (-deep, v.max(0.0));
                    any.store(true, Relaxed);
                } else if high && *x > size + deep {
                    (*x, *v) = (size + deep, v.min(0.0));
                    any.store(true, Relaxed);
                }
            });
        }
        any.into_inner()
    }

    /// Reflects what is beyond a mirror plane: places and velocities; lists what it was.
    pub(super) fn fold_back(&mut self) {
        self.reflected.clear();
        let Some(mirror) = &self.mirror else {
            return;
        };
        let p = &mut self.particles;
        for a in (0..3).filter(|&a| self.domain.fold(a).is_some()) {
            let both = p.position[a].iter_mut().zip(&mut p.velocity[a]);
            for (i, (x, v)) in both.enumerate() {
                if let Some(inside) = mirror.planes.back(a, *x) {
                    (*x, *v) = (inside, -*v);
                    self.reflected.push((i as u32, a as u8));
                }
            }
        }
    }
}
