//! Packing: the particles of one body at rest, before relaxation.
//!
//! Either a lattice (Nishio et al. 2010) or, as in Kuri et al., Poisson-disk sampling, then
//! optimisation until the standard deviation of density from rho0 is small:
//! [`poisson`](super::poisson) -> [`repulse`](super::repulse) -> [`optimise`](super::optimise).
//! Spheres and ellipsoids are packed about the origin, layers and blocks in box coordinates between
//! the wall particles. The result depends on shape, spacing, kernel, mass setting, seed and, for
//! layers and blocks, the box; not on the number of threads.

use super::completion::Completion;
use super::crowd::{Crowd, wall_near, wall_shift};
use super::fault::PAIRED;
pub use super::fault::PackError;
use super::optimise::{self, Measure, Work};
use super::quality;
pub use super::report::{PackProgress, PackReport};
use super::repulse;
use super::shape::Region;
use super::{Particles, lattice, poisson, ring, wall};
use crate::kernel::{self, CubicSpline, Kernel, WendlandC2};
use crate::scene::input::PackInput;
use crate::scene::{Arrangement, KernelName, Mass, Sph};
use crate::space::grid::TooSmall;
use crate::space::ranks::{Communicator, broadcast};
use std::marker::PhantomData;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

/// Largest number of steps of repulsion, and the root mean square step, in spacings, that ends it.
const REPULSIONS: usize = 120;
const QUIET: f64 = 0.0012;

/// Called at each step; `Break` stops the packing.
pub type Watch<'a> = dyn FnMut(&PackProgress) -> ControlFlow<()> + 'a;

/// Mass of one particle, kg (kg/m in 2-D). `density` in kg/m^3, `spacing` in m.
/// `space`: number of dimensions of what the liquid fills.
pub fn mass(space: usize, density: f64, spacing: f64, sph: Sph) -> f64 {
    let d = space;
    let nominal = density * spacing.powi(d as i32);
    match sph.mass {
        Mass::Nominal => nominal,
        Mass::LatticeSum => nominal / kernel::lattice_sum(sph.kernel, d, 1.0, sph.smoothing),
    }
}

fn particle_mass(input: &PackInput) -> f64 {
    mass(
        input.dimension.count(),
        input.density,
        input.spacing,
        input.sph,
    )
}

/// Packs a body: at rest, density rho0, ids from 0, body 0, positions in m (about the origin for
/// spheres and ellipsoids, in box coordinates otherwise). `watch` is called at each step.
///
/// # Errors
/// See [`PackError`].
pub fn pack(input: &PackInput, watch: &mut Watch) -> Result<(Particles, PackReport), PackError> {
    pack_on(None, input, watch)
}

/// [`pack`] on all ranks, of which the first one samples, and has the body at the end; the others
/// have no particles then. Only the first one's `watch` can stop it.
///
/// # Errors
/// See [`PackError`]; the same on all ranks.
pub fn pack_shared(
    with: &Arc<dyn Communicator>,
    input: &PackInput,
    watch: &mut Watch,
) -> Result<(Particles, PackReport), PackError> {
    pack_on(Some(with), input, watch)
}

fn pack_on(
    with: Option<&Arc<dyn Communicator>>,
    input: &PackInput,
    watch: &mut Watch,
) -> Result<(Particles, PackReport), PackError> {
    match input.sph.kernel {
        KernelName::CubicSpline => Packing::<CubicSpline>::new(input, with)?.run(watch),
        KernelName::WendlandC2 => Packing::<WendlandC2>::new(input, with)?.run(watch),
    }
}

/// One body being packed; lengths in units of the spacing.
struct Packing<'a, K> {
    input: &'a PackInput,
    /// The other processes, if there are any.
    with: Option<&'a Arc<dyn Communicator>>,
    region: Region,
    /// Whether the kernel overestimates the density of disordered particles.
    biased: bool,
    /// Number of particles that fills the volume.
    count: usize,
    wall: [Vec<f64>; 3],
    measure: Measure<K>,
    began: Instant,
}

