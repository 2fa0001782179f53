//! MPS, the moving particle semi-implicit method, as Xie, Koshizuka & Oka (2007) use it.
//!
//! (1) w = r_e / r - 1 for r < r_e                                                Eq. 3
//! (2) n_i = SUM w_ij,  n0: that of the lattice                                   Eq. 4
//! (3) grad p = d / n0 SUM (p_j - p_i) (r_j - r_i) / r^2 w                        Eq. 5
//! (4) lap p = 2 d / (n0 lambda) SUM (p_j - p_i) w,  n0 lambda = SUM r^2 w        Eqs. 6, 7
//! (5) v* = v^n + dt (nu lap v + tension + g),  r* = r^n + dt v*                  Eqs. 2, 9
//! (6) lap p = -rho / dt^2 (n* - n0) / n0; with `source.divergence`
//!     lap p = rho (div v* / dt - gamma (n - n0) / (n0 dt^2))                     Eq. 8
//!     (Tanaka & Masunaga 2010)
//! (7) v^(n+1) = v* - dt grad p / rho,  r^(n+1) = r^n + dt v^(n+1)
//!
//! Not in the paper: p = 0 where n < beta n0 (Koshizuka & Oka 1996); in (3) p_i is the least p
//! about i (Koshizuka, Nobe & Oka 1998). `gradient.symmetric` has p_j + p_i, each less the least
//! about it, in its place (Khayyer & Gotoh 2008): momentum is kept between liquid particles.
//! `corrected` is (3) times (d / n0 SUM w r r / r^2)^-1, exact for linear p (Khayyer & Gotoh 2011;
//! Tamai & Koshizuka 2014), but p_j + p_i where a surface is in the support; div v* likewise.
//! `closure.completed` is that of ISPH, [`super::isph::surface`], with the weights of (4); there
//! and in the shifting a smooth kernel of h = r_e / 2 shows the surface. Walls:
//! [`super::isph::walls`].
//!
//! Time step: courant l0 / u_max, and the viscous, capillary and force limits of [`super::limit`],
//! between `shortest` and `longest`. The paper gives none. A pressure that cannot be found is
//! treated as in ISPH. Fails with `courant` 0.25 (vortices), and with `corrected` and `paper` in a
//! hydrostatic column (docs/validation.md); where (6) and (7) are not the same operator, so that
//! v^(n+1) keeps some divergence; (6) as printed turns noise of n into pressure.
//! The tension of Eqs. 10-16 and the wetting of Eq. 18 are not here: `effect::tension` serves.
//! Tests: tests/engine/mps_*.rs, tests/validation.

pub mod pass;
mod project;
mod report;
mod shift;
mod step;

use super::flow::Flow;
use super::isph::surface;
use super::isph::walls::Walls;
use super::model::Case;
use super::pressure::{Equation, Outcome, Solver as PressureSolver};
use super::shifting::LOOSE;
use super::{Diverged, Solver};
use crate::effect::tension::Tension;
use crate::kernel::{Kernel, WendlandC2};
use crate::particle::{Frame, State};
use crate::scene::{Mps as Settings, MpsClosure, PoissonSource};
use crate::space::parallel::{max, sum};
use pass::{Local, Sums};

/// The kernel of the free surface and of the shifting.
pub type Smooth = WendlandC2;

/// Less of the support than this is liquid at the free surface, as in ISPH.
const SURFACE: f64 = 0.9;

/// A particle with a kernel sum below this that crosses a periodic side is mist, as in WCSPH.
const MIST: f32 = 0.4;

/// Sums of the weight (1) over the lattice, the particle itself left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// n0 = SUM w.
    pub number: f64,
    /// n0 lambda = SUM r^2 w, in squared spacings.
    pub spread: f64,
}

impl Lattice {
    /// For `radius` = r_e / l0 in `dimension` dimensions.
    pub fn of(radius: f64, dimension: usize) -> Self {
        let reach = radius.ceil() as i64;
        let depth = if dimension == 3 { reach } else { 0 };
        let (mut number, mut spread) = (0.0, 0.0);
        for x in -reach..=reach {
            for y in -depth..=depth {
                for z in -reach..=reach {
                    let r = ((x * x + y * y + z * z) as f64).sqrt();
                    if r > 0.0 && r < radius {
                        number += radius / r - 1.0;
                        spread += (radius / r - 1.0) * r * r;
                    }
                }
            }
        }
        Lattice { number, spread }
    }
}

