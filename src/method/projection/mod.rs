//! Projection methods: an explicit step, then the pressure that makes its velocity keep the volume.
//!
//! (1) v* = v^n + dt (viscosity + tension + g),  r* = r^n + dt v*
//! (2) the pressure equation at r*: SUM w (p_a - p_b) + surface terms = right-hand side
//! (3) v^(n+1) = v* - dt grad p / rho
//! (4) r^(n+1) = r^n + dt v, v the mean of v^n and v^(n+1), or v^(n+1) (MPS at theta = 1)
//!
//! With `theta` below 1, (1) to (3) go over theta dt, and v^n + (v - v^n) / theta is v^(n+1) (theta
//! method). At 1, implicit Euler, a step takes (dt grad p / rho)^2 / 2 of the kinetic energy, and
//! an impact is all pressure: a crater came out 9 % narrow. Below, it takes 2 theta - 1 of that; at
//! 1/2 what divergence (2) and (3) leave would change its sign forever.
//!
//! Particles at a free surface with less than 0.9 of their support ask for no pressure below
//! -cohesion (d - 1) sigma / h: to hold a sheet of one or two would cost its energy, 37 % in 3 ms.
//!
//! What [`super::isph`] and [`super::mps`] do each in their own way is a [`Scheme`]: sums, weights,
//! gradients. The rest is here: walls are [`walls`], free surfaces [`surface`], the equation and
//! its solvers [`super::pressure`], shifting [`shift`], the momentum of corrected gradients
//! [`closed`].
//!
//! Time step: courant s0 / u, u the largest speed of what is not spray (and no spray crosses more
//! than a spacing), and the viscous, capillary and force limits of [`super::limit`],
//! between `shortest` and `longest`. A gradient with p_a + p_b is a spring between particles, of
//! (omega s0)^2 = 4 to 8 p / rho (a lattice, its rows moving against each other), explicit and so
//! unstable beyond omega dt = 2: dt <= s0 / (4 sqrt(p / rho)) with the largest p. A solution that
//! does not converge is tried again with the diagonal preconditioner, then over half the step, as
//! is a step that throws a particle two spacings, five times; then the run has diverged.
//! Fails where: (2) and (3) are not the same operator, so that v^(n+1) keeps some divergence;
//! [`transposed`] is the form in which they are.
//! Tests: tests/engine/{projection,pressure}_*.rs, tests/validation.

mod closed;
pub mod correction;
mod links;
pub mod look;
mod product;
mod ranks;
mod report;
mod rings;
mod shift;
mod solve;
mod step;
pub mod surface;
pub mod transposed;
pub(super) mod walls;

use super::adapt::Adaption;
use super::frame::{self, Beat};
use super::liquid::Liquid;
use super::model::Case;
use super::pressure::multigrid::Domain;
use super::pressure::{Equation, Outcome, Solver as PressureSolver};
use super::shifting::LOOSE;
use super::{Diverged, Solver};
use crate::columns;
use crate::effect::band::Band;
use crate::kernel::Kernel;
use crate::kernel::ring::Rings;
use crate::particle::column::{Entry, Role, Scalar, Scalars};
use crate::particle::{Frame, State};
use crate::scene::{PoissonSource, Projection as Settings};
use closed::Closed;
use look::{Local, Sums};
use std::mem::size_of;
use std::ops::Index;
use surface::Completion;
use transposed::{Transposed, Weight};
use walls::Walls;

/// Less of the support than this is liquid at the free surface: 0.75 or so in the top layer of a
/// lattice, more than 0.95 in the next.
const SURFACE: f64 = 0.9;

/// What a method does in its own way. `p` is the solver that it belongs to.
pub(super) trait Scheme: Sized + Send + Sync {
    /// As in `method.NAME` of a scene.
    const NAME: &'static str;
    /// Whether particles move with the mean of old and new velocity at theta = 1 too.
    const TRAPEZOIDAL: bool;
    /// The kernel of walls, free surface and shifting.
    type Kernel: Kernel;
    /// What the explicit half sums beside the kernel.
    type Own: Entry;
    /// The weight of gradients.
    type Weight: Weight;
    /// Sums along a row of the equation: w q^2; w c of the neighbours; w d (3); w c of the target;
    /// the method's own.
    type Row: Copy + Default + Send + Sync + Index<usize, Output = f32>;