impl<'a, K: Kernel> Packing<'a, K> {
    fn new(
        input: &'a PackInput,
        with: Option<&'a Arc<dyn Communicator>>,
    ) -> Result<Self, PackError> {
        let (dimension, spacing) = (input.dimension, input.spacing);
        let region = Region::new(input).scaled(1.0 / spacing);
        let count = region.volume().round() as usize;
        let name = || input.name.clone();
        if count < 1 << dimension.count() {
            return Err(PackError::TooFew {
                body: name(),
                spacing,
                count,
            });
        }
        if count > u32::MAX as usize / 2 {
            return Err(PackError::TooMany {
                body: name(),
                spacing,
                count,
            });
        }
        let h = input.sph.smoothing;
        let reach = (2.0 * h).max(2.0 * repulse::SMOOTHING);
        let wall = match region.touches_wall() {
            true => {
                let layers = reach.ceil() as usize;
                wall::build_layers(&input.domain, dimension, spacing, layers).position
            }
            false => Default::default(),
        };
        let wall = wall.map(|x| x.into_iter().map(|x| x / spacing).collect());
        let nominal = input.density * spacing.powi(dimension.count() as i32);
        Ok(Packing {
            input,
            with,
            wall: wall_near(&region, &wall, wall_shift(input), reach),
            region,
            biased: input.sph.kernel == KernelName::WendlandC2,
            count,
            measure: Measure {
                dimension: dimension.count(),
                h,
                mass: particle_mass(input) / nominal,
                kernel: PhantomData,
            },
            began: Instant::now(),
        })
    }

    fn run(self, watch: &mut Watch) -> Result<(Particles, PackReport), PackError> {
        let start = match self.input.packing.arrangement {
            Arrangement::Lattice => self.on_first(|| lattice::fill(&self.region, 1.0)),
            Arrangement::Poisson => self.repel(self.sample(watch)?, watch)?,
        };
        let completion = Completion::new::<K>(&self.region, self.measure.h);
        let mut crowd = self.crowd(start, 2.0 * self.measure.h)?;
        let (iterations, sweeps) = match self.input.packing.arrangement {
            Arrangement::Lattice => (0, 0),
            Arrangement::Poisson => self.optimise(&mut crowd, &completion, watch)?,
        };
        let mut report = self.report(&crowd, &completion);
        (report.iterations, report.sweeps) = (iterations, sweeps);
        Ok((self.particles(&crowd), report))
    }

    /// Points that one rank makes alone: the others have none.
    fn on_first(&self, make: impl FnOnce() -> [Vec<f64>; 3]) -> [Vec<f64>; 3] {
        match self.with {
            Some(with) if with.rank() > 0 => Default::default(),
            _ => make(),
        }
    }

    /// Reports a step to the watcher of the first rank, which can stop all.
    fn tell(&self, watch: &mut Watch, progress: PackProgress) -> Result<(), PackError> {
        let is_first = self.with.is_none_or(|with| with.rank() == 0);
        let own = is_first.then(|| watch(&progress).is_break());
        let stops = match self.with {
            None => own == Some(true),
            Some(with) => broadcast(&**with, 0, own),
        };
        match stops {
            false => Ok(()),
            true => Err(PackError::Stopped { body: self.name() }),
        }
    }

    fn sample(&self, watch: &mut Watch) -> Result<[Vec<f64>; 3], PackError> {
        let progress = |done| PackProgress {
            task: "sample",
            done,
            of: self.count,
            spread: None,
        };
        self.tell(watch, progress(0))?;
        let seed = self.input.packing.seed;
        let position = self.on_first(|| poisson::sample(&self.region, self.count, seed));
        self.tell(watch, progress(self.count))?;
        Ok(position)
    }

    fn repel(
        &self,
        position: [Vec<f64>; 3],
        watch: &mut Watch,
    ) -> Result<[Vec<f64>; 3], PackError> {
        let completion = Completion::new::<WendlandC2>(&self.region, repulse::SMOOTHING);
        let mut crowd = self.crowd(position, 2.0 * repulse::SMOOTHING)?;
        let mut last = Vec::new();
        for done in 1..=REPULSIONS {
            let moved = repulse::step(&mut crowd, &completion, self.measure.dimension, &mut last);
            let progress = PackProgress {
                task: "repel",
                done,
                of: REPULSIONS,
                spread: None,
            };
            self.tell(watch, progress)?;
            if moved < QUIET {
                break;
            }
        }
        Ok(crowd.position)
    }

