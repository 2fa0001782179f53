//! Incompressible SPH: the two-step projection of Kuri et al.
//!
//! (1) v* = v^n + dt (viscosity + tension + g),  r* = r^n + dt v*                 Kuri Eqs. 1, 2
//! (2) rho_a = SUM m W_ab at r*                                                   Eq. 4
//! (3) SUM m 8 / (rho_a + rho_b)^2 (r . grad W) / r^2 (p_a - p_b) = right-hand side    Eq. 8
//!     right-hand side, as printed: (rho0 - rho) / (rho0 dt^2); with `source.divergence`:
//!     div v* / dt + gamma (rho0 - rho) / (rho0 dt^2), rho = rho0 in the weights (Cummins & Rudman
//!     1999; gamma: Asai et al. 2012)
//! (4) at a free surface: [`surface`]                                             Eq. 11
//! (5) v^(n+1) = v* - dt grad p / rho                                             Eq. 9
//! (6) r^(n+1) = r^n + dt (v^n + v^(n+1)) / 2                                     Eq. 10
//!
//! `gradient.symmetric` is Eq. 9 as printed, which keeps momentum; `corrected` is
//! SUM V (p_b - p_a) L grad W with the matrix L of Bonet & Lok 1999, exact for linear p, but Eq. 9
//! where a surface is in the support: differences do not hold a surface together. Walls:
//! [`walls`]. The equation and its solvers: [`super::pressure`]. Shifting: [`shift`].
//!
//! Time step: courant s0 / u_max, and the viscous, capillary and force limits of [`super::limit`],
//! between `shortest` and `longest`. The paper gives 5 to 20 us "by the largest speed" and no law.
//! A solution that does not converge is tried again with the diagonal preconditioner, then over
//! half the step, five times; then the run has diverged, its state as before the step.
//! Fails where: (3) and (5) are not the same operator, so that v^(n+1) keeps some divergence;
//! Eq. 8 as printed turns noise of density into pressure (0.1 % at 10 us: 100 to 700 Pa).
//! Tests: tests/engine/isph_*.rs, tests/validation.

pub mod correction;
pub mod pass;
mod project;
mod report;
mod shift;
mod step;
pub mod surface;
pub(super) mod walls;

use super::flow::Flow;
use super::model::Case;
use super::pressure::{Equation, Outcome, Solver as PressureSolver};
use super::shifting::LOOSE;
use super::{Diverged, Solver};
use crate::effect::tension::Tension;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::particle::{Frame, State};
use crate::scene::{Isph as Settings, PoissonSource};
use crate::space::parallel::{max, sum};
use pass::{Local, Sums};
use std::marker::PhantomData;

/// Less of the support than this is liquid at the free surface: 0.75 or so in the top layer of a
/// lattice, more than 0.95 in the next.
const SURFACE: f64 = 0.9;

/// A particle with a kernel sum below this that crosses a periodic side is mist, as in WCSPH.
const MIST: f32 = 0.4;

/// The solver. `K`: kernel; `V`: viscosity, `()` for none.
pub struct Isph<K, V> {
    case: Case,
    settings: Settings,
    flow: Flow,
    viscosity: V,
    tension: Option<Tension>,
    time: f64,
    step: u64,
    last_step: f64,
    /// Largest speed, m/s, and explicit acceleration, m/s^2, of the last step.
    fastest: f64,
    hardest: f64,
    /// Explicit acceleration, m/s^2.
    held: Vec<[f32; 3]>,
    around: Vec<Sums>,
    /// Particles of the surface in the support.
    marks: Vec<f32>,
    local: Vec<Local>,
    /// Pa, by liquid particle.
    pressure: Vec<f64>,
    /// The same and that of the groups of wall particles.
    unknown: Vec<f64>,
    /// Pressure acceleration of a step, m/s^2.
    push: Vec<[f32; 3]>,
    /// Positions and velocities at the start of a step.
    before: [[Vec<f64>; 3]; 2],
    walls: walls::Walls,
    closure: surface::Completion,
    equation: Equation,
    sums: Vec<[f32; 6]>,
    solver: PressureSolver,
    outcome: Outcome,
    /// Repeated solutions of the run.
    repeated: u64,
    pool: bool,
    scratch: Scratch,
    kernel: PhantomData<K>,
}

/// Kept, so that a step allocates nothing.
#[derive(Default)]
struct Scratch {
    mist: Vec<bool>,
    f64s: Vec<f64>,
    around: Vec<Sums>,
    mirrored: Vec<bool>,
    viscous: Vec<[f32; 3]>,
}

