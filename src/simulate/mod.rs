//! Simulation of a scene by calls from Rust, without files: pack, relax, impact and measure. The
//! results are those of the program, bit for bit.
//!
//! ```
//! let scene = coronet::simulate::scene(r#"
//!     dimension = 2
//!     [box]
//!     size = ["4 mm", "4 mm"]
//!     [liquid]
//!     density = "1000 kg/m^3"
//!     [effects.gravity]
//!     acceleration = "9.81 m/s^2"
//!     [body.drop]
//!     disc = { diameter = "1 mm", centre = ["2 mm", "2 mm"] }
//!     [pack]
//!     spacing = "0.1 mm"
//!     [impact]
//!     end = "1 ms"
//!     [frames]
//!     interval = "0.5 ms"
//! "#)?;
//! let mut simulation = coronet::simulate::Simulation::new(&scene)?;
//! let measures = simulation.run(|frame, _| println!("{} particles", frame.id.len()))?;
//! let last = |name| measures.column(name).and_then(|c| c.last()).unwrap();
//! let fallen = 9.81 * last("time_s");
//! assert!((last("speed_max_m_s") / fallen - 1.0).abs() < 0.05); // it falls freely
//! # Ok::<(), coronet::simulate::Error>(())
//! ```

use std::ops::ControlFlow;
use std::path::Path;

use crate::measure::ending::{Ending, Memory};
use crate::measure::gauge::Gauge;
use crate::measure::kind::contact_time;
use crate::measure::pool;
use crate::measure::series::{Row, Series};
use crate::measure::whole::Unfold;
use crate::method::frame::Schedule;
use crate::method::rest::Rest;
use crate::method::{self, Diverged, MethodError, Phase, Solver};
use crate::particle::pack::{self, PackError};
use crate::particle::{Frame, Particles, State};
use crate::scene::error::SceneError;
use crate::scene::input::RelaxInput;
use crate::scene::{Scene, file};

/// Why a scene cannot be simulated.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A mistake in the scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A body cannot be packed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// The method cannot be set up.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The simulation diverged.
    #[error(transparent)]
    Diverged(#[from] Box<Diverged>),
}

impl From<Diverged> for Error {
    fn from(diverged: Diverged) -> Self {
        Error::Diverged(Box::new(diverged))
    }
}

/// The scene of a TOML text, in the format of the pipeline file.
///
/// # Errors
/// [`Error::Scene`] with line, key, value and remedy.
pub fn scene(text: &str) -> Result<Scene, Error> {
    Ok(file::read(text, Path::new("scene.toml"), &[])?.scene)
}

/// The scene of a file, with the overrides `sets`, each `key.key=value`.
///
/// # Errors
/// [`Error::Scene`].
pub fn load(path: &Path, sets: &[String]) -> Result<Scene, Error> {
    Ok(file::load(path, sets)?.scene)
}

/// Packs the body `index` of a scene, about its own origin.
///
/// # Errors
/// [`Error::Pack`] if it is too small or too large for the spacing, or does not fit its box.
pub fn pack(scene: &Scene, index: usize) -> Result<Particles, Error> {
    let input = scene.pack_input(index);
    let (mut body, _) = pack::pack(&input, &mut |_| ControlFlow::Continue(()))?;
    body.body.fill(index as u8);
    Ok(body)
}

/// Relaxes a packed body at rest, if the scene has a relaxation.
///
/// # Errors
/// [`Error::Method`], [`Error::Diverged`].
pub fn relax(scene: &Scene, packed: Particles) -> Result<Particles, Error> {
    let index = packed.body.first().copied().unwrap_or(0);
    let Some(RelaxInput { problem, relax }) = scene.relax_input(index as usize) else {
        return Ok(packed);
    };
    let phase = Phase::Relax {
        damping: relax.damping,
    };
    let state = method::resting(&problem, &packed);
    let mass = state.particles.mean_mass();
    let mut solver = method::build(&problem, state, phase, None)?;
    let mut rest = Rest::default();
    while !rest.look(solver.as_ref(), mass, &relax).1 {
        solver.advance(&mut |_| ())?;
    }
    let mut body = method::relaxed(&problem, &solver.state());
    body.body.fill(index);
    Ok(body)
}

