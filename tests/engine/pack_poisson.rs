//! Poisson packings: exact number, even density, no pairs, the same for every thread count.

use super::pack_scene::{S0, scene};
use coronet::kernel;
use coronet::particle::pack::{PackError, PackReport, pack};
use coronet::particle::{Particles, wall};
use coronet::scene::*;
use std::ops::ControlFlow::{Break, Continue};

fn packed(scene: &Scene) -> (Particles, PackReport) {
    let (particles, report) = pack(&scene.pack_input(0), &mut |_| Continue(())).unwrap();
    assert_eq!(particles.len(), report.count);
    assert!(report.spread <= scene.pack.tolerance, "{report:?}");
    assert!(report.nearest.least >= 0.7, "{report:?}");
    assert!(report.nearest.mean >= 0.85, "{report:?}");
    assert_eq!(
        report.nearest.histogram.iter().sum::<u64>(),
        report.count as u64
    );
    (particles, report)
}

fn drop(radius: f64) -> Shape {
    Shape::Sphere {
        centre: [0.01; 3],
        radius: radius * S0,
    }
}

fn radius(particles: &Particles, i: usize) -> f64 {
    let square = |k: usize| (particles.position[k][i] / S0).powi(2);
    (0..3).map(square).sum::<f64>().sqrt()
}

#[test]
fn drop_is_even_up_to_its_surface() {
    let scene = scene(Dimension::Three, [40.0; 3], drop(8.0));
    let (particles, report) = packed(&scene);
    assert_eq!(report.count, 2145);
    assert!((report.mass / report.wanted_mass - 1.0).abs() < 3e-4);
    // Number density in shells; thick ones, because a free surface makes the layers under it ring.
    for shell in [[0.0, 4.0], [4.0, 6.0], [6.0, 8.0]] {
        let inside = |&i: &usize| (shell[0]..shell[1]).contains(&radius(&particles, i));
        let count = (0..particles.len()).filter(inside).count() as f64;
        let volume = 4.0 / 3.0 * std::f64::consts::PI * (shell[1].powi(3) - shell[0].powi(3));
        assert!(
            (count / volume - 1.0).abs() < 0.06,
            "{shell:?} {}",
            count / volume
        );
    }
    let outermost = (0..particles.len())
        .map(|i| radius(&particles, i))
        .fold(0.0, f64::max);
    assert!((7.3..8.0).contains(&outermost), "{outermost}");
}

#[test]
fn summed_density_is_what_the_report_says() {
    let layer = Shape::Layer { depth: 9.0 * S0 };
    let scene = scene(Dimension::Three, [12.0, 10.0, 20.0], layer);
    let (particles, report) = packed(&scene);
    assert_eq!(report.count, 12 * 10 * 9);
    let floor = wall::build_layers(&scene.domain, scene.dimension, scene.spacing, 3);
    let size = scene.domain.size;
    let h = 1.3 * S0;
    let (mut count, mut sum) = (0usize, 0.0);
    for i in 0..particles.len() {
        let x = [0, 1, 2].map(|k| particles.position[k][i]);
        if x[2] > 9.0 * S0 - 2.0 * h {
            continue;
        }
        let mut density = 0.0;
        for set in [&particles.position, &floor.position] {
            for j in 0..set[0].len() {
                let mut square = (x[2] - set[2][j]).powi(2);
                for k in 0..2 {
                    let d = x[k] - set[k][j];
                    square += (d - size[k] * (d / size[k]).round()).powi(2);
                }
                let w = kernel::value(KernelName::CubicSpline, 3, square.sqrt(), h);
                density += particles.mass * w;
            }
        }
        count += 1;
        sum += (density - scene.density).powi(2);
    }
    let spread = (sum / count as f64).sqrt();
    assert!(spread < 0.1, "{spread} by brute force");
    assert!(
        count.abs_diff(report.supported) < 3,
        "{count} {}",
        report.supported
    );
    assert!(
        (spread - report.supported_spread).abs() < 0.005,
        "{spread} {report:?}"
    );
}

