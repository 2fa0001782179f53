//! Weakly compressible SPH (Nishio et al. 2010).
//!
//! (1) rho_a = SUM m W_ab                                                        Nishio Eq. 4, or
//! (2) d rho/dt = SUM m v_ab . grad W + density diffusion                        delta-SPH
//! (3) P = c^2 rho0 / chi ((rho / rho0)^chi - 1)                                 Nishio Eqs. 7-8
//!     with (5) rho_a >= rho0 (1 + min(C / compaction - 1, (V / c)^2)), C = SUM m / rho0 W
//! (4) dv/dt = -SUM m (P_a/rho_a^2 + P_b/rho_b^2) grad W + viscosity + a_s + g   Nishio Eq. 5
//! (2) and (4) near a surface whose tension has an energy: [`super::completed`].
//!
//! Walls are particles that take part in every sum; they carry their own summed density or the
//! extrapolation of Adami, Hu & Adams (2012). Time steps: [`super::limit`]; single-rate velocity
//! Verlet in [`verlet`], dual-criteria stepping in [`dual`].
//! Fails where: summation density thins out at a free surface (skin without pressure); negative
//! pressure with few neighbours clumps. Tests: tests/validation.

mod budget;
mod completed;
mod control;
mod dual;
mod report;
mod rings;
mod sums;
mod tension;
mod verlet;
mod walls;

use super::adapt::Adaption;
use super::completed::Completed;
use super::frame::{self, Beat};
use super::limit::Limits;
use super::liquid::Liquid;
use super::model::Model;
use super::pass::Surroundings;
use super::projection::surface::Share;
use super::{Diverged, Solver};
use crate::columns;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::particle::column::{Entry, Role, Scalars};
use crate::particle::{Frame, Particles, State};
use crate::scene::{TimeStepping, WallPressure};
use crate::space::parallel::{each_mut, max};
use crate::space::room::resize;
use std::marker::PhantomData;

/// Kernel sums below this mark the free surface: a flat one has 0.77 (cubic spline, h = 1.3 s0),
/// the layer below it 0.99.
const SURFACE: f32 = 0.9;

columns! {
    /// What the method keeps of a particle.
    pub(super) struct Own as this {
        /// d rho/dt, kg/m^3/s (continuity only).
        pub rate: f32 => Role::Persistent("density_rate"),
        /// Acceleration: the whole one (single rate), or what is held over an advective step
        /// (dual).
        pub held: [f32; 3] => this.role_of_held,
        /// What of it is not of effects, of a tension that has an energy; else empty.
        pub steady: [f32; 3] => Role::Held,
        pub force: [f32; 3] => Role::Scratch,
        /// Pressure acceleration and gradient of the kernel sum (dual stepping with shifting only).
        pub driven: Driven => Role::Scratch,
        pub around: Surroundings => Role::Held,
        /// What dry walls add to SUM slope d (shifting beside them only; else empty).
        pub dry: [f32; 3] => Role::Held,
        /// Of a tension that has an energy; else empty. That of [`Default`] away from a surface.
        pub completed: Completed => Role::Scratch,
        /// Kernel sum, where mist is removed at the next rebuild.
        pub kernel_sum: f32 => Role::Persistent("kernel_sum"),
    }
    with {
        role_of_held: Role,
    }
}

/// Of [`Own`].
type Driven = ([f32; 3], [f32; 3]);

impl Entry for Driven {}

impl Entry for Surroundings {}

/// The solver. `K`: kernel; `V`: viscosity, `()` for none.
pub struct Wcsph<K, V> {
    pub(super) model: Model,
    pub(super) liquid: Liquid,
    own: Own,
    viscosity: V,
    /// For how long the tension has been held, s; infinite if it must be found.
    tension_age: f64,
    walls: walls::WallState,
    control: control::Control,
    adaption: Adaption,
    /// What a flat surface leaves of a kernel sum.
    share: Share,
    /// Of rings: gradients of kernel sums and the sums.
    sums: Vec<[f32; 4]>,
    kernel: PhantomData<K>,
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    pub(super) fn new(mut model: Model, mut liquid: Liquid, viscosity: V, state: &State) -> Self {
        liquid.flow.wall_sees_wall = model.settings.wall_pressure == WallPressure::Summation;
        let n = liquid.len();
        let is_dual = matches!(model.settings.time_stepping, TimeStepping::Dual { .. });
        let mut own = Own {
            rate: match model.diffusion() {
                Some(_) => vec![0.0; n],
                None => Vec::new(),
            },
            held: Vec::new(),
            steady: Vec::new(),
            force: vec![[0.0; 3]; n],
            driven: Vec::new(),
            around: vec![Surroundings::default(); n],
            dry: Vec::new(),
            completed: Vec::new(),
            kernel_sum: Vec::new(),
            role_of_held: match is_dual {
                true => Role::Held,
                false => Role::Persistent("acceleration"),
            },
        };
        Liquid::load(state, &mut own);
        let is_new = !state.has("acceleration_x");
        own.held.resize(n, [0.0; 3]);
        model.load(state);
        let mut steps = control::Steps::default();
        steps.load(state);
        let adaption = Adaption::of(state);
        let mut walls = walls::WallState::default();
        walls.resize(liquid.flow.walls(), model.density);
        let share = match liquid.follows_energy() {
            true => Share::of(liquid.case.sph.kernel, liquid.case.space),
            false => Share::default(),
        };
        let mut solver = Wcsph {
            model,
            liquid,
            own,
            viscosity,
            tension_age: f64::INFINITY,
            walls,
            control: control::Control::new(steps),
            adaption,
            share,
            sums: Vec::new(),
            kernel: PhantomData,
        };
        if !is_dual {
            if is_new {
                solver.prime();
            }
        } else if solver.liquid.lacks_surface() {
            solver.find_surface();
        }
        if is_dual && solver.model.diffusion().is_none() && solver.liquid.now.step == 0 {
            // The bound of the first step sees what is compressed already.
            solver.rebuild();
            solver.sum_density();
        }
        solver
    }

