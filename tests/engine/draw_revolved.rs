//! Rings as a body of revolution: its surface, pictures, points, and its cloud in the log.

use std::collections::HashMap;
use std::path::Path;

use super::draw_surface::{artist, style};
use coronet::draw::render::Material;
use coronet::draw::surface::Field;
use coronet::particle::{Frame, ring};
use coronet::record::export::{Column, Table};
use coronet::record::mesh::Mesh;
use coronet::scene::{Dimension, Scene, file};

/// Spacing, m.
const SPACING: f64 = 0.2e-3;
/// Radius of the cylinder, m.
const RADIUS: f64 = 6e-3;
const DENSITY: f64 = 1000.0;

/// A cylinder, or a space without sides, with a pool and a drop above it.
pub fn scene(side: &str) -> Scene {
    let text = format!(
        "[box]\nsize = ['12 mm', '12 mm', '10 mm']\nx = '{side}'\ny = '{side}'\n\
         z = ['wall', 'open']\nsymmetry = 'axis'\n\
         [liquid]\ndensity = '1000 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [body.pool]\nlayer = {{ depth = '2 mm' }}\ncolour = '#0000ff'\n\
         [body.drop]\nsphere = {{ diameter = '3.2 mm', gap = '1 mm', above = 'pool' }}\n\
         colour = '#ff0000'\n\
         [pack]\nspacing = '0.2 mm'\narrangement = 'lattice'\n[impact]\nend = '1 s'\n\
         [frames]\ninterval = '1 s'\n[method]\nname = 'wcsph'\npreset = 'modern'\n"
    );
    file::read(&text, Path::new("rings.toml"), &[])
        .unwrap()
        .scene
}

/// Rings at rest where `body` names one.
pub fn frame(body: impl Fn(f64, f64) -> Option<u8>) -> Frame {
    let mut frame = Frame::default();
    for i in 0..30 {
        for k in 0..50 {
            let [mut r, z] = [i, k].map(|n| (f64::from(n) + 0.5) * SPACING);
            let Some(body) = body(r, z) else { continue };
            let mass = DENSITY * SPACING.powi(3) * ring::settle(&mut r, SPACING, SPACING);
            frame.id.push(frame.id.len() as u32);
            frame.body.push(body);
            frame.pressure.push(1.0);
            frame.density.push(DENSITY as f32);
            frame.surface.push(0);
            frame.mass.push(mass as f32);
            for (a, c) in [r, 0.0, z].into_iter().enumerate() {
                frame.position[a].push(c as f32);
                frame.velocity[a].push(a as f32);
            }
        }
    }
    frame
}

/// The drop, 1.6 mm about a height of 5 mm.
fn drop(r: f64, z: f64) -> Option<u8> {
    (r.hypot(z - 5e-3) < 1.6e-3).then_some(1)
}

/// The pool, 2 mm deep, and the drop.
fn splash(r: f64, z: f64) -> Option<u8> {
    if z < 2e-3 { Some(0) } else { drop(r, z) }
}

/// The mesh, which must be closed and of the volume of the rings.
fn closed(scene: &Scene, frame: &Frame, within: f64) -> Mesh {
    // As a kernel sum that lacks neighbours: it is not that of the liquid.
    let mut frame = frame.clone();
    frame.density.iter_mut().for_each(|density| *density *= 0.9);
    let frame = &frame;
    let artist = artist(scene, frame, style(Material::Body));
    let mesh = artist.mesh(frame).unwrap();
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        assert!(a != b && b != c && c != a);
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry([from, to]).or_default() += 1;
            *edges.entry([to, from]).or_default() -= 1;
        }
    }
    assert!(!edges.is_empty());
    assert!(edges.values().all(|passes| *passes == 0), "it is open");
    let liquid = frame.mass.iter().map(|m| f64::from(*m)).sum::<f64>() / DENSITY;
    let part = mesh.volume() / liquid;
    assert!((part - 1.0).abs() < within, "volume: {part}");
    mesh
}

