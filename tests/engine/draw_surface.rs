//! The surface of the liquid: closed, of the right volume, the same for any number of threads; its
//! pictures and files.

use std::collections::HashMap;
use std::path::Path;

use coronet::draw::canvas::Canvas;
use coronet::draw::film::{Film, Format};
use coronet::draw::render::Material;
use coronet::draw::render::artist::{Artist, Style, Survey};
use coronet::draw::surface::Field;
use coronet::particle::Frame;
use coronet::record::mesh::{self, Mesh};
use coronet::scene::{Scene, file};

/// Particle spacing, m.
pub const SPACING: f64 = 0.4e-3;

/// A box of 8 mm with a pool of 2 mm and a drop of 3 mm above it.
pub fn scene(dimension: usize, sets: &[&str]) -> Scene {
    let size = ["'8 mm'"; 3][..dimension].join(", ");
    let drop = ["disc", "sphere"][dimension - 2];
    let text = format!(
        "dimension = {dimension}\n[box]\nsize = [{size}]\n[liquid]\ndensity = '1000 kg/m^3'\n\
         [effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [body.pool]\nlayer = {{ depth = '2 mm' }}\ncolour = '#0000ff'\n\
         [body.drop]\n{drop} = {{ diameter = '3 mm', gap = '1 mm', above = 'pool' }}\n\
         colour = '#ff0000'\n\
         [pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n[impact]\nend = '1 s'\n\
         [frames]\ninterval = '1 s'\n[method]\nname = 'wcsph'\npreset = 'modern'\n"
    );
    let sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
    file::read(&text, Path::new("surface.toml"), &sets)
        .unwrap()
        .scene
}

/// A lattice of particles where `body` names one; the plane of y = 0 in 2-D.
pub fn frame(scene: &Scene, body: impl Fn([f64; 3]) -> Option<u8>) -> Frame {
    let mut frame = Frame::default();
    let count = scene
        .domain
        .size
        .map(|size| (size / SPACING).round() as usize);
    for i in 0..count[0] {
        for j in 0..count[1].max(1) {
            for k in 0..count[2] {
                let mut at = [i, j, k].map(|n| (n as f64 + 0.5) * SPACING);
                if count[1] == 0 {
                    at[1] = 0.0;
                }
                let Some(body) = body(at) else { continue };
                frame.id.push(frame.id.len() as u32);
                frame.body.push(body);
                frame.pressure.push(1.0);
                for a in 0..3 {
                    frame.position[a].push(at[a] as f32);
                    frame.velocity[a].push(a as f32);
                }
            }
        }
    }
    frame
}

/// The pool, and the drop about the middle of x and y.
pub fn splash(middle: f64) -> impl Fn([f64; 3]) -> Option<u8> {
    move |at: [f64; 3]| {
        let y = if at[1] == 0.0 { 0.0 } else { at[1] - middle };
        let square = (at[0] - middle).powi(2) + y.powi(2) + (at[2] - 4.5e-3).powi(2);
        match at[2] < 2e-3 {
            true => Some(0),
            false => (square < 1.5e-3f64.powi(2)).then_some(1),
        }
    }
}

pub fn artist(scene: &Scene, frame: &Frame, style: Style) -> Artist {
    let mut survey = Survey::default();
    survey.add(scene, frame);
    Artist::new(scene, &survey, style)
}

pub fn style(material: Material) -> Style {
    Style {
        material,
        size: [160, 120],
        samples: 1,
        ..Style::default()
    }
}

/// The mesh, which must be closed: each edge is passed as often in one direction as in the other.
fn closed(scene: &Scene, frame: &Frame, material: Material) -> Mesh {
    let mesh = artist(scene, frame, style(material)).mesh(frame).unwrap();
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry([from, to]).or_default() += 1;
            *edges.entry([to, from]).or_default() -= 1;
        }
    }
    assert!(!edges.is_empty());
    assert!(edges.values().all(|passes| *passes == 0), "it is open");
    mesh
}

