//! Projections on walls: the contact line of a drop is free to go.

use coronet::scene::file;
use coronet::simulate::Simulation;
use std::path::Path;

/// A square of viscous water on a wall of 60 degrees becomes a flat drop. Where every wall particle
/// asked for no divergence of its own its foot was as wide as the square after 20 ms, 0.98 times
/// its diameter; with WCSPH it is 1.7 then.
#[test]
fn a_drop_spreads_on_a_dry_wall() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for method in ["isph", "mps"] {
        let sets = [
            "pack.spacing=0.24 mm".into(),
            "impact.end=20 ms".into(),
            "frames.interval=20 ms".into(),
            format!("method.name={method}"),
        ];
        let loaded = file::load(&root.join("scenes/xie-2007/static.toml"), &sets).unwrap();
        let mut run = Simulation::new(&loaded.scene).unwrap();
        let series = run.run(|_, _| ()).unwrap();
        let spread = *series.column("spread_factor").unwrap().last().unwrap();
        assert!((1.4..2.0).contains(&spread), "{method}: {spread}");
    }
}
