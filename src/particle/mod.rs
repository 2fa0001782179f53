//! Arrays of particles, and their initial arrangement.
//!
//! Further data of each particle are declared as [`column`]s.
//! Reading order: [`shape`] (the region of a body), [`lattice`], [`wall`], [`pack`] and its steps
//! [`poisson`], [`repulse`], [`optimise`], which use [`crowd`] (neighbours), [`completion`] and
//! [`ellipsoid`] (free surfaces); [`quality`] (what is reported).

pub mod column;
pub mod completion;
pub mod crowd;
pub mod ellipsoid;
mod fault;
pub mod lattice;
pub mod migrate;
pub mod optimise;
pub mod pack;
pub mod poisson;
pub mod quality;
mod report;
pub mod repulse;
pub mod ring;
pub mod scalar;
pub mod shape;
pub mod wall;

use column::{Columns, Role, Viewer, Visitor};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Liquid particles, structure of arrays, SI units, length `len()` each.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Particles {
    /// Stable identity: index at packing, body after body.
    pub id: Vec<u32>,
    /// Index into `Scene::bodies`.
    pub body: Vec<u8>,
    /// x, y, z, m.
    pub position: [Vec<f64>; 3],
    /// m/s.
    pub velocity: [Vec<f64>; 3],
    /// kg/m^3.
    pub density: Vec<f64>,
    /// Mass of one particle, kg (kg/m in 2-D): of all, or that to which weights refer.
    pub mass: f64,
    /// Mass of each particle over `mass`, where they differ: in rings about an axis; else empty.
    pub weight: Vec<f64>,
}

impl Particles {
    /// Speed of particle `i`, m/s.
    #[inline(always)]
    pub fn speed(&self, i: usize) -> f64 {
        let v = &self.velocity;
        (v[0][i] * v[0][i] + v[1][i] * v[1][i] + v[2][i] * v[2][i]).sqrt()
    }

    /// Mass of particle `i` over [`Particles::mass`].
    #[inline(always)]
    pub fn weight(&self, i: usize) -> f64 {
        weight_of(&self.weight, i)
    }

    /// Mass of all, kg.
    pub fn total_mass(&self) -> f64 {
        match self.weight.is_empty() {
            true => self.mass * self.len() as f64,
            false => self.mass * self.weight.iter().sum::<f64>(),
        }
    }

    /// Mass of a particle on average, kg.
    pub fn mean_mass(&self) -> f64 {
        match self.weight.is_empty() {
            true => self.mass,
            false => self.total_mass() / self.len() as f64,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }
}

/// Checkpoints write these arrays themselves.
impl Columns for Particles {
    fn visit(&mut self, visitor: &mut impl Visitor) {
        let vectors = self.position.iter_mut().chain(&mut self.velocity);
        vectors.for_each(|part| visitor.visit(Role::RolledBack, part));
        visitor.visit(Role::RolledBack, &mut self.density);
        visitor.visit(Role::RolledBack, &mut self.id);
        visitor.visit(Role::RolledBack, &mut self.body);
        visitor.visit(Role::RolledBack, &mut self.weight);
    }

    fn view(&self, viewer: &mut impl Viewer) {
        let vectors = self.position.iter().chain(&self.velocity);
        vectors.for_each(|part| viewer.view(Role::RolledBack, part));
        viewer.view(Role::RolledBack, &self.density);
        viewer.view(Role::RolledBack, &self.id);
        viewer.view(Role::RolledBack, &self.body);
        viewer.view(Role::RolledBack, &self.weight);
    }
}

/// Fixed wall particles: positions, m, and prescribed velocities, m/s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wall {
    /// x, y, z, m.
    pub position: [Vec<f64>; 3],
    /// x, y, z, m/s.
    pub velocity: [Vec<f64>; 3],
    /// As [`Particles::weight`].
    pub weight: Vec<f64>,
}

impl Wall {
    /// As [`Particles::weight`].
    #[inline(always)]
    pub fn weight(&self, j: usize) -> f64 {
        weight_of(&self.weight, j)
    }
}

/// The weight of particle `i`: 1 where there are none.
#[inline(always)]
pub fn weight_of(weights: &[f64], i: usize) -> f64 {
    match weights.is_empty() {
        true => 1.0,
        false => weights[i],
    }
}

/// Complete state for a bit-identical restart of a solver.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Simulated time, s.
    pub time: f64,
    /// Number of time steps done.
    pub step: u64,
    /// In the order of the solver, which a restart keeps.
    pub particles: Particles,
    /// Named scalars of the method (removed mass, last time step, calibrated strength ...).
    pub scalars: Vec<(String, f64)>,
    /// Named per-particle arrays of the method, each of `particles.len()` values.
    pub arrays: Vec<(String, Vec<f64>)>,
}

