//! From frames to files: what `post` writes, and what the pictures show.

use std::path::Path;

use coronet::draw::canvas::{Canvas, FAINT, WHITE};
use coronet::draw::field::{Bounds, Field, Scales};
use coronet::draw::post::{Post, PostError};
use coronet::draw::render::Material;
use coronet::draw::render::artist::{Artist, Style, Survey};
use coronet::draw::report::Report;
use coronet::draw::section::{self, Section};
use coronet::measure::kind::Kind;
use coronet::measure::series::Reference as Table;
use coronet::particle::Frame;
use coronet::scene::{Clock, Dimension, FigureStyle, Motion, Reference, Scene, Side};

use crate::measure_splash::{SIDE, Splash, pool_scene, splash};

/// A crater that deepens by half a millimetre a frame, with a crown; then a jet.
fn frames(scene: &Scene) -> Vec<Frame> {
    let shape = |n: usize| match n {
        0 => Splash::default(),
        n if n < 9 => {
            let radius = 2.0 + 0.5 * n as f64;
            let crown = [radius, radius + 1.6, 0.4 * n as f64];
            Splash {
                crater: radius,
                crown,
                ..Splash::default()
            }
        }
        _ => Splash {
            jet: [1.8, 4.0],
            ..Splash::default()
        },
    };
    let frame = |n: usize| {
        let mut frame = splash(scene, &shape(n));
        frame.time = n as f64 * 1e-3;
        frame.scalars = vec![("kinetic_energy_J".into(), 1e-4 / (n + 1) as f64)];
        frame
    };
    (0..11).map(frame).collect()
}

fn scene(dimension: Dimension, folder: &Path) -> Scene {
    let mut scene = pool_scene(dimension, 0.5);
    scene.frames.interval = 1e-3;
    scene.impact.end = 10e-3;
    scene.post.panels = vec![4e-3, 0.0, 0.5];
    scene.post.fields = vec![4.4e-3];
    let mut text = String::from("time_s,crater_depth_m\n");
    for n in 1..9 {
        // The frames count from the start, the reference from the contact 0.1 ms later.
        let depth = (2.0 + 0.5 * n as f64) * 1e-3;
        text += &format!("{},{}\n", n as f64 * 1e-3 - 1e-4, 1.1 * depth);
    }
    std::fs::write(folder.join("curve.csv"), text).unwrap();
    scene.post.references = vec![Reference {
        label: "ten percent <more>".into(),
        path: "curve.csv".into(),
        clock: Some(Clock::Contact),
    }];
    scene
}

fn references(scene: &Scene, folder: &Path) -> Vec<(String, Table)> {
    let references = scene.post.references.iter();
    let table = |r: &Reference| Table::read(&folder.join(&r.path), r.clock).unwrap();
    references.map(|r| (r.label.clone(), table(r))).collect()
}

