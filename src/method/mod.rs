//! One solver a file.

pub mod adapt;
mod budget;
pub mod calibrate;
pub mod completed;
pub mod flow;
pub mod frame;
pub mod isph;
pub mod ledger;
pub mod limit;
pub mod liquid;
pub mod model;
pub mod mps;
pub mod pass;
pub mod pressure;
pub mod projection;
pub mod rest;
pub mod ring;
pub mod shared;
pub mod shifting;
pub mod start;
pub mod wcsph;
pub mod wet;

pub use calibrate::{Calibration, calibrate, is_of_packing};
pub use start::{initial, intruders, relaxed, resting};

use crate::effect::select;
use crate::effect::surface::Surface;
use crate::effect::tension::{Tension, energy};
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::particle::wall::{self, layers};
use crate::particle::{Frame, Particles, Shares, State, Wall};
use crate::scene::{Body, KernelName, Method, Problem, Shape, TensionStrength};
use crate::scene::{Viscosity, ViscosityForm};
use crate::space::ranks::{Communicator, Ranks, broadcast};
use crate::space::row::Source;
use flow::{Flow, Lengths};
use liquid::Liquid;
use model::{Case, Model};
use pressure::Equation;
use pressure::multigrid::{Domain, WIDEST, pitch};
use projection::Projection;
use std::sync::Arc;

/// Physics gone wrong. The caller keeps the last good checkpoint.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "diverged at t = {time:.6e} s, step {step}: particle {particle} at \
     ({x:.4e}, {y:.4e}, {z:.4e}) m: {what}; try {remedy}"
)]
pub struct Diverged {
    /// Simulated time, s.
    pub time: f64,
    /// Steps taken.
    pub step: u64,
    /// Stable identity of the particle.
    pub particle: u32,
    /// Its position, m.
    pub x: f64,
    /// Its position, m.
    pub y: f64,
    /// Its position, m.
    pub z: f64,
    /// Which limit was passed, with both values.
    pub what: String,
    /// A setting to change.
    pub remedy: String,
}

/// A solver that cannot be built or went wrong.
#[derive(Clone, Debug, thiserror::Error)]
pub enum MethodError {
    /// A periodic side is shorter than a kernel support.
    #[error(transparent)]
    TooSmall(#[from] crate::space::grid::TooSmall),
    /// Several processes cannot share the run; the reason.
    #[error("{0}: several processes cannot share this run; start one process")]
    Alone(&'static str),
    /// There is no particle.
    #[error("the state holds no particle; give body.NAME a shape larger than pack.spacing")]
    Empty,
    /// A body has no surface to calibrate the tension on; its name.
    #[error(
        "body {body} has no measurable surface, so the tension cannot be calibrated on it; \
             set effects.tension.strength to a number"
    )]
    NoSurface {
        /// Its name.
        body: String,
    },
}

/// A time-stepping method with its state.
pub trait Solver: Send + Sync {
    /// Simulated time, s.
    fn time(&self) -> f64;
    /// Steps taken.
    fn step_count(&self) -> u64;
    /// Liquid particles now.
    fn len(&self) -> usize;
    /// Whether no particle is left.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// From now on a step ends at every multiple of `interval` s, so that frames are of these
    /// instants; steps of a fixed length keep it.
    fn meet(&mut self, interval: f64);
    /// Advances to the next instant at which the state is complete (a rebuild of the neighbour
    /// lists):
    /// a few steps. `state()` may be called between any two advances, and a solver restored from it
    /// goes on bit for bit. `on_step` sees the solver after every step, for frames.
    fn advance(&mut self, on_step: &mut dyn FnMut(&dyn Solver)) -> Result<(), Diverged>;
    /// Everything that a restart needs. Only right after `advance` or at the start.
    fn state(&self) -> State;
    /// The part of the state that this process has, and what gives those of others.
    fn share(&self) -> (State, Option<Box<dyn Shares + '_>>) {
        (self.state(), None)
    }
    /// What the log shows.
    fn frame(&self) -> Frame;
    /// Kinetic energy, J, and standard deviation of density of supported particles, kg/m^3.
    fn unrest(&self) -> (f64, f64);
    /// Time-step limits by name, s, least first.
    fn limits(&self) -> Vec<(&'static str, f64)>;
    /// Bytes per particle: without neighbour rows, with them.
    fn memory(&self) -> (f64, f64);
    /// The pressure equation of the last step and where multigrid lays its grids, of a method that
    /// has one: for measurements.
    fn equation(&mut self) -> Option<(&mut Equation, Domain)> {
        None
    }
}

/// What a solver is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Bodies move as the scene says.
    Impact,
    /// At rest with damping, 1/s.
    Relax {
        /// 1/s.
        damping: f64,
    },
}

