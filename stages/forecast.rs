//! What a stage will take, told before it starts: processor time, memory and disk.
//!
//! The costs below were measured on machine B of docs/performance.md; an earlier result of the
//! same method corrects them for the machine at hand (`coronet::pipeline`), else a
//! [probe](crate::probe). Steps are counted along the speed that limits them: a splash is faster
//! than the impact at first, then slows down as 1 / t until waves and jet set the pace.

use coronet::pipeline::Work;
use coronet::scene::{
    Arrangement, Dimension, Method, Motion, Preconditioner, Projection, Scene, Side, TensionForm,
    TimeStepping, numbers,
};

use crate::probe;

/// CPU seconds of a particle's step: ISPH and MPS with multigrid, WCSPH without tension.
const ISPH: f64 = 2.5e-6;
const MPS: f64 = 2.6e-6;
const WCSPH_SUMMED: f64 = 0.25e-6;
const WCSPH_CONTINUOUS: f64 = 0.43e-6;
/// What tension adds to a step of WCSPH; the normalised colour is summed to so many H under a
/// surface, at this for each particle within.
const TENSION: f64 = 0.1e-6;
const BAND: f64 = 2.9;
const NORMALISED: f64 = 1.4e-6;
/// Part of the steps in which a tension that is held is found: rows last for eight or more.
const HELD: f64 = 0.12;
/// Iterations of conjugate gradients to 1e-6 at a million particles, which grow as N^(1/3), and CPU
/// seconds of an unknown in one: diagonal (or none), SSOR.
const DIAGONAL: [f64; 2] = [187.0, 40e-9];
const SSOR: [f64; 2] = [144.0, 220e-9];
/// Neighbours in two dimensions over those in three, about.
const FLAT: f64 = 0.5;
/// CPU seconds of a step whatever the number of particles.
const STEP: f64 = 0.2e-3;
/// CPU seconds of a particle: lattice, Poisson disks, rest; of a particle in a frame measured.
const LATTICE: f64 = 2e-6;
const POISSON: f64 = 130e-6;
const REST: f64 = 180e-6;
const MEASURE: f64 = 1e-6;
/// Bytes of a particle in memory (WCSPH, projections), in a frame of the log, and in a checkpoint;
/// checkpoints that stay.
const MEMORY: [f64; 2] = [1300.0, 2500.0];
const FRAME: f64 = 35.0;
/// Bytes of memory of the program itself, and of a particle of the whole that is drawn.
const BASE: f64 = 2e7;
const PICTURE: f64 = 550.0;
const CHECKPOINT: f64 = 52.0;
const CHECKPOINTS: f64 = 5.0;
/// CPU seconds of work for which it pays to probe the machine.
const PROBED: f64 = 20.0;

/// Particles of the whole scene.
fn particles(scene: &Scene) -> f64 {
    let counts = (0..scene.bodies.len()).map(|body| numbers::count(scene, body));
    counts.sum::<u64>() as f64
}

fn frames(scene: &Scene) -> f64 {
    (scene.impact.end / scene.frames.interval).floor() + 1.0
}

fn is_projected(scene: &Scene) -> bool {
    scene.method.projection().is_some()
}

/// CPU seconds of a particle's step.
fn particle_step(scene: &Scene) -> f64 {
    let flat = match scene.dimension {
        Dimension::Two => FLAT,
        Dimension::Three => 1.0,
    };
    let settings = match &scene.method {
        Method::Isph(settings) => return flat * (ISPH + iterations(scene, &settings.projection)),
        Method::Mps(settings) => return flat * (MPS + iterations(scene, &settings.projection)),
        Method::Wcsph(settings) => settings,
    };
    let is_dual = matches!(settings.time_stepping, TimeStepping::Dual { .. });
    let plain = if is_dual {
        WCSPH_CONTINUOUS
    } else {
        WCSPH_SUMMED
    };
    let tension = match scene.method.sph().tension_form {
        _ if scene.effects.tension.is_none() => 0.0,
        TensionForm::NormalisedColour => NORMALISED * near_surface(scene),
        _ => TENSION,
    };
    let found = match &scene.method {
        Method::Wcsph(settings) if settings.time_stepping.holds() => HELD,
        _ => 1.0,
    };
    flat * (plain + found * tension)
}

/// CPU seconds of a particle's step that another preconditioner than multigrid adds.
fn iterations(scene: &Scene, settings: &Projection) -> f64 {
    let [count, cost] = match settings.preconditioner {
        Preconditioner::Multigrid => return 0.0,
        Preconditioner::Diagonal | Preconditioner::None => DIAGONAL,
        Preconditioner::Ssor => SSOR,
    };
    let digits = settings.tolerance.log10() / -6.0;
    count * digits * (particles(scene) * 1e-6).cbrt() * cost
}

