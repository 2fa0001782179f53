//! Scene files: the format, `--set`, and every file that is shipped.

use coronet::scene::file::{self, Loaded};
use coronet::scene::{
    Arrangement, Dimension, Effects, Method, Motion, Shape, Side, Sph, TensionIn, TimeStepping,
    Wcsph, key, numbers, schema,
};
use std::path::{Path, PathBuf};

pub const SMALL: &str = r#"
[box]
size = ["8 mm", "8 mm", "10 mm"]
[liquid]
density = "1100 kg/m^3"
[effects.gravity]
acceleration = "9.81 m/s^2"
[effects.viscosity]
dynamic = "3.5 mPa s"
[effects.tension]
coefficient = "67 mN/m"
[body.pool]
layer = { depth = "2 mm" }
[body.drop]
sphere = { diameter = "2 mm", gap = "0.4 mm", above = "pool" }
velocity = "1.5 m/s"
[pack]
spacing = "0.4 mm"
[relax]
[impact]
end = "5 ms"
[frames]
interval = "0.5 ms"
"#;

/// `SMALL` with overrides.
pub fn small(sets: &[&str]) -> Loaded {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    file::read(SMALL, Path::new("small.toml"), &sets).unwrap_or_else(|error| panic!("{error}"))
}

fn settings(loaded: &Loaded) -> Wcsph {
    let Method::Wcsph(settings) = &loaded.scene.method else {
        panic!("{}", loaded.scene.method.name());
    };
    settings.clone()
}

