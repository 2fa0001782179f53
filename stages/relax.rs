//! `relax`: a packed body -> the same body in equilibrium.
//!
//! Runs with damping until kinetic energy and density spread have stayed below their limits for a
//! tenth of `relax.time` (a body that has not begun to move is also at rest), at most for
//! `relax.time`.

use coronet::method::rest::{Rest, Unrest};
use coronet::method::{self, Phase, Solver};
use coronet::particle::State;
use coronet::pipeline::{Context, Identity, Output, Stage, StageError, Work};
use coronet::record::{Checkpoint, checkpoint};
use coronet::scene::input::RelaxInput;

use crate::body::{BODY, read_body};
use crate::flight::{self, Flight, Shared};
use crate::pace::Pace;
use crate::ranks::{self, Part};
use crate::settings::Forecast;

/// Time from which both limits are met, s, as a scalar of a checkpoint; NaN: they are not.
const CALM_SINCE: &str = "calm_since";

/// The settings that decide whether a body has come to rest; its particles depend on them only
/// where they end its relaxation.
pub const LIMITS: [&str; 2] = ["relax.kinetic_energy", "relax.density_spread"];

/// Start of the note of a body that has not come to rest.
pub const UNREST: &str = "not at rest";

pub struct Relax<'a> {
    pub input: RelaxInput,
    /// Which body of the scene.
    pub body: usize,
    /// Wall-clock seconds between checkpoints.
    pub checkpoint_every: f64,
    /// Job that packs the body.
    pub pack: usize,
    pub forecast: Forecast<'a>,
    pub identity: Identity,
}

impl Stage for Relax<'_> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn inputs(&self) -> Vec<usize> {
        vec![self.pack]
    }

    fn work(&self) -> Option<Work> {
        (self.forecast)()
    }

    fn run(&self, context: &mut Context) -> Result<Vec<Output>, StageError> {
        let RelaxInput { problem, relax } = &self.input;
        let resumed = flight::newest(context)?.and_then(restored);
        let is_resumed = resumed.is_some();
        let (state, calm_since) = match resumed {
            Some(start) => {
                context.resumed();
                start
            }
            None => {
                flight::clear(context)?;
                let packed = read_body(context, 0, 0)?;
                (method::resting(problem, &packed), f64::NAN)
            }
        };
        let mut rest = Rest { calm_since };
        let particle_mass = state.particles.mean_mass();
        let damping = relax.damping;
        let built = ranks::build(
            Part::Relax(self.body),
            problem,
            state,
            Phase::Relax { damping },
            None,
        );
        let mut solver = built.map_err(StageError::failed)?;
        let mut flight = Flight::new(context, self.checkpoint_every)?;
        let mut pace = Pace::new(solver.as_ref());
        // A state is saved after it was looked at: what the look needs is not saved.
        let mut seen = (!is_resumed).then(|| rest.look(solver.as_ref(), particle_mass, relax));
        let unrest = loop {
            if let Some((unrest, true)) = seen {
                break unrest;
            }
            solver.advance(&mut |_| {}).map_err(StageError::failed)?;
            let (unrest, ends) = rest.look(solver.as_ref(), particle_mass, relax);
            seen = Some((unrest, ends));
            if ends {
                continue;
            }
            let stopped = context.stopped();
            if stopped || flight.is_due() {
                let checkpoint = checkpoint(solver.as_ref(), rest.calm_since);
                flight.save(context, checkpoint, None, false)?;
            }
            if stopped {
                flight.land(context)?;
                return Err(StageError::Interrupted);
            }
            flight.collect(context)?;
            let text = format!("{:.2e} J/kg, {:.2} kg/m^3", unrest.energy, unrest.spread);
            pace.report(context, solver.as_ref(), relax.time, &text);
        };
        flight.land(context)?;
        self.report(context, solver.as_ref(), unrest);
        self.write(context, &solver.state())
    }
}

impl Relax<'_> {
    /// Adds a note about the rest of the body.
    fn report(&self, context: &mut Context, solver: &dyn Solver, unrest: Unrest) {
        let relax = &self.input.relax;
        let reached = format!(
            "after {:.3e} s: kinetic energy {:.3e} J/kg (limit {:.3e}), standard deviation of \
             density {:.3} kg/m^3 (limit {:.3})",
            solver.time(),
            unrest.energy,
            relax.kinetic_energy,
            unrest.spread,
            relax.density_spread
        );
        if !unrest.is_calm {
            let is_still = unrest.energy <= relax.kinetic_energy;
            let remedy = match self.input.problem.method.projection() {
                Some(_) if is_still => {
                    "raise relax.density_spread: a projection does not even out density in time"
                }
                _ => "raise relax.time or relax.damping, or the limits",
            };
            let text = format!("{UNREST} {reached}; {remedy}");
            context.warn(&text);
            context.note(text);
        } else {
            context.note(format!("at rest {reached}"));
        }
    }

    fn write(&self, context: &Context, state: &State) -> Result<Vec<Output>, StageError> {
        let body = method::relaxed(&self.input.problem, state);
        let path = context.output().join(BODY);
        Checkpoint::from(body)
            .write(&path, checkpoint::LEVEL)
            .map_err(StageError::failed)?;
        Ok(vec![Output::counted(BODY)])
    }
}

fn checkpoint(solver: &dyn Solver, calm_since: f64) -> Shared<'_> {
    let (state, more) = solver.share();
    let mut checkpoint = Checkpoint::from(state);
    checkpoint.scalars.push((CALM_SINCE.into(), calm_since));
    (checkpoint, more)
}

fn restored(checkpoint: Checkpoint) -> Option<(State, f64)> {
    let calm_since = checkpoint.scalar(CALM_SINCE)?;
    Some((State::try_from(checkpoint).ok()?, calm_since))
}