/// Part of the deepest layer that is within [`BAND`] H of its surface.
fn near_surface(scene: &Scene) -> f64 {
    let long = scene.method.sph().tension_smoothing * numbers::smoothing_length(scene);
    let depth = coronet::measure::gauge::pool_depth(scene);
    if depth > 0.0 {
        (BAND * long / depth).min(1.0)
    } else {
        1.0
    }
}

/// Speed that limits the steps at `time`, m/s: that of a splash if something moves.
fn speed(scene: &Scene, time: f64) -> f64 {
    let impact = numbers::impact_speed(scene);
    let falls = scene.bodies.iter().any(|body| match body.motion {
        Motion::Uniform(velocity) => body.shape.is_free() && velocity.iter().any(|v| *v != 0.0),
        _ => false,
    });
    let Some(diameter) = numbers::drop_diameter(scene).filter(|_| falls) else {
        return numbers::reference_speed(scene);
    };
    // Fitted to the time steps of splashes from d/5 to d/24, 2.42 and 3.13 m/s: those of WCSPH
    // follow its fastest particles, those of the projections leave spray out.
    let crossings = time * impact / diameter;
    let slow = match crossings {
        ..RISE if is_projected(scene) => 0.25,
        ..RISE => 0.35,
        ..FALL => 0.45,
        _ if is_projected(scene) => 0.33,
        _ => 0.2,
    };
    impact * (1.5 / crossings).clamp(slow, 1.1)
}

/// Diameters over the impact's speed until a jet rises, and until it falls.
const RISE: f64 = 30.0;
const FALL: f64 = 55.0;

/// Time step at a speed, s.
fn step(scene: &Scene, speed: f64) -> f64 {
    let calm = numbers::limits(scene);
    let calm = calm
        .iter()
        .filter(|limit| limit.name != "acoustic" && limit.name != "advective");
    let calm = calm.fold(f64::INFINITY, |least, limit| least.min(limit.value));
    if let Some(settings) = scene.method.projection() {
        let cross = settings.courant * scene.pack.spacing / speed;
        return cross.clamp(settings.shortest, settings.longest).min(calm);
    }
    let h = numbers::smoothing_length(scene);
    let [least, most] = numbers::sound_speeds(scene);
    // Adaptive where the two differ: it follows the speed.
    let follows = least < most;
    let sound = match follows {
        true => (most / numbers::reference_speed(scene) * speed).max(least),
        false => most,
    };
    let Method::Wcsph(settings) = &scene.method else {
        return calm;
    };
    match settings.time_stepping {
        TimeStepping::Fixed { step } => step,
        TimeStepping::Adaptive { safety, .. } => calm.min(safety * 0.25 * h / (most + speed)),
        TimeStepping::Dual { acoustic, .. } => calm.min(acoustic * h / (sound + speed)),
    }
}

/// Steps of the impact.
fn steps(scene: &Scene) -> f64 {
    const SLICES: usize = 1000;
    let slice = scene.impact.end / SLICES as f64;
    let middle = |k: usize| (k as f64 + 0.5) * slice;
    (0..SLICES)
        .map(|k| slice / step(scene, speed(scene, middle(k))))
        .sum()
}

fn work(scene: &Scene, cpu: f64, [memory, disk]: [f64; 2]) -> Option<Work> {
    cpu.is_finite().then(|| Work {
        amount: cpu,
        slower: if cpu > PROBED { probe::slower } else { || 1.0 },
        threads: rayon::current_num_threads(),
        memory: BASE + memory * MEMORY[usize::from(is_projected(scene))],
        disk,
    })
}

/// Of packing body `body`.
pub fn pack(scene: &Scene, body: usize) -> Option<Work> {
    let count = numbers::count(scene, body) as f64;
    let cost = match scene.pack.arrangement {
        Arrangement::Lattice => LATTICE,
        Arrangement::Poisson => POISSON,
    };
    work(scene, count * cost, [count, count * CHECKPOINT])
}

/// Of relaxing body `body`, which ends when it is at rest.
pub fn relax(scene: &Scene, body: usize) -> Option<Work> {
    scene.relax.as_ref()?;
    let count = numbers::count(scene, body) as f64;
    work(scene, count * REST, [count, count * CHECKPOINT])
}

/// Of the impact.
pub fn impact(scene: &Scene) -> Option<Work> {
    let count = particles(scene);
    let cpu = steps(scene) * (STEP + count * particle_step(scene));
    let disk = count * (frames(scene) * FRAME + CHECKPOINTS * CHECKPOINT);
    work(scene, cpu, [count, disk])
}

/// Of measuring, drawing and plotting the frames, which show the whole of a symmetric scene.
pub fn post(scene: &Scene) -> Option<Work> {
    let cut = |axis: &usize| scene.domain.boundary[*axis].contains(&Side::Mirror);
    let whole = particles(scene) * 2f64.powi((0..2).filter(cut).count() as i32);
    // One thread measures while another reads.
    let work = work(scene, frames(scene) * whole * MEASURE, [0.0, 0.0])?;
    let memory = BASE + whole * PICTURE;
    Some(Work {
        threads: 1,
        memory,
        ..work
    })
}
