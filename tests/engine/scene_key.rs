//! Which settings are in which stage's list.

use crate::scene_file::small;
use coronet::scene::Scene;
use coronet::scene::key::{KeyError, Setting, settings as list};
use std::path::Path;

/// Lists of all stages by name; bodies are 0 (pool) and 1 (drop).
fn lists(scene: &Scene) -> Vec<(&'static str, Vec<Setting>)> {
    let pack = |body| list(&scene.pack_input(body), &scene.resting(body)).unwrap();
    let relax = |body| list(&scene.relax_input(body), &scene.resting(body)).unwrap();
    let post = scene.post_input(Path::new("")).unwrap();
    vec![
        ("pack pool", pack(0)),
        ("pack drop", pack(1)),
        ("relax pool", relax(0)),
        ("relax drop", relax(1)),
        ("calibrate", list(&scene.calibrate_input(), scene).unwrap()),
        ("impact", list(&scene.impact_input(), scene).unwrap()),
        ("post", list(&post, scene).unwrap()),
    ]
}

fn canonical(settings: &[Setting]) -> Vec<&[u8]> {
    settings
        .iter()
        .map(|setting| setting.canonical.as_slice())
        .collect()
}

/// Stages whose lists differ between the scene as it is and with `set`.
fn changed(set: &str) -> Vec<&'static str> {
    let before = lists(&small(&[]).scene);
    let after = lists(&small(&[set]).scene);
    let pairs = before.iter().zip(&after);
    let differ = pairs.filter(|(a, b)| canonical(&a.1) != canonical(&b.1));
    differ.map(|((name, _), _)| *name).collect()
}

#[test]
fn a_setting_reaches_exactly_the_stages_that_read_it() {
    let all = [
        "pack pool",
        "pack drop",
        "relax pool",
        "relax drop",
        "calibrate",
        "impact",
        "post",
    ];
    let motion = ["impact", "post"];
    let run = ["relax pool", "relax drop", "impact", "post"];
    let pool = ["pack pool", "relax pool", "calibrate", "impact", "post"];
    for (set, stages) in [
        ("title=another", &["post"][..]),
        ("body.drop.velocity=2 m/s", &motion),
        ("body.drop.sphere.gap=0.6 mm", &motion),
        ("body.drop.sphere.offset=[0.001, 0]", &motion),
        (
            "body.drop.sphere.diameter=2.4 mm",
            &["pack drop", "relax drop", "calibrate", "impact", "post"],
        ),
        ("body.drop.colour=\"#123456\"", &motion),
        ("body.pool.layer.depth=2.4 mm", &pool),
        ("box.size=[\"8 mm\", \"8 mm\", \"12 mm\"]", &pool),
        ("box.z=\"wall\"", &pool),
        ("liquid.density=1000", &all),
        ("effects.gravity.acceleration=1.62 m/s^2", &pool[1..]),
        ("effects.viscosity.dynamic=1 mPa s", &run),
        ("effects.viscosity.form=two-term", &run),
        ("effects.tension.coefficient=72 mN/m", &all[2..]),
        ("effects.tension.smoothing=1.7", &all[2..]),
        ("effects.wetting.angle=60 deg", &pool[1..]),
        ("pack.spacing=0.2 mm", &all),
        ("pack.seed=2", &["pack pool", "pack drop"]),
        ("pack.tolerance=1 kg/m^3", &["pack pool", "pack drop"]),
        ("pack.iterations=9", &["pack pool", "pack drop"]),
        ("pack.arrangement=lattice", &["pack pool", "pack drop"]),
        ("relax.time=10 ms", &["relax pool", "relax drop"]),
        ("relax.damping=1 1/s", &["relax pool", "relax drop"]),
        ("impact.end=6 ms", &motion),
        ("impact.checkpoint_every=1 s", &[]),
        ("frames.interval=1 ms", &motion),
        ("frames.time_scale=10", &["impact"]),
        ("frames.colour=speed", &["impact"]),
        ("post.panels=[\"1 ms\"]", &["post"]),
        ("post.fields=[\"1 ms\"]", &["post"]),
        ("method.preset=modern", &[]),
        ("method.precision=double", &all[2..]),
        ("method.slack=0.2", &all[2..]),
        ("method.wcsph.kernel=cubic-spline", &all),
        ("method.wcsph.exponent=7", &all[2..]),
        ("method.wcsph.sound_speed_factor=12", &motion),
        ("method.wcsph.reference_speed=2 m/s", &motion),
        ("method.wcsph.wall_pressure=summation", &all[2..]),
        ("method.wcsph.shifting=0.5", &all[2..]),
        ("method.wcsph.time_stepping={ adaptive = {} }", &all[2..]),
    ] {
        assert_eq!(changed(set), stages, "{set}");
    }
}