    fn is_dual(&self) -> bool {
        matches!(self.model.settings.time_stepping, TimeStepping::Dual { .. })
    }

    /// m norm / h^(d+1): what turns a sum of `slope d` into one with m grad W.
    fn gradient_factor(&self) -> f64 {
        let d = self.liquid.case.space;
        self.liquid.flow.particles.mass * K::norm(d) / self.liquid.case.h.powi(d as i32 + 1)
    }

    /// Largest acceleration held now, m/s^2.
    fn acceleration(&self) -> f64 {
        let square = |i: usize| self.own.held[i].iter().map(|a| (*a as f64).powi(2)).sum();
        max(self.liquid.flow.span(), square).max(0.0).sqrt()
    }

    fn limits_now(&self) -> Limits<'_> {
        self.liquid.limits(self.model.sound_speed)
    }

    /// Wraps, removes, sorts, finds neighbours, looks at the surroundings.
    fn rebuild(&mut self) {
        let before = self.stored();
        self.liquid.find_mist(&self.own.kernel_sum);
        self.liquid.confine(&mut self.own);
        self.liquid.ledger.removal += self.stored() - before;
        self.tension_age = f64::INFINITY;
        if self.liquid.flow.balance(false) {
            self.forget_walls();
        }
        self.sort();
        self.look();
        if self.adapt() {
            self.sort();
            self.look();
        }
        if self.model.compaction().is_finite() {
            let before = self.stored();
            self.show_crushed();
            self.liquid.ledger.diffusion += self.stored() - before;
        }
    }

    /// Merges and splits rings; whether there were any.
    fn adapt(&mut self) -> bool {
        let Some(plan) = self.adaption.plan(&self.liquid) else {
            return false;
        };
        let before = self.stored();
        self.liquid.adapt(&plan, &mut self.own, &mut self.adaption);
        self.liquid.ledger.removal += self.stored() - before;
        true
    }

    /// (5): the sum can only lack support, so that it is the least that density can be. (2) does
    /// not see particles that pile up where a contact line recedes; without a pressure of their
    /// own they would end at one place. It gets what stops the flow, rho0 V^2 with V the speed for
    /// which c was chosen, and no more.
    fn show_crushed(&mut self) {
        let (model, around, scale) = (&self.model, &self.own.around, self.sum_factor());
        let most = model.settings.sound_speed_factor.powi(-2);
        each_mut(
            &mut self.liquid.flow.particles.density[..around.len()],
            |i, density| {
                let over = around[i].kernel_sum(scale) as f64 / model.compaction() - 1.0;
                if over > 0.0 {
                    let rho = density;
                    *rho = rho.max(model.density * (1.0 + over.min(most)));
                }
            },
        );
    }

    /// Sorts along cells and finds neighbours; every column follows. Those that are held over a
    /// sort inside an advective step are needed at its end.
    fn sort(&mut self) {
        self.liquid.sort(&mut self.own);
        resize(&mut self.own.force, self.liquid.len(), [0.0; 3]);
        self.liquid.flow.find();
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
        self.liquid.now.time
    }

    fn step_count(&self) -> u64 {
        self.liquid.now.step
    }

    fn len(&self) -> usize {
        self.liquid.len()
    }

    fn meet(&mut self, interval: f64) {
        self.liquid.beat = Beat { interval };
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
        let mut state = self.liquid.state(&self.own);
        self.model.save(&mut state);
        self.control.steps.save(&mut state);
        if self.books() {
            self.liquid.ledger.save(&mut state);
        }
        if self.liquid.adapts() {
            self.adaption.save(&mut state);
        }
        state
    }

    fn frame(&self) -> Frame {
        self.make_frame()
    }

    fn unrest(&self) -> (f64, f64) {
        let supported = |i: usize| self.kernel_sum(i) >= SURFACE;
        let spread = frame::deviation(&self.liquid.flow, self.model.density, supported);
        (self.liquid.budget()[0], spread)
    }

    fn limits(&self) -> Vec<(&'static str, f64)> {
        self.limits_now().all()
    }

    fn memory(&self) -> (f64, f64) {
        let sums = 16 * self.sums.capacity();
        self.liquid.memory(&self.own, self.control.memory() + sums)
    }
}
