//! The budget of energy: what the liquid was given since the start of a run, part by part, J (J/m
//! in 2-D), negative where it was taken, and the energy of its surface. With those of motion,
//! height and compression the budget closes: what is left over came from nowhere.

use crate::effect::Account;
use crate::particle::column::{Scalar, Scalars};

/// Work of what is no exchange between the energies of the liquid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Of viscosity, moving walls included.
    pub viscosity: f64,
    /// Of all that changes density but motion: diffusion, tearing, a speed of sound that changes.
    pub diffusion: f64,
    /// Of particle shifting.
    pub shifting: f64,
    /// What removed particles had, negative; what falls behind a wall and is put back, or wraps
    /// round a periodic side along gravity.
    pub removal: f64,
    /// Of the pressure of walls and of the friction of contact lines.
    pub walls: f64,
    /// Of a tension that has one, J, now; `None` before it was first found.
    pub surface: Option<f64>,
    /// Power of viscosity at the start of a step, W, and its rate, W/s.
    pub viscous: [f64; 2],
    /// Powers that are held, W: of diffusion, of contact lines, and the rate of the energy of the
    /// surface.
    pub diffusive: f64,
    /// Power of contact lines, W.
    pub lines: f64,
    /// Rate of the energy of the surface, W.
    pub rising: f64,
    /// From the start of a step to the instant of the energy of the surface, s.
    ahead: f64,
    /// Of the pressure of a projection, which should do none; `None`: it stores energy.
    pub pressure: Option<f64>,
    /// Work of pressure and of friction in the last step of a projection, J.
    pub corrected: [f64; 2],
    /// Whether particles were removed, or put back out of a wall, at the start of this step.
    pub displaces: bool,
    /// Energy of the surface at the end of the step before, J.
    before: Option<f64>,
}

impl Scalars for Ledger {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("surface_energy_J", &mut self.surface);
        see("viscosity_work_J", &mut self.viscosity);
        see("diffusion_work_J", &mut self.diffusion);
        see("shifting_work_J", &mut self.shifting);
        see("removal_work_J", &mut self.removal);
        see("wall_work_J", &mut self.walls);
        see("pressure_work_J", &mut self.pressure);
        see("diffusion_power_W", &mut self.diffusive);
    }
}

impl Ledger {
    /// Of frames, by name.
    pub fn works(&self) -> impl Iterator<Item = (&'static str, f64)> + use<> {
        let surface = self.surface.map(|energy| ("surface_energy_J", energy));
        let works = [
            ("viscosity_work_J", self.viscosity),
            ("diffusion_work_J", self.diffusion),
            ("shifting_work_J", self.shifting),
            ("removal_work_J", self.removal),
            ("wall_work_J", self.walls),
        ];
        let pressure = self.pressure.map(|work| ("pressure_work_J", work));
        surface.into_iter().chain(works).chain(pressure)
    }

    /// Books a step of `dt` s: what is held over it, the surface at its end, and how particles that
    /// were removed or put back at its start changed it.
    pub fn step(&mut self, dt: f64) {
        let [power, rate] = self.viscous;
        self.viscosity += dt * (power + 0.5 * dt * rate);
        self.walls += dt * self.lines;
        let Some(seen) = self.surface else {
            return;
        };
        if let (Some(before), true) = (self.before, self.displaces) {
            self.removal += seen - self.ahead * self.rising - before;
        }
        self.surface = Some(seen + (dt - self.ahead) * self.rising);
    }

    /// Books the end of a step of `dt` s with the powers that held forces have then, W, for
    /// particles move by the mean of the velocities at its ends: of viscosity, of effects, and, if
    /// it is known, of contact lines.
    pub fn end(&mut self, dt: f64, viscous: f64, pull: f64, lines: Option<f64>) {
        let ([before, change], lines) = (self.viscous, lines.unwrap_or(self.lines));
        self.viscosity += 0.5 * dt * (viscous - before - dt * change);
        self.walls += 0.5 * dt * (lines - self.lines);
        let more = 0.5 * dt * (lines - pull - self.rising);
        self.surface = self.surface.map(|energy| energy + more);
    }

    /// Books the last correction of a projection.
    pub fn correct(&mut self) {
        let [pressed, rubbed] = self.corrected;
        self.pressure = self.pressure.map(|work| work + pressed);
        self.walls += rubbed;
    }

    /// Takes what effects add `ahead` s after the start of a step.
    pub fn see(&mut self, account: Option<Account>, ahead: f64) {
        let Some(account) = account else {
            return;
        };
        self.ahead = ahead;
        self.before = self.surface.replace(account.energy);
        (self.lines, self.rising) = (account.lines, account.rate);
    }
}
