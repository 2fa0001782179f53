//! Speed of this machine: the time of steps whose cost on another machine is known.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

use coronet::method::{Phase, build, initial};
use coronet::particle::pack::pack;
use coronet::pipeline::{Work, machine};
use coronet::scene::file;

use crate::forecast;

/// Number of measured advances after the first.
const TURNS: usize = 4;

/// A pool of 24 x 24 x 12 particles with tension, WCSPH `modern`, as most forecast scenes; it
/// slides, so that rows are searched again as often as in a splash.
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

/// CPU seconds of work from which the machine is probed, which takes some tenths of a second.
const PROBED: f64 = 0.3;

/// The work, with the speed of this machine.
pub fn adjusted(work: Work) -> Work {
    let slower = if work.amount > PROBED {
        slower
    } else {
        work.slower
    };
    Work { slower, ..work }
}

/// CPU seconds of this machine for one of the machine of the forecasts.
fn slower() -> f64 {
    static SLOWER: OnceLock<f64> = OnceLock::new();
    *SLOWER.get_or_init(|| probe().unwrap_or(1.0))
}

/// `None` where the time of a process is not available.
fn probe() -> Option<f64> {
    let scene = file::read(POOL, Path::new("probe"), &[]).ok()?.scene;
    let (pool, _) = pack(&scene.pack_input(0), &mut |_| ControlFlow::Continue(())).ok()?;
    let mut solver = build(
        &scene,
        initial(&scene.impact_input(), &[pool]),
        Phase::Impact,
        None,
    )
    .ok()?;
    // The first one allocates memory.
    solver.advance(&mut |_| ()).ok()?;
    let (step, start) = (solver.step_count(), machine::cpu_seconds());
    for _ in 0..TURNS {
        solver.advance(&mut |_| ()).ok()?;
    }
    let steps = (solver.step_count() - step) as f64;
    let cost = (machine::cpu_seconds() - start) / steps;
    (cost > 0.0).then(|| cost / forecast::step_cost(&scene))
}