/// Every scene file that is shipped; `scenes/study` holds tables of runs of them.
pub fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![root.join("pipeline.toml")];
    let mut folders = vec![root.join("scenes")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.extend((!path.ends_with("study")).then_some(path));
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

#[test]
fn values_arrive_in_si_with_defaults() {
    let loaded = small(&[]);
    let scene = &loaded.scene;
    assert_eq!(loaded.text, SMALL);
    assert_eq!(scene.name, "small");
    assert_eq!(scene.dimension, Dimension::Three);
    assert_eq!(scene.domain.size, [0.008, 0.008, 0.01]);
    assert_eq!(scene.domain.boundary[0], [Side::Periodic; 2]);
    assert_eq!(scene.domain.boundary[2], [Side::Wall, Side::Open]);
    let effects = Effects {
        gravity: Some([0.0, 0.0, -9.81]),
        ..scene.effects.clone()
    };
    assert_eq!(scene.effects, effects);
    assert_eq!(scene.effects.mu(), Some(0.0035));
    assert_eq!(scene.effects.sigma(), Some(0.067));
    assert_eq!(scene.effects.wetting, None);
    assert_eq!(scene.bodies[0].name, "pool");
    assert_eq!(scene.bodies[0].shape, Shape::Layer { depth: 0.002 });
    assert_eq!(scene.bodies[1].motion, Motion::Uniform([0.0, 0.0, -1.5]));
    let Shape::Sphere { centre, radius } = scene.bodies[1].shape else {
        panic!("{:?}", scene.bodies[1]);
    };
    assert_eq!((centre[0], centre[1], radius), (0.004, 0.004, 0.001));
    assert!((centre[2] - 0.0034).abs() < 1e-15);
    assert_eq!(scene.pack.arrangement, Arrangement::Poisson);
    assert_eq!((scene.pack.tolerance, scene.pack.seed), (0.1, 1));
    let relax = scene.relax.as_ref().unwrap();
    assert_eq!((relax.time, relax.damping), (0.02, 500.0));
    assert_eq!(scene.frames.time_scale, 1.0);
    assert_eq!(settings(&loaded).shifting, 4.0);
}

#[test]
fn overrides_replace_what_the_file_says() {
    let loaded = small(&[
        "body.drop.velocity=2.42 m/s",
        "pack.spacing=\"0.5 mm\"",
        "pack.arrangement=lattice",
        "impact.end=0.01",
        "effects.tension.strength=4.5",
        "method={ preset = \"paper\" }",
        "method.wcsph.smoothing=1.2",
        "method.wcsph.time_stepping={ adaptive = { safety = 0.5 } }",
        "post.panels=[\"1 ms\", 2e-3]",
    ]);
    let scene = &loaded.scene;
    assert_eq!(scene.bodies[1].motion, Motion::Uniform([0.0, 0.0, -2.42]));
    assert_eq!(scene.spacing, 0.0005);
    assert_eq!(scene.pack.arrangement, Arrangement::Lattice);
    assert_eq!(scene.impact.end, 0.01);
    assert_eq!(scene.post.panels, [0.001, 0.002]);
    let expected = Wcsph {
        sph: Sph {
            smoothing: 1.2,
            ..settings(&small(&["method.preset=paper"])).sph
        },
        time_stepping: TimeStepping::Adaptive {
            safety: 0.5,
            tension: TensionIn::Each,
        },
        ..settings(&small(&["method.preset=paper"]))
    };
    assert_eq!(settings(&loaded), expected);
    let again = file::read(&loaded.text, Path::new("small.toml"), &[]).unwrap();
    assert_eq!(again.scene, *scene, "{}", loaded.text);
}

/// Settings as keys name them: name and value.
fn named(sets: &[&str]) -> Vec<(String, String)> {
    let scene = small(sets).scene;
    let list = key::settings(&scene.impact_input(), &scene).unwrap();
    list.into_iter()
        .map(|setting| (setting.name, setting.value))
        .collect()
}

/// Every key of a method and of the effects' forms, with every word that the schema knows for it,
/// arrives in the input of the impact.
#[test]
fn every_setting_of_every_method_can_be_overridden() {
    let mut tried = 0;
    for method in ["wcsph", "isph", "mps"] {
        let table = ["properties", "method", "properties", method, "properties"];
        let keys = table.iter().fold(&*file::SCHEMA, |at, key| &at[key]);
        for (key, rule) in keys.as_object().unwrap() {
            let words = ["oneOf", "anyOf"].map(|word| rule[word].as_array());
            let words = words.into_iter().flatten().flatten();
            let words = words.flat_map(|one| match one["enum"].as_array() {
                Some(words) => words.clone(),
                None => vec![one["const"].clone()],
            });
            let bounds = ["minimum", "maximum"].map(|bound| rule[bound].clone());
            for value in words.chain(bounds).filter(|value| !value.is_null()) {
                let name = format!("method.{method}.{key}");
                let method = format!("method.name={method}");
                let sets = [&method[..], &format!("{name}={value}")];
                let Ok(list) = std::panic::catch_unwind(|| named(&sets)) else {
                    continue; // what one setting needs of another: its own tests
                };
                let value = value.to_string().replace('"', "");
                let is_it = |(is, has): &(String, String)| *is == name && same(has, &value);
                let is_there = list.iter().any(is_it);
                let is_unread = ["beta", "wall_pressure"].contains(&key.as_str());
                assert!(is_there || is_unread, "{name} = {value}: {list:?}");
                tried += 1;
            }
        }
    }
    assert!(tried > 40, "{tried} tried");
}

/// Whether a value is the one that was given, units apart.
fn same(has: &str, given: &str) -> bool {
    let number = |text: &str| {
        text.split(' ')
            .next()
            .and_then(|text| text.parse::<f64>().ok())
    };
    has == given || (number(has).is_some() && number(has) == number(given))
}

/// A preset gives every setting that its method has, with the forms of the effects.
#[test]
fn presets_are_complete() {
    for (method, preset, expected) in [
        (
            "wcsph",
            "paper",
            ["cubic-spline", "two-term", "normalised-colour"],
        ),
        (
            "wcsph",
            "corrected",
            ["cubic-spline", "two-term-exact", "normalised-colour"],
        ),
        (
            "wcsph",
            "modern",
            ["wendland-c2", "central", "surface-energy"],
        ),
        ("isph", "paper", ["cubic-spline", "cleary", "cahn-hilliard"]),
        (
            "isph",
            "corrected",
            ["cubic-spline", "cleary", "cahn-hilliard"],
        ),
        (
            "isph",
            "modern",
            ["wendland-c2", "central", "surface-energy"],
        ),
        ("mps", "paper", ["", "", "number-density"]),
        ("mps", "corrected", ["", "", "number-density-exact"]),
        ("mps", "modern", ["", "", "surface-energy"]),
    ] {
        let sets = [
            format!("method.name={method}"),
            format!("method.preset={preset}"),
        ];
        let list = named(&sets.each_ref().map(String::as_str));
        let value = |name: &str| {
            let found = list.iter().find(|(is, _)| is == name);
            found.map_or("", |(_, value)| value.as_str())
        };
        let kernel = format!("method.{method}.kernel");
        let found = [&kernel, "effects.viscosity.form", "effects.tension.form"].map(value);
        assert_eq!(found, expected, "{method} {preset}");
    }
}

/// h of MPS is half the largest radius.
#[test]
fn the_support_of_mps_covers_both_radii() {
    let smoothing = |set: &str| {
        small(&["method.name=mps", set])
            .scene
            .method
            .sph()
            .smoothing
    };
    assert_eq!(smoothing("method.mps.radius=4"), 2.0);
    assert_eq!(smoothing("method.mps.laplacian_radius=4"), 2.0);
}

/// Both methods pack the same particles under the same key.
#[test]
fn methods_of_one_kernel_share_what_they_pack() {
    let key = |method: &str| {
        let scene = small(&[&format!("method.name={method}")]).scene;
        let list = key::settings(&scene.pack_input(0), &scene.resting(0)).unwrap();
        list.into_iter()
            .map(|setting| setting.canonical)
            .collect::<Vec<_>>()
    };
    assert_eq!(key("wcsph"), key("isph"));
}

#[test]
fn every_shipped_scene_loads_and_its_numbers_are_sane() {
    let files = shipped();
    assert_eq!(files.len(), 45, "a scene file came or went: {files:?}");
    for path in files {
        let loaded = file::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        let scene = &loaded.scene;
        let shown = path.display();
        assert!(!scene.title.is_empty(), "{shown}");
        let total: u64 = (0..scene.bodies.len())
            .map(|body| numbers::count(scene, body))
            .sum();
        let least = match (
            path.to_string_lossy().contains("hard"),
            scene.domain.is_revolved(),
        ) {
            (true, _) => 1,
            (_, true) => 100,
            _ => 300,
        };
        assert!(
            (least..1_200_000).contains(&total),
            "{shown}: {total} particles"
        );
        let sound = numbers::sound_speed(scene);
        match scene.method {
            Method::Wcsph(_) => assert!(sound > 0.05 && sound <= 100.0, "{shown}: {sound} m/s"),
            _ => assert_eq!(sound, f64::INFINITY, "{shown}"),
        }
        let limits = numbers::limits(scene);
        assert!(
            limits
                .iter()
                .all(|limit| limit.value > 1e-7 && limit.value < 10.0),
            "{shown}"
        );
        let steps = scene.impact.end / limits[0].value;
        assert!(steps < 5e5, "{shown}: {steps} steps");
        assert!(scene.impact.end / scene.frames.interval >= 10.0, "{shown}");
        let lines = numbers::of(scene).to_string();
        assert!(
            lines.contains("Limits of the time step"),
            "{shown}: {lines}"
        );
        for body in 0..scene.bodies.len() {
            assert!(
                numbers::rest_sound_speed(&scene.resting(body)) > 0.0,
                "{shown}"
            );
        }
    }
}

#[test]
fn the_reference_manual_shows_every_key() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("pipeline.toml")).unwrap();
    let keys = schema::keys(&file::SCHEMA);
    for key in keys.iter().filter_map(|key| key.rsplit('.').next()) {
        let key = key.split('_').next().unwrap();
        assert!(text.contains(key), "pipeline.toml does not mention `{key}`");
    }
}

