//! How fast this machine is: what it takes for steps whose cost on another one is known.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;

use coronet::method::{Phase, build, initial};
use coronet::particle::pack::pack;
use coronet::pipeline::machine;
use coronet::scene::file;

/// CPU seconds of a particle's step of the probe on the machine that forecasts are of.
const KNOWN: f64 = 0.21e-6;
/// Turns after the first, of which the fastest counts.
const TURNS: usize = 3;

/// A block of 24^3 particles, WCSPH `modern`.
const BLOCK: &str = "\
title = 'probe'
box = { size = ['24 mm', '24 mm', '24 mm'], x = 'periodic', y = 'periodic', z = 'periodic' }
liquid = { density = '1000 kg/m^3' }
effects = { viscosity = { dynamic = '1 mPa s' } }
body.box.block = { low = [0, 0, 0], high = ['24 mm', '24 mm', '24 mm'] }
pack = { spacing = '1 mm', arrangement = 'lattice' }
impact = { end = '1 s' }
frames = { interval = '1 s' }
method = { name = 'wcsph', preset = 'modern', wcsph = { reference_speed = '1 m/s' } }
";

/// CPU seconds of this machine for one of the machine that forecasts are of.
pub fn slower() -> f64 {
    static SLOWER: OnceLock<f64> = OnceLock::new();
    *SLOWER.get_or_init(|| probe().unwrap_or(1.0))
}

/// `None` where the system does not tell the time of a process.
fn probe() -> Option<f64> {
    let scene = file::read(BLOCK, Path::new("probe"), &[]).ok()?.scene;
    let (block, _) = pack(&scene, 0, &mut |_| ControlFlow::Continue(())).ok()?;
    let mut solver = build(&scene, initial(&scene, &[block]), Phase::Impact, None).ok()?;
    let mut least = f64::INFINITY;
    for turn in 0..=TURNS {
        let (step, start) = (solver.step_count(), machine::cpu_seconds());
        solver.advance(&mut |_| ()).ok()?;
        let work = (solver.step_count() - step) as f64 * solver.len() as f64;
        if turn > 0 {
            least = least.min((machine::cpu_seconds() - start) / work);
        }
    }
    (least > 0.0).then(|| least / KNOWN)
}