/// Distance from the axis and height of the vertices, m.
fn outline(mesh: &Mesh) -> impl Iterator<Item = [f64; 2]> {
    mesh.points.iter().map(|p| {
        let [x, y, z] = p.map(f64::from);
        [(x - RADIUS).hypot(y - RADIUS), z]
    })
}

#[test]
fn a_drop_is_a_sphere_up_to_its_poles() {
    let mesh = closed(&scene("open"), &frame(drop), 0.01);
    for [r, z] in outline(&mesh) {
        let radius = r.hypot(z - 5e-3);
        let off = (radius - 1.6e-3) / SPACING;
        assert!(off.abs() < 0.35, "{off} spacings off at r = {r}, z = {z}");
    }
    let poles = outline(&mesh).filter(|[r, _]| *r < 1e-9).count();
    assert_eq!(poles, 2, "one vertex at each pole");
    let outward = mesh.points.iter().zip(&mesh.normals).all(|(p, n)| {
        let [x, y, z] = [p[0] - 6e-3, p[1] - 6e-3, p[2] - 5e-3];
        x * n[0] + y * n[1] + z * n[2] > 0.9 * 1.6e-3
    });
    assert!(outward, "normals point outward");
}

#[test]
fn a_pool_is_flat_on_the_axis_and_at_its_walls() {
    let frame = frame(|r, z| splash(r, z).filter(|body| *body == 0));
    let mesh = closed(&scene("wall"), &frame, 0.002);
    let mut at_wall = 0;
    for [r, z] in outline(&mesh) {
        assert!(r < RADIUS + 1e-8 && z >= 0.0);
        at_wall += usize::from(r > RADIUS - 1e-8);
        if z > 1e-3 && r < RADIUS - 1e-8 {
            let off = (z - 2e-3) / SPACING;
            assert!(off.abs() < 0.05, "{off} spacings off at r = {r}");
        }
    }
    assert!(at_wall > 1000, "{at_wall} vertices at the wall");
    let lowest = outline(&mesh).map(|[_, z]| z).fold(1.0, f64::min);
    assert_eq!(lowest, 0.0, "flat at the floor");
    let axis: Vec<[f64; 2]> = outline(&mesh).filter(|[r, _]| *r < 1e-9).collect();
    assert_eq!(axis.len(), 2, "one vertex on the floor, one at the surface");
}

#[test]
fn a_splash_has_its_volume_and_colours() {
    let mesh = closed(&scene("wall"), &frame(splash), 0.005);
    let is_red = |c: &[u8; 3]| c[0] > 200 && c[2] < 60;
    let above = outline(&mesh)
        .zip(&mesh.colours)
        .filter(|([_, z], _)| *z > 3e-3);
    let (all, red) = above.fold((0, 0), |(all, red), (_, colour)| {
        (all + 1, red + usize::from(is_red(colour)))
    });
    assert!(all > 100 && red == all, "{red} of {all}");
}

/// A cylinder of one layer, and one ring that has come near the axis.
#[test]
fn thin_liquid_has_a_surface_too() {
    let scene = scene("open");
    let sheet = frame(|r, z| ((r - 3.1e-3).abs() < 1e-5 && z > 3e-3).then_some(0));
    closed(&scene, &sheet, 0.2);
    let mut single = frame(|r, z| (r < 2e-4 && (z - 5.1e-3).abs() < 1e-5).then_some(0));
    assert_eq!(single.id.len(), 1);
    for r in [1.4e-4, 2e-5] {
        single.position[0][0] = r;
        let mesh = closed(&scene, &single, 0.2);
        let axis = outline(&mesh).filter(|[r, _]| *r < 1e-9).count();
        assert_eq!(axis, 2, "a drop on the axis, without a hole");
    }
}