#[test]
fn disc_rectangle_and_pool_in_two_dimensions() {
    packed(&scene(Dimension::Two, [80.0, 0.0, 80.0], drop(16.0)));
    let layer = Shape::Layer { depth: 20.0 * S0 };
    let (pool, _) = packed(&scene(Dimension::Two, [60.0, 0.0, 80.0], layer));
    assert_eq!(pool.len(), 1200);
    assert!(pool.position[1].iter().all(|&y| y == 0.0));
    let rectangle = Shape::Block {
        low: [10.0 * S0, 0.0, 10.0 * S0],
        high: [34.0 * S0, 0.0, 30.0 * S0],
    };
    let (rectangle, _) = packed(&scene(Dimension::Two, [60.0, 0.0, 60.0], rectangle));
    assert_eq!(rectangle.len(), 480);
}

#[test]
fn ellipsoid_and_block_in_a_corner() {
    let ellipsoid = Shape::Ellipsoid {
        centre: [0.0; 3],
        semi_axes: [10.0 * S0, 8.0 * S0, 6.0 * S0],
    };
    packed(&scene(Dimension::Three, [40.0; 3], ellipsoid));
    let block = Shape::Block {
        low: [0.0; 3],
        high: [12.0 * S0, 10.0 * S0, 10.0 * S0],
    };
    let mut corner = scene(Dimension::Three, [30.0, 10.0, 30.0], block);
    corner.domain.boundary[0] = [Side::Wall; 2];
    let (block, _) = packed(&corner);
    assert_eq!(block.len(), 1200);
    let low = |k: usize| block.position[k].iter().fold(f64::MAX, |a, &b| a.min(b)) / S0;
    assert!(low(0) > 0.2 && low(2) > 0.2, "{} {}", low(0), low(2));
}

fn settings(scene: &mut Scene) -> &mut Wcsph {
    match &mut scene.method {
        Method::Wcsph(settings) => settings,
        other => panic!("{}", other.name()),
    }
}

#[test]
fn other_kernel_and_mass() {
    let mut scene = scene(Dimension::Three, [40.0; 3], drop(8.0));
    settings(&mut scene).sph.mass = Mass::LatticeSum;
    let (particles, _) = packed(&scene);
    assert!((particles.mass / (1100.0 * S0.powi(3)) - 1.0 / 0.99726).abs() < 1e-5);
    settings(&mut scene).sph.kernel = KernelName::WendlandC2;
    packed(&scene);
}

#[test]
fn closed_box_is_even_about_its_mean() {
    let layer = Shape::Layer { depth: 30.0 * S0 };
    let mut scene = scene(Dimension::Two, [30.0, 0.0, 30.0], layer);
    scene.domain.boundary[2] = [Side::Periodic; 2];
    let (particles, report) = packed(&scene);
    assert_eq!(particles.len(), 900);
    assert!(report.offset.abs() < 0.01 * 1100.0, "{report:?}");
}

#[test]
fn same_for_every_thread_count_and_other_for_another_seed() {
    let mut scene = scene(Dimension::Three, [40.0; 3], drop(6.0));
    let with = |threads: usize, scene: &Scene| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| packed(scene).0)
    };
    let one = with(1, &scene);
    assert!(one == with(2, &scene) && one == with(4, &scene));
    scene.pack.seed = 2;
    assert!(one != with(2, &scene));
}

#[test]
fn where_a_drop_hangs_does_not_matter() {
    let here = scene(Dimension::Three, [40.0; 3], drop(6.0));
    let mut there = scene(Dimension::Three, [50.0; 3], drop(6.0));
    there.bodies[0].motion = Motion::Uniform([0.0, 0.0, -3.0]);
    let Shape::Sphere { centre, .. } = &mut there.bodies[0].shape else {
        unreachable!()
    };
    *centre = [0.02; 3];
    assert!(packed(&here).0 == packed(&there).0);
}

