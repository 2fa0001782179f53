//! Walls in the pressure equation.
//!
//! The particles of the layer in contact with the liquid are unknowns (with the transposed gradient
//! they follow from the liquid: [`super::product`]); those behind copy the one in front (Kuri,
//! Section 2.2), so each is one unknown with its followers, and its equation is the sum of theirs:
//! the matrix stays symmetric. Walls exchange nothing with walls, so that pressure does not leak
//! along them.
//!
//! As printed every wall particle moves with the wall and has a density of its own. With
//! `source.divergence` the wall goes on with the velocity that the liquid before it has, v*_w =
//! SUM v* W / SUM W, and the pressure takes its part through the wall away,
//! (1) n . grad p = rho0 n . ((v*_w - v_wall) / dt + (1 - theta) g)
//! (Cummins & Rudman 1999; Lee et al. 2008): along the normals n of its axes the pressure of wall
//! particle j behind contact g is p_j = p_g + c_j,
//! c_j = n n . grad p . (r_j - r_g). On a lattice p = rho g depth is then an exact solution. dt is
//! the whole step, of whose gravity v* has the part theta: over theta dt a wall would give back
//! (1 - theta) / theta of what hits it, and particles pressed into the floor, which a unit of
//! pressure moves more than the equation has it, leapt higher in every step. With the transposed
//! gradient the slope is that of gravity alone (`halt` in [`super::solve`]). Viscosity sees
//! 2 v_wall - SUM v W / SUM W (Adami, Hu & Adams 2012, Eq. 23).
//! Test: tests/engine/projection_flow.rs.

use crate::method::flow::Flow;
use crate::method::liquid::Liquid;
use crate::method::model::Case;
use crate::method::pass::WallSums;
use crate::method::wet;
use crate::particle::Wall;
use crate::scene::Side;
use crate::space::sparse::Layout;
use std::collections::HashMap;

/// What walls take from the liquid before them in a step.
pub struct Halt {
    /// rho0, kg/m^3.
    pub density: f64,
    /// The whole step, s.
    pub dt: f64,
    /// Gravity that v* lacks, m/s^2.
    pub late: [f64; 3],
}

/// Groups of wall particles, one for each particle in contact.
#[derive(Default)]
pub struct Walls {
    /// Members of group g: `member[start[g] .. start[g + 1]]`.
    pub start: Vec<u32>,
    pub member: Vec<u32>,
    /// Group of each wall particle.
    pub group: Vec<u32>,
    /// Unknown of each wall particle, a group after the liquid, and of each ghost, after those.
    pub unknown: Vec<u32>,
    /// The particle in contact of each group.
    pub contact: Vec<u32>,
    /// Axes whose walls a group belongs to.
    normal: Vec<[bool; 3]>,
    /// Per wall particle: sums over the liquid, and its density over rho0.
    pub sums: Vec<WallSums>,
    pub density: Vec<f64>,
    /// The part of the density that is the walls' own, and whether it is known.
    pub own: Vec<f64>,
    pub is_seen: bool,
    /// Whether a wall has its pressure only as far as it is wet.
    dries: bool,
    /// Per group: v*_w, m/s; mean pressure of the liquid, Pa; whether any is there.
    pub velocity: Vec<[f32; 3]>,
    pub guess: Vec<f64>,
    pub wet: Vec<bool>,
    /// S_wet of [`wet`] at the particle in contact; empty where walls do not dry.
    full: Vec<f32>,
    /// f of [`wet`] at the particle in contact.
    pub share: Vec<f64>,
    /// f c_j, Pa.
    pub offset: Vec<f32>,
}

impl Walls {
    /// `dries`: as the field.
    pub fn new(case: &Case, wall: &Wall, dries: bool) -> Self {
        let n = wall.position[0].len();
        let mut walls = Walls {
            group: vec![0; n],
            sums: vec![WallSums::default(); n],
            density: vec![1.0; n],
            offset: vec![0.0; n],
            dries,
            ..Walls::default()
        };
        let pitch = [0, 1, 2].map(|a| {
            let size = case.domain.size[a];
            let count = (size / case.spacing).round().max(1.0);
            (size / count, count as i64)
        });
        let mut known: HashMap<[i64; 3], u32> = HashMap::new();
        let mut depth = Vec::new();
        for j in 0..n {
            let (mut key, mut normal, mut behind) = ([0; 3], [false; 3], 0);
            for a in (0..3).filter(|a| pitch[*a].0 > 0.0) {
                let (pitch, count) = pitch[a];
                let cell = (wall.position[a][j] / pitch).floor() as i64;
                let sides = case.domain.boundary[a];
                key[a] = cell;
                if cell < 0 && sides[0] == Side::Wall {
                    (key[a], normal[a]) = (-1, true);
                } else if cell >= count && sides[1] == Side::Wall {
                    (key[a], normal[a]) = (count, true);
                }
                behind += (cell - key[a]).abs();
            }
            let next = known.len() as u32;
            let g = *known.entry(key).or_insert(next);
            walls.group[j] = g;
            if g == next {
                walls.normal.push(normal);
                walls.contact.push(j as u32);
                depth.push(behind);
            } else if behind < depth[g as usize] {
                walls.contact[g as usize] = j as u32;
                depth[g as usize] = behind;
            }
        }
        walls.list();
        if dries {
            let full = wet::full(case, wall);
            walls.full = walls.contact.iter().map(|&j| full[j as usize]).collect();
        }
        walls.share = vec![1.0; walls.len()];
        walls
    }

