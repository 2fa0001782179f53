//! `box.symmetry` and mirror sides: what they make of a scene, and what they refuse.

use coronet::measure::whole::Unfold;
use coronet::particle::Frame;
use coronet::scene::file::{self, Loaded};
use coronet::scene::{Arrangement, Scene, Shape, Side, key, numbers};
use std::path::Path;

const TEXT: &str = include_str!("../../pipeline.toml");

fn read(sets: &[&str]) -> Result<Loaded, coronet::scene::error::SceneError> {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    file::read(TEXT, Path::new("pipeline.toml"), &sets)
}

fn scene(sets: &[&str]) -> Scene {
    read(sets).unwrap_or_else(|error| panic!("{error}")).scene
}

fn centre(scene: &Scene) -> [f64; 3] {
    match scene.bodies[1].shape {
        Shape::Sphere { centre, .. } => centre,
        _ => panic!("the drop is a sphere"),
    }
}

#[test]
fn a_quarter_is_a_quarter_and_its_whole_the_scene() {
    let (full, part) = (scene(&[]), scene(&["box.symmetry='quarter'"]));
    assert_eq!(part.domain.size, [0.02, 0.02, 0.03]);
    assert_eq!(part.domain.boundary[0], [Side::Mirror; 2]);
    assert_eq!(part.domain.boundary[1], [Side::Mirror; 2]);
    assert_eq!(part.domain.boundary[2], full.domain.boundary[2]);
    assert_eq!(centre(&part)[..2], [0.0, 0.0]);
    assert_eq!(part.whole(), full);
    assert_eq!(full.whole(), full);
    let speeds = |scene: &Scene| {
        let rest = [0, 1].map(|body| numbers::rest_sound_speed(&scene.resting(body)));
        (numbers::sound_speeds(scene), rest)
    };
    assert_eq!(speeds(&part), speeds(&full));
    for body in [0, 1] {
        let [whole, quarter] = [&full, &part].map(|scene| numbers::count(scene, body) as f64);
        assert!(
            (4.0 * quarter - whole).abs() <= 2.0,
            "{body}: {quarter} of {whole}"
        );
    }
}

#[test]
fn a_half_is_cut_in_x_alone() {
    let part = scene(&["box.symmetry='half'", "box.x='wall'"]);
    assert_eq!(part.domain.size, [0.02, 0.04, 0.03]);
    assert_eq!(part.domain.boundary[0], [Side::Mirror, Side::Wall]);
    assert_eq!(part.domain.boundary[1], [Side::Periodic; 2]);
    assert_eq!(part.whole(), scene(&["box.x='wall'"]));
}

#[test]
fn the_same_part_has_the_same_keys_however_it_is_written() {
    let (cut, full) = (scene(&["box.symmetry='quarter'"]), scene(&[]));
    let written = scene(&[
        "box.size=['20 mm', '20 mm', '30 mm']",
        "box.x='mirror'",
        "box.y='mirror'",
        "body.drop.sphere={ diameter='4 mm', centre=[0, 0, '12.5 mm'] }",
    ]);
    let keys = |scene: &Scene| {
        let all = [
            key::settings(&scene.pack_input(0), scene),
            key::settings(&scene.pack_input(1), scene),
            key::settings(&scene.relax_input(1), scene),
            key::settings(&scene.impact_input(), scene),
        ];
        all.map(|settings| {
            let settings = settings.unwrap().into_iter();
            settings
                .map(|setting| setting.canonical)
                .collect::<Vec<_>>()
        })
    };
    assert_eq!(keys(&cut), keys(&written));
    for (part, whole) in keys(&cut).iter().zip(&keys(&full)) {
        assert_ne!(part, whole);
    }
}

#[test]
fn what_is_not_symmetric_is_refused_with_a_remedy() {
    let offset = "body.drop.sphere.offset=['1 mm', '0 mm']";
    let slides = "box.wall_velocity.z_low=['1 m/s', 0, 0]";
    let rises = "box.wall_velocity={ x_low=[0, 0, 1], x_high=[0, 0, 1] }";
    let cases: [(&[&str], &str); 9] = [
        (
            &["box.symmetry='quarter'", offset],
            "`drop` is not in the middle",
        ),
        (
            &["box.symmetry='quarter'", "body.drop.velocity=[1, 0, -3]"],
            "moves along x",
        ),
        (&["box.symmetry='quarter'", slides], "a wall slides along x"),
        (
            &["box.symmetry='quarter'", "box.y=['wall', 'open']"],
            "sides in y differ",
        ),
        (
            &[
                "box.symmetry='quarter'",
                "effects.gravity.direction=[0, 1, -1]",
            ],
            "a body force acts along y",
        ),
        (
            &[
                "box.x='mirror'",
                "body.drop.sphere.offset=['-20 mm', 0]",
                slides,
            ],
            "has a mirror",
        ),
        (
            &[
                "box.symmetry='half'",
                "box.x='wall'",
                "box.wall_velocity.x_low=[0, 0, 1]",
            ],
            "the walls in x slide differently",
        ),
        (
            &["box.symmetry='axis'", "box.x='wall'", "box.y='wall'", rises],
            "the walls in x and y slide differently",
        ),
        (&["box.z='mirror'"], "is not known"),
    ];
    for (sets, wanted) in cases {
        let error = read(sets).unwrap_err().to_string();
        assert!(error.contains(wanted), "{sets:?}: {error}");
        assert!(error.contains("box."), "{sets:?}: {error}");
    }
}