#[test]
fn what_cannot_be_packed_is_named() {
    let mut impatient = scene(Dimension::Three, [40.0; 3], drop(6.0));
    impatient.pack.iterations = 1;
    let error = pack(&impatient.pack_input(0), &mut |_| Continue(())).unwrap_err();
    assert!(
        matches!(error, PackError::NotReached { iterations: 1, .. }),
        "{error}"
    );
    let crumb = scene(Dimension::Three, [40.0; 3], drop(0.6));
    let error = pack(&crumb.pack_input(0), &mut |_| Continue(())).unwrap_err();
    assert!(
        matches!(error, PackError::TooFew { count: 1, .. }),
        "{error}"
    );
    let narrow = scene(
        Dimension::Two,
        [4.0, 0.0, 40.0],
        Shape::Layer { depth: 9.0 * S0 },
    );
    let error = pack(&narrow.pack_input(0), &mut |_| Continue(())).unwrap_err();
    assert!(matches!(error, PackError::Box { .. }), "{error}");
}

#[test]
fn packing_stops_when_told_to() {
    let scene = scene(
        Dimension::Two,
        [20.0, 0.0, 20.0],
        Shape::Layer { depth: 8.0 * S0 },
    );
    for task in ["sample", "repel", "optimise"] {
        let mut seen = Vec::new();
        let stopped = pack(&scene.pack_input(0), &mut |progress| {
            seen.push(progress.task);
            if progress.task == task {
                Break(())
            } else {
                Continue(())
            }
        });
        assert!(
            matches!(stopped, Err(PackError::Stopped { body }) if body == "liquid"),
            "{task}"
        );
        assert_eq!(
            seen.iter().filter(|seen| **seen == task).count(),
            1,
            "{seen:?}"
        );
    }
}

/// The rows of a wall beside a pool end where it ends, whatever its depth: at rest nobody is in it.
#[test]
fn a_pool_of_any_depth_is_not_pressed_into_the_wall_beside_it() {
    for depth in [8.0, 8.25, 8.44, 8.56, 8.8] {
        let layer = Shape::Layer { depth: depth * S0 };
        let mut scene = scene(Dimension::Two, [20.0, 0.0, 16.0], layer);
        scene.problem.domain.boundary[0] = [Side::Wall; 2];
        scene.pack.iterations = 2000;
        let (pool, _) = packed(&scene);
        let highest = pool.position[2].iter().fold(0.0, |z: f64, x| z.max(*x)) / S0;
        let beside = pool.position[0].iter().map(|x| x / S0);
        let least = beside.fold(f64::INFINITY, |least, x| least.min(x).min(20.0 - x));
        println!("{depth}: {least:.3} from the walls, {highest:.3} high");
        assert!(least > 0.2, "{depth}: {least}");
        assert!((highest - depth).abs() < 0.6, "{depth}: {highest}");
    }
}

/// No spacing resolves the rim: it is packed as the sharpest that one does.
#[test]
fn a_flat_ellipsoid_is_packed() {
    for (dimension, thick) in [
        (Dimension::Two, 1.2),
        (Dimension::Two, 2.4),
        (Dimension::Three, 1.6),
    ] {
        let wide = if dimension == Dimension::Two {
            24.0
        } else {
            12.0
        };
        let ellipsoid = Shape::Ellipsoid {
            centre: [0.01; 3],
            semi_axes: [wide * S0, wide * S0, thick * S0],
        };
        let mut scene = scene(dimension, [60.0; 3], ellipsoid);
        scene.pack.iterations = 2000;
        scene.pack.tolerance = 1.0;
        let packed = pack(&scene.pack_input(0), &mut |_| Continue(()));
        let (_, report) = packed.unwrap_or_else(|error| panic!("{thick}: {error}"));
        println!("{dimension:?} {thick}: {} iterations", report.iterations);
        assert!(report.nearest.least > 0.5, "{thick}: {report:?}");
    }
}
