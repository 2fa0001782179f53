//! What is asked: the resolved scene, in SI units, defaults filled in. No numerics.
//!
//! The file format lives in [`file`]; everything after it sees only these types.
//! Axes: x and y are lateral, z is up. A 2-D scene is the x-z plane: y is zero everywhere.

mod body;
mod check;
mod conform;
mod cursor;
pub mod error;
pub mod file;
pub mod format;
mod isph;
pub mod key;
pub mod lamella;
mod mps;
pub mod numbers;
mod pairs;
mod post;
pub mod preset;
mod projection;
pub mod quantity;
mod resolve;
pub mod sanity;
pub mod schema;
mod shape;
mod spelling;
mod sph;
mod symmetry;
mod tree;
mod wetting;

pub use isph::{Closure, Gradient, Isph};
pub use mps::{Mps, MpsClosure, MpsGradient};
pub use pairs::{Pairs, Precision};
pub use post::{Clock, Post, Reference};
pub use projection::{PoissonSource, Preconditioner, Projection};
pub use sph::{Sph, TensionLevel};
pub use wetting::{Wetting, WettingForm};

/// Number of space dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    Two,
    Three,
}

impl Dimension {
    /// 2 or 3.
    pub fn count(self) -> usize {
        match self {
            Dimension::Two => 2,
            Dimension::Three => 3,
        }
    }
}

/// What happens at one side of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Leaves here, enters opposite. Both sides of an axis are periodic or none is.
    Periodic,
    /// Nothing there; a particle that leaves is removed and its mass booked.
    Open,
    /// No-slip wall made of fixed particles outside the box.
    Wall,
    /// Plane of symmetry (x and y): the liquid's image lies behind it, see [`symmetry`].
    Mirror,
}

/// The box `[0, size_x] x [0, size_y] x [0, size_z]`, m. In 2-D `size[1] == 0` and y is periodic.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    pub size: [f64; 3],
    /// `boundary[axis] = [low side, high side]`.
    pub boundary: [[Side; 2]; 3],
    /// Velocity of each wall, m/s, `wall_velocity[axis][low/high][component]`; zero at rest.
    pub wall_velocity: [[[f64; 3]; 2]; 3],
}

/// Effects that the scene asks for. `None` is absent: no cost, no array, no key.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Effects {
    /// Acceleration vector, m/s^2.
    pub gravity: Option<[f64; 3]>,
    /// Dynamic viscosity, Pa s.
    pub viscosity: Option<f64>,
    /// Surface tension coefficient, N/m.
    pub tension: Option<f64>,
    /// Contact angle on the walls.
    pub wetting: Option<Wetting>,
}

/// Geometry of a body, m, in box coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Sphere, or disc in 2-D.
    Sphere { centre: [f64; 3], radius: f64 },
    /// Semi-axes; ellipse in 2-D.
    Ellipsoid {
        centre: [f64; 3],
        semi_axes: [f64; 3],
    },
    /// Axis-parallel block, rectangle in 2-D.
    Block { low: [f64; 3], high: [f64; 3] },
    /// Liquid from z = 0 to `depth` over the whole lateral extent of the box.
    Layer { depth: f64 },
}

/// Initial velocity of a body, m/s.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    Uniform([f64; 3]),
    /// u = -U cos(kx) sin(kz), w = U sin(kx) cos(kz), k = 2 pi / size_x.
    TaylorGreen {
        speed: f64,
    },
    /// Velocity that deforms a drop in its n = 2 mode: u = -a x (per lateral axis of d-1), w = +a z
    /// made divergence-free, about the body's centre; `rate` a in 1/s.
    Stretch {
        rate: f64,
    },
}

/// One body of liquid.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    pub name: String,
    pub shape: Shape,
    pub motion: Motion,
    /// Display colour of the body, RGB.
    pub colour: [u8; 3],
}

/// How a body's particles are first placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrangement {
    /// Simple cubic lattice (Nishio et al.).
    Lattice,
    /// Poisson-disk sampling, then optimisation (Kuri et al.).
    Poisson,
}

/// Settings of the pack stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Pack {
    /// Particle spacing s0, m.
    pub spacing: f64,
    pub arrangement: Arrangement,
    /// Largest standard deviation of density from rho0, kg/m^3 (Poisson only).
    pub tolerance: f64,
    pub seed: u64,
    /// Iterations after which the optimiser gives up with an error.
    pub iterations: usize,
}

/// Settings of the relax stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Relax {
    /// Longest simulated time, s.
    pub time: f64,
    /// Stop when kinetic energy per mass is below this, J/kg.
    pub kinetic_energy: f64,
    /// ... and the standard deviation of density of supported particles below this, kg/m^3.
    pub density_spread: f64,
    /// Damping rate, 1/s: a = -damping v.
    pub damping: f64,
}

/// Settings of the impact stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Impact {
    /// Simulated time to reach, s.
    pub end: f64,
    /// Wall-clock seconds between in-flight checkpoints. In no key.
    pub checkpoint_every: f64,
}

/// Frames of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// Simulated time between frames, s.
    pub interval: f64,
    /// Log time = simulated time x this.
    pub time_scale: f64,
    pub colour: Colour,
}

/// What the colour of a particle shows in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    Body,
    Speed,
    Pressure,
}

/// Smoothing kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KernelName {
    CubicSpline,
    WendlandC2,
}

