//! Warnings about scenes that are hardly meant, and silence about sound ones.

use coronet::scene::file;
use coronet::scene::sanity::{Warning, warnings};
use std::path::Path;

const TINY: &str = include_str!("../../scenes/tiny.toml");

fn of(sets: &[&str]) -> Vec<Warning> {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    let loaded = file::read(TINY, Path::new("tiny.toml"), &sets);
    warnings(&loaded.unwrap_or_else(|error| panic!("{error}")).scene)
}

fn keys(warnings: &[Warning]) -> Vec<&str> {
    warnings
        .iter()
        .map(|warning| warning.key.as_str())
        .collect()
}

/// A drop on the bare floor of a box with periodic sides.
const DRY: &str = "body={ drop = { sphere = { diameter = '2.4 mm', \
                   centre = ['4 mm', '4 mm', '2 mm'] }, velocity = '1.5 m/s' } }";

/// Settings, the key that is named, and a word of the warning.
const NONSENSE: &[(&[&str], &str, &str)] = &[
    (
        &["body.drop.velocity='-1.5 m/s'"],
        "body.drop.velocity",
        "1.5 m/s",
    ),
    (
        &["body.drop.velocity=[3, 0, 0]"],
        "body.drop.velocity",
        "meets nothing",
    ),
    (
        &[
            "body.drop.velocity=[9, 0, 9]",
            "box.x='open'",
            "box.z='open'",
        ],
        "body.drop.velocity",
        "leaves the box",
    ),
    (
        &["impact.end='0.1 ms'", "frames.interval='0.1 ms'"],
        "body.drop.velocity",
        "impact.end",
    ),
    (
        &["effects.gravity.direction=[0, 0, 1]"],
        "effects.gravity.direction",
        "up",
    ),
    (
        &["effects.gravity.direction=[0, -1, 0]"],
        "effects.gravity.direction",
        "sideways",
    ),
    (
        &["effects.gravity.direction=[1, 0, -1]"],
        "effects.gravity.direction",
        "along",
    ),
    (&["box.z='open'"], "box.z", "falls out"),
    (
        &["box.z='periodic'", "box.size=['8 mm', '8 mm', '8.8 mm']"],
        "box.z",
        "again and again",
    ),
    (&["box.y='open'"], "box.y", "flows out"),
    (
        &["effects.tension.coefficient=72.8"],
        "effects.tension.coefficient",
        "mN/m",
    ),
    (
        &["effects.tension.coefficient=1e-6"],
        "effects.tension.coefficient",
        "no liquid",
    ),
    (&["liquid.density=1"], "liquid.density", "no liquid"),
    (
        &["liquid.density='1100000 kg/m^3'"],
        "liquid.density",
        "no liquid",
    ),
    (
        &["effects.viscosity.dynamic=1e-9"],
        "effects.viscosity.dynamic",
        "no liquid",
    ),
    (&["frames.interval='1 s'"], "frames.interval", "first"),
    (&["frames.interval='0.3 ms'"], "post.panels", "nearest"),
    (&["frames.interval='0.4 ms'"], "post.fields", "2.8 ms"),
    (&["body.pool.layer.depth='1 mm'"], "pack.spacing", "`pool`"),
    (
        &["body.drop.sphere.diameter='1 mm'"],
        "pack.spacing",
        "`drop`",
    ),
    (&[DRY], "pack.spacing", "Roisman"),
    (&[DRY], "effects.tension.coefficient", "contact angle"),
    (
        &["box.x='wall'"],
        "effects.tension.coefficient",
        "effects.wetting.angle",
    ),
    (&["box.x='mirror'"], "box.x", "box.symmetry"),
    (
        &["body.drop.velocity=[1, 0, -1]"],
        "post.fields",
        "moves along x",
    ),
    (
        &["effects.viscosity.dynamic='100 Pa s'"],
        "effects.viscosity.dynamic",
        "before it touches",
    ),
    (
        &["body.drop.velocity='4e8 m/s'"],
        "body.drop.velocity",
        "compressible",
    ),
    (
        &["effects.gravity.acceleration='1e20 m/s^2'"],
        "effects.gravity.acceleration",
        "million",
    ),
];

#[test]
fn what_is_hardly_meant_is_named_with_value_and_remedy() {
    for (sets, key, word) in NONSENSE {
        let found = of(sets);
        let about = found.iter().filter(|warning| warning.key == *key);
        let texts: Vec<String> = about.map(ToString::to_string).collect();
        assert!(
            texts.iter().any(|text| text.contains(word)),
            "{sets:?}: {key} {word}: {found:?}"
        );
        for warning in &found {
            assert!(!warning.value.is_empty() && !warning.remedy.is_empty());
        }
    }
}

