//! Time-step limits, s. Sources beside each; the least one rules.

/// What the limits depend on, SI.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub h: f64,
    pub spacing: f64,
    pub density: f64,
    pub sound_speed: f64,
    pub viscosity: Option<f64>,
    pub tension: Option<f64>,
    /// Largest speed, m/s, and acceleration, m/s^2, now.
    pub speed: f64,
    pub acceleration: f64,
}

impl Limits {
    /// 0.25 h / (c + u) (Monaghan 1992).
    pub fn acoustic(&self) -> f64 {
        0.25 * self.h / (self.sound_speed + self.speed)
    }

    /// 0.25 sqrt(h / |a|) (Monaghan 1992).
    pub fn force(&self) -> f64 {
        0.25 * (self.h / self.acceleration.max(1e-30)).sqrt()
    }

    /// 0.125 h^2 / nu (Morris, Fox & Zhu 1997).
    pub fn viscous(&self) -> f64 {
        self.viscosity.map_or(f64::INFINITY, |mu| {
            0.125 * self.h * self.h * self.density / mu
        })
    }

    /// 0.25 sqrt(rho h^3 / (2 pi sigma)) (Morris 2000).
    pub fn capillary(&self) -> f64 {
        let wave = |sigma: f64| self.density * self.h.powi(3) / (std::f64::consts::TAU * sigma);
        self.tension
            .map_or(f64::INFINITY, |sigma| 0.25 * wave(sigma).sqrt())
    }

    /// The largest advective step, `cfl` h / u, with the other slow limits (Zhang, Rezavand & Hu
    /// 2020).
    pub fn advective(&self, cfl: f64) -> f64 {
        let advection = cfl * self.h / self.speed.max(1e-30);
        advection
            .min(self.force())
            .min(self.viscous())
            .min(self.capillary())
    }

    /// The least limit of a single-rate step.
    pub fn least(&self) -> f64 {
        self.acoustic()
            .min(self.force())
            .min(self.viscous())
            .min(self.capillary())
    }

    /// Every limit of a single-rate step by name, least first.
    pub fn all(&self) -> Vec<(&'static str, f64)> {
        let mut all = vec![
            ("acoustic", self.acoustic()),
            ("force", self.force()),
            ("viscous", self.viscous()),
            ("capillary", self.capillary()),
        ];
        all.retain(|(_, dt)| dt.is_finite());
        all.sort_by(|a, b| a.1.total_cmp(&b.1));
        all
    }
}