#[test]
fn reasons_show_names_as_in_the_file_and_values_with_units() {
    let scene = small(&[]).scene;
    let impact = list(&scene.impact_input(), &scene).unwrap();
    let shown = |name: &str| {
        let setting = impact.iter().find(|setting| setting.name == name);
        setting.unwrap_or_else(|| panic!("{name}")).value.clone()
    };
    assert_eq!(shown("body.drop.velocity"), "1.5 m/s");
    assert_eq!(shown("body.drop.sphere.diameter"), "2 mm");
    assert_eq!(shown("body.pool.layer.depth"), "2 mm");
    assert_eq!(shown("box.size"), "[8 mm, 8 mm, 10 mm]");
    assert_eq!(shown("box.z"), "[wall, open]");
    assert_eq!(shown("effects.gravity.acceleration"), "9.81 m/s^2");
    assert_eq!(shown("effects.tension.coefficient"), "67 mN/m");
    assert_eq!(shown("method.wcsph.density.continuity.diffusion"), "0.1");
    assert_eq!(shown("impact.end"), "5 ms");
}

#[test]
fn names_are_unique_within_a_list() {
    for (stage, settings) in lists(&small(&[]).scene) {
        let mut names: Vec<&str> = settings
            .iter()
            .map(|setting| setting.name.as_str())
            .collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count, "{stage}: {names:?}");
        assert!(!settings.is_empty(), "{stage}");
    }
}

#[test]
fn settings_of_absent_effects_are_in_no_list() {
    let tables = [
        ("gravity", "acceleration = \"9.81 m/s^2\"\n"),
        ("viscosity", "dynamic = \"3.5 mPa s\"\n"),
        ("tension", "coefficient = \"67 mN/m\"\n"),
    ];
    let mut bare = crate::scene_file::SMALL.to_string();
    for (effect, value) in tables {
        let table = format!("[effects.{effect}]\n{value}");
        assert!(bare.contains(&table), "{table}");
        bare = bare.replace(&table, "");
    }
    for method in ["wcsph", "isph", "mps"] {
        let set = format!("method.name={method}");
        let loaded = coronet::scene::file::read(&bare, Path::new("bare.toml"), &[set]);
        let scene = loaded.unwrap().scene;
        assert_eq!(scene.calibrate_input(), None);
        for (stage, settings) in lists(&scene) {
            let mut names = settings.iter().map(|setting| setting.name.as_str());
            let absent = |name: &&str| tables.iter().any(|(effect, _)| name.contains(effect));
            assert_eq!(names.find(absent), None, "{method}: {stage}");
        }
    }
}

#[test]
fn what_a_body_is_called_changes_no_packing() {
    let renamed = crate::scene_file::SMALL.replace("drop", "projectile");
    let scene = coronet::scene::file::read(&renamed, Path::new("x.toml"), &[])
        .unwrap()
        .scene;
    let before = lists(&small(&[]).scene);
    for ((stage, a), (_, b)) in before.iter().zip(lists(&scene)) {
        let same = canonical(a) == canonical(&b);
        assert_eq!(same, !["impact", "post"].contains(stage), "{stage}");
    }
}

#[test]
fn equal_values_are_equal_however_they_are_written() {
    for (one, other) in [
        (
            "body.drop.velocity=0.9 m/s",
            "body.drop.velocity=[0, -0.0, \"-90 cm/s\"]",
        ),
        ("pack.spacing=0.4 mm", "pack.spacing=400 um"),
        (
            "effects.viscosity.dynamic=3.5 cP",
            "effects.viscosity.dynamic=0.0035",
        ),
        (
            "effects.gravity.direction=[0, 0, -1]",
            "effects.gravity.direction=[0, 0, -7]",
        ),
    ] {
        let lists = [one, other].map(|set| lists(&small(&[set]).scene));
        assert_eq!(lists[0], lists[1], "{one}");
    }
}

#[test]
fn what_is_not_a_number_is_refused() {
    let mut scene = small(&[]).scene;
    scene.density = f64::NAN;
    let fault = KeyError::NotANumber("liquid.density".to_string());
    assert_eq!(list(&scene.pack_input(0), &scene), Err(fault.clone()));
    assert_eq!(list(&scene.impact_input(), &scene), Err(fault));
}

#[test]
fn reference_curves_count_by_content() {
    let folder = tempfile::tempdir().unwrap();
    let post = "[post]\nreferences = [{ label = \"a\", path = \"curve.csv\" }]\n";
    let text = format!("{}{post}", crate::scene_file::SMALL);
    let curve = |place: &Path, content: &str| {
        std::fs::create_dir_all(place).unwrap();
        std::fs::write(place.join("curve.csv"), content).unwrap();
        let loaded = coronet::scene::file::read(&text, &place.join("x.toml"), &[]).unwrap();
        list(&loaded.scene.post_input(place).unwrap(), &loaded.scene).unwrap()
    };
    let first = curve(&folder.path().join("a"), "time_s\n0\n");
    let moved = curve(&folder.path().join("b"), "time_s\n0\n");
    let other = curve(&folder.path().join("b"), "time_s\n1\n");
    assert_eq!(first, moved);
    assert_ne!(canonical(&first), canonical(&other));
    let content = |list: &[Setting]| {
        let mut all = list.iter();
        all.find(|s| s.name == "post.references[0].content")
            .unwrap()
            .value
            .clone()
    };
    assert_ne!(content(&first), content(&other));
}