/// Volume of the particles, m^3.
fn volume(frame: &Frame) -> f64 {
    frame.id.len() as f64 * SPACING.powi(3)
}

#[test]
fn a_mesh_is_closed_and_has_the_volume_of_the_liquid() {
    let scene = scene(3, &[]);
    let frame = frame(&scene, splash(4e-3));
    let mesh = closed(&scene, &frame, Material::Body);
    let part = mesh.volume() / volume(&frame);
    assert!((part - 1.0).abs() < 0.01, "{part}");
    for a in 0..3 {
        let all = mesh.points.iter().map(|p| p[a]);
        let [low, high] = all.fold([1.0f32, 0.0], |[l, h], x| [l.min(x), h.max(x)]);
        assert_eq!(low, 0.0, "flat at the low side");
        if a < 2 {
            assert!((high - 8e-3).abs() < 1e-7, "flat at the high side");
        }
    }
    // The normals point outward: the highest vertex is at the top of the drop.
    let top = (0..mesh.points.len()).max_by(|&i, &j| {
        let height = |i: usize| mesh.points[i][2];
        height(i).total_cmp(&height(j))
    });
    let top = top.unwrap();
    assert!((mesh.points[top][2] - 6e-3).abs() < 0.5 * SPACING as f32);
    assert!(mesh.normals[top][2] > 0.9);
    assert!(
        mesh.colours[top][0] > 200 && mesh.colours[top][2] < 60,
        "the drop is red"
    );
}

#[test]
fn thin_and_small_liquid_has_a_surface_too() {
    let scene = scene(3, &[]);
    let height = 10.5 * SPACING;
    let sheet = frame(&scene, |at| {
        ((at[2] - height).abs() < 0.1 * SPACING).then_some(0)
    });
    let part = closed(&scene, &sheet, Material::Water).volume() / volume(&sheet);
    assert!((part - 1.0).abs() < 0.25, "a sheet of one layer: {part}");
    let field = Field::new(&scene, &sheet, &[]).unwrap();
    let level = ((height as f32 - field.low.z) / field.step.z).round() as usize;
    for i in 0..field.count[0] {
        for j in 0..field.count[1] {
            let value = field.values[field.index([i, j, level])];
            assert!(value > 0.6, "a hole at {i}, {j}: {value}");
        }
    }
    let near = |x: f64| (x - 4.2e-3).abs() < 0.1 * SPACING;
    let single = frame(&scene, |at| at.into_iter().all(near).then_some(0));
    assert_eq!(single.id.len(), 1);
    let part = closed(&scene, &single, Material::Water).volume() / volume(&single);
    assert!((0.6..1.4).contains(&part), "a single particle: {part}");
}

#[test]
fn a_quarter_is_shown_as_the_whole() {
    let whole = scene(3, &[]);
    let quarter = scene(3, &["box.symmetry=quarter"]);
    let all = frame(&whole, splash(4e-3));
    let part = frame(&quarter, splash(0.0));
    assert_eq!(4 * part.id.len(), all.id.len());
    let [a, b] = [(&whole, &all), (&quarter, &part)];
    let [a, b] = [a, b].map(|(scene, frame)| closed(scene, frame, Material::Water).volume());
    assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
}

#[test]
fn pictures_and_meshes_do_not_depend_on_threads() {
    let scene = scene(3, &[]);
    let frame = frame(&scene, splash(4e-3));
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let artist = artist(&scene, &frame, style(Material::Water));
            let picture = artist.picture(&frame);
            (picture.pixels().to_vec(), artist.mesh(&frame))
        })
    };
    assert!(made(1) == made(3));
}