impl State {
    /// Whether there is an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.arrays.iter().any(|array| array.0 == name)
    }

    /// The particles of a range, with all scalars.
    pub fn part(&self, range: Range<usize>) -> State {
        let reals = |column: &Vec<f64>| column.get(range.clone()).unwrap_or_default().to_vec();
        let p = &self.particles;
        let arrays = self.arrays.iter();
        State {
            particles: Particles {
                id: p.id[range.clone()].to_vec(),
                body: p.body[range.clone()].to_vec(),
                position: p.position.each_ref().map(reals),
                velocity: p.velocity.each_ref().map(reals),
                density: reals(&p.density),
                mass: p.mass,
                weight: reals(&p.weight),
            },
            scalars: self.scalars.clone(),
            arrays: arrays
                .map(|(name, values)| (name.clone(), reals(values)))
                .collect(),
            ..*self
        }
    }

    /// A copy of some of the columns: identities, bodies, positions, velocities, densities, arrays.
    /// The others are empty. For particles of one mass.
    pub fn columns(&self, wanted: &Range<usize>) -> State {
        let mut next = 0..usize::MAX;
        let mut is_wanted = || next.next().is_some_and(|k| wanted.contains(&k));
        let p = &self.particles;
        let (with_id, with_body) = (is_wanted(), is_wanted());
        let mut part = |column: &Vec<f64>| copy_if(is_wanted(), column);
        let particles = Particles {
            id: copy_if(with_id, &p.id),
            body: copy_if(with_body, &p.body),
            position: p.position.each_ref().map(&mut part),
            velocity: p.velocity.each_ref().map(&mut part),
            density: part(&p.density),
            mass: p.mass,
            weight: Vec::new(),
        };
        let arrays = self.arrays.iter();
        let arrays = arrays.map(|(name, values)| (name.clone(), part(values)));
        State {
            particles,
            arrays: arrays.collect(),
            scalars: Vec::new(),
            ..*self
        }
    }
}

fn copy_if<T: Clone>(wanted: bool, column: &[T]) -> Vec<T> {
    if wanted { column.to_vec() } else { Vec::new() }
}

/// The parts of a state that other ranks have, in their order behind that of this one.
pub trait Shares {
    /// Particles of all ranks.
    fn count(&self) -> usize;
    /// Calls `take` with the same [`State::columns`] of each part, one after the other.
    fn each(&self, columns: &Range<usize>, take: &mut dyn FnMut(State));
}

/// One recorded frame of the liquid, SI units, f32 as in the log; particles sorted by `id`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Simulated time, s.
    pub time: f64,
    /// Identity, as in [`Particles`].
    pub id: Vec<u32>,
    /// Index into `Scene::bodies`.
    pub body: Vec<u8>,
    /// x, y, z, m.
    pub position: [Vec<f32>; 3],
    /// x, y, z, m/s.
    pub velocity: [Vec<f32>; 3],
    /// Pa.
    pub pressure: Vec<f32>,
    /// kg/m^3.
    pub density: Vec<f32>,
    /// 1 at the free surface, else 0.
    pub surface: Vec<u8>,
    /// kg, where particles are rings, whose masses differ; else empty.
    pub mass: Vec<f32>,
    /// Scalars that the solver computes in f64, by name with unit suffix
    /// (`kinetic_energy_J`, `mass_kg`, `mass_removed_kg`, `time_step_s` ...), in a fixed order.
    pub scalars: Vec<(String, f64)>,
}

impl Frame {
    /// Sorts the particles by id. Bodies follow each other, and usually ids do, too: then there is
    /// nothing to do.
    pub fn sort(&mut self) {
        if self.id.is_sorted() {
            return;
        }
        let mut order: Vec<u32> = (0..self.id.len() as u32).collect();
        order.sort_by_key(|&i| self.id[i as usize]);
        fn sorted<T: Copy>(column: &mut Vec<T>, order: &[u32]) {
            if !column.is_empty() {
                *column = order.iter().map(|&i| column[i as usize]).collect();
            }
        }
        sorted(&mut self.id, &order);
        sorted(&mut self.body, &order);
        for component in self.position.iter_mut().chain(&mut self.velocity) {
            sorted(component, &order);
        }
        for column in [&mut self.pressure, &mut self.density, &mut self.mass] {
            sorted(column, &order);
        }
        sorted(&mut self.surface, &order);
    }
}
