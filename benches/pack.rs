//! Cost of packing: lines `name value unit`. `cargo bench --bench pack` packs the default scene's
//! drop and pool; with `-- million` also the published pool of 1,024,000 particles.

#[path = "wcsph/meter.rs"]
mod meter;

use coronet::particle::pack::pack;
use coronet::scene::{Scene, file};
use meter::{cpu_seconds, line};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

fn main() {
    let loaded = file::load(Path::new("pipeline.toml"), &[]).expect("the default scene is valid");
    let mut scene = loaded.scene;
    for body in 0..scene.bodies.len() {
        measure(&scene, body, &scene.bodies[body].name);
    }
    if std::env::args().any(|argument| argument == "million") {
        scene.spacing = 0.25e-3;
        let pool = scene.bodies.iter().position(|body| body.name == "pool");
        measure(
            &scene,
            pool.expect("the default scene has a pool"),
            "million",
        );
    }
}

fn measure(scene: &Scene, body: usize, name: &str) {
    let (mut task, mut since) = ("", Instant::now());
    let say = |measure: &str, value: f64, unit: &str| {
        line(&format!("{name}.{measure}"), value, unit);
    };
    let cpu = cpu_seconds();
    let packed = pack(&scene.pack_input(body), &mut |now| {
        if now.task != task {
            if !task.is_empty() {
                say(task, since.elapsed().as_secs_f64(), "s");
            }
            (task, since) = (now.task, Instant::now());
        }
        ControlFlow::Continue(())
    });
    say(task, since.elapsed().as_secs_f64(), "s");
    let (_, report) = packed.expect("a packing is found");
    say("particles", report.count as f64, "1");
    say("whole", report.seconds, "s");
    say("whole_cpu", cpu_seconds() - cpu, "s");
    say("iterations", report.iterations as f64, "1");
    say("sweeps", report.sweeps as f64, "1");
    say("spread", report.spread, "kg/m^3");
    say("nearest_mean", report.nearest.mean, "s0");
    say("nearest_least", report.nearest.least, "s0");
    if let Some(peak) = peak() {
        say("peak_memory", peak, "MB");
    }
}

/// Largest resident memory of this process so far, MB, where the system tells.
fn peak() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace()
        .nth(1)?
        .parse::<f64>()
        .ok()
        .map(|kb| kb / 1024.0)
}
