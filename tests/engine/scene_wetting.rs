//! What a scene with a contact angle must have.

use crate::scene_error::holds;
use coronet::scene::file;
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
