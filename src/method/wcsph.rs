//! Weakly compressible SPH (Nishio et al. 2010).
//!
//! (1) rho_a = SUM m W_ab                                                        Nishio Eq. 4, or
//! (2) d rho/dt = SUM m v_ab . grad W + density diffusion                        delta-SPH
//! (3) P = c^2 rho0 / chi ((rho / rho0)^chi - 1)                                 Nishio Eqs. 7-8
//!     with (5) rho_a >= rho0 (1 + min(C / compaction - 1, (V / c)^2)), C = SUM m / rho0 W
//! (4) dv/dt = -SUM m (P_a/rho_a^2 + P_b/rho_b^2) grad W + viscosity + a_s + g   Nishio Eq. 5
//!
//! Walls are particles that take part in every sum; they carry their own summed density or the
//! extrapolation of Adami, Hu & Adams (2012). Time steps: [`super::limit`]; single-rate velocity
//! Verlet in [`verlet`], dual-criteria stepping in [`dual`].
//! Fails where: summation density thins out at a free surface (skin without pressure); negative
//! pressure with few neighbours clumps. Tests: tests/validation.

mod budget;
mod control;
mod dual;
mod report;
mod sums;
mod tension;
mod verlet;
mod walls;

use super::flow::Flow;
use super::ledger::Ledger;
use super::limit::Limits;
use super::model::Model;
use super::pass::Surroundings;
use super::{Diverged, Solver, frame};
use crate::effect::tension::Tension;
use crate::effect::viscosity::PairViscosity;
use crate::effect::wetting::friction::Hold;
use crate::kernel::Kernel;
use crate::particle::{Frame, Particles, State};
use crate::scene::{TimeStepping, WallPressure};
use crate::space::grid::Scale;
use crate::space::parallel::{each_mut, max};
use std::marker::PhantomData;

/// Kernel sums below this mark the free surface: a flat one has 0.77 (cubic spline, h = 1.3 s0),
/// the layer below it 0.99.
const SURFACE: f32 = 0.9;

/// A particle with a kernel sum below this that crosses a periodic side is mist: it has no more
/// neighbours than the tip of a ligament.
const MIST: f32 = 0.4;

/// The solver. `K`: kernel; `V`: viscosity, `()` for none.
pub struct Wcsph<K, V> {
    pub(super) model: Model,
    pub(super) flow: Flow,
    viscosity: V,
    tension: Option<Tension>,
    /// For how long the tension has been held, s; infinite if it must be found.
    tension_age: f64,
    time: f64,
    step: u64,
    last_step: f64,
    /// Largest speed, m/s, and acceleration, m/s^2, of the last step.
    fastest: f64,
    hardest: f64,
    /// Largest speed that steps follow, m/s: with dual stepping that of what is not spray.
    connected: f64,
    /// d rho/dt, kg/m^3/s (continuity only).
    rate: Vec<f32>,
    /// Acceleration: the whole one (single rate), or what is held over an advective step (dual).
    held: Vec<[f32; 3]>,
    force: Vec<[f32; 3]>,
    /// Pressure acceleration and gradient of the kernel sum (dual stepping with shifting only).
    driven: Vec<([f32; 3], [f32; 3])>,
    around: Vec<Surroundings>,
    /// Of contact lines; empty without hysteresis.
    friction: Vec<Hold>,
    walls: walls::WallState,
    pool: bool,
    ledger: Ledger,
    control: control::Control,
    scratch: Scratch,
    kernel: PhantomData<K>,
}