#[test]
fn a_run_becomes_a_table_plots_pictures_and_a_page() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let folder = tempfile::tempdir().unwrap();
        let scene = scene(dimension, folder.path());
        let out = folder.path().join("out");
        std::fs::create_dir(&out).unwrap();
        let mut post = Post::new(&scene, references(&scene, folder.path()), &out);
        for frame in frames(&scene) {
            post.frame(&frame).unwrap();
        }
        let provenance = [("key & digest".to_string(), "<0123>".to_string())];
        let report = post.finish(&provenance).unwrap();
        assert_eq!(
            report.missed,
            ["No panel at 500.0 ms: the last frame is at 10.0 ms."]
        );
        for file in &report.files {
            assert!(out.join(file).metadata().unwrap().len() > 100, "{file:?}");
        }
        assert_eq!(report.series.len(), 11);
        let norm = &report.norms[0];
        assert!(
            (norm.l2 - 0.1 / 1.1).abs() < 0.03 && norm.points == 8,
            "{norm:?}"
        );
        let jet = report.series.column("jet_height_m").unwrap();
        assert!(
            jet[..8].iter().all(|h| h.is_nan()) && (jet[9] - 4e-3).abs() < 3e-4,
            "{jet:?}"
        );
        let page = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(page.contains("key &amp; digest") && page.contains("&lt;0123&gt;"));
        assert!(page.contains("ten percent &lt;more&gt;") && page.contains("500.0 ms"));
        // The reference's own times, after contact.
        assert!(page.contains("0.9–7.9 ms"), "the span of the comparison");
        // Nothing is fetched: no address in what a browser loads by itself.
        for loads in [
            "src=\"http",
            "url(",
            "<link",
            "<script src",
            "@import",
            "src=\"/",
        ] {
            assert!(!page.contains(loads), "{loads}");
        }
        let pictures = page.matches("data:image/png;base64,").count();
        // A field has one for its pixels and one for its colour bar.
        assert_eq!(pictures, if dimension == Dimension::Three { 7 } else { 4 });
        for name in ["plots/crater-depth", "fields/01"] {
            for ending in ["svg", "pdf", "png"] {
                assert!(
                    out.join(format!("{name}.{ending}")).is_file(),
                    "{name}.{ending}"
                );
            }
        }
        assert!(page.matches("<svg").count() >= 4);
    }
}

#[test]
fn frames_out_of_order_and_an_empty_run_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene(Dimension::Two, folder.path());
    let post = || Post::new(&scene, Vec::new(), folder.path());
    assert!(matches!(post().finish(&[]), Err(PostError::Empty)));
    let mut started = post();
    let all = frames(&scene);
    started.frame(&all[3]).unwrap();
    assert!(matches!(
        started.frame(&all[2]),
        Err(PostError::Order { .. })
    ));
    let error = Table::read(&folder.path().join("nowhere.csv"), None).err();
    let error = error.unwrap();
    assert!(error.to_string().contains("nowhere.csv"), "{error}");
}

/// The page of a run of these frames, and what is not drawn.
fn evaluated(scene: &Scene, frames: &[Frame]) -> (String, Vec<String>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let mut post = Post::new(scene, Vec::new(), folder.path());
    post.frames(frames).unwrap();
    let report = post.finish(&[]).unwrap();
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    let files = report.files.iter().map(|file| file.display().to_string());
    (page, report.missed, files.collect())
}

#[test]
fn a_scene_without_an_axis_has_no_fields_and_its_page_warns() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene(Dimension::Two, folder.path());
    let drawn = |scene: &Scene| {
        let (page, _, files) = evaluated(scene, &frames(scene)[..6]);
        let is_drawn = files.iter().any(|file| file.starts_with("fields"));
        assert_eq!(is_drawn, !page.contains("No field is drawn"));
        assert_eq!(is_drawn, !page.contains("fields are means over both sides"));
        is_drawn
    };
    assert!(drawn(&scene));
    scene.bodies[1].motion = Motion::Uniform([1.0, 0.0, -3.13]);
    assert!(!drawn(&scene));
}

#[test]
fn an_instant_after_the_end_has_its_own_unit() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = scene(Dimension::Two, folder.path());
    (scene.impact.end, scene.frames.interval) = (0.5e-3, 0.1e-3);
    (scene.post.panels, scene.post.fields) = (vec![1e-3, 0.4e-3], Vec::new());
    let (_, missed, _) = evaluated(&scene, &frames(&scene)[..1]);
    assert_eq!(
        missed,
        [
            "No panel at 400.0 us: the last frame is at 0.0 us.",
            "No panel at 1.0 ms: the last frame is at 0.0 ms."
        ]
    );
}

fn has(canvas: &Canvas, test: impl Fn([u8; 3]) -> bool) -> usize {
    let rows = (0..canvas.height).flat_map(|y| (0..canvas.width).map(move |x| (x, y)));
    rows.filter(|&(x, y)| test(canvas.get(x, y))).count()
}