/// A running impact.
pub struct Simulation {
    scene: Scene,
    solver: Box<dyn Solver>,
    frames: Schedule,
    unfold: Unfold,
    gauge: Gauge,
    ending: Ending,
    measures: Series,
}

impl Simulation {
    /// Packs and relaxes every body, calibrates the tension, and moves the bodies to their places.
    ///
    /// # Errors
    /// [`Error`].
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        let packed: Result<Vec<_>, _> = (0..scene.bodies.len()).map(|i| pack(scene, i)).collect();
        let packed = packed?;
        let relaxed: Result<Vec<_>, _> = packed.iter().map(|b| relax(scene, b.clone())).collect();
        let relaxed = relaxed?;
        let bodies = match method::is_of_packing(scene) {
            true => &packed,
            false => &relaxed,
        };
        let input = scene.calibrate_input();
        let strength = input.map(|input| method::calibrate(&input.bodies, bodies));
        let strength = strength.transpose()?;
        let state = method::initial(&scene.impact_input(), &relaxed);
        Simulation::of(scene, state, strength.map(|s| s.strength))
    }

    /// Continues from a state; measures count from it.
    ///
    /// # Errors
    /// [`Error::Method`].
    pub fn resume(scene: &Scene, state: State) -> Result<Self, Error> {
        let time = state.time;
        let mut simulation = Simulation::of(scene, state, None)?;
        simulation.frames.skip(time);
        Ok(simulation)
    }

    fn of(scene: &Scene, state: State, strength: Option<f64>) -> Result<Self, Error> {
        let mut solver = method::build(scene, state, Phase::Impact, strength)?;
        solver.meet(scene.frames.interval);
        Ok(Simulation {
            scene: scene.clone(),
            solver,
            frames: Schedule::new(scene.frames.interval),
            unfold: Unfold::new(scene),
            gauge: Gauge::new(&scene.whole()),
            ending: Ending::new(&scene.impact.stop_when, scene.spacing, Memory::default()),
            measures: Series::default(),
        })
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.solver.time()
    }

    /// The present frame, as in a log.
    pub fn frame(&self) -> Frame {
        self.solver.frame()
    }

    /// All that [`Simulation::resume`] needs.
    pub fn state(&self) -> State {
        self.solver.state()
    }

    /// Makes a few steps.
    ///
    /// # Errors
    /// [`Error::Diverged`].
    pub fn advance(&mut self) -> Result<(), Error> {
        Ok(self.solver.advance(&mut |_| ())?)
    }

    /// Continues to `impact.end`, or until a condition of `impact.stop_when` is met. `each` is
    /// called with every frame of `frames.interval` and its measures, by column name; the result
    /// contains the measures of all frames.
    ///
    /// # Errors
    /// [`Error::Diverged`].
    pub fn run(&mut self, mut each: impl FnMut(&Frame, &Row)) -> Result<&Series, Error> {
        self.run_while(|frame, row| {
            each(frame, row);
            true
        })
    }

    /// [`Simulation::run`] that stops soon after `each` has returned false.
    ///
    /// # Errors
    /// [`Error::Diverged`].
    pub fn run_while(
        &mut self,
        mut each: impl FnMut(&Frame, &Row) -> bool,
    ) -> Result<&Series, Error> {
        let Simulation {
            scene,
            solver,
            frames,
            unfold,
            gauge,
            ending,
            measures,
        } = self;
        let mut goes_on = true;
        let mut take = |solver: &dyn Solver, ending: &mut Ending, goes_on: &mut bool| {
            if *goes_on && frames.takes(solver.time()) {
                let frame = solver.frame();
                let row = gauge.measure(&unfold.whole(&frame));
                ending.look(&row);
                measures.push(&row);
                *goes_on = each(&frame, &row);
            }
        };
        take(solver.as_ref(), ending, &mut goes_on);
        while goes_on && solver.time() < scene.impact.end && ending.met().is_none() {
            solver.advance(&mut |solver| take(solver, ending, &mut goes_on))?;
        }
        pool::blank_early_jet(measures, contact_time(&scene.whole()));
        Ok(measures)
    }
}