#[test]
fn the_papers_case_has_the_papers_particles() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/nishio-2010/u3.13.toml");
    let scene = file::load(&path, &[]).unwrap().scene;
    assert_eq!(numbers::count(&scene, 0), 1_024_000);
    assert_eq!(numbers::count(&scene, 1), 1791);
    assert_eq!(numbers::sound_speed(&scene), 10.0 * 3.13);
}

/// The lines that are commented out in the manual show the defaults, except for these examples.
#[test]
fn the_reference_manual_shows_the_true_defaults() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("pipeline.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut shown = 0;
    let full: Vec<String> = text
        .lines()
        .map(|line| {
            let setting = line.strip_prefix("# ").unwrap_or("");
            let key = setting.split(" = ").next().unwrap();
            let is_key = key
                .bytes()
                .all(|byte| byte.is_ascii_lowercase() || byte == b'_');
            let examples = [
                "",
                "symmetry",
                "rings",
                "wall_velocity",
                "references",
                "angle",
                "advancing",
                "receding",
                "amplitude",
                "frequency",
            ];
            let example = examples.contains(&key);
            if example || !is_key || key.len() == setting.len() {
                return line.to_string();
            }
            shown += 1;
            setting.to_string()
        })
        .collect();
    assert!(shown > 17, "{shown} defaults found");
    let plain = file::read(&text, &path, &[]).unwrap().scene;
    let full = file::read(&full.join("\n"), &path, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(full.scene, plain);
}
