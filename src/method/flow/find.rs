//! Neighbours: how far rows reach, images, sources, rows.

use super::{Flow, HASTE, LEAST};
use crate::space::dilate::dilate;
use crate::space::mirror::Points;
use crate::space::parallel::each_mut;
use crate::space::room::{make_room, resize};
use crate::space::row::{Search, Source, Sources};

impl Flow {
    /// Where neighbours are: liquid, its images or ghosts, then walls if there are any, and their
    /// images.
    pub fn sources(&self) -> Sources<'_> {
        let liquid = Source {
            start: &self.liquid_cells.start,
            offset: 0,
        };
        let wall = Source {
            start: &self.wall_cells.start,
            offset: self.liquid(),
        };
        let kinds = 1 + usize::from(self.has_walls());
        let ghosts = self.halo.source();
        match (&self.mirror, &self.ranks) {
            (None, None) => Sources::of(&[liquid, wall][..kinds]),
            (None, Some(_)) => Sources::of(&[liquid, ghosts, wall][..1 + kinds]),
            (Some(mirror), ranks) => {
                let [images, walls] = mirror.sources();
                match ranks {
                    None => Sources::of(&[liquid, images, wall, walls][..2 * kinds]),
                    Some(_) => Sources::of(&[liquid, ghosts, images, wall, walls][..1 + 2 * kinds]),
                }
            }
        }
    }

    /// How many of them are liquid, its images and ghosts: the first.
    pub fn liquid_sources(&self) -> usize {
        1 + usize::from(self.mirror.is_some()) + usize::from(self.ranks.is_some())
    }

    /// Sets what each particle may move, and its reach: the support, that, and the most about it.
    fn allow(&mut self) -> f64 {
        let (n, support, late) = (self.liquid(), self.lengths.support, self.lengths.late);
        let equal = 0.5 * (self.slack * support + late);
        resize(&mut self.allowed, n, 0.0);
        self.reach.clear();
        if self.lasting == 0.0 {
            self.allowed.fill(equal as f32);
            return support * (1.0 + self.slack);
        }
        let (p, haste) = (&self.particles, HASTE * self.lasting);
        let (least, most) = (LEAST * equal, self.lengths.most(self.slack));
        each_mut(&mut self.allowed[..n], |i, allowed| {
            *allowed = (haste * p.speed(i)).max(least).min(most) as f32
        });
        let start = &self.liquid_cells.start;
        let (peaks, scratch) = (&mut self.scratch.peaks, &mut self.scratch.dilated);
        peaks.resize(start.len() - 1, 0.0);
        each_mut(&mut peaks[..start.len() - 1], |cell, peak| {
            let run = start[cell] as usize..start[cell + 1] as usize;
            let most = self.allowed[run].iter().fold(0.0, |m: f32, a| m.max(*a));
            *peak = most;
        });
        if let Some(ranks) = &self.ranks {
            self.halo.join_cells(ranks, &self.grid, peaks);
        }
        let longest = support - late + 2.0 * most;
        dilate(peaks, scratch, &self.grid, longest);
        resize(&mut self.reach, n + self.wall.position[0].len(), 0.0);
        let (grid, peaks, base) = (&self.grid, &self.scratch.peaks, (support - late) as f32);
        let allowed = &self.allowed;
        let (liquid, wall) = (&self.particles.position, &self.wall.position);
        let peak = |x: [f64; 3]| peaks[grid.index(grid.cell(x))];
        let (of_liquid, of_wall) = self.reach.split_at_mut(n);
        each_mut(of_liquid, |i, reach| {
            let x = [liquid[0][i], liquid[1][i], liquid[2][i]];
            *reach = base + allowed[i] + peak(x);
        });
        each_mut(of_wall, |i, reach| {
            let x = [wall[0][i], wall[1][i], wall[2][i]];
            *reach = base + peak(x);
        });
        longest
    }

    /// Finds all neighbour rows. Call after [`Flow::sort`].
    pub fn find(&mut self) {
        self.find_ghosts();
        let cutoff = self.allow();
        self.longest = cutoff;
        self.sorted += 1;
        self.find_images(cutoff);
        self.place();
        let n = self.liquid();
        for (home, at) in self.home.iter_mut().zip(&self.at) {
            home.clear();
            make_room(home, n);
            home.extend_from_slice(&at[..n]);
        }
        let mut rows = std::mem::take(&mut self.rows);
        let mut wall_rows = std::mem::take(&mut self.wall_rows);
        let sources = self.sources();
        let search = Search {
            grid: &self.grid,
            at: &self.at,
            sources: &sources,
            cutoff,
            each: &self.reach,
        };
        rows.build(search, 0, &self.particles.position);
        if self.has_walls() {
            let seen = match self.wall_sees_wall {
                true => sources.len(),
                false => self.liquid_sources(),
            };
            let search = Search {
                sources: &sources[..seen],
                ..search
            };
            wall_rows.build(search, self.liquid(), &self.wall.position);
        }
        (self.rows, self.wall_rows) = (rows, wall_rows);
    }

    /// Images for rows of `cutoff` m and for what asks farther, with room for what particles move
    /// until the next search.
    fn find_images(&mut self, cutoff: f64) {
        let most = self.allowed.iter().fold(0.0, |m: f32, a| m.max(*a)) as f64;
        let most = self.largest(most);
        let (all, index) = self.with_ghosts();
        let (n, first) = (
            self.liquid(),
            self.liquid() + self.walls() + self.halo.len(),
        );
        let Some(mirror) = &mut self.mirror else {
            return;
        };
        let reach = cutoff.max(self.lengths.longest + 2.0 * most) + 2.0 * most;
        let liquid = match self.ranks {
            None => Points::of(&self.particles.position),
            Some(_) => Points {
                position: &all,
                index: &index,
            },
        };
        mirror.find(&self.grid, (liquid, n), &self.wall.position, first, reach);
    }
}
