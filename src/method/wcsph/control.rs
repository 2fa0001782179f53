//! The step controller. A step in which particles gain more than what is there can give them is
//! rejected: the state before it comes back, and it is taken again over half the time. Once
//! [`CALM`] steps have held, they are twice as long again. Fixed steps stay what they are.
//!
//! The bounds are on the growth of an instability, so that what comes back is sound.
//! (1) V' <= 2 V + c / 10 + a dt: V the largest speed before, a the largest acceleration held.
//!     Pressure at most turns a flow round, which adds its speed once, and c / 10 is the speed for
//!     which c was chosen (Monaghan 1994), so that a liquid at rest may be set in motion.
//! (2) SUM m / 2 (v'^2 + c^2 e'^2) <= 1.02 SUM m / 2 ((v + a dt)^2 + c^2 e^2), e = rho / rho0 - 1:
//!     kinetic energy and that of compression have nothing to come from but each other and the
//!     work of what is held. e' counts where it is above zero and has come from a rate, not a sum.
//!     Walls too do work where liquid settles on them, slowly: the last attempt has 2 % for each of
//!     its acoustic steps, of which an instability makes more.
//! Test: tests/engine/method_control.rs.

use super::Wcsph;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::adapt::Adaption;
use crate::method::ledger::Ledger;
use crate::method::liquid::Moment;
use crate::method::{Diverged, frame};
use crate::particle::column::{Rollback, Scalar, Scalars};
use crate::space::parallel::sum_in;

/// Halvings after which a run has diverged.
const HALVINGS: u32 = 6;

/// Steps that have to hold before they get longer again.
const CALM: u64 = 50;

/// Room in (2) for what is no compression of the whole, as shifting.
const ROOM: f64 = 1.02;

/// How long steps are, and what a rejected one goes back to.
#[derive(Default)]
pub(super) struct Control {
    pub steps: Steps,
    /// The most that (1) lets a particle have, m/s, and what (2) allows to grow, J.
    speed: f64,
    energy: f64,
    /// The state before the step.
    particles: Rollback,
    own: Rollback,
    walls: Rollback,
    now: Moment,
    ledger: Ledger,
    sound_speed: f64,
    adaption: Adaption,
}

/// How the steps of a run went.
#[derive(Clone, Copy, Default)]
pub(super) struct Steps {
    halvings: u32,
    /// Steps that held since they last changed.
    calm: u64,
    /// Rejected steps of the run.
    pub rejected: u64,
}

impl Scalars for Steps {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("step_halvings", &mut self.halvings);
        see("steps_calm", &mut self.calm);
        see("steps_rejected", &mut self.rejected);
    }
}

impl Steps {
    /// What steps are multiplied by now.
    fn part(&self) -> f64 {
        0.5f64.powi(self.halvings as i32)
    }

    fn held(&mut self) {
        self.calm += 1;
        if self.halvings > 0 && self.calm >= CALM {
            self.halvings -= 1;
            self.calm = 0;
        }
    }

    fn reject(&mut self) {
        self.halvings += 1;
        self.rejected += 1;
        self.calm = 0;
    }
}

impl Control {
    /// For a run whose steps went as in `steps`.
    pub fn new(steps: Steps) -> Self {
        Control {
            steps,
            speed: f64::INFINITY,
            energy: f64::INFINITY,
            ..Control::default()
        }
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.particles.memory() + self.own.memory() + self.walls.memory()
    }
}

impl<K: Kernel, V: PairViscosity> Wcsph<K, V> {
    /// Takes one `step`, a function of what its length is multiplied by, as often as it has to be.
    pub(super) fn controlled(
        &mut self,
        step: impl Fn(&mut Self, f64) -> Result<(), Diverged>,
    ) -> Result<(), Diverged> {
        self.remember();
        loop {
            let part = self.control.steps.part();
            match step(self, part) {
                Ok(()) => {
                    self.control.steps.held();
                    return Ok(());
                }
                Err(fault) if self.control.steps.halvings >= HALVINGS => return Err(fault),
                Err(_) => {
                    self.control.steps.reject();
                    self.restore();
                }
            }
        }
    }

