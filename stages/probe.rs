//! How fast this machine is: what it takes for steps whose cost on another one is known.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

use coronet::method::{Phase, build, initial};
use coronet::particle::pack::pack;
use coronet::pipeline::{Work, machine};
use coronet::scene::file;

use crate::forecast;

/// Advances after the first that are measured.
const TURNS: usize = 4;

/// A pool of 24 x 24 x 12 particles with tension, WCSPH `modern`, as most of what is forecast; it
/// slides, so that rows are found again as often as in a splash.
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

/// CPU seconds of work for which it pays to probe the machine, which takes some tenths of a second.
const PROBED: f64 = 0.3;

/// Work as this machine does it.
pub fn adjusted(work: Work) -> Work {
    let slower = if work.amount > PROBED {
        slower
    } else {
        work.slower
    };
    Work { slower, ..work }
}

/// CPU seconds of this machine for one of the machine that forecasts are of.
fn slower() -> f64 {
    static SLOWER: OnceLock<f64> = OnceLock::new();
    *SLOWER.get_or_init(|| probe().unwrap_or(1.0))
}

/// `None` where the system does not tell the time of a process.
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
    // The first one sets up what stays.
    solver.advance(&mut |_| ()).ok()?;
    let (step, start) = (solver.step_count(), machine::cpu_seconds());
    for _ in 0..TURNS {
        solver.advance(&mut |_| ()).ok()?;
    }
    let steps = (solver.step_count() - step) as f64;
    let cost = (machine::cpu_seconds() - start) / steps;
    (cost > 0.0).then(|| cost / forecast::step_cost(&scene))
}
