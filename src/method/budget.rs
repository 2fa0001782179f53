//! How a step of any method enters the budget of energy ([`Ledger`](super::ledger::Ledger)).

use super::frame;
use super::liquid::Liquid;
use crate::effect::tension::Tension;
use crate::space::parallel::sum_in;

impl Liquid {
    /// Energy of motion, of height, and of compression, J; `compression`, J/kg, at a density.
    pub fn stored(&mut self, compression: impl Fn(f64) -> f64 + Sync) -> f64 {
        let p = &self.flow.particles;
        let (own, span) = (|i: usize| compression(p.density[i]), self.flow.span());
        frame::stored((p, span), self.body_force.constant, own, &mut self.parts)
    }

    /// Kinetic and potential energy, J, momentum, kg m/s.
    pub fn budget(&self) -> [f64; 5] {
        frame::budget(&self.flow, self.body_force.constant)
    }

    /// Takes the accelerations `held`, m/s^2, of viscosity.
    pub fn see_viscosity(&mut self, held: &[[f32; 3]]) {
        let of = (&self.flow.particles, self.flow.span());
        self.ledger.viscous = frame::power(of, held, [0.0; 3], &mut self.pairs);
    }

    /// A step begins: positions are those from which a driven body force does work until
    /// [`Liquid::end_step`].
    pub fn begin_step(&mut self) {
        self.driven = self.driven_energy();
    }

    /// Books a step of `dt` s: the work of a driven body force, as that of a constant one, and of
    /// all accelerations `held`, m/s^2, with the velocities at its end too; `steady`: without those
    /// of effects, of a tension that has an energy.
    pub fn end_step(&mut self, dt: f64, held: &[[f32; 3]], steady: &[[f32; 3]]) {
        self.ledger.walls += self.driven_energy() - self.driven;
        let pulls = self.effects.tension.as_ref().is_some_and(Tension::pulls);
        let steady = match self.follows_energy() {
            true => steady,
            false if pulls => return,
            false => held,
        };
        let (p, force) = (&self.flow.particles, self.body_force.total());
        let of = |held| frame::power((p, self.flow.span()), held, force, &mut self.pairs)[0];
        let [all, viscous] = [held, steady].map(of);
        let lines = self.effects.lines(p, self.flow.sorted);
        self.ledger.end(dt, viscous, all - viscous, lines);
    }

    /// SUM m a . x of a driven body force, J; zero without.
    fn driven_energy(&mut self) -> f64 {
        let Some(driven) = self.body_force.driven else {
            return 0.0;
        };
        let p = &self.flow.particles;
        let [sum] = sum_in(&mut self.parts, self.flow.span(), |i| {
            let along: f64 = (0..3).map(|a| driven[a] * p.position[a][i]).sum();
            [p.weight(i) * along]
        });
        p.mass * sum
    }
}
