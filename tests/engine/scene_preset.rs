//! What presets supply where the scene asks for something else.

use super::scene_file::{SMALL, small};
use coronet::scene::{Gradient, Method, TensionForm, file};
use std::path::Path;

/// Where the energy of the surface is not served, `modern` has the stress; angles of MPS too.
#[test]
fn presets_follow_what_the_scene_says() {
    let form = |sets: &[&str]| small(sets).scene.effects.tension.unwrap().form;
    assert_eq!(form(&[]), TensionForm::SurfaceEnergy);
    for set in [
        "method.wcsph.kernel=cubic-spline",
        "method.wcsph.time_stepping={ adaptive = {} }",
    ] {
        assert_eq!(form(&[set]), TensionForm::RawColour, "{set}");
    }
    let gradient = |sets: &[&str]| match small(sets).scene.problem.method {
        Method::Isph(isph) => isph.gradient,
        _ => panic!("not ISPH"),
    };
    let isph = "method.name=isph";
    assert_eq!(form(&[isph]), TensionForm::SurfaceEnergy);
    assert_eq!(gradient(&[isph]), Gradient::Transposed);
    for set in [
        "method.isph.gradient=corrected",
        "method.isph.closure=mirrored",
    ] {
        assert_eq!(form(&[isph, set]), TensionForm::RawColour, "{set}");
        assert_eq!(gradient(&[isph, set]), Gradient::Corrected, "{set}");
    }
    assert_eq!(
        gradient(&[isph, "effects.tension.form=raw-colour"]),
        Gradient::Corrected
    );
    assert_eq!(
        form(&[isph, "effects.wetting.angle=60 deg"]),
        TensionForm::SurfaceEnergy
    );
    let corrected = ["method.name=mps", "method.preset=corrected"];
    let wets = [&corrected[..], &["effects.wetting.angle=60 deg"]].concat();
    assert_eq!(form(&corrected), TensionForm::NumberDensityExact);
    assert_eq!(form(&wets), TensionForm::RawColour);
}

#[test]
fn mps_has_two_viscous_forms() {
    let form = |form: &str| {
        let form = format!("effects.viscosity.form={form}");
        let sets = ["method.name=mps".to_string(), form];
        file::read(SMALL, Path::new("small.toml"), &sets)
    };
    assert!(form("morris").is_ok() && form("central").is_ok());
    let cleary = form("cleary").unwrap_err().to_string();
    for part in ["effects.viscosity.form", "no form of mps", "central"] {
        assert!(cleary.contains(part), "{cleary}");
    }
}