/// Builds the method of a problem on a state (fresh or restored).
///
/// `strength`: calibrated tension strength; `None` takes the one in the state, else the fixed one,
/// else calibrates on the state itself.
pub fn build(
    problem: &Problem,
    state: State,
    phase: Phase,
    strength: Option<f64>,
) -> Result<Box<dyn Solver>, MethodError> {
    if state.particles.body.is_empty() {
        return Err(MethodError::Empty);
    }
    let case = Case::new(problem, phase);
    let strength = strength_of(problem, &case, &state, strength)?;
    build_on(None, problem, case, state, strength, phase)
}

/// The same on several ranks, each of which calls it: on rank 0 the solver of all, on the others
/// one to [`shared::serve`]. Only rank 0 has a `state`.
///
/// # Errors
/// As [`build`], and a problem that several ranks cannot share.
pub fn build_shared(
    with: &Arc<dyn Communicator>,
    problem: &Problem,
    state: Option<State>,
    phase: Phase,
    strength: Option<f64>,
) -> Result<Box<dyn Solver>, MethodError> {
    if let Some(reason) = shared::alone(problem) {
        return Err(MethodError::Alone(reason));
    }
    let case = Case::new(problem, phase);
    let found = state.map(|state| match state.particles.is_empty() {
        true => Err(MethodError::Empty),
        false => strength_of(problem, &case, &state, strength).map(|strength| (state, strength)),
    });
    let known = found
        .as_ref()
        .map(|found| found.as_ref().ok().map(|(_, s)| *s));
    // Where rank 0 cannot begin, the others get nothing.
    let known = broadcast(&**with, 0, known);
    let state = found.transpose()?.map(|(state, _)| state);
    let strength = known.ok_or(MethodError::Empty)?;
    let state = shared::scatter(&**with, state);
    let own = build_on(Some(with), problem, case, state, strength, phase)?;
    let count = shared::counted(&**with, own.len());
    Ok(match with.rank() {
        0 => Box::new(shared::Shared::new(own, with.clone(), count)),
        _ => own,
    })
}

fn build_on(
    with: Option<&Arc<dyn Communicator>>,
    problem: &Problem,
    case: Case,
    state: State,
    strength: f64,
    phase: Phase,
) -> Result<Box<dyn Solver>, MethodError> {
    let wall = match with {
        None => wall::build(problem),
        Some(_) => Wall::default(),
    };
    let mut flow = flow_of(&case, state.particles.clone(), wall)?;
    flow.ranks = with.map(|with| Ranks::new(with.clone(), &flow.grid, flow.liquid()));
    flow.far = far(problem, &case);
    if with.is_some() {
        let problem = problem.clone();
        flow.build_walls = Box::new(move |wanted| wall::build_where(&problem, wanted));
        flow.balance(true);
    }
    let layer = |b: &Body| matches!(b.shape, Shape::Layer { .. });
    let pool = problem.bodies.iter().any(layer);
    let tension = tension_of(&case, strength, problem.method.shifting() > 0.0)
        .or_else(|| normals_of(&case, &problem.method));
    let effects = select::active(&case.effects, problem.stiff_viscosity(), tension);
    let (settings, d, h) = (case.sph, case.space, case.h);
    let mut asked = case.effects.clone();
    if matches!(problem.method, Method::Wcsph(_)) && case.shifts(problem.method.shifting()) {
        // Shifting reads relative speeds, which are found with viscosity, if only with none.
        let dynamic = 0.0;
        let form = ViscosityForm::Morris;
        asked.viscosity = asked.viscosity.or(Some(Viscosity { dynamic, form }));
    }
    let parts = Parts {
        problem,
        phase,
        liquid: Liquid::new(case, flow, effects, pool, &state),
        state: &state,
    };
    Ok(select::pair(&asked, &settings, d, h, parts))
}

/// How far ranks must see each other beside the reach of sums over pairs, m.
fn far(problem: &Problem, case: &Case) -> f64 {
    let grids = match case.is_implicit {
        true => WIDEST * pitch(case),
        false => 0.0,
    };
    let leaning = problem
        .effects
        .wetting
        .filter(|angle| problem.shears(angle));
    // Sums about points that a line's angle puts above the particles of a wall.
    let feet = leaning.map_or(0.0, |angle| {
        let depth = layers(problem) as f64 * case.spacing;
        angle.steepest() * depth + 2.0 * case.widest
    });
    grids.max(feet)
}