/// Kept, so that a step allocates nothing.
#[derive(Default)]
struct Scratch {
    rate: Vec<f32>,
    around: Vec<Surroundings>,
    mist: Vec<bool>,
    friction: Vec<Hold>,
    position: [Vec<f64>; 3],
    pairs: Vec<[f64; 2]>,
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    pub(super) fn new(
        mut model: Model,
        mut flow: Flow,
        viscosity: V,
        tension: Option<Tension>,
        state: &State,
        pool: bool,
    ) -> Self {
        flow.wall_sees_wall = model.settings.wall_pressure == WallPressure::Summation;
        let named = |name: &str| state.scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        flow.removed = (
            named("removed_mass_kg").unwrap_or(0.0),
            named("removed_particles").unwrap_or(0.0) as u64,
        );
        let n = flow.liquid();
        let array = |name: &str| state.arrays.iter().find(|a| a.0 == name).map(|a| &a.1);
        let narrow = |v: &Vec<f64>| v.iter().map(|x| *x as f32).collect::<Vec<f32>>();
        let rate = match model.diffusion() {
            Some(_) => array("density_rate").map_or(vec![0.0; n], narrow),
            None => Vec::new(),
        };
        model.sound_speed = named("sound_speed_m_s").unwrap_or(model.sound_speed);
        let mut solver = Wcsph {
            model,
            flow,
            viscosity,
            tension,
            tension_age: f64::INFINITY,
            time: state.time,
            step: state.step,
            last_step: named("time_step_s").unwrap_or(0.0),
            fastest: 0.0,
            hardest: named("acceleration_m_s2").unwrap_or(0.0),
            connected: 0.0,
            rate,
            held: vec![[0.0; 3]; n],
            force: vec![[0.0; 3]; n],
            driven: Vec::new(),
            around: vec![Surroundings::default(); n],
            friction: Vec::new(),
            walls: walls::WallState::default(),
            pool,
            ledger: Ledger::of(state),
            control: control::Control::new(state),
            scratch: Scratch::default(),
            kernel: PhantomData,
        };
        solver
            .walls
            .resize(solver.flow.walls(), solver.model.density);
        if let Some(sums) = array("kernel_sum") {
            let around = solver.around.iter_mut().zip(sums);
            around.for_each(|(s, x)| s.sum = *x as f32);
        }
        solver.fastest = solver.speed();
        solver.connected = named("connected_speed_m_s").unwrap_or(solver.fastest);
        if !solver.is_dual() {
            let parts = ["acceleration_x", "acceleration_y", "acceleration_z"].map(array);
            match parts {
                [Some(x), Some(y), Some(z)] => {
                    let of = |i: usize| [x[i] as f32, y[i] as f32, z[i] as f32];
                    solver.held = (0..n).map(of).collect();
                }
                _ => solver.prime(),
            }
        } else if solver.ledger.surface.is_none() && solver.follows_energy() {
            solver.find_surface_energy();
        }
        solver
    }

    fn is_dual(&self) -> bool {
        matches!(self.model.settings.time_stepping, TimeStepping::Dual { .. })
    }

    /// m norm / h^(d+1): what turns a sum of `slope d` into one with m grad W.
    fn gradient_factor(&self) -> f64 {
        let d = self.model.dimension.count();
        self.flow.particles.mass * K::norm(d) / self.model.h.powi(d as i32 + 1)
    }

    fn scale(&self) -> Scale {
        self.flow.grid.scale(self.model.h)
    }

    /// Largest speed now, m/s.
    fn speed(&self) -> f64 {
        let v = &self.flow.particles.velocity;
        let square = |i: usize| v[0][i] * v[0][i] + v[1][i] * v[1][i] + v[2][i] * v[2][i];
        max(self.flow.liquid(), square).max(0.0).sqrt()
    }

    /// Largest acceleration held now, m/s^2.
    fn acceleration(&self) -> f64 {
        let square = |i: usize| self.held[i].iter().map(|a| (*a as f64).powi(2)).sum();
        max(self.held.len(), square).max(0.0).sqrt()
    }

    fn limits_now(&self) -> Limits {
        Limits {
            h: self.model.h,
            spacing: self.model.spacing,
            density: self.model.density,
            sound_speed: self.model.sound_speed,
            viscosity: self.model.effects.mu(),
            tension: self.model.effects.sigma(),
            speed: self.connected,
            acceleration: self.hardest,
        }
    }

    /// Wraps, removes, sorts, finds neighbours, looks at the surroundings.
    fn rebuild(&mut self) {
        let (before, gone) = (self.stored(), self.flow.removed.1);
        let (around, scale) = (&self.around, self.sum_factor());
        let mist = &mut self.scratch.mist;
        mist.clear();
        if self.pool && self.step > 0 {
            let is = |i| self.flow.crosses(i) && scale * around[i].sum < MIST;
            mist.extend((0..around.len()).map(is));
        }
        let doomed = |i: usize| !mist.is_empty() && mist[i];
        if let Some(keep) = self.flow.confine(doomed, &mut self.held) {
            if !self.rate.is_empty() {
                super::flow::retain(&mut self.rate, &keep);
            }
            super::flow::retain(&mut self.held, &keep);
            super::flow::retain(&mut self.force, &keep);
            super::flow::retain(&mut self.around, &keep);
        }
        self.ledger.removal += self.stored() - before;
        self.ledger.removes = self.flow.removed.1 > gone;
        self.friction.clear();
        self.tension_age = f64::INFINITY;
        self.sort();
        self.look();
        if self.model.compaction().is_finite() {
            let before = self.stored();
            self.show_crushed();
            self.ledger.diffusion += self.stored() - before;
        }
    }

    /// (5): the sum can only lack support, so that it is the least that density can be. (2) does
    /// not see particles that pile up where a contact line recedes; without a pressure of their
    /// own they would end at one place. It gets what stops the flow, rho0 V^2, and no more.
    fn show_crushed(&mut self) {
        let (model, around, scale) = (&self.model, &self.around, self.sum_factor());
        let most = model.settings.sound_speed_factor.powi(-2);
        each_mut(
            &mut self.flow.particles.density[..around.len()],
            |i, density| {
                let over = around[i].kernel_sum(scale) as f64 / model.compaction() - 1.0;
                if over > 0.0 {
                    let rho = density;
                    *rho = rho.max(model.density * (1.0 + over.min(most)));
                }
            },
        );
    }

