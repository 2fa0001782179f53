//! What a scene with a contact angle must have.

use crate::scene_error::holds;
use coronet::scene::{Scene, file};
use std::path::Path;

#[test]
fn a_contact_angle_needs_tension_a_wall_and_a_form_that_has_it() {
    let with = |method: &str, tension: &str, low: &str| {
        let text = format!(
            "dimension = 2\n[box]\nsize = [\"9 mm\", \"9 mm\"]\nz = [\"{low}\", \"open\"]\n\
             [liquid]\ndensity = 1000\n{tension}[effects.wetting]\nangle = \"60 deg\"\n\
             [body.drop]\ndisc = {{ diameter = \"3 mm\", centre = [\"4 mm\", \"2 mm\"] }}\n\
             [pack]\nspacing = \"0.25 mm\"\ntolerance = 1\n[impact]\nend = \"1 ms\"\n\
             [frames]\ninterval = \"1 ms\"\n[method]\n{method}"
        );
        let read = file::read(&text, Path::new("drop.toml"), &[]);
        read.map(|_| ()).map_err(|error| error.to_string())
    };
    let tension = "[effects.tension]\ncoefficient = \"73 mN/m\"\n";
    for preset in ["paper", "corrected"] {
        let method = format!("name = \"mps\"\npreset = \"{preset}\"");
        assert_eq!(with(&method, tension, "wall"), Ok(()));
    }
    for method in ["wcsph", "isph", "mps"] {
        assert_eq!(
            with(&format!("name = \"{method}\""), tension, "wall"),
            Ok(())
        );
    }
    for (method, tension, low, parts) in [
        (
            "",
            "",
            "wall",
            ["effects.wetting", "tension", "[effects.tension]"],
        ),
        (
            "",
            tension,
            "open",
            ["effects.wetting", "needs a wall", "box.z"],
        ),
        (
            "preset = \"paper\"",
            tension,
            "wall",
            ["effects.wetting", "raw-colour", "modern"],
        ),
    ] {
        holds(&with(method, tension, low).unwrap_err(), &parts);
    }
}

#[test]
fn a_surface_energy_needs_what_can_do_its_work() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/tiny.toml");
    for (set, need) in [
        ("density=summation", "density that follows from its rate"),
        ("density={continuity={}}", ""),
        ("wall_pressure=summation", "density of their own"),
        ("pressure=controlled", "one pressure for each particle"),
        ("time_stepping={adaptive={}}", "dual stepping"),
        ("kernel=cubic-spline", "Wendland's kernel"),
    ] {
        let set = format!("method.wcsph.{set}");
        // Preset `modern` has another form then.
        assert!(
            file::load(&path, std::slice::from_ref(&set)).is_ok(),
            "{set}"
        );
        let form = "effects.tension.form=surface-energy".to_string();
        let read = file::load(&path, &[set, form]).map(|_| ());
        match need {
            "" => assert!(read.is_ok(), "{read:?}"),
            need => {
                let parts = ["effects.tension", need, "set "];
                holds(&read.unwrap_err().to_string(), &parts);
            }
        }
    }
}

#[test]
fn types_of_particles_are_for_two_dimensions_and_have_layers() {
    let read = |sets: &[&str]| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/xie-2007/static.toml");
        let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
        let read = file::load(&path, &sets).map(|read| read.scene);
        read.map_err(|error| error.to_string())
    };
    let paper = ["method.name=mps", "method.preset=paper"];
    let layers = |scene: Scene| scene.effects.wetting.unwrap().layers;
    assert_eq!(layers(read(&paper).unwrap()), Some([2.1, 4.1, 4.1]));
    let set = "effects.wetting.layers=[1.1, 3.1, 3.1]";
    let scene = read(&[&paper[..], &[set]].concat()).unwrap();
    assert_eq!(layers(scene), Some([1.1, 3.1, 3.1]));
    let no_use = ["effects.wetting.layers", "Young's force", "particle-types"];
    holds(&read(&[set]).unwrap_err(), &no_use);
    let types = "effects.wetting.form=particle-types";
    let parts = ["effects.wetting", "number-density", "young"];
    holds(&read(&[types]).unwrap_err(), &parts);
    let young = [&paper[..], &["effects.wetting.form=young"]].concat();
    let form = ["effects.wetting", "raw-colour"];
    holds(&read(&young).unwrap_err(), &form);
}

#[test]
fn two_angles_stand_for_hysteresis() {
    let read = |wetting: &str| {
        let text = format!(
            "dimension = 2\n[box]\nsize = [\"9 mm\", \"9 mm\"]\n[liquid]\ndensity = 1000\n\
             [effects.tension]\ncoefficient = \"73 mN/m\"\n[effects.wetting]\n{wetting}\n\
             [body.drop]\ndisc = {{ diameter = \"3 mm\", centre = [\"4 mm\", \"2 mm\"] }}\n\
             [pack]\nspacing = \"0.25 mm\"\ntolerance = 1\n[impact]\nend = \"1 ms\"\n\
             [frames]\ninterval = \"1 ms\"\n"
        );
        let read = file::read(&text, Path::new("drop.toml"), &[]);
        let wetting = |file: file::Loaded| file.scene.effects.wetting.expect("it is there");
        read.map(wetting).map_err(|error| error.to_string())
    };
    let both = "advancing = \"120 deg\"\nreceding = \"60 deg\"";
    let found = read(both).unwrap();
    assert!((found.angle - 90.0).abs() < 1e-12 && (found.friction() - 0.5).abs() < 1e-12);
    assert_eq!(read("angle = \"60 deg\"").unwrap().friction(), 0.0);
    let turned = both.replace("120", "30");
    for (wetting, parts) in [
        ("", ["effects.wetting", "one contact angle or two"]),
        ("advancing = \"60 deg\"", ["effects.wetting", "`receding`"]),
        (
            &format!("angle = \"60 deg\"\n{both}"),
            ["effects.wetting", "alone"],
        ),
        (&turned, ["effects.wetting.receding", "above the advancing"]),
    ] {
        holds(&read(wetting).unwrap_err(), &parts);
    }
}
