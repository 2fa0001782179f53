//! Speed of this machine: the time of steps whose cost on another machine is known.
//!
//! Steps are timed for the scene itself, on a lattice that is coarser where the scene has many
//! particles: the table of [`forecast`] then only says how the cost grows with their number.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

use coronet::method::{self, Phase, initial};
use coronet::particle::pack::pack;
use coronet::pipeline::{Work, machine};
use coronet::scene::{Arrangement, Relax, Scene, file};

use crate::forecast;

/// Particles of the copy that is timed, rings of such a copy.
const PARTICLES: f64 = 5000.0;
const RINGS: f64 = 1500.0;
/// Timed advances after the first: CPU seconds after which they end, and their number.
const ENOUGH: f64 = 0.15;
const TURNS: usize = 6;

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

/// The work in CPU seconds of this machine.
pub fn adjusted(work: Work, scene: &Scene, like: Like) -> Work {
    if work.amount <= PROBED {
        return work;
    }
    let own = match like {
        Like::Machine => None,
        Like::Impact => slower(scene, Phase::Impact),
        Like::Relax(body) => {
            let resting = forecast::resting(scene, body);
            let damping = scene
                .relax
                .as_ref()
                .map_or(0.0, |Relax { damping, .. }| *damping);
            slower(&resting, Phase::Relax { damping })
        }
    };
    let slower = own.unwrap_or_else(machine_slower);
    let amount = work.amount * slower;
    Work { amount, ..work }
}

/// CPU seconds of this machine for one of the machine of the forecasts.
fn machine_slower() -> f64 {
    static SLOWER: OnceLock<f64> = OnceLock::new();
    *SLOWER.get_or_init(|| {
        let pool = file::read(POOL, Path::new("probe"), &[]).ok();
        pool.and_then(|pool| slower(&pool.scene, Phase::Impact))
            .unwrap_or(1.0)
    })
}

/// A copy of the scene with few particles.
fn coarse(scene: &Scene) -> Scene {
    let mut copy = scene.clone();
    copy.pack.arrangement = Arrangement::Lattice;
    let is_axial = scene.domain.is_axial();
    let most = if is_axial { RINGS } else { PARTICLES };
    let plane = is_axial || scene.dimension.count() == 2;
    let over = (forecast::particles(scene) / most).max(1.0);
    copy.spacing *= if plane { over.sqrt() } else { over.cbrt() };
    copy
}

/// Timed cost of a step over that of the table; `None` where the time of a process is not
/// available, or the copy of the scene has too few particles or fails.
fn slower(scene: &Scene, phase: Phase) -> Option<f64> {
    let scene = coarse(scene);
    let body = |body| pack(&scene.pack_input(body), &mut |_| ControlFlow::Continue(())).ok();
    let bodies: Option<Vec<_>> = (0..scene.bodies.len())
        .map(|at| body(at).map(|b| b.0))
        .collect();
    let bodies = bodies?;
    let state = match phase {
        Phase::Impact => initial(&scene.impact_input(), &bodies),
        Phase::Relax { .. } => method::resting(&scene, &bodies[0]),
    };
    let mut solver = method::build(&scene, state, phase, None).ok()?;
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
    (cost > 0.0).then(|| cost / forecast::step_cost(&scene))
}