#[test]
fn what_may_be_meant_is_not_warned_of() {
    let sound: &[&[&str]] = &[
        &[],
        &["box.symmetry='quarter'"],
        &[
            "box.symmetry='half'",
            "box.x='wall'",
            "effects.wetting.angle='90 deg'",
        ],
        // Sideways, but it falls on the pool in the end.
        &["body.drop.velocity=[1, 0, -1]", "post.fields=[]"],
        // Thrown up a little, it falls back.
        &["body.drop.velocity=[0, 0, 0.02]", "impact.end='30 ms'"],
        &["body.drop.velocity=[0, 0, 0]"],
        // Molten metal.
        &[
            "liquid.density='7000 kg/m^3'",
            "effects.tension.coefficient='1.8 N/m'",
        ],
        &["box.x='wall'", "effects.wetting.angle='60 deg'"],
        &[
            "box.x='wall'",
            "effects={ gravity = { acceleration = 9.81, direction = [1, 0, -3] } }",
            "post.fields=[]",
        ],
        // A drop that drifts in an endless space.
        &[
            "effects={}",
            "box.z='periodic'",
            "box.size=['8 mm', '8 mm', '8.8 mm']",
            "body={ drop = { sphere = { diameter = '2.4 mm', \
             centre = ['4 mm', '4 mm', '4 mm'] }, velocity = '1.5 m/s' } }",
        ],
    ];
    for sets in sound {
        assert_eq!(of(sets), [], "{sets:?}");
    }
}

/// Warnings about shipped scenes that are true; all others have none.
const TRUE: &[(&str, &[&str])] = &[
    // One of its particles flies up and out.
    ("scenes/hard/mist.toml", &["body.p08.velocity"]),
    // It is about walls without an angle.
    (
        "scenes/hard/water-tank.toml",
        &["effects.tension.coefficient"],
    ),
    // It runs down.
    (
        "scenes/verification/film.toml",
        &["effects.gravity.direction"],
    ),
    // It has no end.
    ("scenes/verification/pipe.toml", &["box.z"]),
    // What is not within the thread is removed before it runs.
    ("scenes/verification/thread.toml", &["box.x"]),
    // A drop of a few particles.
    ("scenes/hard/particle.toml", &["pack.spacing"]),
    // Lamellas of 1.9 and 2.4 spacings.
    ("scenes/xie-2007/fukai-a-3d.toml", &["pack.spacing"]),
    ("scenes/xie-2007/fukai-a.toml", &["pack.spacing"]),
];

#[test]
fn shipped_scenes_are_sound_but_where_they_say_so() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut count, mut told) = (0, Vec::new());
    for path in crate::scene_file::shipped() {
        let scene = file::load(&path, &[]).unwrap().scene;
        let found = warnings(&scene);
        let name = path.strip_prefix(root).unwrap().display().to_string();
        let expected = TRUE.iter().find(|(scene, _)| *scene == name);
        if keys(&found) != expected.map_or(&[][..], |(_, keys)| keys) {
            let texts: Vec<String> = found.iter().map(ToString::to_string).collect();
            told.push(format!("{name}:\n  {}", texts.join("\n  ")));
        }
        count += 1;
    }
    assert!(told.is_empty(), "{}", told.join("\n"));
    assert!(count > 20);
}

#[test]
fn a_full_box_that_vibrates_is_warned_of_with_wcsph_alone() {
    let text = "dimension = 2\n[box]\nsize = ['4 mm', '4 mm']\nx = 'wall'\nz = 'wall'\n\
                [liquid]\ndensity = '1000 kg/m^3'\n\
                [effects.vibration]\namplitude = '0.1 mm'\nfrequency = '100 Hz'\n\
                direction = [1, 0]\n\
                [body.water]\nrectangle = { low = [0, 0], high = ['4 mm', '4 mm'] }\n\
                [pack]\nspacing = '0.2 mm'\n\
                [impact]\nend = '1 ms'\n[frames]\ninterval = '0.1 ms'\n";
    let found = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
        let loaded = file::read(text, Path::new("full.toml"), &sets).unwrap();
        let all = warnings(&loaded.scene);
        all.iter()
            .any(|warning| warning.key == "effects.vibration.frequency")
    };
    assert!(found(&[]));
    for set in [
        "method.wcsph.pressure='controlled'",
        "method.name='isph'",
        "box.x='periodic'",
        "body.water.rectangle.high=['4 mm', '3 mm']",
    ] {
        assert!(!found(&[set]), "{set}");
    }
}
