//! One run on several processes that `mpirun` has started: rank 0 runs the pipeline, the others
//! share its packings and solvers.

#[cfg(feature = "mpi")]
mod mpi;

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use anyhow::{Context as _, Result, bail};
use coronet::method::{self, MethodError, Phase, Solver, shared};
use coronet::particle::pack::{self, PackError, PackReport, Watch};
use coronet::particle::{Particles, State};
use coronet::scene::input::PackInput;
use coronet::scene::{Problem, Scene};
use coronet::space::ranks::{Communicator, broadcast};
use serde::{Deserialize, Serialize};

use crate::fault::Usage;

static WORLD: OnceLock<Arc<dyn Communicator>> = OnceLock::new();

/// What of a scene is shared.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub enum Part {
    /// The packing of a body.
    Pack(usize),
    /// Of the relaxation of a body.
    Relax(usize),
    /// Of the impact.
    Impact,
}

/// How many processes a launcher of MPI has started with this one.
fn launched() -> usize {
    first_of(["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"]).unwrap_or(1)
}

/// How many of them are on this machine, this one included.
pub fn beside() -> usize {
    first_of(["OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"]).unwrap_or_else(launched)
}

/// The number that the first of these variables has.
fn first_of(names: [&str; 2]) -> Option<usize> {
    let mut numbers = names
        .iter()
        .filter_map(|name| std::env::var(name).ok()?.parse().ok());
    numbers.next()
}

/// Joins the other processes, if there are any.
///
/// # Errors
/// A program without MPI.
pub fn join() -> Result<()> {
    if launched() < 2 {
        return Ok(());
    }
    #[cfg(feature = "mpi")]
    let _ = WORLD.set(Arc::new(mpi::World::join()?));
    if WORLD.get().is_none() {
        bail!(Usage(
            "this program was built without MPI, so that several processes cannot share a run; \
             build it with --features mpi"
                .to_string()
        ));
    }
    Ok(())
}

/// The other processes.
pub fn world() -> Option<&'static Arc<dyn Communicator>> {
    WORLD.get()
}

/// Whether this process only helps another.
pub fn is_helper() -> bool {
    world().is_some_and(|world| world.rank() > 0)
}

/// An error if there are several processes, and they cannot share a scene.
///
/// # Errors
/// As it says.
pub fn check(scene: &Scene) -> Result<()> {
    let reason = world().and_then(|_| method::shared::alone(scene));
    match reason {
        None => Ok(()),
        Some(reason) => bail!(Usage(MethodError::Alone(reason).to_string())),
    }
}

/// Packs a body of a scene, on all ranks if there are several.
///
/// # Errors
/// As [`pack::pack`].
pub fn pack(
    body: usize,
    input: &PackInput,
    watch: &mut Watch,
) -> Result<(Particles, PackReport), PackError> {
    let Some(world) = world() else {
        return pack::pack(input, watch);
    };
    broadcast(&**world, 0, Some(Some(Part::Pack(body))));
    pack::pack_shared(world, input, watch)
}

/// Builds the solver of `part` of a scene, on all ranks if there are several.
///
/// # Errors
/// As [`method::build`] and [`method::build_shared`].
pub fn build(
    part: Part,
    problem: &Problem,
    state: State,
    phase: Phase,
    strength: Option<f64>,
) -> Result<Box<dyn Solver>, MethodError> {
    let Some(world) = world() else {
        return method::build(problem, state, phase, strength);
    };
    broadcast(&**world, 0, Some(Some(part)));
    method::build_shared(world, problem, Some(state), phase, strength)
}

/// Helps rank 0 with a scene until it has ended.
///
/// # Errors
/// As [`build`].
pub fn help(scene: &Scene) -> Result<()> {
    let Some(world) = world() else {
        return Ok(());
    };
    while let Some(part) = broadcast::<Option<Part>>(&**world, 0, None) {
        let (problem, phase) = match part {
            Part::Pack(body) => {
                // Rank 0 has the same error, and says so.
                let input = scene.pack_input(body);
                let _ = pack::pack_shared(world, &input, &mut |_| ControlFlow::Continue(()));
                continue;
            }
            Part::Relax(body) => {
                let input = scene
                    .relax_input(body)
                    .context("a body that does not relax")?;
                let damping = input.relax.damping;
                (input.problem, Phase::Relax { damping })
            }
            Part::Impact => (scene.impact_input().problem, Phase::Impact),
        };
        let solver = method::build_shared(world, &problem, None, phase, None);
        // Rank 0 has the same error, and says so.
        if let Ok(solver) = solver {
            shared::serve(solver, &**world);
        }
    }
    Ok(())
}

/// Lets the others go, at the end of rank 0.
pub fn leave() {
    if let Some(world) = world()
        && world.rank() == 0
    {
        broadcast::<Option<Part>>(&**world, 0, Some(None));
    }
    #[cfg(feature = "mpi")]
    if world().is_some() {
        mpi::World::leave();
    }
}