impl<K: Kernel, V: PairViscosity> Isph<K, V> {
    pub(super) fn new(
        case: Case,
        settings: Settings,
        mut flow: Flow,
        viscosity: V,
        tension: Option<Tension>,
        state: &State,
        pool: bool,
    ) -> Self {
        flow.wall_sees_wall = settings.source == PoissonSource::Density;
        let named = |name: &str| state.scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        flow.removed = (
            named("removed_mass_kg").unwrap_or(0.0),
            named("removed_particles").unwrap_or(0.0) as u64,
        );
        let n = flow.liquid();
        let array = |name: &str| state.arrays.iter().find(|a| a.0 == name).map(|a| &a.1);
        let walls = walls::Walls::new(&case, &flow.wall);
        let closure = surface::Completion::of::<K>(
            case.sph.kernel,
            case.dimension.count(),
            case.sph.smoothing,
        );
        let mut solver = Isph {
            case,
            settings,
            flow,
            viscosity,
            tension,
            time: state.time,
            step: state.step,
            last_step: named("time_step_s").unwrap_or(0.0),
            fastest: 0.0,
            hardest: named("acceleration_m_s2").unwrap_or(0.0),
            held: vec![[0.0; 3]; n],
            around: vec![Sums::default(); n],
            marks: Vec::new(),
            local: Vec::new(),
            pressure: array("pressure").map_or(vec![0.0; n], Clone::clone),
            unknown: Vec::new(),
            push: Vec::new(),
            before: Default::default(),
            walls,
            closure,
            equation: Equation::default(),
            sums: Vec::new(),
            solver: PressureSolver::default(),
            outcome: Outcome {
                iterations: named("pressure_iterations").unwrap_or(0.0) as usize,
                residual: named("pressure_residual").unwrap_or(0.0),
                converged: true,
            },
            repeated: named("pressure_repeated").unwrap_or(0.0) as u64,
            pool,
            scratch: Scratch::default(),
            kernel: PhantomData,
        };
        if let Some(sums) = array("kernel_sum") {
            let around = solver.around.iter_mut().zip(sums);
            around.for_each(|(s, x)| s.kernel = *x as f32);
        }
        solver.fastest = solver.speed();
        solver
    }

    fn scale(&self) -> [f32; 3] {
        self.flow.grid.scale(self.case.h)
    }

    /// V norm / h^(d+k), V = m / rho0.
    fn factor(&self, k: i32) -> f64 {
        let d = self.case.dimension.count();
        let volume = self.flow.particles.mass / self.case.density;
        volume * K::norm(d) / self.case.h.powi(d as i32 + k)
    }

    /// norm s0^d / h^d: turns [`Surroundings::sum`] into the kernel sum.
    fn sum_factor(&self) -> f32 {
        let d = self.case.dimension.count();
        (K::norm(d) * (self.case.spacing / self.case.h).powi(d as i32)) as f32
    }

    /// Largest speed now, m/s.
    fn speed(&self) -> f64 {
        let p = &self.flow.particles;
        max(p.len(), |i| p.speed(i)).max(0.0)
    }

    /// Kernel sum of particle `i` at r^n: 1 inside.
    #[inline(always)]
    fn kernel_sum(&self, i: usize) -> f32 {
        self.sum_factor() * self.around[i].kernel
    }

    /// Whether particle `i` is at the free surface, at r^n: less than [`SURFACE`] of its support is
    /// liquid, or hardly anything is near. A thin liquid is no surface.
    #[inline(always)]
    fn is_surface(&self, i: usize) -> bool {
        let Sums { kernel, slope, .. } = self.around[i];
        let steep = slope
            .iter()
            .map(|s| (*s as f64).powi(2))
            .sum::<f64>()
            .sqrt();
        self.kernel_sum(i) < LOOSE || self.closure.share.at(steep / kernel as f64)[0] < SURFACE
    }

    /// Whether Eq. 8 stands as printed: densities of r* in the weights, walls with a density.
    fn is_printed(&self) -> bool {
        self.settings.source == PoissonSource::Density
    }
}

impl<K: Kernel, V: PairViscosity> Solver for Isph<K, V> {
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
        self.advance_step()?;
        on_step(self);
        Ok(())
    }

    fn state(&self) -> State {
        let mut scalars = vec![
            ("removed_mass_kg".to_string(), self.flow.removed.0),
            ("removed_particles".to_string(), self.flow.removed.1 as f64),
            ("time_step_s".to_string(), self.last_step),
            ("acceleration_m_s2".to_string(), self.hardest),
        ];
        let solution = self.solution_scalars();
        scalars.extend(solution.map(|(name, value)| (name.to_string(), value)));
        if let Some(tension) = &self.tension {
            scalars.push(("tension_strength".to_string(), tension.strength));
        }
        // The last pressure is the first guess of the next; kernel sums decide on mist.
        let mut arrays = vec![("pressure".to_string(), self.pressure.clone())];
        if self.pool {
            let sums = self.around.iter().map(|s| s.kernel as f64).collect();
            arrays.push(("kernel_sum".to_string(), sums));
        }
        State {
            time: self.time,
            step: self.step,
            particles: self.flow.particles.clone(),
            scalars,
            arrays,
        }
    }

    fn frame(&self) -> Frame {
        self.make_frame()
    }

    fn unrest(&self) -> (f64, f64) {
        let kinetic = self.budget()[0];
        let rho0 = self.case.density;
        let [squares, count] = sum(self.flow.liquid(), |i| {
            let d = self.flow.particles.density[i] - rho0;
            match self.marks.get(i) {
                Some(0.0) => [d * d, 1.0],
                _ => [0.0, 0.0],
            }
        });
        (kinetic, (squares / count.max(1.0)).sqrt())
    }

    fn limits(&self) -> Vec<(&'static str, f64)> {
        self.step_limits()
    }

    fn memory(&self) -> (f64, f64) {
        let n = self.len().max(1) as f64;
        let own = 8 * (self.pressure.capacity() + self.unknown.capacity())
            + 48 * self.before[0][0].capacity()
            + 12 * (self.held.capacity() + self.push.capacity())
            + 4 * self.marks.capacity()
            + std::mem::size_of::<Local>() * self.local.capacity()
            + std::mem::size_of::<Sums>() * self.around.capacity() * 2
            + 24 * self.sums.capacity()
            + self.solver.memory()
            + self.tension.as_ref().map_or(0, Tension::memory);
        let (bare, whole) = self.flow.memory();
        let own = own as f64 / n;
        (bare + own, whole + own + self.equation.memory() as f64 / n)
    }
}