/// The solver.
pub struct Mps {
    case: Case,
    settings: Settings,
    flow: Flow,
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
    walls: Walls,
    closure: surface::Completion,
    equation: Equation,
    sums: Vec<[f32; 7]>,
    /// 1, or 0 where p = 0 is given, by unknown.
    inside: Vec<f32>,
    /// Least pressure about, Pa, by liquid and wall particle.
    least: Vec<f64>,
    /// The lattice at the radii of (2), (3) and of (4).
    lattice: Lattice,
    laplacian: Lattice,
    solver: PressureSolver,
    outcome: Outcome,
    /// Repeated solutions of the run.
    repeated: u64,
    pool: bool,
    scratch: Scratch,
}

/// Kept, so that a step allocates nothing.
#[derive(Default)]
struct Scratch {
    mist: Vec<bool>,
    f64s: Vec<f64>,
    around: Vec<Sums>,
    viscous: Vec<[f32; 3]>,
}

impl Mps {
    pub(super) fn new(
        case: Case,
        settings: Settings,
        mut flow: Flow,
        tension: Option<Tension>,
        state: &State,
        pool: bool,
    ) -> Self {
        flow.wall_sees_wall =
            settings.source == PoissonSource::Density || settings.closure == MpsClosure::Threshold;
        let d = case.dimension.count();
        let lattice = Lattice::of(settings.radius, d);
        let laplacian = Lattice::of(settings.laplacian_radius, d);
        let named = |name: &str| state.scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        flow.removed = (
            named("removed_mass_kg").unwrap_or(0.0),
            named("removed_particles").unwrap_or(0.0) as u64,
        );
        let n = flow.liquid();
        let array = |name: &str| state.arrays.iter().find(|a| a.0 == name).map(|a| &a.1);
        let walls = Walls::new(&case, &flow.wall);
        let closure = surface::Completion::of::<Smooth>(case.sph.kernel, d, case.sph.smoothing)
            .with_full(laplacian.number);
        let mut solver = Mps {
            case,
            settings,
            flow,
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
            inside: Vec::new(),
            least: Vec::new(),
            lattice,
            laplacian,
            solver: PressureSolver::default(),
            outcome: Outcome {
                iterations: named("pressure_iterations").unwrap_or(0.0) as usize,
                residual: named("pressure_residual").unwrap_or(0.0),
                converged: true,
            },
            repeated: named("pressure_repeated").unwrap_or(0.0) as u64,
            pool,
            scratch: Scratch::default(),
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

    /// r_e / h of number density and gradient, and of the Laplacian.
    fn reach(&self) -> f32 {
        (self.settings.radius / self.case.sph.smoothing) as f32
    }

    fn laplacian_reach(&self) -> f32 {
        (self.settings.laplacian_radius / self.case.sph.smoothing) as f32
    }

    /// d / n0 of (3).
    fn gradient_factor(&self) -> f64 {
        self.case.dimension.count() as f64 / self.lattice.number
    }

    /// 2 d / (n0 lambda) of (4), 1/m^2.
    fn laplacian_factor(&self) -> f64 {
        let spread = self.laplacian.spread * self.case.spacing.powi(2);
        2.0 * self.case.dimension.count() as f64 / spread
    }

    /// norm s0^d / h^d: turns a sum of w into the kernel sum.
    fn sum_factor(&self) -> f32 {
        let d = self.case.dimension.count();
        (Smooth::norm(d) * (self.case.spacing / self.case.h).powi(d as i32)) as f32
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

    /// Whether particle `i` is at the free surface, at r^n: n < beta n0, or less than [`SURFACE`]
    /// of its support is liquid or hardly anything is near.
    #[inline(always)]
    fn is_surface(&self, i: usize) -> bool {
        let Sums {
            kernel,
            slope,
            number,
        } = self.around[i];
        if self.settings.closure == MpsClosure::Threshold {
            return (number as f64) < self.settings.beta;
        }
        let steep = slope
            .iter()
            .map(|s| (*s as f64).powi(2))
            .sum::<f64>()
            .sqrt();
        self.kernel_sum(i) < LOOSE || self.closure.share.at(steep / kernel as f64)[0] < SURFACE
    }

    /// Whether Eq. 8 stands as printed: walls with a number density and without offsets.
    fn is_printed(&self) -> bool {
        self.settings.source == PoissonSource::Density
    }
}

impl Solver for Mps {
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
            + 28 * self.sums.capacity()
            + 4 * self.inside.capacity()
            + 8 * self.least.capacity()
            + self.solver.memory()
            + self.tension.as_ref().map_or(0, Tension::memory);
        let (bare, whole) = self.flow.memory();
        let own = own as f64 / n;
        (bare + own, whole + own + self.equation.memory() as f64 / n)
    }
}
