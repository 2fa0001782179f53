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
