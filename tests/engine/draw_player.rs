//! The player of the report: what its shots say, read as its script reads them.

use std::io::Read;

use super::{draw_revolved, draw_surface};
use coronet::draw::player::{Kind, Player, Shot, thinned};
use coronet::draw::surface::Field;
use coronet::record::mesh::Mesh;

/// Places and normals by point, and the corners of faces.
struct Read3 {
    places: Vec<Vec<f64>>,
    normals: Vec<Vec<f64>>,
    faces: Vec<u32>,
}

fn read(shot: &Shot, kind: Kind) -> Read3 {
    let mut bytes = Vec::new();
    let mut packed = flate2::read::ZlibDecoder::new(&shot.bytes[..]);
    packed.read_to_end(&mut bytes).unwrap();
    let mut at = 0;
    let mut column = |count: usize, width: usize| {
        let mut sum = 0u32;
        let range = u64::from(u32::MAX) >> (8 * (4 - width));
        let values: Vec<u32> = (0..count)
            .map(|i| {
                let byte = |b: usize| u32::from(bytes[at + b * count + i]) << (8 * b);
                let step = (0..width).map(byte).sum::<u32>();
                sum = (u64::from(sum.wrapping_add(step)) & range) as u32;
                sum
            })
            .collect();
        at += count * width;
        values
    };
    let (axes, corners) = match kind {
        Kind::Mesh => (3, 3),
        Kind::Outline => (2, 2),
        Kind::Points => (2, 0),
    };
    let places: Vec<Vec<f64>> = (0..axes)
        .map(|a| {
            let place =
                |v: u32| f64::from(shot.low[a]) + f64::from(shot.size[a]) * f64::from(v) / 65535.0;
            column(shot.points, 2).into_iter().map(place).collect()
        })
        .collect();
    let normals = match corners {
        0 => vec![column(shot.points, 1).into_iter().map(f64::from).collect()],
        _ => (0..axes)
            .map(|_| {
                let part = |v: u32| f64::from(v) / 127.0 - 1.0;
                column(shot.points, 1).into_iter().map(part).collect()
            })
            .collect(),
    };
    let faces = column(shot.faces * corners, 4);
    assert_eq!(at, bytes.len());
    Read3 {
        places,
        normals,
        faces,
    }
}

#[test]
fn a_shot_in_three_dimensions_is_the_closed_surface() {
    let scene = draw_surface::scene(3, &[]);
    let frame = draw_surface::frame(&scene, draw_surface::splash(4e-3));
    let player = Player::new(&scene);
    assert_eq!(player.kind(), Kind::Mesh);
    let shot = player.shot(&frame).unwrap();
    let Read3 {
        places,
        normals,
        faces,
    } = read(&shot, Kind::Mesh);
    let point = |i: usize| [0, 1, 2].map(|a| places[a][i] as f32);
    let mesh = Mesh {
        points: (0..shot.points).map(point).collect(),
        triangles: faces.chunks(3).map(|c| [c[0], c[1], c[2]]).collect(),
        ..Mesh::default()
    };
    let volume = frame.id.len() as f64 * draw_surface::SPACING.powi(3);
    let part = mesh.volume() / volume;
    assert!((part - 1.0).abs() < 0.02, "{part}");
    for i in 0..shot.points {
        let square: f64 = normals.iter().map(|n| n[i] * n[i]).sum();
        assert!((square - 1.0).abs() < 0.05, "{square}");
        // On top of the pool, away from the drop, normals go up.
        let [x, y, z] = point(i);
        let off = (x - 4e-3).hypot(y - 4e-3);
        if (z - 2e-3).abs() < 1e-4 && off > 3e-3 && off < 3.6e-3 {
            assert!(normals[2][i] > 0.9, "{}", normals[2][i]);
        }
    }
}

/// Nodes further apart than particles keep the volume, and end at walls.
#[test]
fn a_coarse_surface_has_the_volume_of_the_liquid() {
    let scene = draw_surface::scene(3, &[]);
    let frame = draw_surface::frame(&scene, draw_surface::splash(4e-3));
    let volume = frame.id.len() as f64 * draw_surface::SPACING.powi(3);
    for (cell, room) in [(0.62e-3, 0.06), (0.8e-3, 0.1)] {
        let mesh = Field::coarse(&scene, &frame, cell).unwrap().mesh(0.0);
        let part = mesh.volume() / volume;
        assert!((part - 1.0).abs() < room, "{cell}: {part}");
        let lowest = mesh.points.iter().map(|p| p[2]).fold(f32::MAX, f32::min);
        assert_eq!(lowest, 0.0);
    }
}

/// A sheet of two particles above the pool is there, with nodes two and a half spacings apart.
#[test]
fn a_coarse_surface_shows_a_sheet() {
    let scene = draw_surface::scene(3, &[]);
    let sheet = |at: [f64; 3]| match at[2] {
        z if z < 2e-3 => Some(0),
        z if z > 4.8e-3 && z < 5.6e-3 => Some(1),
        _ => None,
    };
    let frame = draw_surface::frame(&scene, sheet);
    let mesh = Field::coarse(&scene, &frame, 1e-3).unwrap().mesh(0.0);
    let inner = mesh.points.iter().filter(|p| p[2] > 4e-3);
    assert!(inner.count() > 80);
}