    /// (1) and (2) for a step of `dt` s.
    pub(super) fn bound(&mut self, dt: f64) {
        let (model, p, held) = (&self.model, &self.liquid.flow.particles, &self.own.held);
        let speed = 2.0 * self.liquid.now.max_speed
            + 0.1 * model.sound_speed
            + self.liquid.now.max_acceleration * dt;
        let [energy] = sum_in(&mut self.liquid.parts, self.liquid.flow.span(), |i| {
            let mut square = 0.0;
            for (v, held) in p.velocity.iter().zip(&held[i]) {
                square += (v[i] + *held as f64 * dt).powi(2);
            }
            let compressed = p.density[i] / model.density - 1.0;
            let mass = p.mass * p.weight(i);
            [0.5 * mass * (square + (model.sound_speed * compressed).powi(2))]
        });
        (self.control.speed, self.control.energy) = (speed, energy);
    }

    /// An error if a particle is faster than sound or than (1) has it, or has no number for a
    /// speed.
    pub(super) fn check(&self) -> Result<(), Diverged> {
        let (sound, bound) = (self.model.sound_speeds[1], self.control.speed);
        if self.liquid.now.max_speed <= sound.min(bound) {
            return Ok(());
        }
        let speed = frame::fastest(&self.liquid.flow).speed;
        Err(self.fault(if bound < sound {
            format!("speed {speed:.4e} m/s above {bound:.4e} m/s, more than a step can give")
        } else {
            format!("speed {speed:.4e} m/s above the sound speed {sound:.4e} m/s")
        }))
    }

    /// An error if (2) is passed in a step of `count` acoustic ones.
    pub(super) fn check_energy(&mut self, count: f64) -> Result<(), Diverged> {
        let (model, p) = (&self.model, &self.liquid.flow.particles);
        let sound = match model.diffusion() {
            Some(_) => model.sound_speed,
            None => 0.0,
        };
        let [energy] = sum_in(&mut self.liquid.parts, self.liquid.flow.span(), |i| {
            let compressed = (p.density[i] / model.density - 1.0).max(0.0);
            let mass = p.mass * p.weight(i);
            [0.5 * mass * (p.speed(i).powi(2) + (sound * compressed).powi(2))]
        });
        let is_last = self.control.steps.halvings >= HALVINGS;
        let room = if is_last { ROOM.powf(count) } else { ROOM };
        let bound = room * self.control.energy;
        if energy <= bound {
            return Ok(());
        }
        Err(self.fault(format!(
            "energy of motion and compression {energy:.4e} J above {bound:.4e} J, more than a step \
             can give"
        )))
    }

    fn fault(&self, what: String) -> Diverged {
        let remedy = "a larger method.wcsph.sound_speed_factor or a smaller time step";
        let now = (self.liquid.now.time, self.liquid.now.step);
        frame::fault(frame::fastest(&self.liquid.flow), now, what, remedy)
    }

    fn remember(&mut self) {
        let control = &mut self.control;
        control.particles.remember(&self.liquid.flow.particles);
        control.own.remember(&self.own);
        control.walls.remember(&self.walls);
        (control.now, control.ledger) = (self.liquid.now, self.liquid.ledger);
        control.sound_speed = self.model.sound_speed;
        control.adaption = self.adaption;
    }

    fn restore(&mut self) {
        let control = &self.control;
        control.particles.restore(&mut self.liquid.flow.particles);
        control.own.restore(&mut self.own);
        control.walls.restore(&mut self.walls);
        let n = self.liquid.len();
        self.own.around.resize(n, Default::default());
        self.own.held.resize(n, [0.0; 3]);
        self.own.force.resize(n, [0.0; 3]);
        // Of the rejected step, which may have removed particles: found anew where they are read.
        self.own.steady.clear();
        self.own.dry.clear();
        (self.liquid.now, self.liquid.ledger) = (control.now, control.ledger);
        self.model.sound_speed = control.sound_speed;
        self.adaption = control.adaption;
        self.tension_age = f64::INFINITY;
        self.liquid.flow.count();
        if self.liquid.flow.ranks.is_some() {
            // Slabs may have moved since. A step begins without what is known of walls.
            self.forget_walls();
        }
    }
}