    /// How the equation ends at a free surface.
    fn completion(&self, case: &Case) -> Completion;
    /// Whether the gradient has p_a + p_b, so that pressure alone pushes particles apart.
    fn is_symmetric(&self) -> bool;
    /// Whether the gradient is the transpose of the divergence, in the equation too.
    fn is_transposed(&self) -> bool;
    /// Whether the gradient is exact for a linear p and keeps no momentum by itself.
    fn is_corrected(&self) -> bool;
    /// Whether wall particles have a density.
    fn walls_are_dense(p: &Projection<Self>) -> bool;
    /// Fills `around` at r^n, and `held` with the acceleration of viscosity.
    fn look_around(p: &mut Projection<Self>);
    /// Whether particle `i` is at the surface, where a number decides.
    fn threshold(p: &Projection<Self>, i: usize) -> Option<bool>;
    /// Fills `local` at r*, but for its density. Records hold v*.
    fn look(p: &mut Projection<Self>);
    /// Fills the density of wall particles, over rho0, with what the liquid adds.
    fn look_at_walls(p: &mut Projection<Self>);
    /// What wall particles add to each other at a distance of `q` h; 0: a particle to itself.
    fn wall_to_wall(p: &Projection<Self>, q: f64) -> f64;
    /// Fills coupling, diagonal and sums of the equation.
    fn couple(p: &mut Projection<Self>);
    /// What is coupled to p = 0, where flags decide; `degree`: the diagonal so far.
    fn flagged(p: &Projection<Self>, i: usize, degree: f64) -> Option<f64>;
    /// Whether p = 0 is given for the unknown `i`.
    fn given(p: &Projection<Self>, i: usize) -> bool;
    /// Density of the rows of liquid particle `i`, and of what the source sees, over rho0.
    fn dense(p: &Projection<Self>, i: usize) -> [f64; 2];
    /// The Laplacian of p / rho over SUM w (p_b - p_a), m^3/(kg m^2).
    fn unit(p: &Projection<Self>) -> f64;
    /// Fills `push` with -grad p / rho.
    fn slope(p: &mut Projection<Self>);
    /// Of rings: kernels K of which -K'/q is the weight of gradients and that of the equation.
    fn of_rings(&self) -> [Rings; 2];
    /// Whether a density that is completed near a surface can take the place of the divergence:
    /// gradients have the weight of the kernel.
    const COMPLETES: bool = false;
    /// The weight of gradients, and its factor c, 1/m.
    fn weight(p: &Projection<Self>) -> (Self::Weight, f64);
    /// Bytes held.
    fn memory(&self) -> usize;
}

columns! {
    /// What a projection keeps of a particle; `T`: what its method sums beside the kernel.
    pub(super) struct Own<T> as this {
        /// Pa; the last one is the first guess of the next.
        pub pressure: f64 => Role::Persistent("pressure"),
        /// Kernel sum at r^n, where mist is removed at the next rebuild.
        pub kernel_sum: f32 => Role::Persistent("kernel_sum"),
        pub around: Sums<T> => Role::Held,
        /// Explicit acceleration, m/s^2.
        pub held: [f32; 3] => Role::Scratch,
        /// What of it is not of effects, of a tension that has an energy; else empty.
        pub steady: [f32; 3] => Role::Scratch,
        /// Whether it is at the free surface.
        pub is_surface: bool => Role::Scratch,
        /// Whether a particle of the surface may be in the support, and how many are.
        pub near: bool => Role::Scratch,
        pub marks: f32 => Role::Scratch,
        /// The neighbourhood at r*.
        pub local: Local => Role::Scratch,
        /// Pressure acceleration of a step, m/s^2.
        pub push: [f32; 3] => Role::Scratch,
    }
}

impl<T: Entry> Entry for Sums<T> {}

impl Entry for Local {}

/// The solver.
pub(super) struct Projection<S: Scheme> {
    pub liquid: Liquid,
    pub own: Own<S::Own>,
    pub settings: Settings,
    pub scheme: S,
    /// Largest pressure, Pa.
    peak: f64,
    /// Pressure of the particles and of the groups of wall particles, Pa.
    pub unknown: Vec<f64>,
    /// Positions and velocities at the start of a step.
    before: [[Vec<f64>; 3]; 2],
    pub walls: Walls,
    pub closure: Completion,
    closed: Closed,
    pub equation: Equation,
    pub sums: Vec<S::Row>,
    solver: PressureSolver,
    solution: Solution,
    band: Band,
    /// Velocity of the walls that viscosity sees, m/s.
    viscous: Vec<[f32; 3]>,
    transposed: Transposed,
    adaption: Adaption,
}

/// How the pressure was found.
#[derive(Clone, Copy)]
struct Solution {
    outcome: Outcome,
    /// Repeated solutions of the run.
    repeated: u64,
}

impl Scalars for Solution {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("pressure_iterations", &mut self.outcome.iterations);
        see("pressure_residual", &mut self.outcome.residual);
        see("pressure_repeated", &mut self.repeated);
    }
}