#[test]
fn a_shot_in_two_dimensions_with_a_mirror_is_of_the_whole() {
    let scene = draw_surface::scene(2, &["box.symmetry='half'"]);
    let frame = draw_surface::frame(&scene, draw_surface::splash(0.0));
    let player = Player::new(&scene);
    let shot = player.shot(&frame).unwrap();
    let Read3 { places, .. } = read(&shot, player.kind());
    let lowest = places[0].iter().copied().fold(f64::MAX, f64::min);
    let highest = places[0].iter().copied().fold(f64::MIN, f64::max);
    assert_eq!(shot.points, 2 * frame.id.len());
    assert!(lowest < 0.4e-3 && highest > player.size()[0] - 0.4e-3);
}

#[test]
fn a_shot_of_rings_is_the_outline_of_their_section() {
    let scene = draw_revolved::scene("wall");
    let drop = |r: f64, z: f64| (r * r + (z - 5e-3).powi(2) < 1.6e-3f64.powi(2)).then_some(1);
    let frame = draw_revolved::frame(drop);
    let player = Player::new(&scene);
    assert_eq!(player.kind(), Kind::Outline);
    let shot = player.shot(&frame).unwrap();
    let Read3 {
        places,
        normals,
        faces,
    } = read(&shot, Kind::Outline);
    assert!(shot.faces > 40);
    for (i, corner) in faces.iter().enumerate() {
        let k = *corner as usize;
        let [r, z] = [places[0][k], places[1][k] - 5e-3];
        let radius = r.hypot(z);
        assert!((radius / 1.6e-3 - 1.0).abs() < 0.05, "{i}: {radius}");
        let cosine = (normals[0][k] * r + normals[1][k] * z) / radius;
        assert!(cosine > 0.95, "{i}: {cosine}");
    }
}

#[test]
fn a_shot_in_two_dimensions_is_its_particles() {
    let scene = draw_surface::scene(2, &[]);
    let frame = draw_surface::frame(&scene, draw_surface::splash(4e-3));
    let player = Player::new(&scene);
    let shot = player.shot(&frame).unwrap();
    let Read3 {
        places, normals, ..
    } = read(&shot, player.kind());
    assert_eq!(shot.points, frame.id.len());
    assert!(
        normals[0]
            .iter()
            .zip(&frame.body)
            .all(|(found, body)| *found == f64::from(*body))
    );
    for (axis, places) in [0, 2].into_iter().zip(places) {
        for (place, wanted) in places.iter().zip(&frame.position[axis]) {
            assert!((place - f64::from(*wanted)).abs() < 1e-6);
        }
    }
}

#[test]
fn a_page_holds_a_few_megabytes_of_shots_of_the_whole_run() {
    let mut scene = draw_surface::scene(2, &[]);
    for count in [1u32, 7, 40, 81, 1000] {
        scene.impact.end = 1e-3 * f64::from(count - 1) + 1e-7;
        scene.frames.interval = 1e-3;
        let player = Player::new(&scene);
        let shown: Vec<u64> = (0..u64::from(count)).filter(|n| player.shows(*n)).collect();
        assert!(shown[0] == 0 && shown.len() <= 41 && shown.len() * 2 > count.min(40) as usize);
    }
    let shot = |n: usize| Shot {
        time: n as f64,
        low: Vec::new(),
        size: Vec::new(),
        points: 0,
        faces: 0,
        bytes: vec![0; 1 << 20],
    };
    let times: Vec<f64> = thinned((0..20).map(shot).collect())
        .iter()
        .map(|s| s.time)
        .collect();
    assert_eq!(times, [0.0, 4.0, 8.0, 12.0, 16.0]);
}

/// Where walls close the mesh its normals are theirs, whatever the disorder inside.
#[test]
fn a_side_that_closes_the_mesh_has_its_own_normal() {
    let scene = draw_surface::scene(3, &[]);
    let mut frame = draw_surface::frame(&scene, draw_surface::splash(4e-3));
    for i in 0..frame.id.len() {
        for a in 0..3 {
            let wave = (1.7 * i as f32 + 2.1 * a as f32).sin();
            frame.position[a][i] += 0.25 * draw_surface::SPACING as f32 * wave;
        }
    }
    let coarse = Field::coarse(&scene, &frame, 0.62e-3).unwrap();
    let fine = Field::new(&scene, &frame, &[]).unwrap();
    for mesh in [coarse.mesh(0.0), fine.mesh(0.0)] {
        let mut seen = 0;
        for (point, normal) in mesh.points.iter().zip(&mesh.normals) {
            let is_inside = |a: usize| point[a] > 0.8e-3 && point[a] < 7.2e-3;
            if point[0] == 0.0 && is_inside(1) && point[2] > 0.4e-3 && point[2] < 1.2e-3 {
                assert_eq!(*normal, [-1.0, 0.0, 0.0]);
                seen += 1;
            }
        }
        assert!(seen > 8, "{seen}");
    }
}
