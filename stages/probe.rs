//! Speed of this machine: the time of steps whose cost on another machine is known.
//!
//! Steps are timed for the scene itself, on a lattice that is coarser where the scene has many
//! particles: the table of [`forecast`] then only says how the cost grows with their number. Of a
//! scene of which there is no small copy, those of a pool are timed.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, OnceLock};

use coronet::measure::gauge::Gauge;
use coronet::measure::whole::Unfold;
use coronet::method::{self, Phase, Solver, initial};
use coronet::particle::pack::pack;
use coronet::pipeline::{Work, machine};
use coronet::scene::{Arrangement, Relax, Scene, Shape, file};

use crate::forecast;

/// Particles, or rings, that the copy should have, and of liquid, walls and cells of the box
/// together at most.
const PARTICLES: f64 = 5000.0;
const RINGS: f64 = 1500.0;
const MOST: f64 = 1e6;
/// Layers that the copy of a body has at least, if the body has them.
const LAYERS: f64 = 4.0;
/// Timed advances after the first: CPU seconds after which they end, and their largest number.
const ENOUGH: f64 = 0.15;
const TURNS: usize = 50;

/// A pool of 24 x 24 x 12 particles with tension, WCSPH `modern`, for what has no steps. It slides,
/// so that rows are searched again as often as in a splash.
const POOL: &str = "\
title = 'probe'
box = { size = ['24 mm', '24 mm', '16 mm'] }
liquid = { density = '1000 kg/m^3' }
body.pool = { layer = { depth = '12 mm' }, velocity = ['1 m/s', 0, 0] }
pack = { spacing = '1 mm', arrangement = 'lattice' }
impact = { end = '1 s' }
frames = { interval = '1 s' }
method = { name = 'wcsph', preset = 'modern', wcsph = { reference_speed = '1 m/s' } }
[effects]
gravity = { acceleration = 9.81 }
viscosity = { dynamic = '1 mPa s' }
tension = { coefficient = '70 mN/m', strength = 5 }
";

/// CPU seconds of work from which steps are timed, which takes some tenths of a second.
const PROBED: f64 = 0.3;

/// Whose speed a work follows.
#[derive(Clone, Copy)]
pub enum Like {
    /// Any: a pool's.
    Machine,
    /// Steps of the impact.
    Impact,
    /// Steps of the relaxation of a body.
    Relax(usize),
}

/// The work in CPU seconds of this machine; little work as it is in the table.
pub fn adjusted(work: Work, scene: &Scene, like: Like) -> Work {
    if work.amount <= PROBED {
        return work;
    }
    let own = match like {
        Like::Machine => None,
        Like::Impact => known(scene, Phase::Impact),
        Like::Relax(body) => {
            let resting = forecast::resting(scene, body);
            let damping = scene
                .relax
                .as_ref()
                .map_or(0.0, |Relax { damping, .. }| *damping);
            known(&resting, Phase::Relax { damping })
        }
    };
    let amount = work.amount * own.unwrap_or_else(of_pool);
    Work { amount, ..work }
}

/// CPU seconds of this machine for one of the machine of the forecasts.
fn of_pool() -> f64 {
    static SLOWER: OnceLock<f64> = OnceLock::new();
    *SLOWER.get_or_init(|| {
        let pool = file::read(POOL, Path::new("probe"), &[]).ok();
        pool.and_then(|pool| slower(&pool.scene, Phase::Impact))
            .unwrap_or(1.0)
    })
}

/// [`slower`] of the copy of a scene, timed once: a study that is watched asks again and again.
fn known(scene: &Scene, phase: Phase) -> Option<f64> {
    static KNOWN: Mutex<Option<HashMap<String, Option<f64>>>> = Mutex::new(None);
    let scene = coarse(scene)?;
    let name = format!("{:?} {:?}", scene.problem, phase);
    let mut known = KNOWN.lock().ok()?;
    let known = known.get_or_insert_default();
    *known.entry(name).or_insert_with(|| slower(&scene, phase))
}

/// A copy of the scene with few particles; `None` if there is none.
fn coarse(scene: &Scene) -> Option<Scene> {
    let mut copy = scene.clone();
    copy.pack.arrangement = Arrangement::Lattice;
    copy.relax = None;
    let dimensions = scene.dimension.count() as f64;
    let most = if scene.domain.is_axial() {
        RINGS
    } else {
        PARTICLES
    };
    let wanted = (forecast::particles(scene) / most).powf(1.0 / dimensions);
    let thinnest = scene
        .bodies
        .iter()
        .map(|body| thickness(scene, &body.shape));
    let thinnest = thinnest.fold(f64::INFINITY, f64::min);
    let layers = thinnest / (LAYERS * scene.spacing);
    copy.spacing *= wanted.min(layers).max(1.0);
    let cells = scene.dimension.axes().iter();
    let cells: f64 = cells
        .map(|axis| scene.domain.size[*axis] / copy.spacing)
        .product();
    let all = forecast::particles(&copy) + forecast::wall_particles(&copy) + cells;
    (all < MOST).then_some(copy)
}

/// Least extent of a body, m.
fn thickness(scene: &Scene, shape: &Shape) -> f64 {
    let (low, high) = shape.bounds(&scene.domain, scene.dimension);
    let extents = scene.dimension.axes().iter();
    let extents = extents.map(|axis| high[*axis] - low[*axis]);
    extents.fold(f64::INFINITY, f64::min)
}

/// Timed cost of a step over that of the table, on one thread; `None` where the time of a process
/// is not available, or the scene cannot be built.
fn slower(scene: &Scene, phase: Phase) -> Option<f64> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    alone.ok()?.install(|| timed(scene, phase))
}

/// Names of the measures of a scene, from the first frame of its copy; `None` without one.
pub fn columns(scene: &Scene) -> Option<Vec<String>> {
    let scene = coarse(scene)?;
    let frame = start(&scene, Phase::Impact)?.frame();
    let row = Gauge::new(&scene.whole()).measure(&Unfold::new(&scene).whole(&frame));
    Some(row.into_iter().map(|(name, _)| name).collect())
}

/// A solver at the beginning of a phase of a scene.
fn start(scene: &Scene, phase: Phase) -> Option<Box<dyn Solver>> {
    let body = |body| {
        let packed = pack(&scene.pack_input(body), &mut |_| ControlFlow::Continue(()));
        packed.ok().map(|packed| packed.0)
    };
    let bodies: Vec<_> = (0..scene.bodies.len()).map(body).collect::<Option<_>>()?;
    let state = match phase {
        Phase::Impact => initial(&scene.impact_input(), &bodies),
        Phase::Relax { .. } => method::resting(scene, bodies.first()?),
    };
    method::build(scene, state, phase, None).ok()
}

fn timed(scene: &Scene, phase: Phase) -> Option<f64> {
    let mut solver = start(scene, phase)?;
    // The first one allocates memory.
    solver.advance(&mut |_| ()).ok()?;
    let (first, start) = (solver.step_count(), machine::cpu_seconds());
    for _ in 0..TURNS {
        solver.advance(&mut |_| ()).ok()?;
        if machine::cpu_seconds() - start > ENOUGH {
            break;
        }
    }
    let steps = (solver.step_count() - first) as f64;
    let cost = (machine::cpu_seconds() - start) / steps;
    (cost > 0.0).then(|| cost / forecast::step_cost(scene))
}