/// How density is obtained.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Nishio Eq. 4.
    Summation,
    /// Continuity equation with density diffusion of this strength (delta-SPH), and the kernel sum
    /// from which crushed liquid shows its density (infinite: it never does).
    Continuity { diffusion: f64, compaction: f64 },
}

/// What a pressure below zero becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pressure {
    /// Zero.
    Clipped,
    /// Itself.
    Signed,
    /// Itself, with control of the tensile instability inside the liquid.
    Controlled,
    /// Itself inside; at a free surface no less than tension can hold, for a sheet of one or two
    /// particles cannot get thinner: what is stretched there tears.
    Tearing,
}

/// Speed of sound in the course of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoundSpeed {
    Constant,
    /// Follows the largest speed (continuity density, signed pressure, dual-criteria stepping).
    Adaptive,
}

/// Mass of a particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mass {
    /// rho0 s0^d.
    Nominal,
    /// rho0 / SUM W over the lattice, so that the lattice's summed density is rho0.
    LatticeSum,
}

/// Form of the viscous term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViscosityForm {
    /// Nishio Eq. 6 as printed: (d+3)/(d+2) too strong.
    TwoTerm,
    /// Nishio Eq. 6 multiplied by (d+2)/(d+3).
    TwoTermExact,
    /// Morris, Fox & Zhu 1997.
    Morris,
    /// Kuri Eq. 1 with zeta = d + 2: keeps angular momentum.
    Cleary,
}

/// Form of the surface-stress tension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TensionForm {
    /// Nishio Eqs. 9-13 as printed: normalised colour, difference gradient.
    NormalisedColour,
    /// Colour and normal from raw sums.
    RawColour,
    /// The derivative of an energy.
    SurfaceEnergy,
    /// Kuri Eqs. 1, 5-7: Cahn-Hilliard stress, force on the short kernel.
    CahnHilliard,
    /// Xie Eqs. 10-16: curvature from counted neighbours.
    NumberDensity,
    /// The same with the curvature of a circle or a sphere, and smooth weights.
    NumberDensityExact,
}

/// Strength alpha of the tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TensionStrength {
    Fixed(f64),
    /// By the integral of the squared gradient across a flat interface (Kuri, after Eq. 6).
    Flat,
    /// Calibrated by the virial identity on the arrangement at hand.
    Virial,
}

/// Time stepping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStepping {
    /// Velocity Verlet with a fixed step, s.
    Fixed { step: f64 },
    /// Velocity Verlet, step = the least of the limits x `safety`; tension found in each step, or
    /// held over several up to its own limit.
    Adaptive { safety: f64, holds: bool },
    /// Dual-criteria (Zhang, Rezavand & Hu 2020): advective and acoustic CFL numbers.
    Dual { advective: f64, acoustic: f64 },
}

impl TimeStepping {
    /// Whether single-rate steps hold the tension over several.
    pub fn holds(self) -> bool {
        matches!(self, TimeStepping::Adaptive { holds: true, .. })
    }
}

/// How walls give pressure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallPressure {
    /// Wall particles sum their own density (they take part in every sum).
    Summation,
    /// Extrapolated from the liquid (Adami, Hu & Adams 2012).
    Extrapolated,
}

/// Every setting of WCSPH, after the preset and the overrides.
#[derive(Clone, Debug, PartialEq)]
pub struct Wcsph {
    pub sph: Sph,
    pub density: Density,
    pub pressure: Pressure,
    /// Exponent chi of the equation of state (Nishio Eq. 7); 1 is linear.
    pub exponent: f64,
    /// c / V of Nishio Eq. 8 (10 is Mach 0.1).
    pub sound_speed_factor: f64,
    pub sound_speed: SoundSpeed,
    /// V in m/s; `None`: the largest of impact speed, sqrt(2 g T), sqrt(8 sigma / (rho R)).
    pub reference_speed: Option<f64>,
    pub wall_pressure: WallPressure,
    /// Strength of particle shifting (0 is off).
    pub shifting: f64,
    pub time_stepping: TimeStepping,
}

/// The method and its settings.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    Wcsph(Wcsph),
    Isph(Isph),
    Mps(Mps),
}

impl Method {
    /// Its word in a scene file.
    pub fn name(&self) -> &'static str {
        match self {
            Method::Wcsph(_) => "wcsph",
            Method::Isph(_) => "isph",
            Method::Mps(_) => "mps",
        }
    }

    /// What every SPH method sets.
    pub fn sph(&self) -> &Sph {
        match self {
            Method::Wcsph(settings) => &settings.sph,
            Method::Isph(settings) => &settings.sph,
            Method::Mps(settings) => &settings.sph,
        }
    }

    /// The settings of a projection method.
    pub fn projection(&self) -> Option<&Projection> {
        match self {
            Method::Wcsph(_) => None,
            Method::Isph(settings) => Some(&settings.projection),
            Method::Mps(settings) => Some(&settings.projection),
        }
    }
}

/// A scene, resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    pub name: String,
    pub title: String,
    pub dimension: Dimension,
    pub domain: Domain,
    /// Liquid density rho0, kg/m^3.
    pub density: f64,
    pub effects: Effects,
    pub bodies: Vec<Body>,
    pub pack: Pack,
    /// `None`: bodies go to the impact as packed.
    pub relax: Option<Relax>,
    pub impact: Impact,
    pub frames: Frames,
    pub post: Post,
    pub method: Method,
    pub pairs: Pairs,
}