    /// Iterations and conjugate-gradient steps taken.
    fn optimise(
        &self,
        crowd: &mut Crowd,
        completion: &Completion,
        watch: &mut Watch,
    ) -> Result<(usize, usize), PackError> {
        let pack = &self.input.packing;
        let (mut local, mut work) = (Vec::new(), Work::default());
        let (mut done, mut sweeps) = (0, 0);
        loop {
            let level = self.level(crowd, completion, &mut local);
            let spread = optimise::spread(crowd.span(), &local, level) * self.input.density;
            let progress = PackProgress {
                task: "optimise",
                done,
                of: pack.iterations,
                spread: Some(spread),
            };
            self.tell(watch, progress)?;
            // All ranks know the spread, so that all of them ask for the distance or none.
            if spread <= pack.tolerance && quality::closest(crowd) >= PAIRED {
                return Ok((done, sweeps));
            }
            if done >= pack.iterations || spread.is_nan() {
                let closest = quality::closest(crowd);
                return Err(PackError::NotReached {
                    body: self.name(),
                    spread,
                    closest,
                    iterations: done,
                    tolerance: pack.tolerance,
                });
            }
            sweeps += work.step(crowd, self.measure, &local, level);
            done += 1;
        }
    }

    /// Computes densities; returns the relative deviation from rho0 that is the goal.
    fn level(
        &self,
        crowd: &Crowd,
        completion: &Completion,
        local: &mut Vec<optimise::Local>,
    ) -> f64 {
        optimise::densities(crowd, completion, self.measure, local);
        match self.region.is_closed() || self.biased {
            true => optimise::level(crowd.span(), local),
            false => 0.0,
        }
    }

    fn crowd(&self, position: [Vec<f64>; 3], support: f64) -> Result<Crowd, PackError> {
        let crowd = Crowd::new(
            &self.region,
            position,
            self.wall.clone(),
            support,
            self.with,
        );
        crowd.map_err(|found| PackError::Box {
            body: self.name(),
            // Back to metres.
            source: TooSmall {
                axis: found.axis,
                size: found.size * self.input.spacing,
                need: found.need * self.input.spacing,
            },
        })
    }

    fn report(&self, crowd: &Crowd, completion: &Completion) -> PackReport {
        let density = self.input.density;
        let mut local = Vec::new();
        let level = self.level(crowd, completion, &mut local);
        let span = crowd.span();
        let (supported, supported_spread) = quality::supported(span.clone(), &local, level);
        let (mass, wanted_mass) = self.masses(crowd);
        let is_plane = self.measure.dimension == 2 && !self.input.domain.is_revolved();
        PackReport {
            count: span.total(),
            own: crowd.len(),
            mass,
            wanted_mass,
            unit: if is_plane { "kg/m" } else { "kg" },
            spread: density * optimise::spread(span.clone(), &local, level),
            offset: density * optimise::level(span, &local),
            supported,
            supported_spread: density * supported_spread,
            nearest: quality::nearest(crowd, 2.0 * self.measure.h),
            iterations: 0,
            sweeps: 0,
            seconds: self.began.elapsed().as_secs_f64(),
        }
    }

    /// Total and wanted mass.
    fn masses(&self, crowd: &Crowd) -> (f64, f64) {
        let PackInput {
            density,
            spacing,
            domain,
            shape,
            ..
        } = self.input;
        let nominal = density * spacing.powi(self.measure.dimension as i32);
        if !domain.is_revolved() {
            let mass = crowd.span().total() as f64 * particle_mass(self.input);
            return (mass, nominal * self.region.volume());
        }
        let pitch = wall::Lattice::new(domain, self.input.dimension, *spacing).pitch[0] / spacing;
        let rings = crowd.position[0].iter();
        let weights = rings.map(|r| ring::settle(&mut r.clone(), pitch, 1.0));
        let mass = nominal * spacing * weights.sum::<f64>();
        (mass, density * shape.revolved(domain))
    }

    fn particles(&self, crowd: &Crowd) -> Particles {
        let spacing = self.input.spacing;
        let position = crowd.position.each_ref().map(|x| {
            let all = crowd.collect(x.iter().map(|x| x * spacing).collect());
            all.unwrap_or_default()
        });
        let n = position[0].len();
        Particles {
            id: (0..n as u32).collect(),
            body: vec![0; n],
            position,
            velocity: [const { Vec::new() }; 3].map(|_: Vec<f64>| vec![0.0; n]),
            density: vec![self.input.density; n],
            mass: particle_mass(self.input),
            weight: Vec::new(),
        }
    }

    fn name(&self) -> String {
        self.input.name.clone()
    }
}
