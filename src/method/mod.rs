//! One solver a file.

use crate::particle::{Frame, Particles, State};
use crate::scene::Scene;

/// Physics gone wrong. The caller keeps the last good checkpoint.
#[derive(Clone, Debug, thiserror::Error)]
#[error(
    "diverged at t = {time:.6e} s, step {step}: particle {particle} at ({x:.4e}, {y:.4e}, {z:.4e}) m: \
     {what}; try {remedy}"
)]
pub struct Diverged {
    pub time: f64,
    pub step: u64,
    pub particle: u32,
    pub x: f64,
    pub y: f64,
    pub z: f64,
    /// Which limit was passed, with both values.
    pub what: String,
    pub remedy: String,
}

/// A time-stepping method with its state.
pub trait Solver: Send {
    /// Simulated time, s.
    fn time(&self) -> f64;
    /// Steps taken.
    fn step_count(&self) -> u64;
    /// Liquid particles now.
    fn len(&self) -> usize;
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Advances to the next instant at which the state is complete (a rebuild of the neighbour lists):
    /// a few steps. `state()` may be called between any two advances, and a solver restored from it
    /// goes on bit for bit. `on_step` sees the solver after every step, for frames.
    fn advance(&mut self, on_step: &mut dyn FnMut(&dyn Solver)) -> Result<(), Diverged>;
    /// Everything that a restart needs. Only right after `advance` or at the start.
    fn state(&self) -> State;
    /// What the log shows.
    fn frame(&self) -> Frame;
    /// Kinetic energy, J, and standard deviation of density of supported particles, kg/m^3.
    fn unrest(&self) -> (f64, f64);
    /// Time-step limits by name, s, least first.
    fn limits(&self) -> Vec<(&'static str, f64)>;
}

/// What a solver is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Bodies move as the scene says.
    Impact,
    /// At rest with damping, 1/s.
    Relax { damping: f64 },
}

/// Merges relaxed bodies and gives them their initial velocities: the state at t = 0.
pub fn initial(_scene: &Scene, _bodies: &[Particles]) -> State {
    todo!()
}

/// Builds the scene's method on a state (fresh or restored).
/// `strength`: calibrated tension strength, if the scene has tension.
pub fn build(
    _scene: &Scene,
    _state: State,
    _phase: Phase,
    _strength: Option<f64>,
) -> Result<Box<dyn Solver>, Diverged> {
    todo!()
}
