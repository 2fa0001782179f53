//! Cost of packing: lines `name value unit`. `cargo bench --bench pack` packs the default scene's
//! drop and pool; with `-- million` also the published pool of 1,024,000 particles.

use coronet::particle::pack::pack;
use coronet::scene::{Scene, file};
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
    let packed = pack(&scene.pack_input(body), &mut |now| {
        if now.task != task {
            if !task.is_empty() {
                println!("pack.{name}.{task} {:.2} s", since.elapsed().as_secs_f64());
            }
            (task, since) = (now.task, Instant::now());
        }
        ControlFlow::Continue(())
    });
    println!("pack.{name}.{task} {:.2} s", since.elapsed().as_secs_f64());
    let (_, report) = packed.expect("a packing is found");
    println!("pack.{name}.particles {} 1", report.count);
    println!("pack.{name}.whole {:.2} s", report.seconds);
    println!("pack.{name}.iterations {} 1", report.iterations);
    println!("pack.{name}.sweeps {} 1", report.sweeps);
    println!("pack.{name}.spread {:.4} kg/m^3", report.spread);
    println!("pack.{name}.nearest_mean {:.3} s0", report.nearest.mean);
    println!("pack.{name}.nearest_least {:.3} s0", report.nearest.least);
    if let Some(peak) = peak() {
        println!("pack.{name}.peak_memory {peak:.0} MB");
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
