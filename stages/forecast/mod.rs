//! Forecast of the processor time, memory and disk space of a stage.
//!
//! The costs below were measured on two cores that other programs shared. A [probe](crate::probe)
//! corrects them for the present machine and scene, and an earlier result of the same method for
//! what is left (`coronet::pipeline`). Steps follow from the speed that limits them: a splash is
//! faster than the impact at first, then slows down as 1 / t until waves and jet determine the
//! speed.

pub mod memory;
mod post;

pub use post::post;

use coronet::particle::wall::layers;
use coronet::pipeline::Work;
use coronet::scene::{
    Arrangement, Dimension, Method, Motion, Preconditioner, Projection, Scene, Side, TensionForm,
    TimeStepping, numbers,
};

/// CPU seconds per particle and step: ISPH and MPS with multigrid, WCSPH without tension.
const ISPH: f64 = 6e-6;
const MPS: f64 = 6.5e-6;
const WCSPH_SUMMED: f64 = 0.6e-6;
const WCSPH_CONTINUOUS: f64 = 1.1e-6;
/// CPU seconds that tension adds per particle and step of WCSPH; depth in H to which the normalised
/// colour is summed under a surface, and its cost for each particle there.
const TENSION: f64 = 0.25e-6;
const BAND: f64 = 2.9;
const NORMALISED: f64 = 3.5e-6;
/// CPU seconds per ring and step of WCSPH, and of one near a surface besides; of a projection.
const RING: [f64; 2] = [2.4e-6, 6.5e-6];
const RING_PROJECTED: f64 = 30e-6;
/// Part of the steps that compute a tension that is kept: rows are valid for eight or more.
const HELD: f64 = 0.12;
/// Iterations of conjugate gradients to 1e-6 at a million particles, which grow as N^(1/3), and CPU
/// seconds of an unknown in one: diagonal (or none), SSOR.
const DIAGONAL: [f64; 2] = [187.0, 100e-9];
const SSOR: [f64; 2] = [144.0, 550e-9];
/// Cost of a step of WCSPH for liquid at rest, over that of moving liquid: its rows stay valid.
const STILL: f64 = 0.4;
/// Neighbours in two dimensions over those in three, about.
const FLAT: f64 = 0.5;
/// CPU seconds of a step, independent of the number of particles: WCSPH, projections.
const STEP: [f64; 2] = [0.1e-3, 0.5e-3];
/// CPU seconds of a wall particle in a step: WCSPH, projections. Its layers cover the widest
/// kernel.
const WALL: [f64; 2] = [0.12e-6, 0.65e-6];
/// CPU seconds that a contact angle adds to that.
const WETTING: [f64; 2] = [0.25e-6, 1e-6];
/// CPU seconds of a particle in a frame that is written.
const LOG: f64 = 2e-6;
/// CPU seconds of a particle on a lattice.
const LATTICE: f64 = 5e-6;
/// CPU seconds of packing a body, per particle in 2-D, in 3-D over N^(4/3): the iterations grow
/// with its width. Factor for a free body, most of it near the surface; part that each digit of the
/// tolerance below a thousandth of the density adds.
const POISSON: [f64; 2] = [54e-6, 4.3e-6];
const ROUND: f64 = 2.5;
const DIGIT: f64 = 0.35;
const START: f64 = 0.04;
/// Part of `relax.time` until a body is at rest: over density and the permitted spread, over the
/// permitted kinetic energy, kg/J; minimum. Measured for pools, within a factor of two or three.
/// With contact lines, which creep, it takes all the time.
const CALM: [f64; 3] = [0.5e-3, 1e-6, 0.12];
/// Cosine of a contact angle that moves no contact line.
const UPRIGHT: f64 = 0.1;
/// CPU seconds per particle in the calibration, and the factor with a contact angle.
const CALIBRATE: [f64; 2] = [2e-6, 4.0];
/// CPU seconds of measuring a frame: per particle, and over N^(2/3) for the surface; in 2-D per
/// particle.
const MEASURE: [f64; 2] = [1e-6, 10e-6];
const MEASURE_FLAT: f64 = 1.1e-6;
/// Bytes per particle in a frame of the log, and in a checkpoint; number of checkpoints that stay.
const FRAME: f64 = 35.0;
const CHECKPOINT: f64 = 52.0;
const CHECKPOINTS: f64 = 5.0;

/// Number of particles of the whole scene.
pub fn particles(scene: &Scene) -> f64 {
    let counts = (0..scene.bodies.len()).map(|body| numbers::count(scene, body));
    counts.sum::<u64>() as f64
}

/// Number of frames of the log: at most one for each step of a fixed length; others end at frames.
fn frames(scene: &Scene) -> f64 {
    let wanted = (scene.impact.end / scene.frames.interval).floor();
    let most = match &scene.method {
        Method::Wcsph(settings) => match settings.time_stepping {
            TimeStepping::Fixed { step } => scene.impact.end / step,
            _ => f64::INFINITY,
        },
        _ => f64::INFINITY,
    };
    wanted.min(most) + 1.0
}

