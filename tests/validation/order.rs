//! Orders of convergence: three spacings each, preset `modern`.

use crate::drop::{rest, sphere};
use crate::flow::{decay, front, front_error};
use crate::potential;
use crate::scene;
use crate::wall::poiseuille_errors;
use coronet::method::Diverged;
use coronet::scene::Scene;

/// Prints errors and the orders between neighbours; the finest spacing must have a smaller error
/// than the coarsest.
fn order(case: &str, spacings: [&str; 3], error: impl Fn(&Scene) -> Result<f64, Diverged>) {
    println!();
    let (mut last, mut first): (Option<(f64, f64)>, f64) = (None, 0.0);
    for spacing in spacings {
        let scene = scene(case, "modern", &[&format!("pack.spacing={spacing}")]);
        let e = error(&scene).expect("stays stable").abs();
        let order = last.map(|(s, old)| (old / e).ln() / (s / scene.spacing).ln());
        let order = order.map_or("-".into(), |p: f64| format!("{p:.1}"));
        println!("| {case} | {spacing} | {:.2} % | {order} |", 100.0 * e);
        if last.is_none() {
            first = e;
        }
        last = Some((scene.spacing, e));
    }
    let best = last.expect("three spacings").1;
    assert!(best < first, "{case}: {best} is not less than {first}");
}

#[test]
fn order_of_poiseuille() {
    let error = |scene: &Scene| Ok(poiseuille_errors(scene)?[0]);
    order("poiseuille", ["0.1 mm", "0.05 mm", "0.025 mm"], error);
}

#[test]
fn order_of_taylor_green() {
    let error = |scene: &Scene| decay(scene).map(|[rate, theory, _]| rate / theory - 1.0);
    order("taylor-green", ["0.2 mm", "0.1 mm", "0.05 mm"], error);
}

#[test]
fn order_of_static_drop_2d() {
    let error = |scene: &Scene| {
        let radius = sphere(scene);
        let theory = scene.effects.sigma().unwrap() / radius;
        Ok(rest(scene, radius)?.pressure / theory - 1.0)
    };
    order("static-drop-2d", ["0.2 mm", "0.1 mm", "0.05 mm"], error);
}

#[test]
fn order_of_dam_break() {
    let theory = potential::front(2.0, 3.5, &potential::Grid::new(0.01));
    let error = |scene: &Scene| Ok(front_error(&front(scene)?, &theory));
    order("dam-break", ["2.85 mm", "1.425 mm", "0.7125 mm"], error);
}
