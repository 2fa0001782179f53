//! Particle shifting against the gradient of concentration (Lind, Xu, Stansby & Rogers 2012; Sun et
//! al. 2019), with C = SUM V W:
//! (1) dr = -2 A h v dt grad C, 2 A h v dt <= h^2 / 2, beyond which the explicit diffusion of
//!     particles is unstable, and |dr| <= v dt / 2
//!
//! Inside v is the largest speed, not the local one: voids open at stagnation points. Near a
//! surface particles are shifted along it, by the normal of the colour (`Tension::normals` where
//! there is no tension), with the speed at which the flow disorders them, the root mean square u of
//! |v_ab| over the neighbours, or the one at which tension does, v_c (1 - (u / v_c)^2),
//! v_c^2 = sigma / (rho h). What has less support than a flat surface is a rim, a tip or a sheet,
//! whose normal is uncertain: only the speed of tension moves it. Spray stays. A layer that is not
//! shifted is pressed together by the particles that are shifted inside, without a higher density,
//! until it bursts. Beside a contact line the dry part of the wall is left out of grad C
//! (`Wetting::dry`): it would point past the edge of the liquid, and its part along the surface
//! would carry particles off the line, against which the drop turns (4 degrees too flat at 120).
//!
//! No particle is shifted where the tension derives from an energy (`Case::shifts`).

/// Shifting is never faster than this part of the largest speed (Sun et al. 2019).
const CAP: f64 = 0.5;

/// Kernel sum of the outermost layer of a flat surface (lattice, Wendland C2, h = 1.5 s0: 0.753; an
/// edge has 0.56, a sheet of two layers 0.737).
const FLAT: f32 = 0.75;

/// Below this kernel sum a particle is spray and is not shifted (Sun et al. 2017 use 0.55 of the
/// eigenvalue of the renormalisation matrix, which a surface lowers like the kernel sum).
pub const LOOSE: f32 = 0.55;

/// Largest dr / grad C in h^2: beyond it the explicit diffusion of particles is unstable (Lind et
/// al. 2012).
const LIMIT: f64 = 0.5;

/// The shifting of one step.
pub struct Shifting {
    /// A.
    pub strength: f64,
    /// m.
    pub h: f64,
    /// s.
    pub dt: f64,
    /// Largest speed and v_c, m/s.
    pub fastest: f64,
    /// v_c, the speed of tension, m/s.
    pub capillary: f64,
    /// What turns the slopes given into grad C, 1/m.
    pub unit: f64,
}

impl Shifting {
    /// v_c, m/s, for sigma in N/m, density in kg/m^3 and h in m; zero without tension.
    pub fn capillary(tension: Option<f64>, density: f64, h: f64) -> f64 {
        (tension.unwrap_or(0.0) / (density * h)).sqrt()
    }

    /// -dr / slope at a speed.
    #[inline(always)]
    fn factor(&self, speed: f64) -> f64 {
        let wanted = 2.0 * self.strength * self.h * speed * self.dt;
        wanted.min(LIMIT * self.h * self.h) * self.unit
    }

    /// dr inside, m.
    #[inline(always)]
    pub fn inside(&self, slope: [f64; 3]) -> [f64; 3] {
        let factor = self.factor(self.fastest);
        self.capped(slope.map(|g| -g * factor))
    }

    /// dr near a surface with the normal `normal` (of any length), m; `support`: kernel sum,
    /// `stir`: u, m/s.
    #[inline(always)]
    pub fn near(&self, slope: [f64; 3], normal: [f64; 3], support: f32, stir: f32) -> [f64; 3] {
        if support < LOOSE {
            return [0.0; 3];
        }
        let u = stir as f64;
        let calm = if u < self.capillary {
            self.capillary - u * u / self.capillary
        } else {
            0.0
        };
        let factor = self.factor(if support < FLAT { calm } else { calm.max(u) });
        let mut dr = slope.map(|g| -g * factor);
        let n2: f64 = normal.iter().map(|n| n * n).sum();
        let along = (0..3).map(|a| dr[a] * normal[a]).sum::<f64>() / n2;
        (0..3).for_each(|a| dr[a] -= along * normal[a]);
        self.capped(dr)
    }

    #[inline(always)]
    fn capped(&self, dr: [f64; 3]) -> [f64; 3] {
        let cap = CAP * self.fastest.max(self.capillary) * self.dt;
        let length = dr.iter().map(|d| d * d).sum::<f64>().sqrt();
        let limit = if length > cap { cap / length } else { 1.0 };
        dr.map(|d| limit * d)
    }
}