    /// The same of the walls that `liquid` has now.
    pub fn of(&self, liquid: &Liquid) -> Self {
        Walls::new(&liquid.case, &liquid.flow.wall, self.dries)
    }

    /// Members of the groups, by counting.
    fn list(&mut self) {
        let groups = self.contact.len();
        self.start = vec![0; groups + 1];
        self.group
            .iter()
            .for_each(|g| self.start[*g as usize + 1] += 1);
        for g in 0..groups {
            self.start[g + 1] += self.start[g];
        }
        let mut next = self.start.clone();
        self.member = vec![0; self.group.len()];
        for (j, g) in self.group.iter().enumerate() {
            self.member[next[*g as usize] as usize] = j as u32;
            next[*g as usize] += 1;
        }
        self.velocity = vec![[0.0; 3]; groups];
        self.guess = vec![0.0; groups];
        self.wet = vec![false; groups];
    }

    /// Groups.
    pub fn len(&self) -> usize {
        self.contact.len()
    }

    pub fn members(&self, group: usize) -> &[u32] {
        &self.member[self.start[group] as usize..self.start[group + 1] as usize]
    }

    /// Numbers the groups after the liquid, then the ghosts.
    pub fn number(&mut self, flow: &Flow) {
        let liquid = flow.liquid() as u32;
        let ghosts = liquid + self.len() as u32;
        self.unknown.clear();
        self.unknown
            .extend(self.group.iter().map(|group| liquid + group));
        self.unknown.extend(ghosts..ghosts + flow.halo.len() as u32);
    }

    /// Where the rows of the equation come from; groups are numbered after the liquid. `h` in m.
    pub fn layout<'a>(&'a self, flow: &'a Flow, h: f64) -> Layout<'a> {
        Layout {
            records: &flow.records,
            liquid: &flow.rows,
            wall: &flow.wall_rows,
            start: &self.start,
            member: &self.member,
            unknown: &self.unknown,
            columns: flow.liquid() + self.len() + flow.halo.len(),
            images: flow.image_sources(),
            scale: flow.grid.scale(h),
        }
    }

    /// Velocity v*_w, guess and wetness of the groups from the sums over the liquid, of which
    /// `factor` makes SUM V W.
    pub fn gather(&mut self, wall: &Wall, factor: f64) {
        for g in 0..self.len() {
            let (mut weight, mut pressure, mut velocity) = (0.0f64, 0.0f64, [0.0f64; 3]);
            for &j in self.members(g) {
                let s = &self.sums[j as usize];
                weight += s.weight as f64;
                pressure += s.pressure as f64;
                (0..3).for_each(|a| velocity[a] += s.velocity[a] as f64);
            }
            let contact = self.contact[g] as usize;
            if let Some(full) = self.full.get(g) {
                let seen = factor as f32 * self.sums[contact].weight;
                self.share[g] = wet::part(seen, *full) as f64;
            }
            self.wet[g] = weight > 0.0;
            self.guess[g] = if self.wet[g] { pressure / weight } else { 0.0 };
            self.velocity[g] = [0, 1, 2].map(|a| match self.wet[g] {
                true => (velocity[a] / weight) as f32,
                false => wall.velocity[a][contact] as f32,
            });
        }
    }

    /// n n . grad p of (1) for group `g`, Pa/m.
    pub fn slope(&self, g: usize, wall: &Wall, halt: &Halt) -> [f64; 3] {
        let contact = self.contact[g] as usize;
        let beside = |a: usize| self.velocity[g][a] as f64 - wall.velocity[a][contact];
        [0, 1, 2].map(|a| match self.normal[g][a] {
            true => halt.density * (beside(a) / halt.dt + halt.late[a]),
            false => 0.0,
        })
    }

    /// Sets f c_j; all zero with `still`, the copy as printed.
    pub fn set_offsets(&mut self, wall: &Wall, still: bool, halt: &Halt) {
        if still {
            return self.offset.fill(0.0);
        }
        for g in 0..self.len() {
            let (slope, contact) = (self.slope(g, wall, halt), self.contact[g] as usize);
            for k in self.start[g]..self.start[g + 1] {
                let j = self.member[k as usize] as usize;
                let away = |a: usize| wall.position[a][j] - wall.position[a][contact];
                let c: f64 = (0..3).map(|a| slope[a] * away(a)).sum();
                self.offset[j] = (self.share[g] * c) as f32;
            }
        }
    }
}