#[test]
fn pictures_show_the_liquid_before_its_background() {
    let scene = scene(3, &[]);
    let frame = frame(&scene, splash(4e-3));
    let draw = |style: Style| artist(&scene, &frame, style).picture(&frame);
    let body = draw(style(Material::Body));
    let is_red = |[r, _, b]: &[u8; 3]| *r / 2 > *b && *r > 60;
    let is_blue = |[r, _, b]: &[u8; 3]| *b / 2 > *r && *b > 60;
    let count = |canvas: &Canvas, is: &dyn Fn(&[u8; 3]) -> bool| {
        canvas.pixels().iter().filter(|colour| is(colour)).count()
    };
    assert!(count(&body, &is_red) > 300, "{}", count(&body, &is_red));
    assert!(count(&body, &is_blue) > 1200, "{}", count(&body, &is_blue));
    let milk = draw(style(Material::Milk));
    assert_eq!(count(&milk, &is_red) + count(&milk, &is_blue), 0);
    let water = draw(style(Material::Water));
    let is_bluish = |[r, _, b]: &[u8; 3]| b.saturating_sub(*r) > 25;
    assert!(
        count(&water, &is_bluish) > 1000,
        "{}",
        count(&water, &is_bluish)
    );

    // Corners, above: background, in every style.
    let dark = draw(Style {
        background: [10, 12, 14],
        ..style(Material::Milk)
    });
    assert!(
        dark.get(0, 0).iter().all(|c| *c < 40),
        "{:?}",
        dark.get(0, 0)
    );
    assert!(
        milk.get(0, 0).iter().all(|c| *c > 190),
        "{:?}",
        milk.get(0, 0)
    );

    let written = draw(Style {
        has_clock: true,
        has_scale: true,
        caption: Some("Ein Tropfen fällt".into()),
        ..style(Material::Water)
    });
    let differ = |rows: std::ops::Range<usize>| {
        let at = |canvas: &Canvas| canvas.pixels()[rows.start * 160..rows.end * 160].to_vec();
        at(&written) != at(&water)
    };
    assert!(differ(0..20), "the clock");
    assert!(differ(90..120), "scale and caption");
    assert!(!differ(40..60), "nothing else");
}

#[test]
fn two_dimensions_are_a_filled_section_without_a_mesh() {
    let scene = scene(2, &[]);
    let frame = frame(&scene, splash(4e-3));
    let artist = artist(&scene, &frame, style(Material::Body));
    assert!(artist.mesh(&frame).is_none());
    let picture = artist.picture(&frame);
    // The sheet shows 8 mm by 6 mm.
    let at = |x: f64, z: f64| {
        let pixel = 1.08 * 6e-3 / 120.0;
        let column = 80.0 + (x - 4e-3) / pixel;
        let row = 60.0 - (z - 3e-3) / pixel;
        picture.get(column as usize, row as usize)
    };
    assert!(at(4e-3, 1e-3)[2] > 200, "{:?}", at(4e-3, 1e-3));
    assert!(at(4e-3, 4.5e-3)[0] > 200, "{:?}", at(4e-3, 4.5e-3));
    let background = Style::default().background;
    assert_eq!(at(4e-3, 2.5e-3), background);
    // A caption over liquid is on a plate.
    let mut style = style(Material::Body);
    style.caption = Some("Ein Tropfen fällt".into());
    let written = self::artist(&scene, &frame, style).picture(&frame);
    let off = |canvas: &Canvas| {
        let colours = canvas.get(80, 91).into_iter().zip(background);
        colours.map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>()
    };
    assert!(3 * off(&written) < off(&picture));
}

#[test]
fn an_empty_frame_is_a_picture_of_the_background() {
    let scene = scene(3, &[]);
    let frame = Frame::default();
    let artist = artist(&scene, &frame, style(Material::Water));
    assert_eq!(artist.mesh(&frame), Some(Mesh::default()));
    let picture = artist.picture(&frame);
    assert!(picture.pixels().iter().flatten().all(|c| *c > 150));
}

