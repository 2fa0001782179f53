//! Clouds of particles for the tests of pair sums: jittered lattices in boxes of all kinds.

use super::pack_scene::{S0, scene};
use coronet::method::flow::{Flow, Lengths};
use coronet::particle::{Particles, Wall, wall};
use coronet::scene::{Dimension, Shape, Side};
use coronet::space::sparse::Layout;
use coronet::space::sweep::Payload;
use std::f64::consts::TAU;

pub const PERIODIC: [[Side; 2]; 3] = [[Side::Periodic; 2]; 3];
pub const OPEN: [[Side; 2]; 3] = [[Side::Open; 2], [Side::Open; 2], [Side::Open; 2]];
/// Walls below and above, periodic across.
pub const CHANNEL: [[Side; 2]; 3] = [
    [Side::Periodic; 2],
    [Side::Periodic; 2],
    [Side::Wall, Side::Wall],
];

/// A stream of numbers that is the same everywhere.
pub struct Random(pub u64);

impl Random {
    /// Uniform in -1 .. 1.
    pub fn signed(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 32) as f64 / (1u64 << 31) as f64 - 1.0
    }

    /// Uniform on the unit circle of the x-z plane or on the unit sphere.
    pub fn direction(&mut self, dimension: Dimension) -> [f64; 3] {
        loop {
            let mut v = [self.signed(), self.signed(), self.signed()];
            if dimension == Dimension::Two {
                v[1] = 0.0;
            }
            let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                return v.map(|v| v / length);
            }
        }
    }
}

/// A lattice in a box of `cells` spacings, each particle moved by up to `jitter` spacings.
pub struct Cloud {
    pub flow: Flow,
    /// m.
    pub h: f64,
    pub random: Random,
}

impl Cloud {
    /// The rows of the liquid as those of an equation, without unknowns for walls.
    pub fn layout(&self) -> Layout<'_> {
        Layout {
            records: &self.flow.records,
            liquid: &self.flow.rows,
            wall: &self.flow.wall_rows,
            start: &[],
            member: &[],
            unknown: &[],
            columns: self.flow.rows.len(),
            images: self.flow.image_sources(),
            scale: self.flow.grid.scale(self.h),
        }
    }

    /// `h` in spacings. `keep` says which lattice points hold liquid, by place in spacings.
    pub fn new(
        dimension: Dimension,
        cells: [f64; 3],
        sides: [[Side; 2]; 3],
        [h, jitter]: [f64; 2],
        keep: impl Fn([f64; 3]) -> bool,
    ) -> Self {
        let mut random = Random(7);
        let count = cells.map(|n| n.round().max(1.0) as usize);
        let mut points = Vec::new();
        for i in 0..count[0] * count[1] * count[2] {
            let at = [
                i / count[2] / count[1],
                i / count[2] % count[1],
                i % count[2],
            ];
            let mut at = at.map(|c| c as f64 + 0.5 + jitter * random.signed());
            if dimension == Dimension::Two {
                at[1] = 0.0;
            }
            if keep(at) {
                points.push((at, [0; 4].map(|_| random.signed())));
            }
        }
        Cloud {
            random,
            ..Cloud::of(dimension, cells, sides, h, &points)
        }
    }

    /// Liquid at places, in spacings, each with a velocity and a change of density in per cent.
    pub fn of(
        dimension: Dimension,
        cells: [f64; 3],
        sides: [[Side; 2]; 3],
        h: f64,
        points: &[([f64; 3], [f64; 4])],
    ) -> Self {
        let mut scene = scene(dimension, cells, Shape::Layer { depth: S0 });
        scene.domain.boundary = sides;
        if dimension == Dimension::Two {
            scene.domain.boundary[1] = [Side::Periodic; 2];
        }
        let is_axial = scene.domain.is_axial();
        scene.domain.revolved = is_axial.then(coronet::scene::Rings::default);
        let mut p = Particles {
            mass: scene.density * S0.powi(scene.space() as i32),
            ..Particles::default()
        };
        for (at, [u, v, w, dense]) in points {
            (0..3).for_each(|a| p.position[a].push(at[a] * S0));
            (0..3).for_each(|a| p.velocity[a].push([u, v, w][a] + 0.0));
            p.density.push(scene.density * (1.0 + 0.01 * dense));
            p.id.push(p.id.len() as u32);
            p.body.push(0);
            if is_axial {
                p.weight.push(TAU * (at[0].floor() + 0.5));
            }
        }
        let mut walls = if sides.concat().contains(&Side::Wall) {
            wall::build_layers(
                &scene.domain,
                scene.dimension,
                scene.spacing,
                (2.0 * h).ceil() as usize,
            )
        } else {
            Wall::default()
        };
        if is_axial {
            let radii = walls.position[0].iter();
            walls.weight = radii.map(|r| TAU * r.abs() / S0).collect();
        }
        let lengths = Lengths {
            spacing: S0,
            support: 2.0 * h * S0,
            longest: 2.0 * h * S0,
            late: 0.0,
            farthest: 0.0,
            deepest: 0.5 * S0,
        };
        let mut flow = Flow::new(dimension, &scene.domain, lengths, scene.pairs, p, walls).unwrap();
        flow.wall_sees_wall = true;
        flow.sort();
        flow.find();
        Cloud {
            flow,
            h: h * S0,
            random: Random(7),
        }
    }

    /// Liquid and wall records.
    pub fn records(&self) -> usize {
        self.flow.liquid() + self.flow.walls()
    }

    /// Where record `i` is, m.
    pub fn position(&self, i: usize) -> [f64; 3] {
        let n = self.flow.liquid();
        match i.checked_sub(n) {
            None => self.flow.position(i),
            Some(i) => [0, 1, 2].map(|a| self.flow.wall.position[a][i]),
        }
    }

    /// Own minus other of records `i` and `j`, nearest image, m.
    pub fn separation(&self, i: usize, j: usize) -> [f64; 3] {
        let (x, y) = (self.position(i), self.position(j));
        std::array::from_fn(|a| {
            let (d, size) = (x[a] - y[a], self.flow.domain.size[a]);
            if self.flow.grid.periodic[a] {
                d - size * (d / size).round()
            } else {
                d
            }
        })
    }

    /// The row of liquid or wall record `i`, without padding, sorted.
    pub fn row(&self, i: usize) -> Vec<usize> {
        let rows = match i.checked_sub(self.flow.liquid()) {
            None => self.flow.rows.row(i),
            Some(i) => self.flow.wall_rows.row(i),
        };
        let other = rows.indices().filter(|&j| j != i);
        let mut row: Vec<usize> = other.collect();
        row.sort_unstable();
        row
    }

    /// Writes payloads into the records, given as their numbers one after the other.
    pub fn pack<P: Payload>(&mut self, payload: &[[f32; 5]]) {
        let n = self.flow.liquid();
        let of = |[a, b, c, d, e]: [f32; 5]| P::from_words([a, b, c, d, e, 0.0]);
        self.flow
            .pack(|_, i| of(payload[i]), |_, i| of(payload[n + i]));
    }
}

/// |d|.
pub fn length(d: [f64; 3]) -> f64 {
    d.iter().map(|d| d * d).sum::<f64>().sqrt()
}

/// a . b
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
