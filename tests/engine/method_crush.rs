//! Liquid whose particles lie too close, although its density does not say so.

use super::method_scene::{disturbed, drop_scene};
use coronet::method::{self, Phase};
use coronet::particle::State;
use coronet::scene::{Density, Method};

/// Root mean square of the distance from the middle, m.
fn radius(state: &State) -> f64 {
    let p = &state.particles;
    let square = |i: usize| {
        (0..3)
            .map(|a| (p.position[a][i] - middle(a)).powi(2))
            .sum::<f64>()
    };
    ((0..p.len()).map(square).sum::<f64>() / p.len() as f64).sqrt()
}

fn middle(axis: usize) -> f64 {
    if axis == 1 { 0.0 } else { 2.4e-3 }
}

/// A disc squeezed to 0.8 of its radius (kernel sum 1.5 inside) bounces back, for nothing holds it;
/// where the continuity equation alone has its say it stays as it is. Nothing changes at rest.
#[test]
fn crushed_liquid_spreads_again() {
    for (squeeze, compaction, least, most) in [
        (0.8, 1.1, 0.9, f64::INFINITY),
        (0.8, f64::INFINITY, 0.79, 0.83),
        (1.0, 1.1, 0.98, 1.02),
    ] {
        let mut scene = drop_scene("modern", 2, "");
        let Method::Wcsph(settings) = &mut scene.method else {
            panic!("not WCSPH");
        };
        settings.density = Density::Continuity {
            diffusion: 0.1,
            compaction,
        };
        let mut state = disturbed(&scene, 0.0);
        let whole = radius(&state);
        for a in [0, 2] {
            let x = state.particles.position[a].iter_mut();
            x.for_each(|x| *x = middle(a) + squeeze * (*x - middle(a)));
        }
        let mut solver = method::build(&scene, state, Phase::Impact, None).unwrap();
        let mut widest: f64 = 0.0;
        for _ in 0..200 {
            solver.advance(&mut |_| ()).unwrap();
            widest = widest.max(radius(&solver.state()) / whole);
        }
        assert!(
            (least..most).contains(&widest),
            "{squeeze} {compaction}: {widest}"
        );
    }
}
