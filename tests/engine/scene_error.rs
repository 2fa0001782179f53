//! What a user reads when a scene file is wrong: place, key, value, and what would be right.

use crate::scene_file::SMALL;
use coronet::scene::error::SceneError;
use coronet::scene::file;
use std::path::Path;

/// The error of `SMALL` with one text replaced by another.
pub fn edited(from: &str, to: &str) -> SceneError {
    assert!(SMALL.contains(from), "{from}");
    let text = SMALL.replacen(from, to, 1);
    file::read(&text, Path::new("small.toml"), &[]).expect_err(to)
}

/// The error of `SMALL` with `--set`.
fn set(argument: &str) -> String {
    let sets = [argument.to_string()];
    file::read(SMALL, Path::new("small.toml"), &sets)
        .expect_err(argument)
        .to_string()
}

#[track_caller]
pub fn holds(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn unknown_keys_name_the_nearest_known_one() {
    for (from, to, key, nearest, place) in [
        (
            "velocity =",
            "veloctiy =",
            "body.drop.veloctiy",
            "body.drop.velocity",
            "16:1",
        ),
        (
            "spacing =",
            "spaceing =",
            "pack.spaceing",
            "pack.spacing",
            "18:1",
        ),
        ("[liquid]", "[liqiud]", "liqiud", "liquid", "4:2"),
        (
            "gap =",
            "gapp =",
            "body.drop.sphere.gapp",
            "body.drop.sphere.gap",
            "15:31",
        ),
        (
            "[relax]",
            "seed = 2\n[relax]\nseed = 1",
            "relax.seed",
            "pack.seed",
            "21:1",
        ),
        ("[body.drop]", "[boddy.drop]", "boddy", "body", "14:2"),
    ] {
        let error = edited(from, to);
        let message = error.to_string();
        let SceneError::UnknownKey {
            nearest: found,
            key: found_key,
            ..
        } = error
        else {
            panic!("{message}");
        };
        assert_eq!(found_key, key);
        assert!(found.as_ref().unwrap().ends_with(nearest), "{found:?}");
        holds(
            &message,
            &[
                "small.toml:",
                &format!("small.toml:{place}:"),
                "did you mean",
            ],
        );
    }
}

/// A text of `SMALL`, what is put in its place, and parts of the message.
const WRONG: &[(&str, &str, &[&str])] = &[
    (
        "\"1.5 m/s\"",
        "\"1.5 m\"",
        &["16:12", "body.drop.velocity", "a length", "m/s"],
    ),
    (
        "\"1.5 m/s\"",
        "\"1.5\"",
        &["no unit", "a speed", "3.13 m/s"],
    ),
    (
        "\"1.5 m/s\"",
        "\"fast\"",
        &["\"fast\"", "does not start with a number"],
    ),
    ("\"1.5 m/s\"", "true", &["16:12", "true", "write a speed"]),
    (
        "\"1.5 m/s\"",
        "[0, 1]",
        &["2 components", "3-D", "x, y and z"],
    ),
    (
        "\"1.5 m/s\"",
        "[0, 0, \"1 s\"]",
        &["body.drop.velocity[2]", "a time"],
    ),
    (
        "\"0.4 mm\"\n[relax]",
        "\"-0.4 mm\"\n[relax]",
        &["pack.spacing", "above zero"],
    ),
    (
        "\"0.4 mm\"\n[relax]",
        "nan\n[relax]",
        &["pack.spacing", "above zero"],
    ),
    ("\"5 ms\"", "{ a = 1 }", &["impact.end", "a table", "40 ms"]),
    (
        "\"8 mm\", \"8 mm\", \"10 mm\"",
        "\"8 mm\"",
        &["box.size", "1 entries"],
    ),
    (
        "end = \"5 ms\"\n",
        "",
        &["20:1", "impact.end", "missing", "end = \"40 ms\""],
    ),
    (
        "[relax]",
        "[relax]\ndamping = \"-1 1/s\"",
        &["relax.damping", "zero or above"],
    ),
    (
        "[relax]",
        "[method]\npreset = \"papre\"",
        &["did you mean \"paper\""],
    ),
    (
        "[relax]",
        "[method]\nname = 3",
        &["method.name", "write one of \"wcsph\", \"isph\", \"mps\""],
    ),
    ("[relax]", "seed = 1.5", &["pack.seed", "whole number"]),
    (
        "[relax]",
        "[method.wcsph]\nsmoothing = 9",
        &["between 1 and 2.5"],
    ),
    (
        "[relax]",
        "[method.wcsph]\ntime_stepping = {}",
        &["exactly one of fixed, adaptive"],
    ),
    (
        "velocity =",
        "colour = \"red\"\nvelocity =",
        &["16:10", "is not a colour", "#1f77b4"],
    ),
    (
        "[body.drop]",
        "[body.Drop]",
        &["14:7", "is not a name", "lower-case"],
    ),
];

#[test]
fn wrong_values_say_where_what_and_how() {
    for (from, to, parts) in WRONG {
        holds(&edited(from, to).to_string(), parts);
    }
}

#[test]
fn scenes_that_make_no_sense_are_refused() {
    let sphere = "sphere = { diameter = \"2 mm\", gap = \"0.4 mm\", above = \"pool\" }";
    let edit = |to: &str| edited(sphere, to).to_string();
    let centred = |centre: &str| {
        edit(&format!(
            "sphere = {{ diameter = \"2 mm\", centre = {centre} }}"
        ))
    };
    let mm = "[\"4 mm\", \"4 mm\", \"9.5 mm\"]";
    holds(
        &centred(mm),
        &[
            "15:10",
            "body.drop.sphere",
            "10.5 mm",
            "out of the box",
            "box.size",
        ],
    );
    holds(
        &centred("[\"4 mm\", \"4 mm\", \"2.9 mm\"]"),
        &["overlaps body `pool`"],
    );
    holds(
        &edit("layer = { depth = \"1 mm\" }"),
        &["overlaps body `pool`"],
    );
    holds(
        &edit("disc = { diameter = \"2 mm\" }"),
        &["not a shape of a 3-D scene", "sphere"],
    );
    holds(
        &edit(&format!("{sphere}\nlayer = {{ depth = \"1 mm\" }}")),
        &["exactly one of"],
    );
    holds(
        &edit(""),
        &["body.drop", "is missing", "exactly one of layer"],
    );
    holds(
        &edit("sphere = { diameter = \"2 mm\" }"),
        &["body.drop.sphere.centre", "`gap`"],
    );
    let above = sphere.replace("pool", "lake");
    holds(
        &edit(&above),
        &["\"lake\"", "is not a body", "earlier in the file: pool"],
    );
    let both = sphere.replace("gap", "centre = [0, 0, 0], gap");
    holds(&edit(&both), &["beside `centre`"]);
    let low = "block = { low = [0, 0, 0.004], high = [0.001, 0.001, 0.004] }";
    holds(&edit(low), &["body.drop.block.high", "not above `low`"]);
}

#[test]
fn motions_and_spacings_that_make_no_sense_are_refused() {
    holds(
        &edited(
            "velocity = \"1.5 m/s\"",
            "velocity = 1\nstretch = { rate = 1 }",
        )
        .to_string(),
        &["second initial velocity"],
    );
    let vortex = edited("velocity = \"1.5 m/s\"", "taylor_green = { speed = 1 }").to_string();
    holds(&vortex, &["body.drop.taylor_green", "periodic square"]);
    let spacing = edited("\"0.4 mm\"\n[relax]", "\"0.45 mm\"\n[relax]").to_string();
    holds(
        &spacing,
        &["18:11", "does not divide", "0.444444", "0.470588"],
    );
    let coarse = edited("\"0.4 mm\"\n[relax]", "\"2 mm\"\n[relax]").to_string();
    holds(&coarse, &["fewer than 2 particles across body `pool`"]);
    let tiny = "[\"2.4 mm\", \"8 mm\", \"10 mm\"]";
    let narrow = edited("[\"8 mm\", \"8 mm\", \"10 mm\"]", tiny).to_string();
    holds(&narrow, &["box.size", "periodic in x", "at least 4.2 mm"]);
}

#[test]
fn sides_walls_and_times_are_checked() {
    let boxed = |line: &str| edited("[liquid]", &format!("{line}\n[liquid]")).to_string();
    holds(
        &boxed("x = [\"periodic\", \"wall\"]"),
        &["box.x", "periodic on one side only"],
    );
    let open = boxed("wall_velocity = { z_high = [1, 0, 0] }");
    holds(
        &open,
        &["box.wall_velocity.z_high", "without a wall", "`box.z`"],
    );
    let through = boxed("wall_velocity = { z_low = [1, 0, 2] }");
    holds(&through, &["moves the wall through the liquid"]);
    let gravity = edited("\"9.81 m/s^2\"", "\"9.81 m/s^2\"\ndirection = [0, 0, 0]").to_string();
    holds(&gravity, &["effects.gravity.direction", "has no direction"]);
    let frames = edited("\"0.5 ms\"", "\"1 ns\"").to_string();
    holds(&frames, &["frames.interval", "frames", "longer"]);
    // A wrong unit is told at once, without counting.
    let tiny = edited("\"0.4 mm\"\n[relax]", "\"1e-16 m\"\n[relax]").to_string();
    holds(&tiny, &["pack.spacing", "particles"]);
    for scale in ["1e30", "1e-12"] {
        let times = format!("\"0.5 ms\"\ntime_scale = {scale}");
        let times = edited("\"0.5 ms\"", &times).to_string();
        holds(&times, &["frames.time_scale", "nearer to 1"]);
    }
    let step = "[method.wcsph]\ntime_stepping = { fixed = { step = \"1 ms\" } }\n[relax]";
    let unstable = edited("[relax]", step).to_string();
    holds(
        &unstable,
        &[
            "time_stepping.fixed.step",
            "takes fixed steps of 1 ms",
            "adaptive",
        ],
    );
    let sets = [
        "effects.viscosity.dynamic=20 Pa s",
        "method.wcsph.time_stepping={ fixed = { step = \"4 us\" } }",
    ];
    let viscous = file::read(SMALL, Path::new("small.toml"), &sets.map(String::from)).unwrap_err();
    holds(&viscous.to_string(), &["above the viscous limit of"]);
    let none = SMALL.replace("[body.", "[post.");
    let error = file::read(&none, Path::new("small.toml"), &[])
        .unwrap_err()
        .to_string();
    holds(&error, &["small.toml:12:7", "unknown key `post.pool`"]);
    let empty = SMALL
        .replace("[body.pool]\nlayer = { depth = \"2 mm\" }\n", "[body]\n")
        .replace(
            "[body.drop]\nsphere = { diameter = \"2 mm\", gap = \"0.4 mm\", above = \"pool\" }\n",
            "",
        )
        .replace("velocity = \"1.5 m/s\"\n", "");
    let error = file::read(&empty, Path::new("small.toml"), &[])
        .unwrap_err()
        .to_string();
    holds(&error, &["`body`", "has 0 bodies", "[body.NAME]"]);
}

#[test]
fn reference_curves_must_be_there_with_a_time_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let post = "[post]\nreferences = [{ label = \"experiment\", path = \"curve.csv\" }]\n";
    std::fs::write(&path, format!("{SMALL}{post}")).unwrap();
    let missing = file::load(&path, &[]).unwrap_err().to_string();
    holds(
        &missing,
        &[
            "scene.toml:",
            "post.references[0].path",
            "curve.csv",
            "cannot open",
        ],
    );
    std::fs::write(folder.path().join("curve.csv"), "t,depth\n0,0\n").unwrap();
    holds(
        &file::load(&path, &[]).unwrap_err().to_string(),
        &["no column `time_s` or `time_after_contact_s`"],
    );
    std::fs::write(
        folder.path().join("curve.csv"),
        "# source\ntime_s,depth\n0,0\n",
    )
    .unwrap();
    assert_eq!(
        file::load(&path, &[]).unwrap().scene.post.references[0].label,
        "experiment"
    );
}

