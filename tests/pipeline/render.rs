//! `coronet render` from outside.

use std::fs;
use std::process::Command;

use coronet::record::log;
use serde_json::json;

use crate::program::Program;

/// Width and height of a PNG file.
fn size(program: &Program, name: &str) -> [u32; 2] {
    let bytes = fs::read(program.path(name)).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n", "{name}");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
fn a_run_becomes_a_picture_a_series_and_a_film() {
    let program = Program::new();
    program.run(&[]);
    let small = ["--size", "96x64", "--samples", "1"];
    let render = |more: &[&str]| {
        let arguments = [&["render", "tiny"], more, &small].concat();
        program.call(&arguments).well()
    };
    let last = render(&[]);
    assert!(last.out.contains("render.png: t = 4.0"), "{}", last.out);
    assert_eq!(size(&program, "render.png"), [96, 64]);

    render(&[
        "--at",
        "2 ms",
        "--output",
        "new/two.png",
        "--clock",
        "--caption",
        "ä",
    ]);
    assert_eq!(size(&program, "new/two.png"), [96, 64]);
    let first = fs::read(program.path("new/two.png")).unwrap();
    assert_ne!(first, fs::read(program.path("render.png")).unwrap());
    render(&[
        "--at",
        "2 ms",
        "--output",
        "b.png",
        "--clock",
        "--caption",
        "ä",
        "--threads",
        "3",
    ]);
    assert_eq!(
        first,
        fs::read(program.path("b.png")).unwrap(),
        "for any number of threads"
    );

    // A shorter series leaves nothing of a longer one.
    let series = |until: &str| {
        let ended = render(&["--output", "s.png", "--until", until, "--json"]);
        let object = ended.objects().remove(0);
        let times = object["times_s"].as_array().unwrap().len();
        let name = |n: usize| format!("s-{n:05}.png");
        let names: Vec<String> = (0..times).map(name).collect();
        assert_eq!(object["files"], json!(names));
        assert!(names.iter().all(|name| program.path(name).exists()));
        assert!(!program.path(&name(times)).exists());
        times
    };
    let (long, short) = (series("3.2 ms"), series("1.2 ms"));
    assert!(long > short && short >= 2, "{long} {short}");

    let film = render(&["--output", "a.gif", "--material", "speed"]);
    assert!(film.out.contains("a.gif: "), "{}", film.out);
    assert_eq!(fs::read(program.path("a.gif")).unwrap()[..6], *b"GIF89a");
    // The log itself, and the folder of a result.
    let log = "artifacts/latest/tiny/impact/frames.mcap";
    for run in [log, "artifacts/latest/tiny/impact", "artifacts/latest/tiny"] {
        let arguments = [
            &["render", run, "--output", "c.png", "--at", "2 ms"],
            &small[..],
        ];
        program.call(&arguments.concat()).well();
    }
}

/// A file of somebody else is neither replaced nor removed, nor is a result.
#[test]
fn files_of_others_stay_as_they_are() {
    let program = Program::new();
    program.run(&[]);
    let numbered = |n: usize| program.path(&format!("s-{n:05}.png"));
    for (name, set, own) in [
        ("s-00000.png", "s.png", 1..9),
        ("s-00009.png", "s.png", 0..9),
        ("s-00001.png", "s.png", 5..6),
        ("q.png", "q.png", 0..1),
    ] {
        (0..9).for_each(|n| drop(fs::remove_file(numbered(n))));
        own.for_each(|n| fs::write(numbered(n), b"\x89PNG coronet").unwrap());
        fs::write(program.path(name), "a photo").unwrap();
        let more = match set {
            "q.png" => ["--at", "1.2 ms"],
            _ => ["--until", "1.2 ms"],
        };
        let series = [&["render", "tiny", "--output", set], &more[..]].concat();
        program.call(&series).badly(2, &[name, "stays as it is"]);
        assert_eq!(fs::read(program.path(name)).unwrap(), b"a photo");
        fs::remove_file(program.path(name)).unwrap();
    }
    let inside = [
        "render",
        "tiny",
        "--output",
        "artifacts/latest/tiny/post/new.png",
    ];
    program.call(&inside).badly(2, &["among results"]);
}

#[test]
fn mistakes_are_explained() {
    let program = Program::new();
    program.run(&[]);
    let render = |more: &[&str]| program.call(&[&["render", "tiny"], more].concat());
    render(&["--at", "1 s"]).badly(2, &["1000 ms", "nearest one is at 4.0"]);
    let late = render(&["--from", "1 s", "--output", "a.gif"]);
    late.badly(2, &["no frame is between", "from 0.000 to 4.0"]);
    render(&["--rate", "9"]).badly(2, &["--rate", "render.png", "leave it out"]);
    render(&["--scale-bar", "--output", "a.ply"]).badly(2, &["--scale-bar", "a.ply"]);
    render(&["--output", "a.bmp"]).badly(2, &["a.bmp", ".png, .gif, .mp4"]);
    render(&["--output", "a"]).badly(2, &["no known format"]);
    render(&["--output", "a.ply"]).badly(2, &["two dimensions", "render a picture"]);
    render(&["--at", "5 mm"]).badly(2, &["--at", "mm"]);
    render(&["--size", "7x7"]).badly(2, &["--size", "16 to 8192"]);
    render(&["--size", "99x64", "--output", "a.mp4"]).badly(2, &["even", "--size"]);
    if !cfg!(feature = "video") {
        render(&["--output", "a.mp4"]).badly(2, &["a.mp4", "MP4", "--features video"]);
    }
    render(&["--background", "red"]).badly(2, &["--background", "#rrggbb"]);
    render(&["--target", "1 mm, 2 mm"]).badly(2, &["--target", "three lengths"]);
    render(&["--material", "oil"]).badly(2, &["--material", "milk"]);
    render(&["--at", "1 ms", "--until", "2 ms"]).badly(2, &["--until"]);
    let missing = program.call(&["render", "nothing"]);
    missing.badly(2, &["nothing", "tiny"]);
    assert!(
        fs::read_dir(program.folder.path()).unwrap().count() == 2,
        "nothing is written"
    );

    let log = program.latest("impact").join("frames.mcap");
    let bytes = fs::read(log).unwrap();
    fs::write(program.path("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let cut = program.call(&["render", "cut.mcap", "--size", "32x32"]);
    cut.badly(4, &["cut.mcap", "cut off"]);
}

#[test]
fn a_run_under_way_is_shown_as_far_as_it_is() {
    let program = Program::new();
    let sets = [
        "--set",
        "impact.end=400 ms",
        "--set",
        "impact.checkpoint_every=5 ms",
    ];
    let mut child = program.start(&[&["run", "tiny.toml", "--name", "long"], &sets[..]].concat());
    let work = program.in_flight(&mut child);
    // The name of the run stands in its file of progress, a little later than its first checkpoint.
    let has_frames = || {
        let segments = log::segments(&work).unwrap();
        let frames = segments.first().map(|first| log::read_frames(&first.path));
        frames.is_some_and(|frames| frames.unwrap().next().is_some_and(|frame| frame.is_ok()))
    };
    while !has_frames() || !work.join("progress.json").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let render = || program.call(&["render", "long", "--size", "64x48", "--samples", "1"]);
    let export = || program.call(&["export", "long", "--to", "csv", "--output", "tables"]);
    let ended = [render(), export()];
    let is_running = child.try_wait().unwrap().is_none();
    let number = child.id().to_string();
    let kill = Command::new("kill").args(["-TERM", &number]).status();
    assert!(kill.unwrap().success());
    child.wait().unwrap();
    assert!(is_running, "the run ended too early for this test");
    for ended in ended {
        ended.well();
    }
    assert_eq!(size(&program, "render.png"), [64, 48]);
    // Now the run has its name, after its last checkpoint.
    assert!(program.path("artifacts/latest/long/manifest.json").exists());
    render().well();
    export().well();
    let index = fs::read_to_string(program.path("tables/frames.csv")).unwrap();
    assert!(index.lines().count() > 1, "{index}");
}

#[test]
fn a_stopped_attempt_does_not_stand_for_the_run_that_ended() {
    let program = Program::new();
    program.run(&[]);
    let sets = ["impact.end=400 ms", "impact.checkpoint_every=5 ms"];
    let other = ["run", "tiny.toml", "--set", sets[0], "--set", sets[1]];
    let mut child = program.start(&other);
    let work = program.in_flight(&mut child);
    while !work.join("progress.json").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let state = || program.call(&["list", "--json"]).well().objects()[0]["state"].clone();
    assert_eq!(state(), "unfinished");
    let ends_as_the_first = || {
        let export = ["export", "tiny", "--to", "csv", "--output", "tables"];
        let printed = program.call(&export).well().out;
        let index = fs::read_to_string(program.path("tables/frames.csv")).unwrap();
        let last = index.lines().last().unwrap();
        assert!(last.contains("0.004"), "{printed}{last}");
    };
    ends_as_the_first();
    program.run(&[]);
    assert_eq!(state(), "finished");
    ends_as_the_first();
    let inside = ["export", "tiny", "--to", "csv", "--output", "artifacts/a"];
    program.call(&inside).badly(2, &["among results"]);
}
