//! Laws of impacts that a single phase decides: how deep a crater becomes, and what part of the
//! motion a spreading drop stores in its surface.

use super::{figure, rings};
use crate::{run, scalar, start};
use coronet::measure::gauge::Gauge;
use coronet::measure::whole::Unfold;

/// The deepest crater of a deep pool against the Froude number V^2 / (g D). A hemisphere that
/// takes all energy of the drop has the radius D (Fr / 3)^(1/4); craters reach an equal part of it
/// at any speed where gravity decides (Pumphrey & Elmore 1990, doi 10.1017/S0022112090000398). The
/// theory of each slower drop is therefore the part of the fastest, which has no row of its own.
#[test]
fn crater_depth() {
    println!();
    let (diameter, gravity) = (4e-3, 9.81);
    let mut part: Option<f64> = None;
    for speed in [4.0f64, 3.13, 2.42, 1.71] {
        let sets = [
            "box.size=['60 mm','60 mm','45 mm']",
            "box.x=wall",
            "box.y=wall",
            "body.pool.layer={depth='28 mm'}",
            "pack.spacing=0.25 mm",
            "frames.interval=0.25 ms",
            &format!("body.drop.velocity={speed} m/s"),
        ];
        let scene = rings("../../pipeline", &sets);
        let mut gauge = Gauge::new(&scene.whole());
        let unfold = Unfold::new(&scene);
        let mut solver = start(&scene).expect("starts");
        let (mut deepest, mut when) = (0.0, 0.0);
        run(solver.as_mut(), 0.04, 0.25e-3, |f| {
            let row = gauge.measure(&unfold.whole(f));
            let depth = row.iter().find(|(name, _)| name == "crater_depth_m");
            if let Some((_, depth)) = depth.filter(|(_, depth)| *depth > deepest) {
                (deepest, when) = (*depth, f.time - 0.5e-3 / speed);
            }
        })
        .expect("stays stable");
        let froude = speed * speed / (gravity * diameter);
        let bound = diameter * (froude / 3.0f64).powf(0.25);
        let case = format!("crater, Fr {froude:.0}");
        if let Some(part) = part {
            let error = figure(&case, "largest depth, m", deepest, Some(part * bound), 0.05);
            assert!(error < 0.1, "{case}: {error}");
        }
        part.get_or_insert(deepest / bound);
        println!(
            "  {:.3} of the full conversion, {:.2} ms after contact, {:.3} D / V Fr^(5/8)",
            deepest / bound,
            1e3 * when,
            when * speed / diameter / froude.powf(0.625)
        );
    }
}

/// Equal drops meet head-on: each spreads on a plane without friction, and half of its kinetic
/// energy is in its surface when that is largest, from a Weber number of 30 on (Wildeman, Visser,
/// Sun & Lohse 2016, doi 10.1017/jfm.2016.584).
#[test]
fn half_energy() {
    println!();
    let (diameter, density, sigma) = (1e-3, 998.0, 0.0728);
    let mut error = 0.0f64;
    for weber in [30.0, 60.0, 120.0] {
        let speed = f64::sqrt(weber * sigma / (density * diameter));
        let sets = [
            "box.size=['12 mm','12 mm','8 mm']",
            "body.lower.sphere={diameter='1 mm',centre=['6 mm','6 mm','3.45 mm']}",
            "body.upper.sphere={diameter='1 mm',centre=['6 mm','6 mm','4.55 mm']}",
            &format!("body.lower.velocity=[0,0,{speed}]"),
            &format!("body.upper.velocity=[0,0,-{speed}]"),
        ];
        let scene = rings("../gallery/collision", &sets);
        let mut solver = start(&scene).expect("starts");
        // A drop spreads in about sqrt(rho D^3 / sigma) / 2.
        let turn = f64::sqrt(density * diameter.powi(3) / sigma);
        let (mut first, mut most) = (None, 0.0f64);
        run(solver.as_mut(), turn, 0.01 * turn, |f| {
            let energies = ["kinetic_energy_J", "surface_energy_J"].map(|name| scalar(f, name));
            let [kinetic, surface] = *first.get_or_insert(energies);
            most = most.max((energies[1] - surface) / kinetic);
        })
        .expect("stays stable");
        let case = format!("head-on drops, We {weber}");
        let what = "largest gain of surface energy over kinetic energy";
        error = error.max(figure(&case, what, most, Some(0.5), 0.1));
    }
    assert!(error < 0.3, "half-energy rule: {error}");
}
