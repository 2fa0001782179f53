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
//! Test: tests/engine/method_control.rs.

use super::Wcsph;
use crate::effect::viscosity::PairViscosity;
use crate::kernel::Kernel;
use crate::method::ledger::Ledger;
use crate::method::{Diverged, frame};
use crate::particle::{Particles, State};
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
    halvings: u32,
    /// Steps that held since they last changed.
    calm: u64,
    /// Rejected steps of the run.
    pub rejected: u64,
    /// The most that (1) lets a particle have, m/s, and (2) all of them, J.
    speed: f64,
    energy: f64,
    before: Before,
    pub parts: Vec<[f64; 1]>,
}

/// Kept, so that a step allocates nothing.
#[derive(Default)]
struct Before {
    particles: Particles,
    rate: Vec<f32>,
    walls: Vec<f64>,
    sums: Vec<f32>,
    removed: (f64, u64),
    ledger: Ledger,
    time: f64,
    step: u64,
    /// Sound speed; largest speeds, of all and of what is no spray; acceleration; last step.
    scalars: [f64; 5],
}

impl Control {
    pub fn new(state: &State) -> Self {
        let named = |name: &str| state.scalars.iter().find(|s| s.0 == name).map(|s| s.1);
        let whole = |name: &str| named(name).unwrap_or(0.0) as u64;
        Control {
            halvings: whole("step_halvings") as u32,
            calm: whole("steps_calm"),
            rejected: whole("steps_rejected"),
            speed: f64::INFINITY,
            energy: f64::INFINITY,
            before: Before::default(),
            parts: Vec::new(),
        }
    }

    pub fn scalars(&self) -> [(&'static str, f64); 3] {
        [
            ("step_halvings", self.halvings as f64),
            ("steps_calm", self.calm as f64),
            ("steps_rejected", self.rejected as f64),
        ]
    }

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

    /// Bytes held.
    pub fn memory(&self) -> usize {
        let b = &self.before;
        b.particles.id.capacity() * (7 * 8 + 5)
            + 4 * (b.rate.capacity() + b.sums.capacity())
            + 8 * b.walls.capacity()
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
            let part = self.control.part();
            match step(self, part) {
                Ok(()) => {
                    self.control.held();
                    return Ok(());
                }
                Err(fault) if self.control.halvings >= HALVINGS => return Err(fault),
                Err(_) => {
                    self.control.reject();
                    self.restore();
                }
            }
        }
    }

    /// (1) and (2) for a step of `dt` s.
    pub(super) fn bound(&mut self, dt: f64) {
        let (model, p, held) = (&self.model, &self.flow.particles, &self.held);
        let speed = 2.0 * self.fastest + 0.1 * model.sound_speed + self.hardest * dt;
        let [energy] = sum_in(&mut self.control.parts, p.len(), |i| {
            let mut square = 0.0;
            for (v, held) in p.velocity.iter().zip(&held[i]) {
                square += (v[i] + *held as f64 * dt).powi(2);
            }
            let compressed = p.density[i] / model.density - 1.0;
            [0.5 * p.mass * (square + (model.sound_speed * compressed).powi(2))]
        });
        (self.control.speed, self.control.energy) = (speed, ROOM * energy);
    }

    /// An error if a particle is faster than sound or than (1) has it, or has no number for a
    /// speed.
    pub(super) fn check(&self) -> Result<(), Diverged> {
        let (sound, bound) = (self.model.sound_speeds[1], self.control.speed);
        if self.fastest <= sound.min(bound) {
            return Ok(());
        }
        let (_, speed) = frame::fastest(&self.flow);
        Err(self.fault(if bound < sound {
            format!("speed {speed:.4e} m/s above {bound:.4e} m/s, more than a step can give")
        } else {
            format!("speed {speed:.4e} m/s above the sound speed {sound:.4e} m/s")
        }))
    }

    /// An error if (2) is passed.
    pub(super) fn check_energy(&mut self) -> Result<(), Diverged> {
        let (model, p) = (&self.model, &self.flow.particles);
        let sound = match model.diffusion() {
            Some(_) => model.sound_speed,
            None => 0.0,
        };
        let [energy] = sum_in(&mut self.control.parts, p.len(), |i| {
            let compressed = (p.density[i] / model.density - 1.0).max(0.0);
            [0.5 * p.mass * (p.speed(i).powi(2) + (sound * compressed).powi(2))]
        });
        let bound = self.control.energy;
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
        let (now, (i, _)) = ((self.time, self.step), frame::fastest(&self.flow));
        frame::fault(&self.flow, now, i, what, remedy)
    }

    fn remember(&mut self) {
        let before = &mut self.control.before;
        copy(&self.flow.particles, &mut before.particles);
        before.rate.clone_from(&self.rate);
        before.walls.clone_from(&self.walls.density);
        before.sums.clear();
        before.sums.extend(self.around.iter().map(|s| s.sum));
        before.removed = self.flow.removed;
        before.ledger = self.ledger;
        (before.time, before.step) = (self.time, self.step);
        let speeds = [self.model.sound_speed, self.fastest, self.connected];
        before.scalars = [
            speeds[0],
            speeds[1],
            speeds[2],
            self.hardest,
            self.last_step,
        ];
    }

    fn restore(&mut self) {
        let before = &self.control.before;
        copy(&before.particles, &mut self.flow.particles);
        self.rate.clone_from(&before.rate);
        self.walls.density.clone_from(&before.walls);
        self.around.resize(before.sums.len(), Default::default());
        let pairs = self.around.iter_mut().zip(&before.sums);
        pairs.for_each(|(around, sum)| around.sum = *sum);
        self.held.resize(before.sums.len(), [0.0; 3]);
        self.force.resize(before.sums.len(), [0.0; 3]);
        self.flow.removed = before.removed;
        self.ledger = before.ledger;
        (self.time, self.step) = (before.time, before.step);
        [
            self.model.sound_speed,
            self.fastest,
            self.connected,
            self.hardest,
            self.last_step,
        ] = before.scalars;
    }
}

/// Without an allocation where there is room.
fn copy(from: &Particles, to: &mut Particles) {
    for a in 0..3 {
        to.position[a].clone_from(&from.position[a]);
        to.velocity[a].clone_from(&from.velocity[a]);
    }
    to.density.clone_from(&from.density);
    to.id.clone_from(&from.id);
    to.body.clone_from(&from.body);
    to.mass = from.mass;
}