    /// Sorts along cells and finds neighbours; every array follows.
    fn sort(&mut self) {
        self.flow.sort();
        let cells = &self.flow.liquid_cells;
        if !self.rate.is_empty() {
            cells.permute(&mut self.rate, &mut self.scratch.rate);
        }
        if !self.friction.is_empty() {
            cells.permute(&mut self.friction, &mut self.scratch.friction);
        }
        cells.permute(&mut self.held, &mut self.force);
        // Held over a sort inside an advective step: flags and shifting need them at its end.
        cells.permute(&mut self.around, &mut self.scratch.around);
        self.force.resize(self.flow.liquid(), [0.0; 3]);
        self.flow.find();
    }
}

#[inline(always)]
fn velocity(p: &Particles, i: usize) -> [f32; 3] {
    [
        p.velocity[0][i] as f32,
        p.velocity[1][i] as f32,
        p.velocity[2][i] as f32,
    ]
}

impl<K: Kernel, V: PairViscosity> Solver for Wcsph<K, V> {
    fn time(&self) -> f64 {
        self.time
    }

    fn step_count(&self) -> u64 {
        self.step
    }

    fn len(&self) -> usize {
        self.flow.liquid()
    }

    fn advance(&mut self, on_step: &mut dyn FnMut(&dyn Solver)) -> Result<(), Diverged> {
        match self.model.settings.time_stepping {
            TimeStepping::Dual {
                advective,
                acoustic,
            } => {
                self.controlled(|s, part| s.dual_step(advective, acoustic, part))?;
                on_step(self);
            }
            _ => self.verlet_steps(on_step)?,
        }
        Ok(())
    }

    fn state(&self) -> State {
        let mut arrays = Vec::new();
        if !self.rate.is_empty() {
            let rate = self.rate.iter().map(|x| *x as f64).collect();
            arrays.push(("density_rate".to_string(), rate));
        }
        if !self.is_dual() {
            for (a, name) in ["x", "y", "z"].iter().enumerate() {
                let part = self.held.iter().map(|f| f[a] as f64).collect();
                arrays.push((format!("acceleration_{name}"), part));
            }
        }
        let mut scalars = vec![
            ("removed_mass_kg".to_string(), self.flow.removed.0),
            ("removed_particles".to_string(), self.flow.removed.1 as f64),
            ("time_step_s".to_string(), self.last_step),
            ("acceleration_m_s2".to_string(), self.hardest),
            ("sound_speed_m_s".to_string(), self.model.sound_speed),
        ];
        let control = self.control.scalars();
        scalars.extend(control.map(|(name, value)| (name.to_string(), value)));
        if self.is_dual() {
            scalars.push(("connected_speed_m_s".to_string(), self.connected));
        }
        let budget = self
            .budget_scalars()
            .chain(self.books().then(|| self.ledger.held()));
        scalars.extend(budget.map(|(name, value)| (name.to_string(), value)));
        if let Some(tension) = self.tension.as_ref().filter(|t| t.pulls()) {
            scalars.push(("tension_strength".to_string(), tension.strength));
        }
        // Kernel sums decide on mist at the next rebuild.
        if self.pool {
            let sums = self.around.iter().map(|s| s.sum as f64).collect();
            arrays.push(("kernel_sum".to_string(), sums));
        }
        let particles = self.flow.particles.clone();
        State {
            time: self.time,
            step: self.step,
            particles,
            scalars,
            arrays,
        }
    }

    fn frame(&self) -> Frame {
        self.make_frame()
    }

    fn unrest(&self) -> (f64, f64) {
        let supported = |i: usize| self.kernel_sum(i) >= SURFACE;
        let spread = frame::deviation(&self.flow, self.model.density, supported);
        (self.budget()[0], spread)
    }

    fn limits(&self) -> Vec<(&'static str, f64)> {
        self.limits_now().all()
    }

    fn memory(&self) -> (f64, f64) {
        let s = &self.scratch;
        let (rate, around) = (self.rate.capacity(), self.around.capacity());
        let bytes = 4 * (rate + s.rate.capacity())
            + 12 * (self.held.capacity() + self.force.capacity())
            + std::mem::size_of::<Hold>() * (self.friction.capacity() + s.friction.capacity())
            + std::mem::size_of::<Surroundings>() * (around + s.around.capacity())
            + s.mist.capacity()
            + 24 * self.driven.capacity()
            + self.control.memory()
            + self.tension.as_ref().map_or(0, Tension::memory);
        let own = bytes as f64 / self.len().max(1) as f64;
        let (bare, whole) = self.flow.memory();
        (bare + own, whole + own)
    }
}
