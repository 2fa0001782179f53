//! The effects of a run, as a solver calls them.

use super::surface::Surface;
use super::tension::Tension;
use super::wetting::friction::Hold;
use super::{Account, Effect, Uniform};
use crate::particle::Particles;
use crate::space::parallel::each_mut;

/// The effects that a scene has, made by [`super::select::active`]. Pair forces, as viscosity is,
/// are types of a method's pair sums; here is what they limit.
#[derive(Default)]
pub struct ActiveEffects {
    /// All but the tension, in the order in which they are added.
    pub others: Vec<Box<dyn Effect>>,
    /// By its own type: shifting needs its normals.
    pub tension: Option<Tension>,
    /// How often particles had been sorted at the last update.
    pub sorted: u64,
}

/// The uniform accelerations of a moment, m/s^2; `None` for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyForce {
    /// Those that are always the same: they have a potential.
    pub constant: Option<[f64; 3]>,
    /// Those that change with time.
    pub driven: Option<[f64; 3]>,
}

impl BodyForce {
    /// All of them; zero for none.
    pub fn total(&self) -> [f64; 3] {
        match (self.constant, self.driven) {
            (Some(constant), Some(driven)) => plus(constant, driven),
            (one, other) => one.or(other).unwrap_or([0.0; 3]),
        }
    }

    /// Adds them to every acceleration.
    pub fn add(&self, into: &mut [[f32; 3]]) {
        if self.constant.is_none() && self.driven.is_none() {
            return;
        }
        let all = self.total();
        let n = into.len();
        each_mut(&mut into[..n], |_, a| {
            (0..3).for_each(|c| a[c] += all[c] as f32);
        });
    }
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

impl ActiveEffects {
    fn each(&self) -> impl Iterator<Item = &(dyn Effect + 'static)> + '_ {
        let tension = self.tension.iter().map(|tension| tension as _);
        self.others.iter().map(|effect| &**effect).chain(tension)
    }

    fn each_mut(&mut self) -> impl Iterator<Item = &mut (dyn Effect + 'static)> {
        let tension = self.tension.iter_mut();
        let others = self.others.iter_mut().map(|effect| &mut **effect);
        others.chain(tension.map(|tension| tension as _))
    }

    /// Longest stable steps by name, s, at a smoothing length, m, and a density, kg/m^3.
    pub fn limits(&self, length: f64, density: f64) -> impl Iterator<Item = (&'static str, f64)> {
        self.each()
            .filter_map(move |effect| effect.limit(length, density))
    }

    /// The uniform accelerations at `time` s.
    pub fn body_force(&self, time: f64) -> BodyForce {
        let mut force = BodyForce::default();
        for uniform in self.each().filter_map(|effect| effect.uniform(time)) {
            let (sum, one) = match uniform {
                Uniform::Constant(one) => (&mut force.constant, one),
                Uniform::Driven(one) => (&mut force.driven, one),
            };
            *sum = Some(sum.map_or(one, |sum| plus(sum, one)));
        }
        force
    }

    /// [`Effect::update`], [`Effect::friction`] and [`Effect::account`] of all; returns the sum of
    /// the last.
    pub fn update(
        &mut self,
        liquid: &Surface,
        is_surface: &(dyn Fn(usize) -> bool + Sync),
        particles: &Particles,
        friction: &mut Vec<Hold>,
    ) -> Option<Account> {
        let mut sum: Option<Account> = None;
        self.sorted = liquid.sorted;
        for effect in self.each_mut() {
            effect.update(liquid, is_surface);
            effect.friction(liquid, &particles.velocity, friction);
            let Some(one) = effect.account(particles) else {
                continue;
            };
            sum = Some(sum.map_or(one, |sum| Account {
                energy: sum.energy + one.energy,
                rate: sum.rate + one.rate,
                lines: sum.lines + one.lines,
            }));
        }
        sum
    }

    /// The sum of [`Effect::lines`]; `None` if particles were sorted since the last update.
    pub fn lines(&mut self, particles: &Particles, sorted: u64) -> Option<f64> {
        (self.sorted == sorted).then(|| self.each_mut().map(|one| one.lines(particles)).sum())
    }

    /// [`Effect::add`] of all.
    pub fn add(&self, into: &mut [[f32; 3]]) {
        self.each().for_each(|effect| effect.add(into));
    }

    /// Whether anything is found by [`ActiveEffects::update`].
    pub fn has_updates(&self) -> bool {
        self.tension.is_some()
    }

    /// [`Effect::kept`] of all.
    pub fn kept(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.each().filter_map(Effect::kept)
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.each().map(Effect::memory).sum()
    }
}