#[test]
fn pictures_show_the_body_from_all_sides_for_any_number_of_threads() {
    let (scene, frame) = (scene("wall"), frame(splash));
    let draw = |azimuth: f32, threads: usize| {
        let mut style = style(Material::Body);
        style.view.azimuth = azimuth;
        style.has_shadows = false;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| {
            artist(&scene, &frame, style)
                .picture(&frame)
                .pixels()
                .to_vec()
        })
    };
    let first = draw(0.0, 1);
    assert!(first == draw(0.0, 3));
    let count = |a: usize, b: usize, least: u8| {
        let is = |c: &&[u8; 3]| c[a] / 2 > c[b] && c[a] > least;
        first.iter().filter(is).count()
    };
    let (red, blue) = (count(0, 2, 60), count(2, 0, 60));
    assert!(red > 200 && blue > 1200, "{red} {blue}");
    // Light comes from one side; what is liquid, not grey, does not depend on the side. The camera
    // fits the box, which looks alike after a quarter of a turn.
    let coloured = |c: &[u8; 3]| {
        let [low, high] = [c.iter().min(), c.iter().max()].map(|c| *c.unwrap() as u32);
        8 * (high - low) > high
    };
    let most = first.iter().filter(|c| coloured(c)).count() / 30;
    let turned = draw(std::f32::consts::FRAC_PI_2, 2);
    let differs = |(a, b): &(&[u8; 3], &[u8; 3])| coloured(a) != coloured(b);
    let differing = first.iter().zip(&turned).filter(differs).count();
    assert!(differing < most, "{differing} pixels of {most} differ");
    let mirrored = first.chunks(160).flat_map(|row| row.iter().rev());
    let differing = first.iter().zip(mirrored).filter(differs).count();
    assert!(
        differing < most,
        "{differing} pixels of {most} differ left and right"
    );
}

#[test]
fn nothing_is_drawn_of_an_empty_frame() {
    let scene = scene("wall");
    let frame = Frame::default();
    assert!(Field::revolved(&scene, &frame, &[]).is_none());
    let artist = artist(&scene, &frame, style(Material::Water));
    assert_eq!(artist.mesh(&frame), Some(Mesh::default()));
    let picture = artist.picture(&frame);
    assert!(picture.pixels().iter().flatten().all(|c| *c > 150));
}

#[test]
fn points_share_the_mass_of_their_rings() {
    let frame = frame(splash);
    let [r, ..] = &frame.position;
    let points = ring::points(&frame, |i| ring::point_count(r[i], SPACING as f32));
    let sum = |values: &[f32]| values.iter().map(|v| f64::from(*v)).sum::<f64>();
    let mass = sum(&frame.mass);
    assert!((sum(&points.mass) / mass - 1.0).abs() < 1e-5);
    assert!(points.id.len() > 20 * frame.id.len());
    let of = |values: &[f32], weights: &[f32]| {
        let pairs = values.iter().zip(weights);
        pairs.map(|(v, w)| f64::from(v * w)).sum::<f64>()
    };
    let heights = [&frame, &points].map(|f| of(&f.position[2], &f.mass));
    assert!((heights[0] / heights[1] - 1.0).abs() < 1e-5);
    for a in 0..2 {
        let middle = of(&points.position[a], &points.mass) / mass;
        assert!(middle.abs() < 0.02 * SPACING, "{middle} m off the axis");
    }
    let table = Table::of_frame(points, Dimension::Three);
    let column = |name: &str| -> &Column {
        table
            .columns
            .iter()
            .find(|column| column.name == name)
            .unwrap()
    };
    let coronet::record::checkpoint::Array::F32(radii) = &column("radius").components[0] else {
        panic!("radii are f32");
    };
    let volume = radii
        .iter()
        .map(|r| 4.19 * f64::from(*r).powi(3))
        .sum::<f64>();
    assert!(
        (volume * DENSITY / mass - 1.0).abs() < 0.01,
        "spheres of the volume"
    );
}
