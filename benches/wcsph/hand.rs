//! The step of `paper` written out by hand for a periodic box: nothing that a wall, gravity or
//! tension would ask for, and a clock about each part.

use crate::meter::cpu_seconds;
use crate::scene::{settings, smoothing};
use coronet::effect::viscosity::PairViscosity;
use coronet::kernel::Kernel;
use coronet::method::Phase;
use coronet::method::flow::{Flow, Lengths};
use coronet::method::model::Model;
use coronet::method::pass::{Force, Moving, Neighbourhood, Summation, Surroundings};
use coronet::particle::{Particles, Wall};
use coronet::scene::{Scene, TimeStepping};
use coronet::space::parallel::{each, max, slots3};
use coronet::space::sweep;
use std::marker::PhantomData;

/// Most steps on one set of rows, as in the solver.
const LONGEST: usize = 20;

#[derive(Clone, Copy, Debug)]
pub enum Part {
    /// Cells, and all arrays along them.
    Sort,
    Rows,
    /// Kernel sums once per set of rows.
    Look,
    Density,
    Force,
    Integration,
}

pub const PARTS: [Part; 6] = [
    Part::Sort,
    Part::Rows,
    Part::Look,
    Part::Density,
    Part::Force,
    Part::Integration,
];

impl Part {
    pub fn name(self) -> &'static str {
        match self {
            Part::Sort => "sort",
            Part::Rows => "list_building",
            Part::Look => "kernel_sum",
            Part::Density => "density",
            Part::Force => "force",
            Part::Integration => "integration",
        }
    }
}

pub struct Hand<K, V> {
    flow: Flow,
    model: Model,
    /// m.
    h: f64,
    viscosity: V,
    dt: f64,
    held: Vec<[f32; 3]>,
    force: Vec<[f32; 3]>,
    around: Vec<Surroundings>,
    spare: Vec<Surroundings>,
    fastest: f64,
    hardest: f64,
    /// CPU seconds, steps and sets of rows since [`Hand::clear`].
    pub seconds: [f64; PARTS.len()],
    pub steps: usize,
    pub builds: usize,
    pub all_steps: usize,
    kernel: PhantomData<K>,
}

impl<K: Kernel, V: PairViscosity> Hand<K, V> {
    pub fn new(scene: &Scene, particles: Particles, viscosity: V) -> Self {
        let model = Model::new(scene, settings(scene), Phase::Impact);
        let TimeStepping::Fixed { step: dt } = model.settings.time_stepping else {
            panic!("`paper` has a fixed step");
        };
        let support = 2.0 * smoothing(scene);
        let lengths = Lengths {
            spacing: scene.spacing,
            support,
            longest: support,
            late: 0.0,
            farthest: 0.0,
            deepest: 0.5 * scene.spacing,
        };
        let (n, wall) = (particles.len(), Wall::default());
        let pairs = scene.pairs;
        let flow = Flow::new(
            scene.dimension,
            &scene.domain,
            lengths,
            pairs,
            particles,
            wall,
        );
        let mut hand = Hand {
            flow: flow.expect("the box is large enough"),
            model,
            h: smoothing(scene),
            viscosity,
            dt,
            held: vec![[0.0; 3]; n],
            force: vec![[0.0; 3]; n],
            around: vec![Surroundings::default(); n],
            spare: Vec::new(),
            fastest: 0.0,
            hardest: 0.0,
            seconds: [0.0; PARTS.len()],
            steps: 0,
            builds: 0,
            all_steps: 0,
            kernel: PhantomData,
        };
        hand.rebuild();
        hand.evaluate(0.0);
        hand
    }

    pub fn len(&self) -> usize {
        self.flow.liquid()
    }

    /// Entries of the rows.
    pub fn entries(&self) -> usize {
        self.flow.rows.entries()
    }

    pub fn clear(&mut self) {
        self.seconds = [0.0; PARTS.len()];
        (self.steps, self.builds) = (0, 0);
    }

    /// CPU seconds of all parts.
    pub fn whole(&self) -> f64 {
        self.seconds.iter().sum()
    }

    /// From one set of rows to the next.
    pub fn cycle(&mut self) {
        self.flow.lasting = LONGEST as f64 * self.dt;
        self.rebuild();
        self.builds += 1;
        for k in 0..LONGEST {
            let start = cpu_seconds();
            let (dt, push) = (self.dt, self.hardest * self.dt);
            let p = &self.flow.particles;
            if k > 0 && self.flow.stale(|i| (p.speed(i) + push) * dt) {
                break;
            }
            self.push(true);
            self.book(Part::Integration, start);
            self.evaluate(0.5 * dt);
            let start = cpu_seconds();
            self.push(false);
            self.book(Part::Integration, start);
            self.steps += 1;
            self.all_steps += 1;
        }
    }