impl<S: Scheme> Projection<S> {
    pub fn new((settings, scheme): (Settings, S), liquid: Liquid, state: &State) -> Self {
        let n = liquid.len();
        let dries = scheme.is_transposed() && liquid.follows_energy();
        let walls = Walls::new(&liquid.case, &liquid.flow.wall, dries);
        let volume = liquid.flow.particles.mass / liquid.case.density;
        let cell = liquid.case.spacing.powi(liquid.case.space as i32);
        let closure = scheme.completion(&liquid.case);
        let closure = match liquid.flow.is_axial() {
            true => closure.of_rings(),
            false => closure.of_volume(volume / cell),
        };
        let mut own = Own {
            pressure: vec![0.0; n],
            kernel_sum: Vec::new(),
            around: vec![Sums::default(); n],
            held: vec![[0.0; 3]; n],
            steady: Vec::new(),
            is_surface: Vec::new(),
            near: Vec::new(),
            marks: Vec::new(),
            local: Vec::new(),
            push: Vec::new(),
        };
        Liquid::load(state, &mut own);
        let mut solution = Solution {
            outcome: Outcome {
                iterations: 0,
                residual: 0.0,
                converged: true,
            },
            repeated: 0,
        };
        solution.load(state);
        let mut solver = Projection {
            liquid,
            own,
            settings,
            scheme,
            peak: 0.0,
            unknown: Vec::new(),
            before: Default::default(),
            walls,
            closure,
            closed: Closed::default(),
            equation: Equation::default(),
            sums: Vec::new(),
            solver: PressureSolver::default(),
            solution,
            band: Band::default(),
            viscous: Vec::new(),
            transposed: Transposed::default(),
            adaption: Adaption::of(state),
        };
        solver.peak = solver.peak();
        solver.liquid.ledger.pressure.get_or_insert(0.0);
        solver.find_surface();
        solver
    }

    /// V norm / h^(d+k), V = m / rho0.
    pub fn factor(&self, k: i32) -> f64 {
        let d = self.liquid.case.space;
        let volume = self.liquid.flow.particles.mass / self.liquid.case.density;
        volume * S::Kernel::norm(d) / self.liquid.case.h.powi(d as i32 + k)
    }

    /// norm s0^d / h^d: turns `Sums::kernel` into the kernel sum.
    fn sum_factor(&self) -> f32 {
        let d = self.liquid.case.space;
        (S::Kernel::norm(d) * (self.liquid.case.spacing / self.liquid.case.h).powi(d as i32)) as f32
    }

    /// Axes along which anything varies.
    pub fn active(&self) -> [bool; 3] {
        self.liquid.flow.grid.unit.map(|unit| unit > 0.0)
    }

    /// Kernel sum of particle `i` at r^n: 1 inside.
    #[inline(always)]
    fn kernel_sum(&self, i: usize) -> f32 {
        self.sum_factor() * self.own.around[i].kernel
    }

    /// Whether particle `i` is at the free surface, at r^n: less than [`SURFACE`] of its support is
    /// liquid, or hardly anything is near. A thin liquid is no surface.
    #[inline(always)]
    fn is_surface(&self, i: usize) -> bool {
        if let Some(below) = S::threshold(self, i) {
            return below;
        }
        let Sums { kernel, slope, .. } = self.own.around[i];
        let steep = slope
            .iter()
            .map(|s| (*s as f64).powi(2))
            .sum::<f64>()
            .sqrt();
        self.kernel_sum(i) < LOOSE || self.closure.share.at(steep / kernel as f64)[0] < SURFACE
    }

    /// Whether the source is density alone, as printed: walls with a density, without offsets.
    pub fn is_printed(&self) -> bool {
        self.settings.source == PoissonSource::Density
    }
}

impl<S: Scheme> Solver for Projection<S> {
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
        self.advance_step()?;
        on_step(self);
        Ok(())
    }

    fn state(&self) -> State {
        let mut state = self.liquid.state(&self.own);
        self.solution.save(&mut state);
        self.liquid.ledger.save(&mut state);
        if self.liquid.adapts() {
            self.adaption.save(&mut state);
        }
        state
    }

    fn frame(&self) -> Frame {
        self.make_frame()
    }

    fn unrest(&self) -> (f64, f64) {
        let supported = |i: usize| self.own.marks.get(i) == Some(&0.0);
        let spread = frame::deviation(&self.liquid.flow, self.liquid.case.density, supported);
        (self.liquid.budget()[0], spread)
    }

    fn limits(&self) -> Vec<(&'static str, f64)> {
        self.step_limits()
    }

    fn memory(&self) -> (f64, f64) {
        let more = 8 * self.unknown.capacity()
            + 48 * self.before[0][0].capacity()
            + size_of::<S::Row>() * self.sums.capacity()
            + self.scheme.memory()
            + self.closed.memory()
            + self.band.memory()
            + self.transposed.memory()
            + self.solver.memory();
        let (bare, whole) = self.liquid.memory(&self.own, more);
        let n = self.liquid.len().max(1) as f64;
        (bare, whole + self.equation.memory() as f64 / n)
    }

    fn equation(&mut self) -> Option<(&mut Equation, Domain)> {
        let domain = self.domain();
        Some((&mut self.equation, domain))
    }
}