/// Each file is read as its format prescribes.
#[test]
fn files_of_meshes_hold_all_vertices_and_triangles() {
    let scene = scene(3, &[]);
    let frame = frame(&scene, splash(4e-3));
    let mesh = closed(&scene, &frame, Material::Body);
    let (points, triangles) = (mesh.points.len(), mesh.triangles.len());
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str| {
        let path = folder.path().join(name);
        let format = mesh::Format::of(name.rsplit('.').next().unwrap()).unwrap();
        mesh.write(format, &path).unwrap();
        std::fs::read(path).unwrap()
    };
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();

    let ply = write("a.ply");
    let end = text(&ply[..1000]).find("end_header\n").unwrap() + 11;
    let head = text(&ply[..end]);
    assert!(head.contains(&format!("element vertex {points}\n")));
    assert!(head.contains(&format!("element face {triangles}\n")));
    assert_eq!(ply.len(), end + points * (6 * 4 + 3) + triangles * 13);

    let obj = text(&write("a.obj"));
    let lines = |start: &str| obj.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(
        [lines("v "), lines("vn "), lines("f ")],
        [points, points, triangles]
    );

    let glb = write("a.glb");
    let number = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&glb[..4], number(8)), (&b"glTF"[..], glb.len()));
    let json: serde_json::Value = serde_json::from_slice(&glb[20..20 + number(12)]).unwrap();
    let binary = 20 + number(12) + 8;
    assert_eq!(number(binary - 8), glb.len() - binary);
    let view = |n: usize| {
        let view = &json["bufferViews"][n];
        let get = |key: &str| view[key].as_u64().unwrap() as usize;
        binary + get("byteOffset")..binary + get("byteOffset") + get("byteLength")
    };
    assert_eq!(json["accessors"][2]["count"], 3 * triangles);
    let first = f32::from_le_bytes(glb[view(0)][..4].try_into().unwrap());
    assert_eq!(first, mesh.points[0][0]);
    assert_eq!(view(3).len(), 4 * points);

    let vtp = write("a.vtp");
    let start = vtp
        .windows(3)
        .position(|w| w == b"\n_\x00" || w[..2] == *b"\n_")
        .unwrap()
        + 2;
    let number = |at: usize| u64::from_le_bytes(vtp[at..at + 8].try_into().unwrap()) as usize;
    let (mut at, mut lengths) = (start, Vec::new());
    for _ in 0..5 {
        lengths.push(number(at));
        at += 8 + number(at);
    }
    let expected = [
        12 * points,
        24 * triangles,
        8 * triangles,
        12 * points,
        3 * points,
    ];
    assert_eq!(lengths, expected);
    assert!(text(&vtp[at..]).contains("</VTKFile>"));
}

#[test]
fn films_hold_their_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let write = |format: Format, name: &str| {
        let path = folder.path().join(name);
        let mut film = Film::new(format, &path, [64, 48], 25.0).unwrap();
        for n in 0..3u8 {
            film.add(&Canvas::new(64, 48, [80 * n, 200, 30])).unwrap();
        }
        film.finish().unwrap();
        std::fs::read(path).unwrap()
    };
    let bytes = write(Format::Gif, "a.gif");
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(&bytes[..]).unwrap();
    for n in 0..3u8 {
        let frame = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!((frame.width, frame.height, frame.delay), (64, 48, 4));
        assert!(frame.buffer[0].abs_diff(80 * n) < 3);
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
    if cfg!(feature = "video") {
        let bytes = write(Format::Mp4, "a.mp4");
        let has = |word: &[u8]| bytes.windows(word.len()).any(|found| found == word);
        assert!(has(b"ftyp") && has(b"moov") && has(b"avc1") && has(b"mdat"));
        // Table of sample sizes: version, size 0, count.
        let at = bytes.windows(4).position(|w| w == b"stsz").unwrap() + 12;
        assert_eq!(bytes[at..at + 4], [0, 0, 0, 3]);
        assert_eq!(bytes, write(Format::Mp4, "b.mp4"), "the same bits");
    }
}
