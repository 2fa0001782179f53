//! Liquid whose particles lie too close, although its density does not say so.

use super::method_scene::{disturbed, drop_scene};
use coronet::method::{self, Phase};
use coronet::particle::{Particles, State};
use coronet::scene::{Density, Method, MpsGradient};

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

/// Two particles that lie half a spacing apart and approach each other part no faster than that
/// after a step. With the weight of Eq. 3 all the way the pressure throws them apart.
#[test]
fn a_close_pair_is_not_thrown() {
    const SPEED: f64 = 0.01;
    // How fast they part after a step, over how fast they approached.
    let returned = |core: f64, gradient: MpsGradient| {
        let mut scene = drop_scene("mps modern", 2, "");
        let Method::Mps(settings) = &mut scene.method else {
            panic!("not MPS");
        };
        settings.core = core;
        settings.gradient = gradient;
        let mut state = disturbed(&scene, 0.0);
        let p = &mut state.particles;
        let away = |p: &Particles, i: usize, k: usize| {
            let x = [0, 2].map(|a| p.position[a][k] - p.position[a][i]);
            (x, x[0].hypot(x[1]))
        };
        let order = |a: &usize, b: &usize| p.position[2][*a].total_cmp(&p.position[2][*b]);
        let top = (0..p.len()).max_by(order).unwrap();
        let others = (0..p.len()).filter(|i| *i != top);
        let far = |i: &usize| away(p, top, *i).1;
        let next = others.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap();
        let (x, length) = away(p, top, next);
        let normal = x.map(|x| x / length);
        let ids = [p.id[top], p.id[next]];
        for (n, a) in normal.into_iter().zip([0, 2]) {
            p.position[a][top] += (length - 0.5 * scene.spacing) * n;
            p.velocity[a][top] = 0.5 * SPEED * n;
            p.velocity[a][next] = -0.5 * SPEED * n;
        }
        let mut solver = method::build(&scene, state, Phase::Impact, None).unwrap();
        solver.advance(&mut |_| ()).unwrap();
        let p = solver.state().particles;
        let place = |id: u32| p.id.iter().position(|other| *other == id).unwrap();
        let [top, next] = ids.map(place);
        let apart = |a: usize| p.velocity[a][next] - p.velocity[a][top];
        (apart(0) * normal[0] + apart(2) * normal[1]) / SPEED
    };
    let Method::Mps(modern) = drop_scene("mps modern", 2, "").problem.method else {
        panic!("not MPS");
    };
    let [held, thrown] = [modern.core, 0.0].map(|core| returned(core, MpsGradient::Corrected));
    assert!(held.abs() < 1.0, "{held} of the speed");
    assert!(thrown > 1.0, "{thrown} of the speed");
    let smooth = returned(modern.core, modern.gradient);
    assert!(smooth.abs() < 1.0, "{smooth} of the speed");
}
