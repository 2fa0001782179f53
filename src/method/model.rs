//! Constants of a run, derived once from the scene.

use super::Phase;
use crate::particle::column::{Scalar, Scalars};
use crate::scene::{
    Density, Dimension, Domain, Effects, Method, Pairs, Pressure, Problem, Sph, TensionForm, Wcsph,
    numbers,
};

/// What every method derives from a problem, SI.
#[derive(Clone, Debug)]
pub struct Case {
    /// Kernel, smoothing length and mass of the method.
    pub sph: Sph,
    /// How pairs are found and summed.
    pub pairs: Pairs,
    /// Of the scene.
    pub dimension: Dimension,
    /// Number of dimensions of the space that kernels fill: 3 where particles are rings.
    pub space: usize,
    /// The box.
    pub domain: Domain,
    /// Effects of the scene.
    pub effects: Effects,
    /// s0, h, m.
    pub spacing: f64,
    /// Smoothing length h, m.
    pub h: f64,
    /// Support of the widest sum, m.
    pub widest: f64,
    /// rho0, kg/m^3.
    pub density: f64,
    /// Largest speed that the scene suggests, m/s.
    pub speed: f64,
    /// Damping rate, 1/s; 0 in the impact.
    pub damping: f64,
    /// Whether a body comes to rest by itself, without the others.
    pub rests: bool,
    /// Whether the pressure solves an equation.
    pub is_implicit: bool,
}

/// Derived constants of a weakly compressible run, SI.
#[derive(Clone, Debug)]
pub struct Model {
    /// Settings of the method.
    pub settings: Wcsph,
    /// rho0, kg/m^3.
    pub density: f64,
    /// c now, m/s.
    pub sound_speed: f64,
    /// Least and largest c of the run, m/s.
    pub sound_speeds: [f64; 2],
}

impl Scalars for Model {
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar)) {
        see("sound_speed_m_s", &mut self.sound_speed);
    }
}

impl Case {
    /// Constants of a problem.
    pub fn new(problem: &Problem, phase: Phase) -> Self {
        let sph = problem.method.sph();
        Case {
            sph,
            pairs: problem.pairs,
            dimension: problem.dimension,
            space: problem.space(),
            domain: problem.domain.clone(),
            effects: problem.effects.clone(),
            spacing: problem.spacing,
            h: sph.smoothing * problem.spacing,
            widest: problem.widest(),
            density: problem.density,
            speed: numbers::reference_speed(problem),
            rests: matches!(phase, Phase::Relax { .. }),
            damping: match phase {
                Phase::Relax { damping } => damping,
                Phase::Impact => 0.0,
            },
            is_implicit: !matches!(problem.method, Method::Wcsph(_)),
        }
    }
}

impl Case {
    /// Whether particles are shifted, for a `strength` of the shifting: not where the tension has
    /// an energy, for what is moved at rest does work on the surface, and not rings.
    pub fn shifts(&self, strength: f64) -> bool {
        strength > 0.0 && !self.follows_energy() && !self.domain.is_axial()
    }

    /// Whether the tension is the derivative of an energy.
    pub fn follows_energy(&self) -> bool {
        self.effects.has_tension(TensionForm::SurfaceEnergy)
    }
}

impl Model {
    /// For `settings`, which are those of the problem's method.
    pub fn new(problem: &Problem, settings: &Wcsph, phase: Phase) -> Self {
        let (sound_speed, sound_speeds) = match phase {
            Phase::Relax { .. } => {
                let sound = numbers::rest_sound_speed(problem);
                (sound, [sound; 2])
            }
            Phase::Impact => (
                numbers::sound_speed(problem),
                numbers::sound_speeds(problem),
            ),
        };
        Model {
            settings: settings.clone(),
            density: problem.density,
            sound_speed,
            sound_speeds,
        }
    }

    /// P(rho), Pa (Nishio Eqs. 7-8), before clipping.
    #[inline(always)]
    pub fn pressure(&self, density: f64) -> f64 {
        let e = density / self.density;
        let p = if self.settings.exponent == 1.0 {
            e - 1.0
        } else if self.settings.exponent == 7.0 {
            let e2 = e * e;
            (e * e2 * (e2 * e2) - 1.0) / 7.0
        } else {
            let chi = self.settings.exponent;
            let power = match chi.fract() == 0.0 {
                true => e.powi(chi as i32),
                false => e.powf(chi),
            };
            (power - 1.0) / chi
        };
        let p = self.density * self.sound_speed * self.sound_speed * p;
        match self.settings.pressure {
            Pressure::Clipped => p.max(0.0),
            _ => p,
        }
    }

    /// Energy of compression, INT P / rho^2 d rho from rho0, J/kg.
    #[inline(always)]
    pub fn compression(&self, density: f64) -> f64 {
        let e = density / self.density;
        if self.settings.pressure == Pressure::Clipped && e < 1.0 {
            return 0.0;
        }
        let (c2, chi) = (self.sound_speed * self.sound_speed, self.settings.exponent);
        if chi == 1.0 {
            return c2 * (e.ln() + 1.0 / e - 1.0);
        }
        let power = match chi == 7.0 {
            true => e.powi(6),
            false => e.powf(chi - 1.0),
        };
        c2 / chi * ((power - 1.0) / (chi - 1.0) + 1.0 / e - 1.0)
    }

    /// rho(P), kg/m^3: the inverse of the unclipped equation of state.
    pub fn density_at(&self, pressure: f64) -> f64 {
        let p = pressure / (self.density * self.sound_speed * self.sound_speed);
        let chi = self.settings.exponent;
        if chi == 1.0 {
            return self.density * (1.0 + p);
        }
        self.density * (1.0 + chi * p).max(1e-6).powf(1.0 / chi)
    }

    /// The least density at a free surface, kg/m^3, where what is stretched tears: that of the
    /// pressure that tension holds across the finest surface, (d - 1) sigma / h.
    pub fn torn(&self, case: &Case) -> Option<f64> {
        let held = (case.space - 1) as f64 / case.h;
        let sigma = case.effects.sigma().unwrap_or(0.0);
        let tears = self.settings.pressure == Pressure::Tearing;
        tears.then(|| self.density_at(-held * sigma))
    }

    /// Kernel sum from which over-compressed liquid gets a density of its own; infinite for none.
    pub fn compaction(&self) -> f64 {
        match self.settings.density {
            Density::Continuity { compaction, .. } => compaction,
            Density::Summation => f64::INFINITY,
        }
    }

    /// Whether density follows the continuity equation, and its diffusion.
    pub fn diffusion(&self) -> Option<f64> {
        match self.settings.density {
            Density::Continuity { diffusion, .. } => Some(diffusion),
            Density::Summation => None,
        }
    }
}