/// The given strength of the tension, else that of the state, else as the scene says.
fn strength_of(
    problem: &Problem,
    case: &Case,
    state: &State,
    given: Option<f64>,
) -> Result<f64, MethodError> {
    let Some(tension) = case.effects.tension else {
        return Ok(0.0);
    };
    let mut scalars = state.scalars.iter();
    let stored = scalars.find(|s| s.0 == "tension_strength").map(|s| s.1);
    Ok(match (given.or(stored), tension.strength) {
        (Some(alpha), _) | (None, TensionStrength::Fixed(alpha)) => alpha,
        (None, TensionStrength::Flat) if case.follows_energy() => 1.0,
        (None, TensionStrength::Flat) => select::flat_strength(&case.sph, case.space),
        (None, TensionStrength::Virial) => {
            let first = state.particles.body.first().copied().unwrap_or(0);
            let problems = [problem.calm(first as usize)];
            calibrate(&problems, &[start::at_home(problem, state)])?.strength
        }
    })
}

/// The tension of a case, with strength `alpha`; `shifts`: for a method that shifts particles.
fn tension_of(case: &Case, alpha: f64, shifts: bool) -> Option<Tension> {
    let d = case.space;
    let mut tension = select::tension(&case.effects, &case.sph, d, case.h, case.density, alpha)?;
    let lengths = [case.spacing, tension.length];
    tension.wetting = select::wetting(
        &case.effects,
        &case.sph,
        &case.domain,
        case.dimension.count(),
        lengths,
        case.density,
    );
    if let Some(wetting) = &mut tension.wetting {
        wetting.short = shifts.then_some(case.h);
    }
    tension.energy.carried = energy::CARRIED;
    tension.energy.shore = select::shore(&case.effects, &case.domain, case.dimension, case.spacing);
    tension.typed = select::typed(&case.effects, &case.domain, case.spacing);
    Some(tension)
}

/// What shifting needs where there is no tension: its normals.
fn normals_of(case: &Case, method: &Method) -> Option<Tension> {
    let (d, length) = (case.space, method.normals() * case.h);
    let normals = || Tension::normals(case.sph.kernel, length, d, case.density);
    (method.shifting() > 0.0 && !case.domain.is_axial()).then(normals)
}

struct Parts<'a> {
    problem: &'a Problem,
    phase: Phase,
    liquid: Liquid,
    state: &'a State,
}

impl select::Visitor for Parts<'_> {
    type Out = Box<dyn Solver>;
    fn visit<K: Kernel, V: PairViscosity>(self, viscosity: V) -> Box<dyn Solver> {
        let (liquid, state) = (self.liquid, self.state);
        match &self.problem.method {
            Method::Wcsph(settings) => {
                let model = Model::new(self.problem, settings, self.phase);
                Box::new(wcsph::Wcsph::<K, V>::new(model, liquid, viscosity, state))
            }
            Method::Isph(settings) => {
                let mass = liquid.flow.particles.mass;
                let scheme = isph::Isph::<K>::new(settings, viscosity, &liquid.case, mass);
                let parts = (settings.projection, scheme);
                Box::new(Projection::new(parts, liquid, state))
            }
            Method::Mps(settings) => {
                let scheme = mps::Mps::new(settings, &liquid.case);
                let parts = (settings.projection, scheme);
                Box::new(Projection::new(parts, liquid, state))
            }
        }
    }
}

/// Cells and rows for a case's lengths.
fn flow_of(case: &Case, particles: Particles, wall: Wall) -> Result<Flow, MethodError> {
    let support = 2.0 * case.h;
    // Wendland C2: slope (1 - q/2)^3 is below 1.3e-4 of its peak within 0.1 h of the support's
    // edge. A pressure equation must have both halves of a pair or none.
    let late = match case.sph.kernel {
        KernelName::WendlandC2 if !case.is_implicit => 0.1 * case.h,
        _ => 0.0,
    };
    let lengths = Lengths {
        spacing: case.spacing,
        support,
        longest: case.widest,
        late,
        // Spray crosses a spacing in a step of a projection.
        farthest: if case.is_implicit { case.spacing } else { 0.0 },
        deepest: flow::wall::deepest(case.spacing, case.effects.tension.is_some()),
    };
    Ok(Flow::new(
        case.dimension,
        &case.domain,
        lengths,
        case.pairs,
        particles,
        wall,
    )?)
}

/// What the tension reads of a flow.
pub fn surface_of<'a>(flow: &'a Flow, sources: &'a [Source<'a>]) -> Surface<'a> {
    Surface {
        grid: &flow.grid,
        liquid: &flow.liquid_cells,
        at: &flow.at,
        sources,
        liquid_sources: flow.liquid_sources(),
        mirror: flow.mirror.as_ref(),
        ranks: flow.ranks.as_ref().map(|ranks| (ranks, &flow.halo)),
        position: &flow.particles.position,
        wall: &flow.wall.position,
        wall_changes: flow.wall_changes,
        density: &flow.particles.density,
        mass: flow.particles.mass,
        weights: flow
            .is_axial()
            .then_some([&flow.particles.weight, &flow.wall.weight]),
        slack: 2.0 * flow.moved(),
        sorted: flow.sorted,
        extra: flow.extra(),
    }
}