fn is_projected(scene: &Scene) -> bool {
    scene.method.projection().is_some()
}

/// CPU seconds per particle and step.
fn particle_step(scene: &Scene) -> f64 {
    if scene.domain.is_axial() {
        let near = match scene.effects.tension {
            Some(_) => RING[1] * near_surface(scene),
            None => 0.0,
        };
        return match is_projected(scene) {
            true => RING_PROJECTED,
            false => RING[0] + near,
        };
    }
    let flat = flat(scene);
    let settings = match &scene.method {
        Method::Isph(settings) => return flat * (ISPH + iterations(scene, &settings.projection)),
        Method::Mps(settings) => return flat * (MPS + iterations(scene, &settings.projection)),
        Method::Wcsph(settings) => settings,
    };
    let plain = if settings.time_stepping.is_dual() {
        WCSPH_CONTINUOUS
    } else {
        WCSPH_SUMMED
    };
    let tension = match scene.effects.tension.map(|tension| tension.form) {
        None => 0.0,
        Some(TensionForm::NormalisedColour) => NORMALISED * near_surface(scene),
        Some(_) => TENSION,
    };
    let found = match &scene.method {
        Method::Wcsph(settings) if settings.time_stepping.holds() => HELD,
        _ => 1.0,
    };
    flat * (plain + found * tension)
}

/// CPU seconds that walls add to a step.
fn walls(scene: &Scene) -> f64 {
    let projected = usize::from(is_projected(scene));
    let is_wetted = scene.effects.wetting.is_some() && scene.effects.tension.is_some();
    let wetting = if is_wetted { WETTING[projected] } else { 0.0 };
    flat(scene) * wall_particles(scene) * (WALL[projected] + wetting)
}

/// Particles of walls: layers as deep as the widest kernel, also beyond open sides.
pub fn wall_particles(scene: &Scene) -> f64 {
    let layers = layers(scene) as f64;
    let (mut outer, mut open) = (1.0, 1.0);
    for &axis in scene.dimension.axes() {
        let cells = scene.domain.size[axis] / scene.spacing;
        let sides = |kind: Side| {
            let sides = scene.domain.boundary[axis].iter();
            layers * sides.filter(|side| **side == kind).count() as f64
        };
        let beyond = if axis < 2 { sides(Side::Open) } else { 0.0 };
        outer *= cells + sides(Side::Wall) + beyond;
        open *= cells + beyond;
    }
    outer - open
}

fn flat(scene: &Scene) -> f64 {
    match scene.dimension {
        Dimension::Two => FLAT,
        Dimension::Three => 1.0,
    }
}

/// CPU seconds per particle and step that another preconditioner than multigrid adds.
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
    let smoothing = scene
        .effects
        .tension
        .map_or(1.0, |tension| tension.smoothing);
    let long = smoothing * numbers::smoothing_length(scene);
    let depth = scene.pool_depth().unwrap_or(0.0);
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
    // Fitted to the time steps of splashes from d/5 to d/24, 2.42 and 3.13 m/s: WCSPH follows its
    // fastest particles, the projections exclude spray.
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

/// Times at which a jet rises and falls, in diameters over the impact's speed.
const RISE: f64 = 30.0;
const FALL: f64 = 55.0;

/// Speed of sound for a speed of the fastest particle, m/s.
fn sound(scene: &Scene, speed: f64) -> f64 {
    let [least, most] = numbers::sound_speeds(scene);
    // It follows the speed if adaptive.
    match least < most {
        true => {
            let factor = numbers::sound_speed(scene) / numbers::reference_speed(scene);
            (factor * speed).clamp(least, most)
        }
        false => most,
    }
}

/// Time step for a speed and a speed of sound, s.
fn step(scene: &Scene, speed: f64, sound: f64) -> f64 {
    let calm = numbers::limits(scene);
    let calm = calm
        .iter()
        .filter(|limit| limit.name != "acoustic" && limit.name != "advective");
    let calm = calm.fold(f64::INFINITY, |least, limit| least.min(limit.value));
    if let Some(settings) = scene.method.projection() {
        let cross = settings.courant * scene.spacing / speed;
        return cross.clamp(settings.shortest, settings.longest).min(calm);
    }
    let h = numbers::smoothing_length(scene);
    let Method::Wcsph(settings) = &scene.method else {
        return calm;
    };
    match settings.time_stepping {
        TimeStepping::Fixed { step } => step,
        TimeStepping::Adaptive { safety, .. } => calm.min(safety * 0.25 * h / (sound + speed)),
        TimeStepping::Dual { acoustic, .. } => calm.min(acoustic * h / (sound + speed)),
    }
}