    fn book(&mut self, part: Part, start: f64) {
        self.seconds[part as usize] += cpu_seconds() - start;
    }

    fn scale(&self) -> coronet::space::grid::Scale {
        self.flow.grid.scale(self.h)
    }

    fn gradient_factor(&self) -> f64 {
        self.flow.particles.mass * K::norm(3) / self.h.powi(4)
    }

    fn rebuild(&mut self) {
        let start = cpu_seconds();
        self.flow.confine(|_| false);
        self.flow.sort();
        let cells = &self.flow.liquid_cells;
        cells.permute(&mut self.held, &mut self.force);
        cells.permute(&mut self.around, &mut self.spare);
        self.force.resize(self.flow.liquid(), [0.0; 3]);
        self.book(Part::Sort, start);
        let start = cpu_seconds();
        self.flow.find();
        self.book(Part::Rows, start);
        let start = cpu_seconds();
        let still = Moving::default();
        self.flow.pack(|_, _| still, |_, _| still);
        let pass = Neighbourhood {
            factor: self.gradient_factor(),
            viscosity: (),
            kernel: self.kernel,
        };
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        sweep::rows(records, rows, self.scale(), &pass, &mut self.around);
        self.book(Part::Look, start);
    }

    /// Half a kick, and with `first` a drift after it.
    fn push(&mut self, first: bool) {
        let (n, dt, held) = (self.flow.liquid(), self.dt, &self.held);
        let p = &mut self.flow.particles;
        let (x, v) = (slots3(&mut p.position), slots3(&mut p.velocity));
        each(n, |i| {
            for a in 0..3 {
                // SAFETY: every particle is visited once.
                let v = unsafe { v[a].at(i) };
                *v += 0.5 * dt * held[i][a] as f64;
                if first {
                    // SAFETY: the same.
                    *unsafe { x[a].at(i) } += dt * *v;
                }
            }
        });
        if !first {
            let p = &self.flow.particles;
            let square = |i: usize| p.speed(i).powi(2);
            self.fastest = max(n, square).sqrt();
            assert!(self.fastest < self.model.sound_speed);
        }
    }

    /// Density, then forces with the velocity `ahead` s on.
    fn evaluate(&mut self, ahead: f64) {
        let start = cpu_seconds();
        self.flow.pack(|_, _| (), |_, _| ());
        let (scale, h) = (self.scale(), self.h);
        let factor = self.flow.particles.mass * K::norm(3) / h.powi(3);
        let pass = Summation {
            factor,
            own: factor * K::w(0.0),
            kernel: self.kernel,
        };
        let flow = &mut self.flow;
        let density = &mut flow.particles.density;
        sweep::rows(&flow.records, &flow.rows, scale, &pass, density);
        self.book(Part::Density, start);
        let start = cpu_seconds();
        let (rho0, held) = (self.model.density, &self.held);
        let stiffness = rho0 * self.model.sound_speed.powi(2) / 7.0;
        let payload = |p: &Particles, i: usize| {
            let (rho, v) = (p.density[i], &p.velocity);
            let weight = 1.0 / (rho * rho);
            let (e, e2) = (rho / rho0, (rho / rho0) * (rho / rho0));
            let pressure = (stiffness * (e * e2 * (e2 * e2) - 1.0)).max(0.0);
            Moving {
                velocity: [0, 1, 2].map(|a| (v[a][i] + ahead * held[i][a] as f64) as f32),
                pressure: (pressure * weight) as f32,
                weight: weight as f32,
            }
        };
        self.flow.repack(payload, |_, _| Moving::default());
        let pass = Force::<K, V, false> {
            factor: self.gradient_factor(),
            viscosity: self.viscosity,
            kernel: self.kernel,
        };
        let (records, rows) = (&self.flow.records, &self.flow.rows);
        sweep::rows(records, rows, scale, &pass, &mut self.force);
        self.book(Part::Force, start);
        let start = cpu_seconds();
        std::mem::swap(&mut self.held, &mut self.force);
        let square = |i: usize| self.held[i].iter().map(|a| (*a as f64).powi(2)).sum();
        self.hardest = max(self.held.len(), square).sqrt();
        self.book(Part::Integration, start);
    }
}