#[test]
fn arguments_of_set_are_named() {
    holds(
        &set("impact.end"),
        &["--set impact.end", "has no `=`", "--set key.key=value"],
    );
    holds(&set("impact..end=1"), &["empty key"]);
    holds(
        &set("title.x=1"),
        &["--set title.x=1", "`title`", "is a table", "write a string"],
    );
    holds(
        &set("body.drop.velocity=5 kg"),
        &[
            "--set body.drop.velocity=5 kg",
            "`kg` is not a known unit of speed",
        ],
    );
    holds(
        &set("impact.ende=1 s"),
        &["--set impact.ende=1 s", "did you mean `impact.end`"],
    );
    holds(
        &set("body.drip.velocity=1 m/s"),
        &[
            "--set body.drip.velocity=1 m/s",
            "did you mean `body.drop`?",
        ],
    );
    holds(&set("dimension=4"), &["--set dimension=4", "write 2 or 3"]);
}

#[test]
fn text_that_is_no_toml_and_files_that_are_not_there() {
    let syntax = file::read("title = \n", Path::new("small.toml"), &[])
        .unwrap_err()
        .to_string();
    holds(&syntax, &["small.toml:1:", "not TOML"]);
    let twice = format!("{SMALL}[frames]\n");
    let error = file::read(&twice, Path::new("small.toml"), &[])
        .unwrap_err()
        .to_string();
    holds(&error, &["small.toml:24:2", "duplicate"]);
    let error = file::load(Path::new("no/such.toml"), &[]).unwrap_err();
    assert!(matches!(error, SceneError::File(_)));
    holds(&error.to_string(), &["no/such.toml", "cannot open"]);
}