/// Steps of the impact.
fn steps(scene: &Scene) -> f64 {
    const SLICES: usize = 1000;
    let slice = scene.impact.end / SLICES as f64;
    let middle = |k: usize| (k as f64 + 0.5) * slice;
    let count = |k: usize| {
        let speed = speed(scene, middle(k));
        slice / step(scene, speed, sound(scene, speed))
    };
    let steps: f64 = (0..SLICES).map(count).sum();
    steps.max(frames(scene))
}

/// Steps of the relaxation of a body, which ends when it is at rest.
fn resting_steps(scene: &Scene, body: usize) -> Option<f64> {
    let relax = scene.relax.as_ref()?;
    let lateral = scene.domain.boundary[..2].iter().flatten();
    let creeps = |angle: f64| angle.to_radians().cos().abs() > UPRIGHT;
    let has_line = scene.effects.tension.is_some()
        && scene.effects.wetting.is_none_or(|w| creeps(w.angle))
        && !scene.bodies[body].shape.is_free()
        && lateral.into_iter().any(|side| *side == Side::Wall);
    let [spread, energy, least] = CALM;
    let spread = spread * scene.density / relax.density_spread;
    let part = match has_line {
        true => 1.0,
        false => spread.max(energy / relax.kinetic_energy).clamp(least, 1.0),
    };
    // Nothing moves; the limits of a projection do not change.
    let sound = numbers::rest_sound_speed(&scene.resting(body));
    Some(part * relax.time / step(scene, 0.0, sound))
}

/// `room`: bytes of memory that are not of the particles, of which there are `count`.
fn work(scene: &Scene, cpu: f64, room: f64, [count, disk]: [f64; 2]) -> Option<Work> {
    cpu.is_finite().then(|| Work {
        amount: cpu,
        threads: rayon::current_num_threads(),
        memory: memory::of(scene, count) + room,
        disk,
    })
}

/// Cost of packing body `body`.
pub fn pack(scene: &Scene, body: usize) -> Option<Work> {
    let count = numbers::count(scene, body) as f64;
    let cpu = match scene.pack.arrangement {
        Arrangement::Lattice => LATTICE * count,
        Arrangement::Poisson => {
            let digits = (1e-3 * scene.density / scene.pack.tolerance).log10();
            let round = scene.bodies[body].shape.is_free();
            let form = if round { ROUND } else { 1.0 };
            let [flat, space] = POISSON;
            START
                + match scene.dimension {
                    Dimension::Two => flat * count,
                    Dimension::Three => {
                        let harder = 1.0 + DIGIT * digits.max(0.0);
                        space * form * harder * count.powf(4.0 / 3.0)
                    }
                }
        }
    };
    work(scene, cpu, 0.0, [count, count * CHECKPOINT])
}

/// The scene of the relaxation of a body.
pub fn resting(scene: &Scene, body: usize) -> Scene {
    let problem = scene.resting(body);
    Scene {
        problem,
        ..scene.clone()
    }
}

/// Cost of relaxing body `body`.
pub fn relax(scene: &Scene, body: usize) -> Option<Work> {
    let count = numbers::count(scene, body) as f64;
    let cpu = resting_steps(scene, body)? * step_cost(&resting(scene, body));
    let room = memory::room(&resting(scene, body));
    work(scene, cpu, room, [count, count * CHECKPOINT])
}

/// Cost of calibrating the tension.
pub fn calibrate(scene: &Scene) -> Option<Work> {
    let count = particles(scene);
    let [each, wetted] = CALIBRATE;
    let wetted = scene.effects.wetting.map_or(1.0, |_| wetted);
    work(
        scene,
        flat(scene) * each * wetted * count,
        0.0,
        [count, 0.0],
    )
}

/// CPU seconds of a step.
pub fn step_cost(scene: &Scene) -> f64 {
    let step = STEP[usize::from(is_projected(scene))];
    let still = numbers::impact_speed(scene) == 0.0 && !is_projected(scene);
    let part = if still { STILL } else { 1.0 };
    step + part * particles(scene) * particle_step(scene) + walls(scene)
}

/// Cost of the impact.
pub fn impact(scene: &Scene) -> Option<Work> {
    let count = particles(scene);
    let recorded = frames(scene) * (count * LOG + measure(scene));
    let cpu = steps(scene) * step_cost(scene) + recorded;
    let disk = count * (frames(scene) * FRAME + CHECKPOINTS * CHECKPOINT);
    work(scene, cpu, memory::room(scene), [count, disk])
}

/// Particles of the whole of a scene that mirrors cut.
fn whole(scene: &Scene) -> f64 {
    let is_unfolded = |axis: &usize| scene.unfolds(*axis).is_some();
    particles(scene) * 2f64.powi((0..2).filter(is_unfolded).count() as i32)
}

/// CPU seconds of measuring a frame.
fn measure(scene: &Scene) -> f64 {
    let whole = whole(scene);
    match scene.dimension {
        Dimension::Two => MEASURE_FLAT * whole,
        Dimension::Three => MEASURE[0] * whole + MEASURE[1] * whole.powf(2.0 / 3.0),
    }
}