fn is_orange(c: [u8; 3]) -> bool {
    i32::from(c[0]) > i32::from(c[2]) + 60
}

#[test]
fn drop_and_pool_have_their_colours_in_section_and_view() {
    let scene = pool_scene(Dimension::Three, 0.5);
    let mut frame = splash(
        &scene,
        &Splash {
            jet: [2.0, 4.0],
            ..Splash::default()
        },
    );
    for i in 0..frame.id.len() {
        frame.body[i] = u8::from(frame.position[2][i] > 10e-3);
    }
    let section = Section::new(&scene, &frame, 12e-3, "t = 1.0 ms".into());
    // However high the liquid is, all of it is in the picture.
    let mut high = frame.clone();
    high.position[2].iter_mut().for_each(|z| *z += 60e-3);
    let high = Section::new(&scene, &high, 12e-3, "t = 1.0 ms".into());
    let picture = high.draw(&scene, high.top());
    let scale = picture.height as f64 / (1e3 * high.top());
    let jet = has(&picture, is_orange) as f64 / (scale * scale);
    assert!((jet - 16.0).abs() < 3.0, "the raised jet covers {jet} mm²");
    assert!(
        (section.top() - 13.75e-3).abs() < 0.3e-3,
        "{}",
        section.top()
    );
    let picture = section.draw(&scene, section.top());
    let scale = section::width(&scene) as f64 / SIDE;
    let jet = has(&picture, is_orange) as f64 / (scale * scale);
    assert!((jet - 16.0).abs() < 3.0, "the jet covers {jet} mm²");
    let blue = has(&picture, |c| i32::from(c[2]) > i32::from(c[0]) + 60) as f64 / (scale * scale);
    assert!(
        (blue / (SIDE * 10.0) - 0.95).abs() < 0.15,
        "the pool covers {blue} mm²"
    );
    let style = Style {
        material: Material::Body,
        size: [240, 180],
        samples: 1,
        ..Style::default()
    };
    let view = Artist::new(&scene, &Survey::of_box(&scene), style).picture(&frame);
    let is_cold = |c: [u8; 3]| i32::from(c[2]) > i32::from(c[0]) + 60;
    assert!(has(&view, is_orange) > 150 && has(&view, is_cold) > 3000);
    // All of it is in the picture.
    let edges = (0..240).flat_map(|x| [view.get(x, 0), view.get(x, 179)]);
    assert_eq!(edges.filter(|c| is_orange(*c) || is_cold(*c)).count(), 0);
}

/// Of a box 20 mm deep and more 1 mm, of one of 0.4 mm a twentieth, of one of few spacings one.
#[test]
fn a_section_is_thin_beside_its_box() {
    let mut scene = pool_scene(Dimension::Three, 0.5);
    let frame = splash(&scene, &Splash::default());
    scene.domain.size[1] = 24e-3;
    assert_eq!(
        section::words(&scene).split(" through").next(),
        Some("Section of 1 mm")
    );
    let share = |k: f32| {
        let mut scene = scene.clone();
        let mut frame = frame.clone();
        scene.spacing *= k as f64;
        scene.domain.size = scene.domain.size.map(|side| side * k as f64);
        for along in &mut frame.position {
            along.iter_mut().for_each(|x| *x *= k);
        }
        let at = 0.5 * scene.domain.size[1];
        let picture = Section::new(&scene, &frame, at, String::new());
        let picture = picture.draw(&scene, 20e-3 * k as f64);
        has(&picture, |c| c != [255, 255, 255]) as f64 / (picture.width * picture.height) as f64
    };
    let [whole, tiny] = [1.0, 0.01].map(share);
    assert!((tiny / whole - 1.0).abs() < 0.02, "{whole} {tiny}");
}

