//! No particle gets through a wall or a mirror plane; which walls there are.

use super::Flow;
use crate::particle::Wall;
use crate::scene::Side;
use crate::space::grid::Grid;
use crate::space::parallel::{each, each_mut, three};
use crate::space::ranks::halo::beside;
use crate::space::sort::Cells;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// How deep in a wall a particle may be, in spacings: where walls can attract liquid, up to their
/// first layer; where they cannot, no farther than they still push it out.
const ATTRACTED: f64 = 0.5;
const PUSHED: f64 = 0.25;

/// How deep in a wall a particle may be, m.
pub fn deepest(spacing: f64, has_tension: bool) -> f64 {
    spacing * if has_tension { ATTRACTED } else { PUSHED }
}

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

    /// What is deeper in a wall than [`Lengths::deepest`](super::Lengths::deepest), where its
    /// layers push every way and not only out, comes back to there and keeps the velocity along
    /// it: what is shot at the wall, and lone particles on a wall that attracts liquid. Not farther
    /// back: a surface costs less in a wall that counts as liquid, so that they would fall again,
    /// for ever. Beyond another wall too it comes back inside of that one, the farther the deeper
    /// it was: all that is pushed into a corner would come to one point, where particles do not see
    /// each other. Returns whether any did.
    pub(super) fn hold_back(&mut self) -> bool {
        let (domain, n) = (&self.domain, self.particles.len());
        let deep = self.lengths.deepest;
        let walls = domain
            .boundary
            .map(|sides| sides.map(|side| side == Side::Wall));
        let beyond = |a: usize, x: f64| {
            let [low, high] = walls[a];
            let low = if low { -x } else { f64::NEG_INFINITY };
            let high = if high {
                x - domain.size[a]
            } else {
                f64::NEG_INFINITY
            };
            low.max(high)
        };
        let any = AtomicBool::new(false);
        let p = &mut self.particles;
        for a in (0..3).filter(|&a| walls[a].contains(&true)) {
            let x = &p.position[a];
            each(n, |i| {
                if beyond(a, x[i]) > deep {
                    any.store(true, Relaxed);
                }
            });
        }
        if !any.load(Relaxed) {
            return false;
        }
        let all = (three(&mut p.position, n), three(&mut p.velocity, n));
        each_mut(all, |_, (x, v)| {
            let depth: [f64; 3] = std::array::from_fn(|a| beyond(a, *x[a]));
            let deepest = if depth[1] > depth[0] { 1 } else { 0 };
            let deepest = if depth[2] > depth[deepest] {
                2
            } else {
                deepest
            };
            if depth[deepest] <= deep {
                return;
            }
            for a in (0..3).filter(|a| depth[*a] > 0.0) {
                let (wall, out) = if *x[a] < 0.0 {
                    (0.0, -1.0)
                } else {
                    (domain.size[a], 1.0)
                };
                // Whatever its depth, it stays near, and apart from others.
                let inside = deep * depth[a] / (depth[a] + deep);
                *x[a] = wall + out * if a == deepest { deep } else { -inside };
                *v[a] = out * (out * *v[a]).min(0.0);
            }
        });
        true
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
