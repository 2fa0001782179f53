//! Lattices and walls: counts, places and velocities.

use super::pack_scene::{S0, scene};
use coronet::particle::shape::Region;
use coronet::particle::{lattice, wall};
use coronet::scene::*;

fn sphere(radius: f64) -> Shape {
    Shape::Sphere {
        centre: [1.0, 2.0, 3.0],
        radius,
    }
}

fn count(dimension: Dimension, size: [f64; 3], shape: Shape) -> usize {
    let scene = scene(dimension, size, shape);
    lattice::fill(&Region::new(&scene.pack_input(0)), S0)[0].len()
}

#[test]
fn published_drop_has_1791_particles() {
    let at = |diameter: f64| {
        count(
            Dimension::Three,
            [160.0, 160.0, 80.0],
            sphere(0.5 * diameter),
        )
    };
    assert_eq!(at(3.75e-3), 1791);
    assert_eq!(at(4.0e-3), 2109);
}

#[test]
fn lattice_drop_hangs_nowhere() {
    let scene = scene(Dimension::Three, [160.0, 160.0, 80.0], sphere(1.875e-3));
    let position = lattice::fill(&Region::new(&scene.pack_input(0)), S0);
    for x in position {
        assert!(x.iter().sum::<f64>().abs() < 1e-12);
        assert!(x.iter().all(|x| x.abs() <= 1.875e-3 * (1.0 + 1e-12)));
    }
}

#[test]
fn layer_fills_the_box_cell_by_cell() {
    let layer = Shape::Layer { depth: 4.0 * S0 };
    assert_eq!(
        count(Dimension::Three, [10.0, 8.0, 20.0], layer.clone()),
        320
    );
    assert_eq!(count(Dimension::Two, [10.0, 0.0, 20.0], layer), 40);
    let stretched = scene(
        Dimension::Two,
        [10.3, 0.0, 20.0],
        Shape::Layer { depth: 4.0 * S0 },
    );
    let position = lattice::fill(&Region::new(&stretched.pack_input(0)), S0);
    assert_eq!(position[0].len(), 40);
    assert!((position[0][0] - 0.5 * 1.03 * S0).abs() < 1e-12);
    assert!((position[0][1] - position[0][0] - 1.03 * S0).abs() < 1e-12);
    assert!((position[2][0] - 0.5 * S0).abs() < 1e-12);
    assert!(position[1].iter().all(|&y| y == 0.0));
}

#[test]
fn disc_and_ellipse_count_by_area() {
    let disc = count(Dimension::Two, [80.0, 0.0, 80.0], sphere(20.0 * S0)) as f64;
    assert!((disc - std::f64::consts::PI * 400.0).abs() < 15.0, "{disc}");
    let ellipse = Shape::Ellipsoid {
        centre: [0.0; 3],
        semi_axes: [20.0 * S0, 1.0, 10.0 * S0],
    };
    let ellipse = count(Dimension::Two, [80.0, 0.0, 80.0], ellipse) as f64;
    assert!(
        (ellipse - std::f64::consts::PI * 200.0).abs() < 15.0,
        "{ellipse}"
    );
}

#[test]
fn floor_is_four_layers_under_the_tension_kernel() {
    let mut scene = scene(
        Dimension::Three,
        [10.0, 8.0, 20.0],
        Shape::Layer { depth: S0 },
    );
    assert_eq!(wall::layers(&scene), 3);
    scene.effects.tension = Some(crate::pack_scene::tension(0.067));
    assert_eq!(wall::layers(&scene), 4);
    let floor = wall::build(&scene);
    assert_eq!(floor.position[0].len(), 10 * 8 * 4);
    let top = floor.position[2].iter().fold(f64::MIN, |a, &b| a.max(b));
    assert!((top + 0.5 * S0).abs() < 1e-12);
}

#[test]
fn closed_box_is_a_full_shell_with_corners() {
    let mut scene = scene(
        Dimension::Three,
        [10.0, 8.0, 6.0],
        Shape::Layer { depth: S0 },
    );
    scene.domain.boundary = [[Side::Wall; 2]; 3];
    scene.domain.wall_velocity[2][1] = [1.0, 0.0, 0.0];
    let shell = wall::build_layers(&scene.domain, scene.dimension, scene.spacing, 3);
    assert_eq!(shell.position[0].len(), 16 * 14 * 12 - 10 * 8 * 6);
    for i in 0..shell.position[0].len() {
        let [x, y, z] = [0, 1, 2].map(|k| shell.position[k][i] / S0);
        let inside = (0.0..10.0).contains(&x) && (0.0..8.0).contains(&y) && (0.0..6.0).contains(&z);
        assert!(!inside, "wall particle in the box at {x} {y} {z}");
        if (0.0..10.0).contains(&x) && (0.0..8.0).contains(&y) {
            let lid = if z > 6.0 { 1.0 } else { 0.0 };
            assert_eq!(shell.velocity[0][i], lid);
        }
    }
}

#[test]
fn floor_goes_on_beyond_an_open_side() {
    let mut scene = scene(Dimension::Two, [10.0, 0.0, 6.0], Shape::Layer { depth: S0 });
    scene.domain.boundary[0] = [Side::Open, Side::Wall];
    let wall = wall::build_layers(&scene.domain, scene.dimension, scene.spacing, 3);
    // Three rows under the box and both margins, then the right wall up to the margin above the
    // box.
    assert_eq!(wall.position[0].len(), 3 * 16 + 3 * 9);
}

/// A wall that slides goes on into the corners: if it ended there, what is behind the next wall
/// would be pressed or torn without end.
#[test]
fn sliding_walls_do_not_end_at_corners() {
    let mut scene = scene(Dimension::Two, [10.0, 0.0, 6.0], Shape::Layer { depth: S0 });
    scene.domain.boundary = [[Side::Wall; 2], [Side::Periodic; 2], [Side::Wall; 2]];
    scene.domain.wall_velocity[0][1] = [0.0, 0.0, 2.0];
    scene.domain.wall_velocity[2][0] = [1.0, 0.0, 0.0];
    let shell = wall::build_layers(&scene.domain, scene.dimension, scene.spacing, 3);
    for i in 0..shell.position[0].len() {
        let [x, z] = [0, 2].map(|k| shell.position[k][i] / S0);
        assert_eq!(shell.velocity[0][i], if z < 0.0 { 1.0 } else { 0.0 });
        assert_eq!(shell.velocity[2][i], if x > 10.0 { 2.0 } else { 0.0 });
    }
}
