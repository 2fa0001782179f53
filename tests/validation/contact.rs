//! Contact angles at rest.

use crate::{Figure, run, start};
use coronet::measure::gauge::Gauge;
use coronet::scene::file;
use std::path::Path;

/// Mean of a measure over the last sixth of a run.
fn angles(set: f64, spacing: &str) -> Option<[f64; 2]> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/xie-2007/static.toml");
    let method = std::env::var("CORONET_METHOD").unwrap_or("wcsph".into());
    let sets = [
        format!("method.name={method}"),
        format!("effects.wetting.angle={set} deg"),
        format!("pack.spacing={spacing}"),
    ];
    let scene = file::load(&root, &sets).expect("the scene is valid").scene;
    let mut gauge = Gauge::new(&scene);
    let end = scene.impact.end;
    let mut sums = [0.0; 3];
    let mut solver = start(&scene).ok()?;
    run(solver.as_mut(), end, 0.01 * end, |frame| {
        let row = gauge.measure(frame);
        let value = |name: &str| row.iter().find(|(n, _)| n == name).expect("a column").1;
        if frame.time > 5.0 / 6.0 * end {
            sums[0] += value("contact_angle_deg");
            sums[1] += value("contact_angle_base_deg");
            sums[2] += 1.0;
        }
    })
    .ok()?;
    Some([sums[0] / sums[2], sums[1] / sums[2]])
}

/// The drop of Xie, Koshizuka & Oka (2007), Section 3.1, at its spacing and twice that. Asserted is
/// what docs/results/wetting.md says is met.
#[test]
fn contact_angle() {
    println!();
    for spacing in ["0.16 mm", "0.08 mm"] {
        for set in [30.0, 45.0, 60.0, 75.0, 90.0, 120.0, 150.0] {
            let [fitted, built] = angles(set, spacing).unwrap_or([f64::NAN; 2]);
            println!("  set {set}, s0 = {spacing}: {fitted:.1} by circle, {built:.1} by base");
            let figure = Figure {
                case: "contact angle",
                preset: "modern",
                what: &format!("{set} deg at {spacing}"),
                got: fitted,
                theory: Some(set),
                target: 3.0 / set,
            };
            figure.row();
            // At 150 degrees a drop of WCSPH touches less wall than its kernel sees.
            let asked = match std::env::var("CORONET_METHOD").as_deref() {
                Ok("isph" | "mps") => 30.0..=150.0,
                _ => 30.0..=120.0,
            };
            let met = (fitted - set).abs() < 3.0;
            assert!(
                met || !asked.contains(&set),
                "{set} deg at {spacing}: {fitted}"
            );
        }
    }
}
