//! The surface energy in the budget: what it is, and the power of its force.

use super::Tension;
use super::energy::density;
use crate::effect::Account;
use crate::particle::{Particles, weight_of};
use crate::space::parallel::sum_in;

impl Tension {
    /// Of the last update, at the present velocities. Walls count with what they have beyond dry
    /// ones; where the angle of a line decides, E has the mean one.
    pub fn account(&mut self, particles: &Particles) -> Account {
        let mut parts = std::mem::take(&mut self.energy.parts);
        let unit = self.strength * self.coefficient / self.length * particles.mass / self.density;
        let (sums, near) = (&self.energy.sums, &self.near);
        let of = |s: &[f32; 4]| {
            let n = [0, 1, 2].map(|a| s[a] as f64);
            density(self.dimension, s[3] as f64, n).energy
        };
        let [own] = sum_in(&mut parts, self.spans[0].clone(), |k| {
            [particles.weight(near[k] as usize) * of(&sums[k])]
        });
        let walls = match &self.energy.shore {
            None => 0.0,
            Some(shore) => {
                let dry = |j: usize| shore.dry_energy[j] as f64;
                let [near] = sum_in(&mut parts, shore.span.clone(), |k| {
                    let j = shore.near[k] as usize;
                    [weight_of(&shore.weights, j) * (of(&shore.sums[k]) - dry(j))]
                });
                let [under] = sum_in(&mut parts, shore.walls.clone(), |j| {
                    [if shore.under[j] { dry(j) } else { 0.0 }]
                });
                self.energy.carried * shore.cosine * (near - under)
            }
        };
        let power = self.power(&mut parts, particles, |k| self.force[k]);
        self.energy.parts = parts;
        let lines = self.power_of_lines(particles);
        Account {
            energy: unit * (own + walls),
            rate: lines - power,
            lines,
        }
    }

    /// Power of what contact lines pull beyond the force that the mean angle would give, W, at the
    /// present velocities of particles in the order of the last update.
    pub fn power_of_lines(&mut self, particles: &Particles) -> f64 {
        let is_varied = self.wetting.is_some();
        let Some(shore) = self.energy.shore.as_ref().filter(|_| is_varied) else {
            return 0.0;
        };
        let ([wet, line], mean) = (&shore.pulls, shore.cosine as f32);
        let beyond = |k: usize| [0, 1, 2].map(|a| line[k][a] - mean * wet[k][a]);
        let mut parts = std::mem::take(&mut self.energy.parts);
        let power = self.power(&mut parts, particles, beyond);
        self.energy.parts = parts;
        power
    }

    /// Power of a force, m/s^2 by item of `reached`, W.
    fn power(
        &self,
        parts: &mut Vec<[f64; 1]>,
        particles: &Particles,
        force: impl Fn(usize) -> [f32; 3] + Sync,
    ) -> f64 {
        let [power] = sum_in(parts, self.spans[1].clone(), |k| {
            let (i, force) = (self.reached[k] as usize, force(k));
            let part = |a: usize| particles.velocity[a][i] * force[a] as f64;
            [particles.weight(i) * (0..3).map(part).sum::<f64>()]
        });
        particles.mass * power
    }
}
