//! Reach of the sums of a scene.

use super::{Problem, TensionForm, Wetting};

impl Problem {
    /// sqrt(sigma / (rho H)), m/s, of a tension that derives from an energy: rho v^2 of it is the
    /// pressure that its layer may carry. At Mach 0.1 of it the layer is compressed by 1 %.
    pub fn layer_speed(&self) -> f64 {
        match self.effects.tension {
            Some(tension) if tension.form == TensionForm::SurfaceEnergy => {
                let sph = self.method.sph();
                let length = tension.smoothing * sph.smoothing * self.spacing;
                (tension.coefficient / (self.density * length)).sqrt()
            }
            _ => 0.0,
        }
    }

    /// Whether sums that are sheared along walls continue surfaces into them: for a stress, and for
    /// the angles of lines with hysteresis.
    pub fn shears(&self, wetting: &Wetting) -> bool {
        let has_energy = self.effects.has_tension(TensionForm::SurfaceEnergy);
        wetting.layers.is_none() && !(has_energy && wetting.hysteresis.is_none())
    }

    /// Support of the widest sum, m: of the tension, of the normals that shifting needs without it,
    /// or of the kernel.
    pub fn widest(&self) -> f64 {
        let sph = self.method.sph();
        let over_kernel = match self.effects.tension {
            Some(tension) => {
                let smoothing = tension.smoothing;
                // Range in which neighbours are counted, in 2 h (Xie et al., Eq. 14).
                let beside = match tension.form {
                    TensionForm::NumberDensity => 0.5 / sph.smoothing,
                    _ => 0.0,
                };
                let wide = smoothing.max(1.0).max(smoothing + beside);
                match self.effects.wetting {
                    Some(wetting) if self.shears(&wetting) => {
                        smoothing.max(1.0) * wetting.stretch()
                    }
                    _ => wide,
                }
            }
            None if self.method.shifting() > 0.0 => self.method.normals().max(1.0),
            None => 1.0,
        };
        2.0 * sph.smoothing * self.spacing * over_kernel
    }
}
