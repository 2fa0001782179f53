//! Kernel mass outside free surfaces, against sums over a fine lattice.

use super::pack_scene::{S0, scene};
use coronet::kernel::{CubicSpline, WendlandC2};
use coronet::particle::completion::Completion;
use coronet::particle::ellipsoid;
use coronet::particle::shape::Region;
use coronet::scene::*;

const H: f64 = 1.3;

fn region(dimension: Dimension, shape: Shape) -> Region {
    let scene = scene(dimension, [60.0, 60.0, 60.0], shape);
    Region::new(&scene.pack_input(0)).scaled(1.0 / S0)
}

/// Share of the kernel about `x` outside `region`, by brute force.
fn outside(region: &Region, x: [f64; 3]) -> f64 {
    let n = 26;
    let deep = if region.axes().len() == 3 { n } else { 0 };
    let (mut all, mut out) = (0.0, 0.0);
    for i in -n..=n {
        for j in -deep..=deep {
            for k in -n..=n {
                let d = [i, j, k].map(|i| (i as f64 + 0.37) / n as f64 * 2.0 * H);
                let d = if deep == 0 { [d[0], 0.0, d[2]] } else { d };
                let r = d.iter().map(|d| d * d).sum::<f64>().sqrt();
                let dimension = region.dimension.count();
                let w = coronet::kernel::value(KernelName::CubicSpline, dimension, r, H);
                all += w;
                if !region.contains([0, 1, 2].map(|k| x[k] + d[k]), 0.0) {
                    out += w;
                }
            }
        }
    }
    out / all
}

fn check(region: &Region, points: &[[f64; 3]], tolerance: f64) {
    let completion = Completion::new::<CubicSpline>(region, H);
    for &x in points {
        let (gamma, slope) = completion.at(x);
        let exact = outside(region, x);
        assert!(
            (gamma - exact).abs() < tolerance,
            "{x:?}: {gamma}, by brute force {exact}"
        );
        for &k in region.axes() {
            let at = |e: f64| {
                let mut x = x;
                x[k] += e;
                completion.at(x).0
            };
            let difference = (at(0.02) - at(-0.02)) / 0.04;
            assert!(
                (slope[k] - difference).abs() < 0.02,
                "{x:?}, {k}: {slope:?} {difference}"
            );
        }
    }
}

#[test]
fn sphere_and_disc() {
    let ball = Shape::Sphere {
        centre: [0.0; 3],
        radius: 8.0 * S0,
    };
    let points = [
        [7.9, 0.0, 0.0],
        [3.0, 4.0, 5.0],
        [0.0, 0.0, 6.4],
        [0.0; 3],
        [0.0, 8.2, 0.0],
    ];
    check(&region(Dimension::Three, ball.clone()), &points, 4e-3);
    check(
        &region(Dimension::Two, ball),
        &[[7.9, 0.0, 0.0], [4.0, 0.0, 6.0]],
        8e-3,
    );
}

#[test]
fn ellipsoid_and_ellipse() {
    let shape = Shape::Ellipsoid {
        centre: [0.0; 3],
        semi_axes: [10.0 * S0, 8.0 * S0, 6.0 * S0],
    };
    let points = [
        [9.5, 0.0, 0.0],
        [0.0, 7.5, 0.0],
        [5.0, 4.0, 3.5],
        [0.0, 0.0, 5.0],
    ];
    check(&region(Dimension::Three, shape.clone()), &points, 6e-3);
    check(
        &region(Dimension::Two, shape),
        &[[9.5, 0.0, 0.0], [5.0, 0.0, 4.0]],
        1e-2,
    );
}

#[test]
fn faces_and_corners_of_a_block() {
    let block = Shape::Block {
        low: [10.0 * S0; 3],
        high: [26.0 * S0; 3],
    };
    let points = [
        [18.0, 18.0, 25.5],
        [18.0, 18.0, 18.0],
        [10.0, 10.0, 18.0],
        [26.0, 10.0, 10.0],
    ];
    check(&region(Dimension::Three, block.clone()), &points, 8e-3);
    // Near an edge the product is an approximation.
    check(
        &region(Dimension::Three, block),
        &[[11.0, 10.7, 11.0]],
        3e-2,
    );
}

#[test]
fn whole_kernel_lies_outside_far_away() {
    let ball = Shape::Sphere {
        centre: [0.0; 3],
        radius: 8.0 * S0,
    };
    let completion = Completion::new::<WendlandC2>(&region(Dimension::Three, ball), H);
    assert!((completion.at([12.0, 0.0, 0.0]).0 - 1.0).abs() < 1e-3);
    assert_eq!(completion.at([0.1, 0.0, 0.0]).0, 0.0);
}

#[test]
fn nearest_point_of_an_ellipsoid() {
    let a = [3.0, 2.0, 1.5];
    // A point at a known distance along the normal of a point of the surface.
    let y = [3.0 * 0.6, 2.0 * 0.48, 1.5 * 0.64];
    let g = [0, 1, 2].map(|k| y[k] / (a[k] * a[k]));
    let length = g.iter().map(|g| g * g).sum::<f64>().sqrt();
    for depth in [0.4, -0.7] {
        let x = [0, 1, 2].map(|k| y[k] - depth * g[k] / length);
        let found = ellipsoid::nearest(Dimension::Three, a, x, 2.0).unwrap();
        assert!((found.depth - depth).abs() < 1e-9, "{found:?}");
        assert!((0..3).all(|k| (found.normal[k] - g[k] / length).abs() < 1e-9));
    }
    let ball = ellipsoid::nearest(Dimension::Three, [2.0; 3], [1.0, 1.0, 0.5], 3.0).unwrap();
    assert!((ball.curvature - 0.5).abs() < 1e-9 && (ball.depth - 0.5).abs() < 1e-9);
}
