//! Speed of a solver, for the watcher.

use std::time::{Duration, Instant};

use coronet::method::Solver;
use coronet::pipeline::{Context, Progress};

/// Time between two reports.
const BETWEEN: Duration = Duration::from_millis(200);

/// Counts particle-steps.
pub struct Pace {
    start: Instant,
    last: Instant,
    step: u64,
    particle_steps: f64,
}

impl Pace {
    pub fn new(solver: &dyn Solver) -> Self {
        let now = Instant::now();
        Pace {
            start: now,
            last: now,
            step: solver.step_count(),
            particle_steps: 0.0,
        }
    }

    /// Reports the progress of the solver to `end`, s, at most once per interval.
    pub fn report(&mut self, context: &Context, solver: &dyn Solver, end: f64, more: &str) {
        let steps = solver.step_count() - self.step;
        self.step = solver.step_count();
        self.particle_steps += steps as f64 * solver.len() as f64;
        if self.last.elapsed() < BETWEEN {
            return;
        }
        self.last = Instant::now();
        let time = solver.time();
        let comma = if more.is_empty() { "" } else { ", " };
        context.progress(Progress {
            fraction: (time / end).clamp(0.0, 1.0),
            speed: self.particle_steps / self.start.elapsed().as_secs_f64(),
            unit: "particle-steps/s",
            text: format!("t = {:.3} of {:.3} ms{comma}{more}", time * 1e3, end * 1e3),
        });
    }
}