#[test]
fn mist_is_kept_at_the_plane_of_unfolding_alone() {
    let part = scene(&["box.symmetry='quarter'"]).problem.domain;
    assert!(!part.is_crossed(0, -1e-6) && part.is_crossed(0, 0.0201));
    let full = scene(&[]).problem.domain;
    assert!(full.is_crossed(0, -1e-6) && full.is_crossed(0, 0.0401));
}

#[test]
fn a_lattice_is_counted_as_it_is_made() {
    let mut part = scene(&["box.symmetry='quarter'"]);
    part.pack.arrangement = Arrangement::Lattice;
    let mut watch = |_: &_| std::ops::ControlFlow::Continue(());
    let (drop, _) = coronet::particle::pack::pack(&part.pack_input(1), &mut watch).unwrap();
    assert_eq!(drop.len() as u64, numbers::count(&part, 1));
    for a in [0, 1] {
        let least = drop.position[a].iter().fold(1.0, |m: f64, x| m.min(*x));
        assert!((least / part.spacing - 0.5).abs() < 1e-9, "{least}");
    }
}

#[test]
fn a_frame_unfolds_to_the_whole() {
    let part = scene(&["box.symmetry='quarter'"]);
    let frame = Frame {
        time: 1.0,
        id: vec![0, 3],
        body: vec![0, 1],
        position: [vec![0.001, 0.002], vec![0.003, 0.004], vec![0.005; 2]],
        velocity: [vec![1.0, 2.0], vec![3.0, 4.0], vec![5.0; 2]],
        pressure: vec![6.0; 2],
        density: vec![7.0; 2],
        surface: vec![0, 1],
        mass: Vec::new(),
        scalars: [
            ("mass_kg", 1.0),
            ("kinetic_energy_J", 2.0),
            ("time_step_s", 3.0),
        ]
        .into_iter()
        .chain([("momentum_x_kg_m_s", 4.0), ("momentum_z_kg_m_s", 5.0)])
        .map(|(name, value)| (name.to_string(), value))
        .collect(),
    };
    let whole = Unfold::new(&part).frame(&frame);
    assert_eq!(whole.id, [0, 3, 4, 7, 8, 11, 12, 15]);
    let sum = |v: &[f32]| v.iter().sum::<f32>();
    assert!((sum(&whole.position[0]) / 8.0 - 0.02).abs() < 1e-7);
    assert!((sum(&whole.position[1]) / 8.0 - 0.02).abs() < 1e-7);
    assert_eq!(
        [sum(&whole.velocity[0]), sum(&whole.velocity[2])],
        [0.0, 40.0]
    );
    let values: Vec<f64> = whole.scalars.iter().map(|(_, value)| *value).collect();
    assert_eq!(values, [4.0, 8.0, 3.0, 0.0, 20.0]);
}

#[test]
fn mirrors_that_cut_no_body_are_sides_of_the_box() {
    // The drop hangs whole in the middle: it is there once, and so is its mass.
    for sides in ["'mirror'", "['mirror', 'wall']", "['open', 'mirror']"] {
        let x = format!("box.x={sides}");
        let part = scene(&[&x, "box.y='mirror'"]);
        assert!(part.domain.is_part());
        assert_eq!(part.whole(), part);
        assert!(Unfold::new(&part).is_plain());
    }
    // The pool alone meets every side and makes no whole.
    let mut pool = scene(&["box.x='mirror'"]);
    pool.bodies.pop();
    assert_eq!(pool.whole(), pool);
}

#[test]
fn a_body_beside_the_plane_has_an_image_in_the_whole() {
    let second = "body.second={ sphere = { diameter = '2 mm', \
                  centre = ['5 mm', '15 mm', '15 mm'] }, velocity = [1, 0, -2] }";
    let part = scene(&["box.symmetry='half'", "box.x='wall'"]);
    assert_eq!(part.whole().bodies.len(), 2);
    let cut = "body.drop.sphere={ diameter='4 mm', centre=[0, '20 mm', '12.5 mm'] }";
    let part = scene(&["box.x=['mirror', 'wall']", cut, second]);
    let whole = part.whole();
    let places: Vec<[f64; 3]> = whole.bodies[1..]
        .iter()
        .map(|body| match body.shape {
            Shape::Sphere { centre, .. } => centre,
            _ => panic!("{body:?}"),
        })
        .collect();
    let x: Vec<i64> = places
        .iter()
        .map(|at| (at[0] * 1e6).round() as i64)
        .collect();
    assert_eq!(x, [40_000, 45_000, 35_000]);
    let motion = |k: usize| match whole.bodies[k].motion {
        coronet::scene::Motion::Uniform(velocity) => velocity,
        _ => panic!("uniform"),
    };
    assert_eq!(
        [motion(2), motion(3)],
        [[1.0, 0.0, -2.0], [-1.0, 0.0, -2.0]]
    );
}
