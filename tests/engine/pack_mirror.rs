//! Packing between mirror planes, and what is calibrated on it.

use coronet::method;
use coronet::particle::{Particles, pack::pack};
use coronet::scene::{Scene, file};
use std::ops::ControlFlow::Continue;
use std::path::Path;

const TEXT: &str = include_str!("../../scenes/tiny.toml");

fn scene(sets: &[&str]) -> Scene {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    let loaded = file::read(TEXT, Path::new("scenes/tiny.toml"), &sets);
    loaded.unwrap_or_else(|error| panic!("{error}")).scene
}

fn packed(scene: &Scene, body: usize) -> Particles {
    let done = pack(&scene.pack_input(body), &mut |_| Continue(()));
    done.unwrap_or_else(|error| panic!("{error}")).0
}

/// Where along an axis, in spacings.
fn places<'a>(body: &'a Particles, a: usize, scene: &'a Scene) -> impl Iterator<Item = f64> + 'a {
    body.position[a].iter().map(|x| x / scene.spacing)
}

#[test]
fn nobody_is_near_its_own_image() {
    let part = scene(&["box.symmetry='quarter'"]);
    for body in [0, 1] {
        let (packed, size) = (packed(&part, body), part.domain.size[0] / part.spacing);
        for a in [0, 1] {
            let least = places(&packed, a, &part).fold(f64::INFINITY, f64::min);
            let most = places(&packed, a, &part).fold(0.0, f64::max);
            assert!((0.35..0.8).contains(&least), "body {body}: {least} s0");
            assert!(
                most < size - if body == 0 { 0.35 } else { 0.0 },
                "{most} s0"
            );
        }
    }
}

#[test]
fn a_packing_is_as_dense_at_a_plane_as_elsewhere() {
    let part = scene(&[
        "box.symmetry='quarter'",
        "box.size=['16 mm', '16 mm', '9 mm']",
    ]);
    let pool = packed(&part, 0);
    let size = part.domain.size[0] / part.spacing;
    let within = |range: std::ops::Range<f64>| {
        let count = places(&pool, 0, &part)
            .filter(|x| range.contains(x))
            .count();
        count as f64 / (range.end - range.start)
    };
    let (near, mean) = (within(0.0..3.0), pool.len() as f64 / size);
    assert!(
        (near / mean - 1.0).abs() < 0.03,
        "{near} a spacing, {mean} on average"
    );
}

#[test]
fn tension_is_calibrated_as_on_the_whole() {
    let strength = |scene: &Scene| {
        let bodies = [packed(scene, 0), packed(scene, 1)];
        let input = scene.calibrate_input().unwrap();
        method::calibrate(&input.bodies, &bodies).unwrap().strength
    };
    let (part, whole) = (scene(&["box.symmetry='quarter'"]), scene(&[]));
    let (part, whole) = (strength(&part), strength(&whole));
    assert!((part / whole - 1.0).abs() < 0.02, "{part} and {whole}");
}