#[test]
fn a_section_has_a_floor_where_there_is_a_wall_and_no_liquid_behind_its_label() {
    let mut scene = pool_scene(Dimension::Two, 0.5);
    let mut frame = splash(&scene, &Splash::default());
    let mist = [0.6e-3, 10.2e-3, 11.4e-3, 12e-3];
    for (i, z) in mist.into_iter().enumerate() {
        for (axis, place) in [(0, 1e-3 * (i + 1) as f32), (2, z)] {
            frame.position[axis][i] = place;
        }
    }
    for (side, is_floor) in [
        (Side::Wall, true),
        (Side::Open, false),
        (Side::Periodic, false),
    ] {
        scene.domain.boundary[2][0] = side;
        let section = Section::new(&scene, &frame, 0.0, "t = 1.0 ms".into());
        let picture = section.draw(&scene, section.top());
        let count = has(&picture, |colour| colour == FAINT);
        assert_eq!(count, if is_floor { 8 * picture.width } else { 0 });
        let strip = (0..48).flat_map(|y| (0..picture.width).map(move |x| (x, y)));
        let is_grey = |[r, _, b]: [u8; 3]| r.abs_diff(b) < 20;
        assert!(strip.into_iter().all(|(x, y)| is_grey(picture.get(x, y))));
    }
}

#[test]
fn a_source_flow_averages_to_its_radial_profile() {
    for dimension in [Dimension::Two, Dimension::Three] {
        let scene = pool_scene(dimension, 0.5);
        let Kind::Pool(axis) = Kind::new(&scene) else {
            panic!("not a pool")
        };
        let mut frame = splash(
            &scene,
            &Splash {
                crater: 4.0,
                ..Splash::default()
            },
        );
        for i in 0..frame.id.len() {
            let x = [0, 1, 2].map(|a| f64::from(frame.position[a][i]));
            let y = if dimension == Dimension::Two {
                0.0
            } else {
                x[1] - 12e-3
            };
            frame.velocity[0][i] = (100.0 * (x[0] - 12e-3)) as f32;
            frame.velocity[1][i] = (100.0 * y) as f32;
            frame.velocity[2][i] = 0.5;
            frame.pressure[i] = (1100.0 * 9.81 * (10e-3 - x[2])) as f32;
        }
        let field = Field::new(&scene, &frame, &axis, "t = 0.0 ms".into());
        assert!(field.bin(2, 15).is_none(), "the crater is empty");
        for r in [10, 14, 20] {
            let bin = field.bin(r, 8).unwrap();
            let radius = (r as f64 + 0.5) * 0.5e-3;
            assert!((bin.velocity[0] - 100.0 * radius).abs() < 0.03, "{bin:?}");
            assert!((bin.velocity[1] - 0.5).abs() < 1e-6);
            assert!(
                (bin.pressure - 1100.0 * 9.81 * 5.75e-3).abs() < 1e-2,
                "{bin:?}"
            );
        }
        let fields = [field];
        let figure = Bounds {
            top: fields[0].top(),
            level: 10e-3,
            scales: Scales::of(&fields),
        };
        let picture = fields[0]
            .draw(&figure, &FigureStyle::default())
            .canvas(100.0);
        assert!(has(&picture, |c| c == WHITE) > 1000 && has(&picture, is_blue_green) > 1000);
    }
}

fn is_blue_green(c: [u8; 3]) -> bool {
    i32::from(c[2]) > i32::from(c[0]) + 30
}

#[test]
fn a_png_reads_back_pixel_by_pixel() {
    let mut canvas = Canvas::new(7, 5, [1, 2, 3]);
    canvas.set(6, 4, [250, 0, 9]);
    let bytes = canvas.png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height, pixels.len()), (7, 5, 105));
    assert_eq!(
        (&pixels[..3], &pixels[102..]),
        (&[1, 2, 3][..], &[250, 0, 9][..])
    );
}

#[test]
fn a_page_without_pictures_is_whole() {
    let page = Report {
        title: "A & B".into(),
        ..Report::default()
    }
    .html();
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("<title>A &amp; B</title>"));
    assert_eq!(page.matches("<div").count(), page.matches("</div>").count());
}
